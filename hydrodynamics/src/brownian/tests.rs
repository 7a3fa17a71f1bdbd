use super::*;
use crate::coupled_solver::ShortRange;
use domain::{Boundaries, Comm, Partition};
use fcm::{Costs, Fixed, Loading, Method, Mobility, Multipoles, Output, Plan, Problem, StressletSolver};
use gpu::Emulator;
use lubrication::LubricationRange;

/// Three near spheres in a cube of edge 14, sheared by 0.2, at a viscosity of 1.
const PLACES: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [1.9, 0.85, 0.2], [1.0, -0.6, 2.95]];
const RADII: [f64; 3] = [1.0, 1.0, 2.0];

/// Divergence of their mobility, velocities and then angular velocities, by central differences of dense matrices of
/// the method without a grid; without lubrication, and with that of all three pairs (exact, by bispherical
/// coordinates).
const FAR: [f64; 18] = [
    -1.569987629198e-03,
    -5.236852091350e-04,
    -7.580833588286e-04,
    1.655137046935e-03,
    9.396971267631e-04,
    -5.466529678249e-04,
    -1.897514727335e-05,
    3.494672579984e-05,
    -3.449300271948e-05,
    -1.293397369863e-04,
    8.037728089272e-05,
    2.115588762253e-05,
    2.027093712867e-05,
    -1.281800927593e-04,
    -9.998388670747e-05,
    -1.905513180238e-05,
    1.220784143764e-05,
    6.326800533505e-06,
];
const LUBRICATED: [f64; 18] = [
    -3.466151914010e-02,
    -7.624689296715e-03,
    -2.587432368012e-02,
    3.108198638554e-02,
    1.936784255828e-02,
    -1.190328224174e-02,
    3.269240068242e-05,
    -4.948472530173e-04,
    7.902728976489e-04,
    -2.027907977294e-03,
    4.070383287290e-03,
    1.515595730878e-03,
    2.857902098875e-03,
    -5.833614976104e-03,
    -2.166103987472e-03,
    -2.448684841434e-04,
    4.290255716572e-04,
    1.792479072141e-04,
];

/// Divergence of the first moments caused by forces, with lubrication, far-field and near-field parts together: the
/// components along diag(-1, -1, 2)/sqrt(6), diag(1, -1, 0)/sqrt(2), and the three off-diagonal ones over sqrt(2),
/// sphere by sphere.
const MOMENTS: [[f64; 5]; 3] = [
    [0.119091439, 0.590403586, 0.563819431, 0.467478175, -0.189779820],
    [-0.189979055, 0.516763329, 0.720130936, -0.028341371, -0.241648021],
    [0.119125121, -0.078961979, -0.162501413, 0.039366107, 0.013337035],
];

fn particles() -> Particles {
    let mut particles = Particles::default();
    for (id, (place, radius)) in PLACES.into_iter().zip(RADII).enumerate() {
        particles.push(id as u64, Vector::from_array(place) + Vector::splat(5.0), radius, 0);
    }
    particles
}

fn hydrodynamics(cell: &PeriodicBox, tolerance: f64, lubrication: Option<LubricationRange>) -> CoupledSolver {
    let (plan, partition) = planned(cell, tolerance, lubrication, Fixed::default());
    CoupledSolver::new(&plan, &partition, ShortRange { lubrication, springs: None }).unwrap()
}

/// The same by the kernels of a card, which an emulator runs.
fn on_card(cell: &PeriodicBox, tolerance: f64, lubrication: Option<LubricationRange>) -> CoupledSolver {
    let fixed = Fixed { method: Some(Method::Split), ..Fixed::default() };
    let (plan, partition) = planned(cell, tolerance, lubrication, fixed);
    let device = Box::new(Emulator::beside_program(&[], 3).unwrap());
    let far = StressletSolver::of(Mobility::on(device, &plan, &partition), partition.comm());
    CoupledSolver::of(far, &partition, ShortRange { lubrication, springs: None }).unwrap()
}

fn planned(
    cell: &PeriodicBox,
    tolerance: f64,
    lubrication: Option<LubricationRange>,
    fixed: Fixed,
) -> (Plan, Partition) {
    let problem = Problem {
        edges: cell.edges(),
        boundaries: cell.boundaries(),
        volume: cell.edges().element_product(),
        shortest_vector: Problem::shortest_vector_of(cell),
        smallest_edge_ratio: 1.0,
        largest_strain: cell.strain().abs(),
        largest_tilts: [0.0; 2],
        radii: vec![(1.0, 2), (2.0, 1)],
        viscosity: 1.0,
        multipoles: Multipoles::Dipole,
        rigid: true,
        lubricated: lubrication.is_some(),
        loading: Loading::Varied,
        tolerance,
        threads: 1,
        ranks: 1,
        costs: Costs::default(),
        network: None,
        fixed,
    };
    let plan = Plan::choose(&problem).unwrap();
    let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
    (plan, partition)
}

