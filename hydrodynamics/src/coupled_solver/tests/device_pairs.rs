//! Near pairs that the kernels of a card find and assemble, against those of the host.

use super::on_device::{Suspension, emulator, relative};
use super::*;
use crate::pairs::lubrication::PairLubrication;
use domain::Tensor;
use fcm::{HeldSprings, NearInput, PairRows};
use gpu::Counted;

/// Lubrication of a solver.
pub(super) fn lubrication_of(solver: &CoupledSolver) -> &PairLubrication {
    solver.near.as_ref().and_then(|near| near.lubrication.as_ref()).unwrap()
}

impl Suspension {
    /// Numbers of stiff and of soft pairs, each counted for both of its spheres, by all images of all pairs.
    pub(super) fn pairs(&self, solver: &CoupledSolver) -> [u32; 2] {
        let rows = 0..self.particles.len();
        let of_pair = |counts: [u32; 2], pair| {
            let images = self.images(solver, pair);
            [counts[0] + images[0], counts[1] + images[1]]
        };
        rows.clone().flat_map(|row| rows.clone().map(move |other| [row, other])).fold([0; 2], of_pair)
    }

    /// Numbers of images of a sphere that are in a stiff and in a soft pair with another one.
    fn images(&self, solver: &CoupledSolver, [row, other]: [usize; 2]) -> [u32; 2] {
        let Self { cell, particles, .. } = self;
        let (lubrication, mut counts) = (lubrication_of(solver), [0; 2]);
        let pair = [row, other].map(|row| u32::from(particles.radii[row] > 1.0));
        for k in 0..343 {
            let steps = [k % 7 - 3, k / 7 % 7 - 3, k / 49 - 3];
            if (0..3).any(|axis| steps[axis] != 0 && !cell.is_periodic(axis)) {
                continue;
            }
            let image = cell.lattice(steps);
            let distance = (particles.positions[other] + image - particles.positions[row]).length();
            if let Some(gap) = lubrication.force.gap(distance / solver.units.length, pair) {
                counts[usize::from(!lubrication.is_stiff(pair, gap))] += 1;
            }
        }
        counts
    }
}

/// All pairs are found, once each; one that the host gives is stiff for both of its spheres, whatever its gap.
#[test]
fn pairs_are_those_of_all_images() {
    let suspension = Suspension::within(tilted, Precision::Single, 1e-2);
    let mut solver = suspension.on(emulator(6));
    let expected = suspension.pairs(&solver);
    let is_soft = |other: &usize| suspension.images(&solver, [0, *other])[0] == 0;
    let soft = (1..16).filter(is_soft).find(|&other| suspension.images(&solver, [0, other])[1] > 0).unwrap();
    let moved = 2 * suspension.images(&solver, [0, soft])[1] as usize;
    let starts = (0..17).map(|row| i32::from(row > 0) + i32::from(row > soft)).collect();
    let others = vec![soft as i32, 0];
    let given = PairRows { starts, others, numbers: vec![0.0; 18], own: vec![0.0; 16 * 15], ..PairRows::default() };
    let tables = lubrication_of(&solver).tables(1.0, vec![[1.0; 3]; 2]);
    let mobility = solver.far.mobility();
    mobility.follow(&suspension.cell, &suspension.particles);
    let far = mobility.coupled().unwrap();
    let mut found =
        |given| far.assemble(&|| tables.clone(), &NearInput { given, ..NearInput::default() }, &HeldSprings::default());
    let [stiff, soft] = found(None);
    assert_eq!([stiff, soft], expected.map(|count| count as usize));
    assert_eq!(found(Some(&given)), [stiff + moved + 2, soft - moved]);
}

/// A box along other axes than those of space, and one whose edges differ.
pub(super) fn tilted(edge: f64) -> PeriodicBox {
    let turn = Tensor::from_rotation_x(0.4) * Tensor::from_rotation_z(-0.9);
    let lattice = [Vector::X, Vector::new(0.2, 1.0, 0.0), Vector::new(-0.1, 0.25, 1.0)];
    PeriodicBox::of_lattice(lattice.map(|vector| turn * vector * edge)).unwrap()
}

fn oblong(edge: f64) -> PeriodicBox {
    PeriodicBox::new(Vector::new(0.8 * edge, edge, 1.25 * edge)).unwrap()
}

