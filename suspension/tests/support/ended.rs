//! Runs to their ends.

use domain::Comm;
use suspension::{Model, Suspension};

/// What `look` sees on the first of so many ranks when a model has run to its last step. Collective.
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
