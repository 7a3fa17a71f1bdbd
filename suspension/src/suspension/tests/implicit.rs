//! Implicit and adaptive steps, by spheres that move on an emulator of a card.

use super::*;
use crate::forces::contacts::{self, CONTACTS};
use crate::model::{Attraction, Contacts, RateChange};
use crate::scalars::NEXT_SUBSTEP;
use gpu::{SUBSTEP_BYTES, bytes_of_contacts};
use lubrication::Elasticity;

/// Spheres in shear at a volume fraction of 40%, by implicit steps.
pub(super) fn dense(change: impl FnOnce(&mut Parameters)) -> Model {
    model([10, 6], |parameters| {
        // Spheres are near several images of others, of which one is in contact.
        parameters.cell = PeriodicBox::new(Vector::splat(6.5)).unwrap();
        parameters.flow = Flow::Shear { rate: 1.0, lees_edwards: true };
        parameters.hydrodynamics.lubrication = true;
        parameters.hydrodynamics.lubrication_cutoff = Some(1.0);
        parameters.hydrodynamics.iteration_tolerance = Some(1e-4);
        parameters.integrator = Integrator::Implicit(Adaptive { tolerance: 1e-3, ..Adaptive::default() });
        change(parameters);
    })
}

/// Contacts of asperities so high that many spheres touch from the start.
pub(super) fn touching() -> Contacts {
    Contacts { roughness: 0.05, stiffness: Some(2e3), ..Contacts::new(0.5) }
}

/// Stiff repulsion.
fn repelling() -> Model {
    dense(|parameters| {
        parameters.repulsion = Some(Repulsion { radius_power: 2, range: Some(0.1), ..Repulsion::new(300.0) });
    })
}

/// Frictional contacts, without control of the error.
fn frictional() -> Model {
    dense(|parameters| {
        parameters.contacts = Some(touching());
        parameters.integrator = Integrator::Implicit(Adaptive::UNLIMITED);
    })
}

/// Hertz' law, with a critical load and friction of rolling, a screened repulsion that reaches beyond lubrication, and
/// a weight.
fn rolling() -> Model {
    dense(|parameters| {
        let law = Elasticity::Hertz;
        parameters.contacts =
            Some(Contacts { rolling_friction: 0.2, critical_load: 0.5, law, stiffness: Some(2e4), ..touching() });
        parameters.repulsion = Some(Repulsion { screening_length: Some(0.05), ..Repulsion::new(5.0) });
        parameters.gravity = Vector::new(0.0, 0.0, -4.0);
        parameters.species[1].density_difference = 1.0;
    })
}

/// A stiffness that adapts.
fn adapting() -> Model {
    dense(|parameters| parameters.contacts = Some(Contacts { stiffness: None, ..touching() }))
}

/// Implicit repulsion and explicit attraction alone, without lubrication.
fn alone() -> Model {
    dense(|parameters| {
        parameters.hydrodynamics.lubrication = false;
        parameters.hydrodynamics.lubrication_cutoff = None;
        parameters.repulsion = Some(Repulsion { range: Some(0.2), ..Repulsion::new(300.0) });
        parameters.attraction = Some(Attraction::VanDerWaals { hamaker: 10.0, closest: 0.05, range: 0.5 });
    })
}

/// Spheres without any force.
fn without_forces() -> Model {
    dense(|parameters| {
        parameters.hydrodynamics.lubrication = false;
        parameters.hydrodynamics.lubrication_cutoff = None;
    })
}

/// Spheres in shear in a box that stays straight.
fn straight() -> Model {
    dense(|parameters| {
        parameters.hydrodynamics.lubrication = false;
        parameters.hydrodynamics.lubrication_cutoff = None;
        parameters.flow = Flow::Shear { rate: 1.0, lees_edwards: false };
        parameters.integrator = Integrator::Adaptive(Adaptive::default());
    })
}

/// Explicit steps whose lengths depend on gaps.
fn explicit() -> Model {
    dense(|parameters| {
        parameters.integrator = Integrator::Adaptive(Adaptive::default());
        parameters.repulsion = Some(Repulsion { radius_power: 2, range: Some(0.1), ..Repulsion::new(30.0) });
    })
}

/// In `f64` with a smaller tolerance of solves.
pub(super) fn exact(model: &Model) -> Model {
    let mut parameters = (**model).clone();
    parameters.hydrodynamics.iteration_tolerance = Some(1e-8);
    Model::new(parameters).unwrap()
}

