//! Solves with pairs that are nearly in contact.

use super::*;
use crate::pairs::search::Pairs;
use crate::pairs::squeezed::{PRESSED, SQUEEZED};
use crate::preconditioner::Preconditioner;
use crate::system::SingleSpheres;
use fcm::{Iterate, Limits, Linear, conjugate_gradients};

const TOLERANCE: f64 = 1e-8;

/// Pairs, a chain of three and single spheres of two radii, with gaps from `gap` to a hundred times that.
fn clusters(gap: f64) -> Particles {
    let [x, y, diagonal] = [Vector::X, Vector::Y, Vector::new(1.0, 2.0, -1.0).normalize()];
    let chain = [Vector::splat(10.0), Vector::splat(10.0) + x * (2.0 + gap)];
    let end = chain[1] + diagonal * (2.5 + 10.0 * gap);
    let pair = [Vector::splat(25.0), Vector::splat(25.0) + y * (3.0 + 100.0 * gap)];
    let across = [Vector::new(39.5, 5.0, 20.0), Vector::new(39.5, 5.0, 20.0) + x * (2.0 + 3.0 * gap)];
    let positions = [chain[0], chain[1], end, pair[0], pair[1], across[0], across[1], Vector::new(5.0, 30.0, 30.0)];
    placed(&positions, &[1.0, 1.0, 1.5, 1.5, 1.5, 1.0, 1.0, 1.0])
}

/// Motions by id under given loads, and the number of iterations, on the ranks of a communicator.
fn moved(comm: &Comm, gap: f64, least: Option<f64>) -> (Vec<SixVector>, usize) {
    let (cell, partition) = (cube(40.0), Partition::new(comm, [8, 8]));
    let mut particles = if comm.is_first() { clusters(gap) } else { Particles::default() };
    particles.wrap(&cell);
    particles.migrate(&partition, &cell);
    let radii = vec![1.0, 1.5];
    let force = PairForce::new(&radii, 1.0, LubricationRange::default()).unwrap();
    let alone: Vec<SixVector> = radii.iter().map(|&a| single(1.0, a)).collect();
    let lists = NearLists::new(force.reach(), &partition);
    let lubrication = Some(PairLubrication::new(force, &alone));
    let mut field = NearField { lubrication, at_walls: None, lists, precision: Precision::Double, radii };
    let view = DomainView { cell: &cell, partition: &partition };
    let near = NearPairs::find(&mut field, Connections::default(), &particles, view, StrainRate::default());
    let spheres = SingleSpheres::new(1.0, &particles.radii);
    let mut matrix = Preconditioner::new(comm, &near, &spheres.motion, TOLERANCE);
    if let Some(least) = least {
        matrix = matrix.with_squeezed_pairs(least);
    }
    let load = |id: &u64| SixVector(std::array::from_fn(|k| ((*id as usize * 6 + k) as f64 * 1.7).sin()));
    let mut residual = SixVectors(particles.ids.iter().map(load).collect());
    let mut x = SixVectors::zero(particles.len());
    let mut z = x.clone();
    let limits = Limits { tolerance: TOLERANCE, iterations: 1000, interrupt: &Interrupt::NEVER };
    let iterate = Iterate { x: &mut x, residual: &mut residual, z: &mut z };
    let outcome = conjugate_gradients(comm, &mut matrix, iterate, limits);
    assert!(outcome.converged);
    // The residual is that of the motions.
    let mut loads = near.times(&[Pairs::Stiff], &x);
    loads.add(1.0, &x.resisted(&spheres.motion));
    loads.add(1.0, &residual);
    for (found, id) in loads.0.iter().zip(&particles.ids) {
        // Round-off of resistances of up to 1e6 in motions of up to 0.1.
        assert!((0..6).all(|k| (found.0[k] - load(id).0[k]).abs() < 1e-8), "{id}: {found:?}");
    }
    let column = particles.column("motion", 6);
    column.values = bytemuck::cast_slice(&x.0).to_vec().into();
    let gathered = particles.gathered(&partition);
    let values = gathered.columns.iter().find(|column| column.name == "motion");
    let values = values.map_or(Vec::new(), |column| bytemuck::cast_slice(&column.values).to_vec());
    (values, outcome.iterations)
}

/// The motions are the same with both preconditioners. The number of iterations hardly depends on the gaps when close
/// pairs have one of their own: what is left of their resistance grows like the logarithm.
#[test]
fn motions_of_close_pairs_take_about_as_many_iterations_for_any_gap() {
    let alone = Comm::alone();
    let [wide, closest] = [1e-3, 1e-6].map(|gap| {
        let (expected, plain) = moved(&alone, gap, None);
        let (found, iterations) = moved(&alone, gap, Some(SQUEEZED));
        assert!(iterations < plain, "{iterations} and {plain}");
        for (found, expected) in found.iter().zip(&expected) {
            assert!((0..6).all(|k| (found.0[k] - expected.0[k]).abs() < 10.0 * TOLERANCE), "{found:?} {expected:?}");
        }
        iterations
    });
    assert!(closest <= wide + 5, "{wide} {closest}");
}

/// Spheres that no pair presses onto others move by the same bits as without the coupling.
#[test]
fn pairs_are_coupled_only_if_some_are_pressed_together() {
    let alone = Comm::alone();
    let bits =
        |motions: Vec<SixVector>| motions.iter().flat_map(|motion| motion.0.map(f64::to_bits)).collect::<Vec<_>>();
    let [apart, plain] = [Some(PRESSED), None].map(|least| moved(&alone, 2e-3, least));
    assert_eq!(bits(apart.0), bits(plain.0));
    let [pressed, coupled, plain] = [Some(PRESSED), Some(SQUEEZED), None].map(|least| moved(&alone, 1e-5, least));
    assert_eq!(bits(pressed.0), bits(coupled.0));
    assert!(pressed.1 < plain.1, "{} {}", pressed.1, plain.1);
}

/// Pairs may have their spheres on different ranks, and some ranks may have none.
#[test]
fn close_pairs_are_those_of_all_ranks() {
    let (expected, iterations) = moved(&Comm::alone(), 1e-5, Some(SQUEEZED));
    for ranks in [2, 3, 7] {
        Comm::threads(ranks, |comm| {
            let (found, taken) = moved(&comm, 1e-5, Some(SQUEEZED));
            assert_eq!(taken, iterations);
            if comm.is_first() {
                assert_eq!(found.len(), expected.len());
                for (found, expected) in found.iter().zip(&expected) {
                    assert!((0..6).all(|k| (found.0[k] - expected.0[k]).abs() < 1e-9), "{found:?} {expected:?}");
                }
            }
        });
    }
}
