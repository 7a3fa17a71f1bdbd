//! Runs whose far field and forces between surfaces an emulator of a card computes, against those of the host.

mod brownian;
mod changes;
mod flows;
mod implicit;
mod random_difference;
mod steps;

use super::Suspension;
use crate::columns::{ANGULAR_VELOCITY, BROWNIAN, PAST, STRESSLET, VELOCITY};
use crate::model::{Adaptive, Flow, Hydrodynamics, Integrator, Model, Parameters, Protocol, Repulsion, Species, Start};
use crate::scalars::BLEND;
use domain::{Boundaries, Comm, Interrupt, Particles, PeriodicBox, Vector};
use fcm::Method;
use gpu::{Counted, Device, Emulator, SharedCounts};
use hydrodynamics::brownian::CHANGE;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Steps, of which the first three are those of the Runge-Kutta method.
const STEPS: u64 = 5;

/// An emulator that counts, whose threads run in the order of a seed.
fn emulator(seed: u64) -> (Box<dyn Device>, SharedCounts) {
    let (device, counts) = Counted::new(Box::new(Emulator::beside_program(&[], seed).unwrap()));
    (Box::new(device), counts)
}

fn model(species: [u64; 2], change: impl FnOnce(&mut Parameters)) -> Model {
    let cell = PeriodicBox::new(Vector::splat(9.0)).unwrap();
    let [small, large] = species;
    let species = vec![Species::new("small", 1.0, small), Species::new("large", 1.4, large)];
    let mut parameters = Parameters::new(cell, 1.0, species, 0.01, STEPS);
    parameters.hydrodynamics = Hydrodynamics {
        method: Some(Method::Split),
        tolerance: 1e-2,
        iteration_tolerance: Some(1e-5),
        ..Hydrodynamics::default()
    };
    change(&mut parameters);
    Model::new(parameters).unwrap()
}

/// Settling spheres, without lubrication.
fn settling() -> Model {
    model([12, 6], |parameters| {
        parameters.gravity = Vector::new(0.0, 0.0, -4.0);
        parameters.species.iter_mut().for_each(|species| species.density_difference = 1.0);
        parameters.repulsion = Some(Repulsion { range: Some(0.4), ..Repulsion::new(30.0) });
    })
}

/// Spheres in shear, with lubrication and repulsion.
fn sheared() -> Model {
    model([12, 8], |parameters| {
        parameters.flow = Flow::Shear { rate: 1.0, lees_edwards: true };
        parameters.hydrodynamics.lubrication = true;
        parameters.repulsion = Some(Repulsion { radius_power: 2, range: Some(0.2), ..Repulsion::new(20.0) });
    })
}

/// A run from the start of a model or from a later state.
fn started(model: &Model, from: Option<&mut Suspension>) -> Suspension {
    let alone = Comm::alone();
    match from {
        None => Suspension::start(model, &alone).unwrap(),
        Some(suspension) => Suspension::resume(model, Some(suspension.state()), &alone).unwrap(),
    }
}

/// The same with an emulator for the solves.
fn on(mut suspension: Suspension, device: Box<dyn Device>) -> Suspension {
    suspension.dynamics.evaluate_on(device, &suspension.particles);
    suspension
}

fn advanced(mut suspension: Suspension, steps: u64) -> Suspension {
    (0..steps).for_each(|_| suspension.step().unwrap());
    suspension
}

/// Takes a step after two interruptions, before its solve or within, each of which leaves the state as it was; that is
/// compared if it is asked for, as it copies all columns.
fn step_interrupted(run: &mut Suspension, is_compared: bool) {
    for check in 0..2 {
        let checks = AtomicUsize::new(0);
        run.listen(Interrupt::when(move || checks.fetch_add(1, Ordering::Relaxed) == check));
        let before = is_compared.then(|| by_id(&run.state().particles));
        run.step().unwrap_err();
        assert!(before.is_none_or(|before| by_id(&run.state().particles) == before), "as before the step");
    }
    run.listen(Interrupt::NEVER);
    run.step().unwrap();
}