/// Largest difference of the numbers of a column over the largest number.
pub(super) fn difference(name: &str, runs: [&Suspension; 2]) -> f64 {
    let [card, host] = runs.map(|run| by_id(run.particles()));
    let column = |particles: &Particles| particles.columns.iter().find(|c| c.name == name).unwrap().values.clone();
    let (found, exact) = (column(&card), column(&host));
    let largest = exact.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    found.iter().zip(exact.iter()).map(|(found, exact)| (found - exact).abs()).fold(0.0, f64::max) / largest
}

/// Spheres move as on the host in each step, in as many substeps, with the same forces at contacts: to the precision of
/// the far field, or to that of solves.
#[test]
fn spheres_move_as_on_the_host() {
    for model in [repelling(), frictional(), rolling(), adapting(), explicit()] {
        agree(&model, 1e-3);
    }
}

/// The same without lubrication.
#[test]
fn spheres_without_lubrication_move_as_on_the_host() {
    for model in [alone(), without_forces(), straight()] {
        agree(&model, 1e-3);
    }
}

/// The same in `f64`.
#[test]
fn spheres_move_as_on_the_host_in_double_precision() {
    for model in [repelling(), alone(), frictional(), rolling(), adapting(), explicit()] {
        agree(&exact(&model), 1e-6);
    }
}

pub(super) fn agree(model: &Model, allowed: f64) {
    let start = started(model, None);
    let [mut host, mut card] = [started(model, None), on(started(model, None), emulator(1).0)];
    for step in 0..2 {
        for run in [&mut host, &mut card] {
            run.step().unwrap();
        }
        assert!(card.particles.are_remote());
        let [moved, error] = [&start, &card].map(|run| distance(run, &host));
        assert!(error < allowed * moved, "step {step}: {error:e} of {moved:e}");
        // From the same start.
        assert!(card.outcome.iterations <= host.outcome.iterations + 2);
        let substep = [&card, &host].map(|run| run.particles.scalars.numbers::<1>(NEXT_SUBSTEP));
        if let [Some([of_card]), Some([of_host])] = substep {
            assert!((of_card / of_host - 1.0).abs() < 100.0 * allowed, "{of_card:e} and {of_host:e}");
        }
        if model.contacts.is_some() {
            let error = difference(CONTACTS, [&card, &host]);
            assert!(error < 100.0 * allowed, "step {step}: contacts {error:e}");
            let [of_card, of_host] = [&card, &host].map(|run| run.dynamics.contact_stiffness().unwrap());
            assert!((of_card / of_host - 1.0).abs() < 10.0 * allowed, "{of_card} and {of_host}");
        }
    }
    let touch = host.dynamics.contact_statistics(host.particles());
    assert!(touch.is_none_or(|touch| touch.numbers(&Comm::alone())[0] > 0.5), "most spheres touch");
}

/// A substep copies settings and sums, however many spheres there are.
#[test]
fn particles_stay_on_the_card() {
    for model in [repelling(), frictional()] {
        let (device, counts) = emulator(1);
        let mut card = advanced(on(started(&model, None), device), 1);
        let before = counts.borrow().clone();
        card.step().unwrap();
        let after = counts.borrow().clone();
        let solves = after.runs["displace_all"] - before.runs["displace_all"];
        let copied = |after: [u64; 2], before: [u64; 2]| (after[1] - before[1]) / solves;
        let [up, down] = [copied(after.uploads, before.uploads), copied(after.downloads, before.downloads)];
        assert!(up < 4000 && down < 3000, "{up} and {down} bytes a solve");
        let is_here = |name: &str| card.particles.columns.iter().find(|c| c.name == name).unwrap().values.is_here();
        assert!([VELOCITY, ANGULAR_VELOCITY, STRESSLET].into_iter().all(|name| !is_here(name)));
        assert!(!card.particles.positions.is_here() && !card.particles.steps.is_here());
    }
}

/// Steps with several solves, and contacts, take as much more memory than explicit steps as the forecast has.
#[test]
fn contacts_take_what_is_predicted() {
    let most = |model: &Model, steps| {
        let (device, counts) = emulator(1);
        drop(advanced(on(started(model, None), device), steps));
        let counts = counts.borrow();
        counts.memory[1] as f64
    };
    let in_steps = |model: Model, integrator| Model::new(Parameters { integrator, ..(*model).clone() }).unwrap();
    let explicit = most(&in_steps(repelling(), Integrator::AdamsBashforth { order: 4 }), STEPS);
    let short = Integrator::Implicit(Adaptive { tolerance: 1e-4, ..Adaptive::default() });
    let more = |model| (most(&in_steps(model, short), 2) - explicit) / 16.0;
    let slots = contacts::Contacts::of(&frictional()).unwrap().slots_of(16);
    let (implicit, touching) = (more(repelling()), more(frictional()));
    let is_near = |found: f64, predicted: f64| (0.9 * predicted..1.01 * predicted).contains(&found);
    assert!(is_near(implicit, SUBSTEP_BYTES), "{implicit} of {SUBSTEP_BYTES}");
    let (touching, predicted) = (touching - implicit, bytes_of_contacts(slots));
    assert!(is_near(touching, predicted), "{touching} of {predicted}");
}

