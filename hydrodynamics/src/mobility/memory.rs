//! The memory of single evaluations, for particles that are brought from outside.

use crate::memory::{Ranks, of_peak, solve_bytes, table_bytes};
use domain::{Bytes, Comm, ExpectedCounts, Failure, Particles};
use fcm::{Footprint, Plan};
use lubrication::Range;

/// What is evaluated.
pub struct SingleEvaluation<'a> {
    /// How.
    pub plan: &'a Plan,
    /// Radii and how many particles have each.
    pub radii: Vec<(f64, usize)>,
    /// Where lubrication acts, if it does.
    pub lubrication: Option<Range>,
    /// Numbers of a particle's columns.
    pub numbers: usize,
    /// What the first rank has besides.
    pub besides: Bytes,
    /// What to change where it takes too much.
    pub remedy: &'static str,
}

impl SingleEvaluation<'_> {
    /// Refuses an evaluation for which the ranks have no memory. Collective.
    pub fn check_memory(&self, comm: &Comm) -> Result<(), Failure> {
        let count: usize = self.radii.iter().map(|kind| kind.1).sum();
        let message = |error| format!("{error}; for these {count} spheres take {}, or more machines", self.remedy);
        comm.agree(comm.check_memory(self.need(comm)).map_err(message))
    }

    fn need(&self, comm: &Comm) -> domain::Need {
        let (plan, ranks) = (self.plan, Ranks { count: comm.size(), threads: rayon::current_num_threads() });
        let place = domain::Place::of(ranks.count, comm.rank(), [plan.grid[1], plan.grid[2]]);
        let mut radii = self.radii.clone();
        radii.sort_by(|a, b| a.0.total_cmp(&b.0));
        let expected = ExpectedCounts::new(plan.edges, &radii, &place);
        let far = Footprint::new(plan, (&place, ranks.threads), &expected);
        let tables = self.lubrication.map_or_else(Bytes::default, |_| table_bytes(&plan.radii));
        let solve = self.lubrication.map_or_else(|| far.solve(), |range| solve_bytes(&far, &expected, range));
        let (owned, all) = (expected.owned(), expected.total());
        let gathered = Particles::gathering_bytes(owned, all, self.numbers, comm.is_first());
        let besides = if comm.is_first() { self.besides } else { Bytes::default() };
        let stays = besides.then(far.mobility()).then(tables).then(Particles::bytes(owned, self.numbers));
        of_peak(stays.then(solve.freed().or(gathered.freed())), &far, (comm.rank(), ranks.count))
    }
}