/// A run that is resumed after some of its steps, on a card whose threads run in another order, and one whose steps are
/// interrupted have the bits of a run that goes on.
fn keeps_bits(model: &Model, steps: u64, resumed_after: u64) {
    let state = advanced(on(started(model, None), emulator(1).0), steps).state();
    let mut part = advanced(on(started(model, None), emulator(2).0), resumed_after);
    let mut resumed = advanced(on(started(model, Some(&mut part)), emulator(3).0), steps - resumed_after);
    assert!(resumed.state() == state, "resumed");
    let mut interrupted = on(started(model, None), emulator(1).0);
    (0..steps).for_each(|step| step_interrupted(&mut interrupted, step == 1));
    assert!(interrupted.state() == state, "interrupted");
}

/// Particles in the order of their ids.
fn by_id(particles: &Particles) -> Particles {
    let mut rows: Vec<usize> = (0..particles.len()).collect();
    rows.sort_unstable_by_key(|&row| particles.ids[row]);
    particles.selected(&rows)
}

/// Largest distance of the spheres of two runs from each other.
fn distance(one: &Suspension, other: &Suspension) -> f64 {
    let [a, b] = [one, other].map(|run| run.gathered(Some(&[])).positions);
    a.iter().zip(&b).map(|(&a, &b)| one.cell().nearest_image(a - b).length()).fold(0.0, f64::max)
}

/// Spheres move as on the host, whose forces need no pairs any more; without repulsion they do not.
#[test]
fn spheres_move_as_on_the_host() {
    for model in [settling(), sheared()] {
        let start = started(&model, None);
        let host = advanced(started(&model, None), STEPS);
        let without = Model::new(Parameters { repulsion: None, ..(*model).clone() }).unwrap();
        let free = advanced(started(&without, None), STEPS);
        let (device, counts) = emulator(1);
        let card = advanced(on(started(&model, None), device), STEPS);
        let [moved, repelled, error] = [[&start, &host], [&free, &host], [&card, &host]].map(|[a, b]| distance(a, b));
        assert!(repelled > 1e-2 * moved && error < 1e-4 * moved, "{moved:e}, {repelled:e}, {error:e}");
        let near =
            |run: &Suspension| run.dynamics.forces().near_in_solves(&run.particles, run.dynamics.domain()).is_some();
        assert!(near(&host) && !near(&card));
        // Four evaluations in each of the first three steps, and one in the others.
        assert_eq!(counts.borrow().runs["surface_forces_f32"], 4 * 3 + STEPS - 3);
    }
}

/// Positions, motions and columns of solutions stay on the card until something reads them, and then have the numbers
/// of the host. A step copies settings and sums, however many spheres there are, with lubrication and without, and
/// under a weight.
#[test]
fn particles_stay_on_the_card() {
    for model in [sheared(), settling()] {
        let mut card = stays_on_the_card(&model, 1);
        agree_in_columns([&mut card, &mut advanced(started(&model, None), STEPS + 3)], 1e-3);
    }
}

/// A run after some steps with that many solves, the last of which copies no list.
fn stays_on_the_card(model: &Model, solves: u64) -> Suspension {
    let (device, counts) = emulator(1);
    let mut card = advanced(on(started(model, None), device), STEPS + 2);
    let before = counts.borrow().clone();
    card.step().unwrap();
    let copied = |after: [u64; 2], before: [u64; 2]| after[1] - before[1];
    let after = counts.borrow().clone();
    let [up, down] = [copied(after.uploads, before.uploads), copied(after.downloads, before.downloads)];
    // Each iteration of a solve has settings and a state.
    let [most_up, most_down] = [[1300, 64], [500, 104]].map(|[once, each]| once * solves + each * card.evaluations);
    assert!(up < most_up && down < most_down, "{up} and {down} bytes, {} evaluations", card.evaluations);
    let is_here = |name: &str| card.particles.columns.iter().find(|c| c.name == name).unwrap().values.is_here();
    assert!([VELOCITY, ANGULAR_VELOCITY, STRESSLET].into_iter().all(|name| !is_here(name)));
    assert!(!card.particles.positions.is_here() && !card.particles.steps.is_here());
    card
}

