//! Several ranks with a device each, against one rank of the host.

use super::case::{Case, PERIODIC, Shape};
use super::*;
use crate::plan::problem::Precision;

/// Motions that all ranks found, in the order of ids.
fn joined(parts: Vec<(Vec<u64>, Motion)>) -> Motion {
    let ids: Vec<u64> = parts.iter().flat_map(|(ids, _)| ids.clone()).collect();
    let mut rows: Vec<usize> = (0..ids.len()).collect();
    rows.sort_by_key(|&row| ids[row]);
    let mut all = Motion::default();
    for (_, motion) in parts {
        all.velocities.extend(motion.velocities);
        all.angular_velocities.extend(motion.angular_velocities);
        all.strain_rates.extend(motion.strain_rates);
    }
    Motion {
        velocities: in_order(&all.velocities, &rows),
        angular_velocities: in_order(&all.angular_velocities, &rows),
        strain_rates: in_order(&all.strain_rates, &rows),
    }
}

/// Values by rows; none if there are none.
fn in_order<T: Copy>(values: &[T], rows: &[usize]) -> Vec<T> {
    if values.is_empty() { Vec::new() } else { rows.iter().map(|&row| values[row]).collect() }
}

/// Loads of some kinds of the particles with these ids.
fn selected(loads: &Loads, ids: &[u64]) -> Loads {
    let rows: Vec<usize> = ids.iter().map(|&id| id as usize).collect();
    Loads {
        forces: in_order(&loads.forces, &rows),
        torques: in_order(&loads.torques, &rows),
        stresslets: in_order(&loads.stresslets, &rows),
    }
}

/// Runs `body` on some ranks, each of which has the particles in its slab, and joins what they find.
fn on_ranks(ranks: usize, case: &Case, plan: &Plan, body: impl Fn(&Partition, &Particles) -> Motion + Sync) -> Motion {
    joined(Comm::threads(ranks, |comm| {
        let partition = Partition::with_table(&comm, [plan.grid[1], plan.grid[2]], [1, ranks]);
        let rows: Vec<usize> = (0..case.particles.len()).filter(|row| row % ranks == comm.rank()).collect();
        let mut particles = case.particles.selected(&rows);
        particles.migrate(&partition, &case.cell);
        let motion = body(&partition, &particles);
        (particles.ids, motion)
    }))
}

/// Motions of loads on devices whose threads have an order by a seed.
fn on_devices(ranks: usize, case: &Case, plan: &Plan, seed: u64, loads: &Loads, output: Output) -> Motion {
    on_ranks(ranks, case, plan, |partition, particles| {
        let mut far = DeviceFarField::on(emulator(&[], seed + partition.comm().rank() as u64), plan, partition);
        far.arrange(&case.cell, particles);
        far.apply(&selected(loads, &particles.ids), output)
    })
}

/// Largest difference of motions, kind by kind.
fn worst(found: &Motion, exact: &Motion) -> f64 {
    columns(found).iter().zip(columns(exact)).map(|(found, exact)| relative(found, &exact)).fold(0.0, f64::max)
}

/// Random cases of some shapes on some numbers of ranks, with loads and motions of all kinds in turn.
fn agree(precision: Precision, shapes: &[Shape], seeds: std::ops::Range<u64>, numbers: &[usize]) {
    let allowed = if precision == Precision::Double { 1e-11 } else { 2e-5 };
    for seed in seeds {
        let case = Case::random(seed, shapes[seed as usize % shapes.len()], [1.0, 2.3, 4.0][seed as usize % 3]);
        let plan = case.plan(precision);
        let mut host = case.on_host(&plan);
        for (turn, &ranks) in numbers.iter().enumerate() {
            let loads = &case.kinds()[(seed as usize + turn) % 4];
            let output = [Output::All, Output::Velocities, Output::Gradients][(seed as usize + turn) % 3];
            let found = worst(&on_devices(ranks, &case, &plan, seed, loads, output), &host.apply(loads, output));
            assert!(found < allowed, "case {seed} on {ranks} ranks, grid {:?}: {found:e}", plan.grid);
        }
    }
}

#[test]
fn ranks_agree_with_the_host_in_periodic_boxes() {
    agree(Precision::Double, &PERIODIC, 300..303, &[1, 2, 3]);
    agree(Precision::Single, &PERIODIC, 1300..1303, &[2, 7]);
}

#[test]
fn ranks_agree_with_the_host_at_walls_and_in_unbounded_fluid() {
    agree(Precision::Double, &CHANNELS, 400..403, &[2, 3]);
    agree(Precision::Single, &[OPEN], 1400..1402, &[2, 3]);
}

/// More cases, kinds of loads and ranks.
#[test]
#[ignore = "heavy"]
fn many_ranks_agree_with_the_host() {
    for precision in [Precision::Double, Precision::Single] {
        agree(precision, &PERIODIC, 310..310 + 2 * cases(), &[1, 2, 3, 7]);
        agree(precision, &CHANNELS, 410..410 + cases(), &[2, 3, 7]);
        agree(precision, &[OPEN], 510..510 + cases(), &[2, 3, 7]);
    }
}

