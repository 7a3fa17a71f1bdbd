//! Steps on an emulator of a card that are repeated or interrupted, and forces that are registered between steps.

use super::*;
use crate::integrators::substeps::ages;
use crate::scalars::NEXT_SUBSTEP;
use crate::{PairLaw, PairwiseForce};
use lubrication::PairKind;

/// Spheres in shear so far apart that only the error limits their substeps, in `f64`.
fn apart(tolerance: f64) -> Model {
    model([2, 2], |parameters| {
        let [a, b] = [1.5, 6.0];
        let places = [[a, a, a + 0.3], [b, b + 0.7, a], [a + 0.5, b, b], [b, a + 0.4, b - 0.6]];
        parameters.start = Start::Positions(places.map(Vector::from_array).to_vec());
        parameters.flow = Flow::Shear { rate: 10.0, lees_edwards: true };
        parameters.hydrodynamics.iteration_tolerance = Some(1e-8);
        parameters.integrator = Integrator::Implicit(Adaptive { tolerance, gap_fraction: 0.9 });
    })
}

/// A substep that is proposed as the whole step, whose error is many times the allowed one, is repeated with a shorter
/// length as on the host: the same substeps follow, after as many evaluations.
#[test]
fn a_substep_with_too_large_an_error_is_repeated_as_on_the_host() {
    let model = apart(1e-7);
    let start = started(&model, None);
    let mut runs = [started(&model, None), on(started(&model, None), emulator(1).0)].map(|run| advanced(run, 1));
    for run in &mut runs {
        run.particles.scalars.set(NEXT_SUBSTEP, &[0.01]);
        run.step().unwrap();
    }
    let [host, card] = &runs;
    assert!(card.particles.are_remote());
    let [of_host, of_card] = [host, card].map(|run| ages(&run.particles.scalars));
    assert!(of_host.len() > 1 && of_host[1] < 0.005, "the step has not been repeated: {of_host:?}");
    for (found, exact) in of_card.iter().zip(&of_host).skip(1) {
        assert!((found / exact - 1.0).abs() < 1e-4, "{of_card:?} and {of_host:?}");
    }
    assert_eq!(card.evaluations, host.evaluations);
    let [moved, error] = [&start, card].map(|run| distance(run, host));
    assert!(error < 1e-6 * moved, "{error:e} of {moved:e}");
}

/// A run with adaptive or error-controlled steps that is interrupted, and resumed between on cards whose threads run in
/// other orders, has the same bits.
#[test]
fn steps_of_any_length_are_resumed_with_the_same_bits() {
    for integrator in [Integrator::Adaptive, Integrator::Implicit] {
        let integrator = integrator(Adaptive { tolerance: 1e-3, ..Adaptive::default() });
        let model = Model::new(Parameters { integrator, ..(*sheared()).clone() }).unwrap();
        keeps_bits(&model, 3, 2);
    }
}

/// A constant repulsion up to a distance.
struct Push;

impl PairLaw for Push {
    fn name(&self) -> &'static str {
        "push"
    }

    fn reach(&self, _: PairKind) -> f64 {
        3.5
    }

    fn force(&self, separation: Vector, _: PairKind) -> Vector {
        if separation.length() < 3.5 { -40.0 * separation.normalize() } else { Vector::ZERO }
    }
}

/// A force of the user that is registered between steps moves the spheres to the host, where they go on as in a run on
/// the host; by explicit and by implicit steps.
#[test]
fn a_force_of_the_user_between_steps_acts_as_on_the_host() {
    let implicit = Integrator::Implicit(Adaptive { tolerance: 1e-3, ..Adaptive::default() });
    for integrator in [sheared().integrator, implicit] {
        let model = Model::new(Parameters { integrator, ..(*sheared()).clone() }).unwrap();
        let without = advanced(started(&model, None), 4);
        let mut runs = [started(&model, None), on(started(&model, None), emulator(1).0)].map(|run| advanced(run, 2));
        assert!(runs[1].particles.are_remote());
        let middle = started(&model, Some(&mut advanced(started(&model, None), 2)));
        for run in &mut runs {
            run.add_force(Box::new(PairwiseForce::new(Push))).unwrap();
            (0..2).for_each(|_| run.step().unwrap());
        }
        let [host, card] = &runs;
        assert!(!card.particles.are_remote());
        let [moved, pushed, error] = [&middle, &without, card].map(|run| distance(run, host));
        assert!(pushed > 0.1 * moved && error < 1e-3 * moved, "{moved:e}, {pushed:e}, {error:e}");
        let [of_card, of_host] = [card, host].map(|run| run.stress(2)[0].of("push").x_axis.x);
        assert!(of_host < 0.0 && (of_card / of_host - 1.0).abs() < 1e-3, "{of_card} and {of_host}");
    }
}
