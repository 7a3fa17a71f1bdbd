//! Runs to their last step.

use domain::Comm;
use suspension::{Model, Suspension};

/// Runs a model to its last step and returns the result of `look` on the first rank.
pub fn ended<T: Send>(model: &Model, ranks: usize, look: impl Fn(&mut Suspension) -> T + Sync) -> T {
    let all = Comm::threads(ranks, |comm| {
        let mut suspension = Suspension::start(model, &comm).unwrap();
        for _ in 0..model.steps {
            suspension.step().unwrap();
        }
        look(&mut suspension)
    });
    all.into_iter().next().unwrap()
}
