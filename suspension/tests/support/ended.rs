//! Runs to their last step.

use domain::{Comm, Particles};
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

/// Runs a model to its last step; all particles.
pub fn run(model: &Model, ranks: usize) -> Particles {
    ended(model, ranks, |suspension| suspension.gathered(None))
}

/// Checks that runs on 2, 3 and 7 ranks end with the positions of one on 1 rank, to `allowed`, and returns the
/// particles of the latter; `name` identifies the model in messages.
pub fn ranks_agree(model: &Model, allowed: f64, name: &str) -> Particles {
    let alone = run(model, 1);
    for ranks in [2, 3, 7] {
        let other = run(model, ranks);
        let apart = alone.positions.iter().zip(&other.positions).map(|(a, b)| (*a - *b).length());
        let apart = apart.fold(0.0, f64::max);
        assert!(apart < allowed, "{name} on {ranks} ranks: {apart:e}");
    }
    alone
}