/// A run that is resumed between, on a card whose threads run in another order, has the same bits; one whose columns
/// are read after each step too, and one that goes back to the start of a step that was interrupted.
#[test]
fn a_resumed_run_has_the_same_bits() {
    let model = frictional();
    let state = advanced(on(started(&model, None), emulator(1).0), 3).state();
    let mut part = advanced(on(started(&model, None), emulator(2).0), 1);
    let mut resumed = advanced(on(started(&model, Some(&mut part)), emulator(3).0), 2);
    assert!(resumed.state() == state, "resumed");
    let [mut read, mut interrupted] = [(); 2].map(|()| on(started(&model, None), emulator(1).0));
    for step in 0..3 {
        assert!(read.particles().columns.iter().all(|column| column.values.is_here()));
        read.step().unwrap();
        step_interrupted(&mut interrupted, step == 1);
    }
    assert!(read.state() == state, "read in each step");
    assert!(interrupted.state() == state, "interrupted");
}

/// Spheres cross the faces of a sheared box, whose lattice vectors change at half a period of its strain, as on the
/// host; and so do the frames of reference of their velocities.
#[test]
fn spheres_cross_faces_as_on_the_host() {
    let model = dense(|parameters| {
        parameters.flow = Flow::Shear { rate: 26.0, lees_edwards: true };
        parameters.contacts = Some(Contacts { stiffness: Some(5e4), ..touching() });
        parameters.integrator = Integrator::Implicit(Adaptive::UNLIMITED);
    });
    let [start, mut host] = [(); 2].map(|()| started(&model, None));
    let mut card = on(started(&model, None), emulator(1).0);
    for _ in 0..3 {
        host.step().unwrap();
        card.step().unwrap();
        assert!(card.particles.are_remote());
        let [error, moved] = [&card, &start].map(|run| distance(run, &host));
        assert!(error < 1e-3 * moved, "{error:e} of {moved:e}");
        assert!(difference(CONTACTS, [&card, &host]) < 0.1);
    }
    let steps = [&card, &host].map(|run| run.gathered(None).steps);
    assert_eq!(steps[0], steps[1]);
    assert!(steps[0].iter().filter(|steps| **steps != [0; 3]).count() > 3);
    assert!(difference(PAST[0], [&card, &host]) < 1e-2);
}

/// A rate that changes between steps, with contacts that are known from before.
#[test]
fn rates_change_as_on_the_host() {
    let model = dense(|parameters| {
        parameters.contacts = Some(touching());
        parameters.integrator = Integrator::Implicit(Adaptive::UNLIMITED);
        parameters.protocol = Protocol::Steps(vec![RateChange { step: 2, rate: -0.5 }]);
    });
    let start = started(&model, None);
    let [host, card] = [started(&model, None), on(started(&model, None), emulator(1).0)].map(|run| advanced(run, 3));
    assert!(card.particles.are_remote() && host.shear()[0] < 0.0);
    let [error, moved] = [&card, &start].map(|run| distance(run, &host));
    assert!(error < 1e-3 * moved, "{error:e} of {moved:e}");
    assert!(difference(CONTACTS, [&card, &host]) < 0.1);
}

/// Spheres that come together faster than any step can follow end the run with the message of the host, and the state
/// before the step is there.
#[test]
fn collisions_are_those_of_the_host() {
    let model = model([1, 1], |parameters| {
        parameters.gravity = Vector::new(0.0, 0.0, -400.0);
        parameters.species[1].density_difference = 1.0;
        parameters.start = Start::Positions(vec![Vector::splat(3.0), Vector::new(3.0, 3.0, 5.5)]);
        parameters.integrator = Integrator::Adaptive(Adaptive::default());
    });
    let [mut host, mut card] = [started(&model, None), on(started(&model, None), emulator(1).0)];
    let before = by_id(&card.state().particles);
    let errors = [&mut host, &mut card].map(|run| run.step().unwrap_err().to_string());
    for error in &errors {
        assert!(error.starts_with("step 0: two spheres "), "{errors:?}");
    }
    assert!(by_id(&card.state().particles) == before, "as before the step");
}