/// `sum_k d_k (A M_{.,k})` over the coordinates `k` of all spheres, with `M_{.,k}` the motions of the fluid due to a
/// unit force along `k`, which are kept while that sphere is displaced along `k` in either direction: the mean over
/// random motions, without their variance. Near walls `A sum_k d_k M_{.,k}` is added.
fn divergence(
    hydrodynamics: &mut CoupledSolver,
    cell: &PeriodicBox,
    particles: &Particles,
    tolerance: f64,
) -> ([f64; 18], [Traceless; 3]) {
    let (mut sums, mut stresslets) = ([0.0; 18], [Traceless::ZERO; 3]);
    let mut add = |times: f64, (motion, by_heat): (Motion, Vec<Traceless>)| {
        let Motion { velocities, angular_velocities, .. } = motion;
        let numbers = [velocities, angular_velocities].concat().into_iter().flat_map(|v| v.to_array());
        sums.iter_mut().zip(numbers).for_each(|(sum, number)| *sum += times * number);
        stresslets.iter_mut().zip(by_heat).for_each(|(sum, s)| *sum += s * times);
    };
    for (sphere, axis) in (0..3).flat_map(|sphere| (0..3).map(move |axis| (sphere, axis))) {
        let mut particles = particles.clone();
        let mut forces = vec![Vector::ZERO; 3];
        forces[sphere][axis] = 1.0;
        hydrodynamics.mobility().arrange(cell, &particles);
        let fluid = hydrodynamics.mobility().apply(&Loads { forces, ..Loads::default() }, Output::All);
        solve(hydrodynamics, cell, &mut particles, &Loads::default(), &fluid).unwrap();
        for length in [1e-3, -1e-3] {
            let mut moved = particles.clone();
            moved.positions[sphere][axis] += length;
            let change = FiniteDifference { over: length, energy: 0.0, tolerance };
            store_drift(hydrodynamics, cell, &mut moved, change).unwrap();
            add(0.5, drift(&mut moved));
        }
    }
    let (mut particles, zeros) = (particles.clone(), vec![Vector::ZERO; 3]);
    let rest = Motion { velocities: zeros.clone(), angular_velocities: zeros, strain_rates: vec![Traceless::ZERO; 3] };
    solve(hydrodynamics, cell, &mut particles, &Loads::default(), &rest).unwrap();
    store_drift(hydrodynamics, cell, &mut particles, FiniteDifference { over: 1.0, energy: 1.0, tolerance }).unwrap();
    add(1.0, drift(&mut particles));
    (sums, stresslets)
}

fn sheared() -> PeriodicBox {
    PeriodicBox::sheared(Vector::splat(14.0), 0.2).unwrap()
}

/// The divergence for the spheres in a sheared box.
fn divergence_in_shear(lubrication: Option<LubricationRange>, tolerance: f64) -> ([f64; 18], [Traceless; 3]) {
    divergence(&mut hydrodynamics(&sheared(), 1e-4, lubrication), &sheared(), &particles(), tolerance)
}

/// Distance of two lists, relative to the norm of the second.
fn error(found: &[f64], exact: &[f64]) -> f64 {
    let square = |list: &mut dyn Iterator<Item = f64>| list.map(|x| x * x).sum::<f64>();
    (square(&mut found.iter().zip(exact).map(|(a, b)| a - b)) / square(&mut exact.iter().copied())).sqrt()
}

/// Components in the orthonormal basis of the reference.
fn along(s: &Traceless) -> [f64; 5] {
    let ([xx, xy, xz, yy, yz], root) = (s.0, 2.0_f64.sqrt());
    [-1.5_f64.sqrt() * (xx + yy), (xx - yy) / root, root * xy, root * xz, root * yz]
}

/// Velocities, angular velocities and, with lubrication, Brownian stresslets, which are minus the divergence of the
/// first moments, each relative to its norm. The matrices with lubrication are accurate to half a per cent, and their
/// divergence is less accurate. Without the finite difference the result would be zero.
fn are_divergences(solver: impl Fn(Option<LubricationRange>) -> CoupledSolver) {
    let range = Some(LubricationRange::new(2.5, LubricationRange::MINIMUM_GAP).unwrap());
    let [(far, _), (near, stresslets)] =
        [None, range].map(|lubrication| divergence(&mut solver(lubrication), &sheared(), &particles(), 1e-3));
    let stresslets: Vec<f64> = stresslets.iter().flat_map(along).collect();
    let minus_moments: Vec<f64> = MOMENTS.concat().into_iter().map(|moment| -moment).collect();
    let errors = [
        error(&far[..9], &FAR[..9]),
        error(&far[9..], &FAR[9..]),
        error(&near[..9], &LUBRICATED[..9]),
        error(&near[9..], &LUBRICATED[9..]),
        error(&stresslets, &minus_moments),
    ];
    assert!(errors.iter().all(|error| *error < 0.03), "{errors:?}");
}