/// Columns of runs on a card and on the host have the same numbers, with some relative error.
fn agree_in_columns(runs: [&mut Suspension; 2], error_allowed: f64) {
    let [of_card, of_host] = runs.map(|run| by_id(&run.state().particles));
    assert_eq!(of_card.ids, of_host.ids);
    assert_eq!(of_card.columns.len(), of_host.columns.len());
    for (found, exact) in of_card.columns.iter().zip(&of_host.columns) {
        let square = |values: &mut dyn Iterator<Item = f64>| values.map(|value| value * value).sum::<f64>().sqrt();
        let error = square(&mut found.values.iter().zip(exact.values.iter()).map(|(found, exact)| found - exact));
        let size = square(&mut exact.values.iter().copied());
        // The weights of the parabola are quotients of differences as small as errors of the solves.
        let allowed = match found.name.as_str() {
            BLEND => 2e-2,
            BROWNIAN => 2.0 * CHANGE,
            _ => error_allowed,
        };
        assert!(found.name == exact.name && error <= allowed * size, "{}: {error:e} of {size:e}", found.name);
    }
}

/// Spheres cross the faces of a sheared box, whose lattice vectors change at half a period of its strain, as on the
/// host; a run that is resumed between has the same bits.
#[test]
fn spheres_cross_faces_as_on_the_host() {
    let model = model([8, 4], |parameters| {
        parameters.flow = Flow::Shear { rate: 15.0, lees_edwards: true };
        parameters.hydrodynamics.lubrication = true;
    });
    let on_card = |from, seed| on(started(&model, from), emulator(seed).0);
    let [start, host] = [0, STEPS].map(|steps| advanced(started(&model, None), steps));
    let mut whole = advanced(on_card(None, 1), STEPS);
    let mut resumed = advanced(on_card(Some(&mut advanced(on_card(None, 1), 2)), 3), STEPS - 2);
    assert_eq!(whole.state(), resumed.state());
    assert!(distance(&whole, &host) < 1e-4 * distance(&start, &host));
    let [of_card, of_host] = [&whole, &host].map(|run| run.gathered(None));
    assert_eq!(of_card.steps, of_host.steps);
    assert!(of_host.steps.iter().filter(|steps| **steps != [0; 3]).count() > 3);
    let error = |(one, other): (&f64, &f64)| (one - other).abs();
    let [now, exact] = [&of_card, &of_host].map(|all| &all.columns.iter().find(|c| c.name == PAST[0]).unwrap().values);
    let largest = exact.iter().map(|value| value.abs()).fold(0.0, f64::max);
    assert!(now.iter().zip(exact.iter()).map(error).fold(0.0, f64::max) < 1e-4 * largest);
}

/// Spheres without any near pair move on the card too, and settle under their weight.
#[test]
fn lonely_spheres_settle_as_on_the_host() {
    let model = model([1, 1], |parameters| {
        parameters.hydrodynamics.lubrication = true;
        parameters.gravity = Vector::new(0.0, 0.0, -40.0);
        parameters.species[0].density_difference = 1.0;
        parameters.start = Start::Positions(vec![Vector::splat(1.0), Vector::splat(6.0)]);
    });
    let [start, host] = [0, STEPS].map(|steps| advanced(started(&model, None), steps));
    let card = advanced(on(started(&model, None), emulator(1).0), STEPS);
    assert!(card.particles.are_remote());
    assert!(distance(&card, &host) < 1e-4 * distance(&start, &host));
}

/// A sphere that is lost ends the step with the message of the host, and the state before it is there.
#[test]
fn lost_spheres_are_named() {
    let model = model([1, 1], |parameters| {
        parameters.hydrodynamics.lubrication = true;
        parameters.repulsion = Some(Repulsion { range: Some(0.4), ..Repulsion::new(1e16) });
        parameters.start = Start::Positions(vec![Vector::splat(1.0), Vector::new(1.0, 1.0, 3.5)]);
    });
    let mut host = started(&model, None);
    let mut card = on(started(&model, None), emulator(1).0);
    let before = by_id(&card.state().particles);
    let errors = [&mut host, &mut card].map(|run| run.step().unwrap_err().to_string());
    assert!(errors[0].contains("which is no place") && errors[0] == errors[1], "{errors:?}");
    assert_eq!(by_id(&card.state().particles), before);
}

