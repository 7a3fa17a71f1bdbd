//! Oscillatory shear and extensions, which advect spheres that move on an emulator of a card.

use super::implicit::{agree, dense, difference, exact, touching};
use super::*;
use crate::model::{BrownianScheme, Extension};

const ALL: [Extension; 3] = [Extension::Planar, Extension::Uniaxial, Extension::Biaxial];

fn oscillating(parameters: &mut Parameters) {
    parameters.flow = Flow::Shear { rate: 4.0, lees_edwards: true };
    parameters.protocol = Protocol::Oscillation { frequency: 40.0 };
}

fn extended(kind: Extension, rate: f64) -> impl Fn(&mut Parameters) {
    move |parameters| {
        parameters.cell = kind.cell(parameters.cell.edges()).unwrap();
        parameters.flow = Flow::Extension { kind, rate };
    }
}

/// Explicit steps of a length, with lubrication and repulsion.
fn steady(change: impl FnOnce(&mut Parameters)) -> Model {
    model([12, 8], |parameters| {
        parameters.hydrodynamics.lubrication = true;
        parameters.repulsion = Some(Repulsion { radius_power: 2, range: Some(0.2), ..Repulsion::new(20.0) });
        change(parameters);
    })
}

/// Implicit steps with contacts, and control of the error.
fn frictional(change: impl FnOnce(&mut Parameters)) -> Model {
    dense(|parameters| {
        parameters.contacts = Some(touching());
        change(parameters);
    })
}

/// Explicit steps whose length adapts.
fn adaptive(change: impl FnOnce(&mut Parameters)) -> Model {
    dense(|parameters| {
        parameters.repulsion = Some(Repulsion { radius_power: 2, range: Some(0.1), ..Repulsion::new(30.0) });
        parameters.integrator = Integrator::Adaptive(Adaptive::default());
        change(parameters);
    })
}

/// Thermal motion.
fn agitated(scheme: BrownianScheme, change: impl FnOnce(&mut Parameters)) -> Model {
    steady(|parameters| {
        change(parameters);
        parameters.thermal_energy = Some(10.0);
        parameters.integrator = Integrator::Brownian(scheme);
    })
}

#[test]
fn spheres_oscillate_as_on_the_host() {
    agree(&exact(&steady(oscillating)), 1e-6);
    agree(&frictional(oscillating), 1e-3);
    agree(&adaptive(oscillating), 1e-3);
}

#[test]
fn spheres_are_stretched_as_on_the_host() {
    agree(&exact(&steady(extended(Extension::Planar, 1.0))), 1e-6);
    agree(&frictional(extended(Extension::Uniaxial, 1.0)), 1e-3);
    agree(&adaptive(extended(Extension::Biaxial, 1.0)), 1e-3);
}

/// Lattice vectors change within the steps, and lattice steps have the names of the host. Past velocities are deformed
/// with the box.
#[test]
fn lattices_are_renamed_as_on_the_host() {
    for kind in ALL {
        let model = model([8, 4], extended(kind, 25.0));
        let [start, mut host] = [(); 2].map(|()| started(&model, None));
        let mut card = on(started(&model, None), emulator(1).0);
        let mut renamed = 0;
        for _ in 0..STEPS {
            let before = host.cell().lattice_vectors();
            host.step().unwrap();
            card.step().unwrap();
            assert!(card.particles.are_remote());
            let stretched = before.map(|vector| kind.stretch(0.25) * vector);
            let is_other = |(one, other): (&Vector, &Vector)| (*one - *other).length() > 1e-6;
            renamed += usize::from(stretched.iter().zip(&host.cell().lattice_vectors()).any(is_other));
        }
        let [error, moved] = [&card, &start].map(|run| distance(run, &host));
        assert!(error < 1e-4 * moved, "{kind:?}: {error:e} of {moved:e}");
        let steps = [&card, &host].map(|run| run.gathered(None).steps);
        assert_eq!(steps[0], steps[1]);
        assert!(renamed > 0 && steps[0].iter().filter(|steps| **steps != [0; 3]).count() > 3);
        let past = difference(PAST[0], [&card, &host]);
        assert!(past < 1e-4, "{kind:?}: {past:e}");
    }
}

/// In thermal motion too: up to the errors of drifts, where they are finite differences.
#[test]
fn brownian_spheres_are_carried_as_on_the_host() {
    let planar = agitated(BrownianScheme::Midpoint, extended(Extension::Planar, 1.0));
    for (model, allowed) in [(planar, 1e-6), (agitated(BrownianScheme::TwoEvaluations, oscillating), 1e-2)] {
        let model = exact(&model);
        let [start, mut host] = [(); 2].map(|()| started(&model, None));
        let mut card = on(started(&model, None), emulator(1).0);
        for step in 0..3 {
            host.step().unwrap();
            card.step().unwrap();
            assert!(card.particles.are_remote());
            let [error, moved] = [&card, &start].map(|run| distance(run, &host));
            assert!(error < allowed * moved, "step {step}: {error:e} of {moved:e}");
        }
    }
}

/// A step copies settings and sums, however many spheres there are.
#[test]
fn particles_stay_on_the_card() {
    let model = steady(extended(Extension::Planar, 1.0));
    // Besides settings of solves, those by which velocities are made relative to the flow, and absolute again.
    let mut card = stays_on_the_card(&model, 2);
    agree_in_columns([&mut card, &mut advanced(started(&model, None), STEPS + 3)], 1e-3);
}

/// A run that is resumed, on a card whose threads run in another order, and one that is interrupted have the bits of a
/// run that goes on.
#[test]
fn resumed_and_interrupted_runs_have_the_same_bits() {
    keeps_bits(&frictional(oscillating), 2, 1);
}