#[test]
fn drift_and_stress_by_heat_are_divergences() {
    are_divergences(|lubrication| hydrodynamics(&sheared(), 1e-4, lubrication));
}

#[test]
fn drift_and_stress_by_heat_on_a_card_are_divergences() {
    are_divergences(|lubrication| on_card(&sheared(), 1e-4, lubrication));
}

/// The error of the finite difference that a step allows is about that of the drift.
#[test]
fn rough_changes_are_as_exact_as_they_say() {
    let lubrication = Some(LubricationRange::new(2.5, LubricationRange::MINIMUM_GAP).unwrap());
    let [rough, exact] = [CHANGE, 1e-3].map(|tolerance| divergence_in_shear(lubrication, tolerance).0);
    let found = error(&rough[..9], &exact[..9]);
    assert!(found > 0.0 && found < 2.0 * CHANGE, "{found}");
}

/// Divergence of the mobility and of the stresslets of rigid spheres, by central differences of the response to unit
/// forces.
fn by_differences(
    hydrodynamics: &mut CoupledSolver,
    cell: &PeriodicBox,
    particles: &Particles,
) -> ([f64; 18], [Traceless; 3]) {
    const LENGTH: f64 = 5e-3;
    let (mut sums, mut stresslets) = ([0.0; 18], [Traceless::ZERO; 3]);
    for (sphere, axis) in (0..3).flat_map(|sphere| (0..3).map(move |axis| (sphere, axis))) {
        for length in [LENGTH, -LENGTH] {
            let mut moved = particles.clone();
            moved.positions[sphere][axis] += length;
            let mut forces = vec![Vector::ZERO; 3];
            forces[sphere][axis] = 0.5 / length;
            let loads = Loads { forces, ..Loads::default() };
            let acting = SolveInput::new(&loads, StrainRate::default());
            let solved = hydrodynamics.solve(cell, &moved, &acting, Guess::default()).unwrap();
            let numbers = [solved.motion.velocities, solved.motion.angular_velocities].concat();
            let numbers = numbers.into_iter().flat_map(|v| v.to_array());
            sums.iter_mut().zip(numbers).for_each(|(sum, number)| *sum += number);
            stresslets.iter_mut().zip(solved.stresslets).for_each(|(sum, s)| *sum += s);
        }
    }
    (sums, stresslets)
}

/// Between two walls and above one, with and without lubrication between spheres and at walls, drift and Brownian
/// stresslets equal the divergences by differences. Without the walls' effect on each sphere the error would exceed
/// 100%.
#[test]
#[ignore = "heavy"]
fn drift_and_stress_by_heat_are_divergences_near_walls() {
    let mut particles = Particles::default();
    for (id, (place, radius)) in
        [([3.0, 3.0, 1.3], 1.0), ([5.0, 3.6, 2.1], 1.0), ([4.0, 6.4, 5.6], 2.0)].into_iter().enumerate()
    {
        particles.push(id as u64, Vector::from_array(place), radius, 0);
    }
    let range = Some(LubricationRange::new(2.5, LubricationRange::MINIMUM_GAP).unwrap());
    for (boundaries, lubrication) in
        [(Boundaries::Walls, None), (Boundaries::Walls, range), (Boundaries::Wall, None), (Boundaries::Wall, range)]
    {
        let cell = PeriodicBox::new(Vector::new(12.0, 13.0, 8.0)).unwrap().with_boundaries(boundaries).unwrap();
        let mut hydrodynamics = hydrodynamics(&cell, 1e-6, lubrication);
        let (found, stresslets) = divergence(&mut hydrodynamics, &cell, &particles, 1e-4);
        let (exact, by_force) = by_differences(&mut hydrodynamics, &cell, &particles);
        let flat = |list: &[Traceless]| list.iter().flat_map(along).collect::<Vec<_>>();
        let errors = [
            error(&found[..9], &exact[..9]),
            error(&found[9..], &exact[9..]),
            error(&flat(&stresslets), &flat(&by_force)),
        ];
        println!("{boundaries:?} {}: {errors:?}", lubrication.is_some());
        assert!(errors.iter().all(|error| *error < 0.01), "{boundaries:?}: {errors:?}");
    }
}

/// In a step of 0.1 the displacement is limited to a twentieth of the radius, and unchanged below that.
#[test]
fn drift_is_no_jump() {
    let mut particles = particles();
    particles.vectors(DRIFT_VELOCITY).copy_from_slice(&[Vector::X * 0.3, Vector::Y * 7.0, Vector::Z * -7.0]);
    limit_drift(&mut particles, 0.1);
    let found = particles.vectors(DRIFT_VELOCITY).to_vec();
    for (found, wanted) in found.into_iter().zip([Vector::X * 0.3, Vector::Y * 0.5, Vector::Z * -1.0]) {
        assert!((found - wanted).length() < 1e-14, "{found}");
    }
}
