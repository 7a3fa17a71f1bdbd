//! Steps of the midpoint scheme, by spheres that move on an emulator of a card.

use super::*;
use crate::evaluation::overlap_monitor::OverlapCounts;
use crate::model::BrownianScheme::{self, Midpoint};
use gpu::DeviceCounts;

/// Steps of a run that is compared, read or interrupted.
const SEEN: u64 = 3;

/// Spheres in thermal motion, of which some come into overlap within the steps of a test.
pub(super) fn agitated(scheme: BrownianScheme, change: impl FnOnce(&mut Parameters)) -> Model {
    model([12, 8], |parameters| {
        parameters.thermal_energy = Some(10.0);
        parameters.integrator = Integrator::Brownian(scheme);
        change(parameters);
    })
}

/// In shear, with lubrication and repulsion.
pub(super) fn in_shear(scheme: BrownianScheme) -> Model {
    agitated(scheme, |parameters| {
        parameters.flow = Flow::Shear { rate: 1.0, lees_edwards: true };
        parameters.hydrodynamics.lubrication = true;
        parameters.repulsion = Some(Repulsion { radius_power: 2, range: Some(0.2), ..Repulsion::new(20.0) });
    })
}

/// At rest, under a weight, with lubrication or without.
pub(super) fn under_weight(scheme: BrownianScheme, lubrication: bool) -> Model {
    agitated(scheme, |parameters| {
        parameters.gravity = Vector::new(0.0, 0.0, -4.0);
        parameters.species.iter_mut().for_each(|species| species.density_difference = 1.0);
        parameters.hydrodynamics.lubrication = lubrication;
        parameters.repulsion = Some(Repulsion { range: Some(0.4), ..Repulsion::new(30.0) });
    })
}

/// Spheres move as on the host in each step, by the same random numbers, and as many pairs overlap: to the precision of
/// the far field, in which random motions agree to 1e-4 in `f32`, or to that of solves.
#[test]
fn spheres_move_as_on_the_host() {
    for (kernel, tolerance, allowed) in [("drawn_motions_f32", 1e-5, 1e-3), ("drawn_motions_f64", 1e-8, 1e-6)] {
        for model in [in_shear(Midpoint), under_weight(Midpoint, true), under_weight(Midpoint, false)] {
            let mut parameters = (*model).clone();
            parameters.hydrodynamics.iteration_tolerance = Some(tolerance);
            let counts = agrees(&Model::new(parameters).unwrap(), allowed);
            assert_eq!([counts.runs["displace_all"], counts.runs[kernel]], [2 * SEEN, SEEN]);
        }
    }
}

fn agrees(model: &Model, allowed: f64) -> DeviceCounts {
    let (device, counts) = emulator(1);
    let start = started(model, None);
    let [mut host, mut card] = [started(model, None), on(started(model, None), device)];
    let mut overlapping = 0;
    for step in 0..SEEN {
        for run in [&mut host, &mut card] {
            run.step().unwrap();
        }
        assert!(card.particles.are_remote());
        // From the same start.
        assert!(card.outcome.iterations <= host.outcome.iterations + 2);
        let [moved, error] = [&start, &card].map(|run| distance(run, &host));
        assert!(error < allowed * moved, "step {step}: {error:e} of {moved:e}");
        let [of_card, of_host] = [&card, &host].map(|run| run.overlap_counts().unwrap());
        let OverlapCounts { overlapping: pairs, at_minimum_gap, depth } = of_card;
        assert_eq!([pairs, at_minimum_gap], [of_host.overlapping, of_host.at_minimum_gap]);
        assert!((depth - of_host.depth).abs() < allowed, "step {step}: {depth:e} and {:e}", of_host.depth);
        overlapping += pairs;
    }
    assert!(overlapping > 0);
    let counts = counts.borrow();
    counts.clone()
}

/// A step copies settings and sums, however many spheres there are.
#[test]
fn particles_stay_on_the_card() {
    for model in [in_shear(Midpoint), under_weight(Midpoint, true), under_weight(Midpoint, false)] {
        let mut card = stays_on_the_card(&model, 1);
        agree_in_columns([&mut card, &mut advanced(started(&model, None), STEPS + 3)], 1e-3);
    }
}

/// Spheres cross the faces of a sheared box, whose lattice vectors change at half a period of its strain, as on the
/// host; a run that is resumed between, on a card whose threads run in another order, has the same bits.
#[test]
fn a_resumed_run_has_the_same_bits() {
    cross_faces(Midpoint, &[1, 3]);
}

pub(super) fn cross_faces(scheme: BrownianScheme, resumed_after: &[u64]) {
    let model = agitated(scheme, |parameters| {
        parameters.flow = Flow::Shear { rate: 15.0, lees_edwards: true };
        parameters.hydrodynamics.lubrication = true;
    });
    let mut whole = advanced(on(started(&model, None), emulator(1).0), STEPS);
    for &steps in resumed_after {
        let mut part = advanced(on(started(&model, None), emulator(2).0), steps);
        let mut resumed = advanced(on(started(&model, Some(&mut part)), emulator(3).0), STEPS - steps);
        assert_eq!(whole.state(), resumed.state());
    }
    let [start, host] = [0, STEPS].map(|steps| advanced(started(&model, None), steps));
    assert!(distance(&whole, &host) < 1e-3 * distance(&start, &host));
    let steps = [&whole, &host].map(|run| run.gathered(None).steps);
    assert_eq!(steps[0], steps[1]);
    assert!(steps[0].iter().filter(|steps| **steps != [0; 3]).count() > 3);
}

/// A run whose columns are read after each step has the bits of one that keeps them on the card; so has one that goes
/// back to the start of a step that was interrupted, before its solve or within.
#[test]
fn reading_columns_and_going_back_change_nothing() {
    for model in [in_shear(Midpoint), under_weight(Midpoint, false)] {
        let state = advanced(on(started(&model, None), emulator(1).0), SEEN).state();
        let mut read = on(started(&model, None), emulator(1).0);
        for _ in 0..SEEN {
            assert!(read.particles().columns.iter().all(|column| column.values.is_here()));
            read.step().unwrap();
        }
        assert_eq!(read.state(), state);
        let mut interrupted = on(started(&model, None), emulator(1).0);
        (0..SEEN).for_each(|step| step_interrupted(&mut interrupted, step == 1));
        assert_eq!(interrupted.state(), state);
    }
}

/// A sphere that is lost ends the step with the message of the host, and the state before it is there.
#[test]
fn lost_spheres_are_named() {
    let lost = Parameters { thermal_energy: Some(1e24), ..(*under_weight(Midpoint, true)).clone() };
    let model = Model::new(lost).unwrap();
    let [mut host, mut card] = [started(&model, None), on(started(&model, None), emulator(1).0)];
    let before = by_id(&card.state().particles);
    let errors = [&mut host, &mut card].map(|run| run.step().unwrap_err().to_string());
    // Which of the lost spheres is named depends on their order.
    let ends = errors.each_ref().map(|error| error.split("], ").last().unwrap());
    assert!(ends[1].contains("which is no place") && ends[0] == ends[1], "{errors:?}");
    assert_eq!(by_id(&card.state().particles), before);
}
