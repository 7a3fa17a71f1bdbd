//! Runs that are resumed after every step.

use domain::Comm;
use simulation::Simulation;
use suspension::{Model, SuspensionRun};

/// Checks that a run that is resumed after any step has the bits of one that is not, in statistics too;
/// `name` identifies the model in messages.
pub fn resumes_with_the_same_bits(model: &Model, name: &str) {
    let mut whole = SuspensionRun::start(model, None, &Comm::alone()).unwrap();
    whole.sample();
    for step in 1..=model.steps {
        let mut resumed = SuspensionRun::resume(model, Some(whole.state()), &Comm::alone()).unwrap();
        for run in [&mut whole, &mut resumed] {
            run.advance(step).unwrap();
            run.sample();
        }
        let (whole, resumed) = (whole.state(), resumed.state());
        assert_eq!(whole.particles, resumed.particles, "{name} after step {step}");
        assert!(whole.statistics == resumed.statistics, "{name} after step {step}");
    }
}