/// A run whose columns are read after each step has the bits of one that keeps them on the card; so has one that goes
/// back to the start of a step that was interrupted.
#[test]
fn reading_columns_and_going_back_change_nothing() {
    let model = sheared();
    let mut kept = advanced(on(started(&model, None), emulator(1).0), STEPS);
    let mut read = on(started(&model, None), emulator(1).0);
    for _ in 0..STEPS {
        assert!(read.particles().columns.iter().all(|column| column.values.is_here()));
        read.step().unwrap();
    }
    let mut interrupted = on(started(&model, None), emulator(1).0);
    for step in 0..STEPS {
        if step == STEPS - 1 {
            // Within the iteration of the solve.
            let checks = AtomicUsize::new(0);
            interrupted.listen(Interrupt::when(move || checks.fetch_add(1, Ordering::Relaxed) == 2));
            interrupted.step().unwrap_err();
            interrupted.listen(Interrupt::NEVER);
        }
        interrupted.step().unwrap();
    }
    let state = kept.state();
    assert_eq!(read.state(), state);
    assert_eq!(interrupted.state(), state);
}

/// Implicit steps under a given stress, whose solves start from each other.
#[test]
fn a_given_stress_shears_as_on_the_host() {
    let model = model([6, 4], |parameters| {
        parameters.flow = Flow::Shear { rate: 1.0, lees_edwards: true };
        parameters.protocol = Protocol::Stress(1.5);
        parameters.hydrodynamics.lubrication = true;
        parameters.repulsion = Some(Repulsion { radius_power: 2, range: Some(0.2), ..Repulsion::new(20.0) });
        parameters.integrator = Integrator::Implicit(Adaptive::default());
    });
    let start = started(&model, None);
    let [host, card] = [started(&model, None), on(started(&model, None), emulator(1).0)].map(|run| advanced(run, 3));
    assert!(distance(&card, &host) < 1e-3 * distance(&start, &host));
    let [of_card, of_host] = [&card, &host].map(|run| run.shear()[0]);
    assert!((of_card / of_host - 1.0).abs() < 1e-4 && (of_host - 1.0).abs() > 1e-2, "{of_card} and {of_host}");
}

/// Lubricated spheres between walls, by explicit steps in a channel flow and implicit ones that settle in shear: they
/// move as on the host, by solves that iterate on the card, and a resumed run has the same bits.
#[test]
fn spheres_between_walls_move_as_on_the_host() {
    let between = |flow, integrator| {
        model([12, 6], |parameters| {
            parameters.cell = parameters.cell.with_boundaries(Boundaries::Walls).unwrap();
            parameters.flow = flow;
            parameters.gravity = Vector::new(0.0, 0.0, -4.0);
            parameters.species[1].density_difference = 1.0;
            parameters.hydrodynamics.lubrication = true;
            parameters.repulsion = Some(Repulsion { radius_power: 2, range: Some(0.2), ..Repulsion::new(20.0) });
            parameters.integrator = integrator;
        })
    };
    let explicit = between(Flow::Poiseuille { pressure_gradient: 0.5 }, Integrator::AdamsBashforth { order: 4 });
    let shear = Flow::Shear { rate: 1.0, lees_edwards: false };
    let implicit = between(shear, Integrator::Implicit(Adaptive::default()));
    for model in [explicit, implicit] {
        let [start, host] = [0, 3].map(|steps| advanced(started(&model, None), steps));
        let (device, counts) = emulator(1);
        let mut card = advanced(on(started(&model, None), device), 3);
        assert!(!card.particles.are_remote());
        assert!(distance(&card, &host) < 1e-3 * distance(&start, &host));
        assert!(counts.borrow().runs["coupled_image_f32"] > 3);
        let mut part = advanced(on(started(&model, None), emulator(2).0), 2);
        let mut resumed = advanced(on(started(&model, Some(&mut part)), emulator(3).0), 1);
        assert_eq!(card.state(), resumed.state());
    }
}

/// A run that is resumed on another card, whose threads run in another order, has the bits of one that is not; on the
/// host it goes on with the same forces to round-off.
#[test]
fn a_resumed_run_has_the_same_bits() {
    let model = sheared();
    let on_card = |from, seed| on(started(&model, from), emulator(seed).0);
    let (mut whole, mut part) = (advanced(on_card(None, 1), STEPS), advanced(on_card(None, 1), 2));
    let mut resumed = advanced(on_card(Some(&mut part), 2), STEPS - 2);
    assert_eq!(whole.state(), resumed.state());
    let on_host = advanced(started(&model, Some(&mut part)), STEPS - 2);
    assert!(distance(&whole, &on_host) < 1e-4 * distance(&whole, &started(&model, None)));
}