/// A sphere's motion by three spheres at a corner of the box, with ranks that own none of them and most of them no
/// plane of the grid.
#[test]
fn ranks_without_particles_or_planes_take_part() {
    let case = Case::random(320, Shape::Sheared, 1.5).with_fraction_of_edges(Vector::splat(0.2));
    let rows: Vec<usize> = (0..3).collect();
    let case = Case { particles: case.particles.selected(&rows), loads: case.loads_of(&rows), ..case };
    let plan = case.plan(Precision::Double);
    let exact = case.on_host(&plan).apply(&case.loads, Output::All);
    for ranks in [3, plan.grid[2] + 3] {
        let found = worst(&on_devices(ranks, &case, &plan, 1, &case.loads, Output::All), &exact);
        assert!(found < 1e-11, "{ranks} ranks: {found:e}");
    }
}

/// Shuffled threads and blocks: sums of several ranks have a fixed order.
#[test]
fn ranks_have_the_same_bits_again() {
    for (shape, precision) in [(Shape::Tilted, Precision::Single), (CHANNELS[0], Precision::Double)] {
        let case = Case::random(330, shape, 1.7);
        let plan = case.plan(precision);
        let motion = |seed| on_devices(3, &case, &plan, seed, &case.loads, Output::All);
        assert_eq!(motion(1), motion(77));
    }
}

/// Random motions by the same numbers as those of one rank of the host.
#[test]
fn noise_of_ranks_is_that_of_the_host() {
    for (seed, shape, multipoles) in [
        (340, Shape::Sheared, Multipoles::Dipole),
        (341, Shape::Tilted, Multipoles::Monopole),
        (342, CHANNELS[1], Multipoles::Dipole),
    ] {
        let case = Case::random(seed, shape, 1.3);
        let plan = Plan { multipoles, ..case.plan(Precision::Double) };
        let stream = || crate::mobility::noise::Stream::new(3, seed);
        let all = NoiseRequest { ids: &case.particles.ids, tolerance: 1e-3, stream: stream() };
        let (exact, _) = case.on_host(&plan).noise(&all);
        let found = on_ranks(3, &case, &plan, |partition, particles| {
            let mut far = DeviceFarField::on(emulator(&[], seed), &plan, partition);
            far.arrange(&case.cell, particles);
            far.noise(&NoiseRequest { ids: &particles.ids, tolerance: 1e-3, stream: stream() }).0
        });
        let found = worst(&found, &exact);
        assert!(found < 1e-10, "{shape:?}: {found:e}");
    }
}

/// The solve for stresslets, whose iteration is on the host for several ranks.
#[test]
fn stresslets_of_ranks_are_those_of_the_host() {
    let case = Case::random(350, Shape::Sheared, 1.6);
    let plan = Plan { iteration_tolerance: 1e-9, ..case.plan(Precision::Double) };
    let background = Traceless([0.2, -0.1, 0.0, 0.3, 0.05]);
    let (loads, ambient) = (Loads { forces: case.loads.forces.clone(), ..Loads::default() }, Motion::default());
    let solved = |solver: &mut StressletSolver, particles: &Particles| {
        let loads = selected(&loads, &particles.ids);
        let input = RigidInput { loads: &loads, ambient: &ambient, background, guess: &[], quadrupoles: None };
        let found = solver.solve_in(&case.cell, particles, &input).unwrap();
        // Stresslets in the place of rates of strain.
        Motion { strain_rates: found.stresslets, ..found.motion }
    };
    let exact = solved(&mut StressletSolver::new(&plan, &alone(&plan)), &case.particles);
    for ranks in [2, 3] {
        let found = on_ranks(ranks, &case, &plan, |partition, particles| {
            let far: Box<dyn FarField> = Box::new(DeviceFarField::on(emulator(&[], 1), &plan, partition));
            let (plan, partition) = (plan.clone(), partition.clone());
            let comm = partition.comm().clone();
            let mobility = Mobility { plan, partition, far, wall_drift: None, constraint: None };
            solved(&mut StressletSolver::of(mobility, &comm), particles)
        });
        let found = worst(&found, &exact);
        assert!(found < 1e-7, "{ranks} ranks: {found:e}");
    }
}

/// The forecast of `check` for the card of each rank, beside the memory that an emulator serves.
#[test]
#[ignore = "heavy"]
fn memory_of_ranks_is_as_predicted() {
    for (seed, shape) in [(360, Shape::Sheared), (361, OPEN)] {
        let case = Case::random(seed, shape, 1.5);
        let plan = case.plan(Precision::Double);
        on_ranks(3, &case, &plan, |partition, particles| {
            let mut far = DeviceFarField::on(emulator(&[], seed), &plan, partition);
            far.arrange(&case.cell, particles);
            far.apply(&selected(&case.loads, &particles.ids), Output::All);
            let split = far.split.borrow();
            let card = split.device().unwrap();
            let (owned, present) = (particles.len() as f64, far.halo.present() as f64);
            let neighbours = split.neighbours() as f64 / owned.max(1.0);
            let counts = CardCounts { owned, present, ranks: 3 };
            let expected = plan.size_on_card(counts, neighbours).bytes().lists;
            let found = card.total_bytes - card.free_bytes;
            // Ranks with a plane less than others, the window, and tables along the axes.
            assert!((0.8 * expected..expected + 16e3).contains(&found), "{found} bytes, {expected} expected");
            Motion::default()
        });
    }
}