/// Loads and first moments of spheres at rest in a rate of strain, in both precisions to round-off: stiff pairs and
/// sums are in double precision. The closest gap is a thousandth of a radius.
#[test]
fn loads_in_a_strain_are_those_of_the_host() {
    let strain = Traceless([0.3, 0.5, -0.2, 0.1, 0.4]);
    for (shape, precision) in [(tilted as fn(f64) -> _, Precision::Double), (oblong, Precision::Single)] {
        let suspension = Suspension::within(shape, precision, 1e-2);
        let Suspension { cell, particles, .. } = &suspension;
        let (none, found) = (Loads::default(), suspension.on(emulator(8)));
        let input = acting(&none, strain);
        let columns = |mut solver: CoupledSolver| {
            let own = crate::units::particles(particles, &solver.units);
            let near = solver.pairs_of_solve(cell, [particles, &own], &input);
            let loads = near.ambient_loads().0.iter().flat_map(|load| load.0).collect::<Vec<_>>();
            let moments = near.ambient_moments().iter().flat_map(|moment| moment.0).collect::<Vec<_>>();
            if !near.is_on_device() {
                return (false, [loads, moments]);
            }
            assert!(loads.iter().chain(&moments).all(|&value| value == 0.0));
            let in_flow = solver.mobility().coupled().unwrap().in_flow();
            let part = |from: usize, to: usize| in_flow.iter().flat_map(|row| row[from..to].to_vec()).collect();
            (true, [part(0, 6), part(6, 11)])
        };
        let ((is_on_device, found), (is_too, exact)) = (columns(found), columns(suspension.on_host()));
        assert!(is_on_device && !is_too);
        for (found, exact) in found.iter().zip(&exact) {
            assert!(relative(found, exact) < 1e-11, "{precision:?}: {:e}", relative(found, exact));
        }
    }
}

/// Solutions, and first moments by motions within them, in a box along other axes than those of space.
#[test]
fn a_tilted_box_has_the_solution_of_the_host() {
    let suspension = Suspension::within(tilted, Precision::Double, 1e-9);
    let loads = Loads { forces: vec![Vector::new(0.3, -0.2, 1.0); 16], ..Loads::default() };
    let input = acting(&loads, Traceless([0.3, 0.5, -0.2, 0.1, 0.4]));
    let solved = |mut solver: CoupledSolver| {
        solver.solve(&suspension.cell, &suspension.particles, &input, Guess::default()).unwrap()
    };
    let [found, exact] = [suspension.on(emulator(9)), suspension.on_host()].map(solved);
    let stresslets = |solution: &Solution| solution.stresslets.iter().flat_map(|s| s.0).collect::<Vec<_>>();
    let velocities =
        |solution: &Solution| solution.motion.velocities.iter().flat_map(Vector::to_array).collect::<Vec<_>>();
    assert!(relative(&velocities(&found), &velocities(&exact)) < 1e-8);
    assert!(relative(&stresslets(&found), &stresslets(&exact)) < 1e-8);
    // The stresslets of the near field are a good part of all.
    let far = found.far.stresslets.iter().flat_map(|s| s.0).collect::<Vec<_>>();
    assert!(relative(&far, &stresslets(&exact)) > 1e-2);
}

/// Rows are where they are needed: a solve copies the positions, tables when it is the first, and some vectors.
#[test]
fn rows_are_not_copied() {
    let suspension = Suspension::of(32, oblong, Precision::Single, 1e-2);
    let Suspension { cell, particles, .. } = &suspension;
    let (device, counts) = Counted::new(emulator(5));
    let mut solver = suspension.on(Box::new(device));
    let none = Loads::default();
    let mut copied = [0; 3];
    for bytes in &mut copied {
        let before = counts.borrow().uploads[1];
        let input = acting(&none, Traceless([0.0, 0.5, 0.0, 0.0, 0.0]));
        solver.solve(cell, particles, &input, Guess::default()).unwrap();
        *bytes = counts.borrow().uploads[1] - before;
    }
    let [first, second, third] = copied;
    let rows = f64::from(suspension.pairs(&solver).iter().sum::<u32>()) * 9.0 * 4.0;
    assert_eq!(second, third);
    assert!(first > 10 * second && (second as f64) < 0.25 * rows, "{copied:?}, and rows have {rows} bytes");
}

/// Memory of the tables as it is predicted, which takes half a smaller radius as the gap of stiff pairs.
#[test]
fn tables_have_the_expected_size() {
    for range in [LubricationRange::default(), LubricationRange::new(0.2, 1e-4).unwrap()] {
        for radii in [vec![1.0], vec![1.0, 1.6, 3.0]] {
            let force = PairForce::new(&radii, 1.0, range).unwrap();
            let single: Vec<SixVector> = radii.iter().map(|&a| single(1.0, a)).collect();
            let tables = PairLubrication::new(force, &single).tables(1.0, Vec::new());
            assert_eq!(tables.kinds.len(), radii.len() * radii.len());
            let (found, expected) =
                (size_of_val(&tables.series[..]) as f64, PairForce::series_bytes(&radii, range, 0.5));
            assert!((0.8..1.2).contains(&(found / expected)), "{radii:?}: {found} bytes, {expected} expected");
        }
    }
}
