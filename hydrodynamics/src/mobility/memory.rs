//! Memory of single evaluations of the mobility.

use crate::memory::{self, Ranks, of_peak, solve_bytes, table_bytes};
use domain::{Bytes, Comm, ExpectedCounts, Failure, Particles, Place};
use fcm::{CardRanks, CardSteps, Footprint, Plan, PlanError};
use lubrication::LubricationRange;

/// A single evaluation.
pub struct SingleEvaluation<'a> {
    /// Plan of the far field.
    pub plan: &'a Plan,
    /// Radii, with the number of particles of each.
    pub radii: Vec<(f64, usize)>,
    /// Gaps at which lubrication acts, if it does.
    pub lubrication: Option<LubricationRange>,
    /// Numbers per particle in columns.
    pub numbers: usize,
    /// Other memory on the first rank.
    pub besides: Bytes,
    /// Advice if it needs too much memory.
    pub remedy: &'static str,
}

impl SingleEvaluation<'_> {
    /// Refuses an evaluation for which the ranks do not have the memory. Collective.
    pub fn check_memory(&self, comm: &Comm) -> Result<(), Failure> {
        let count: usize = self.radii.iter().map(|kind| kind.1).sum();
        comm.agree(self.check_card(comm))?;
        let message = |error| format!("{error}; for these {count} spheres take {}, or more machines", self.remedy);
        comm.agree(comm.check_memory(self.need(comm)).map_err(message))
    }

    /// Refuses an evaluation for which the device does not have the memory, or that has more ranks than it serves.
    fn check_card(&self, comm: &Comm) -> Result<(), PlanError> {
        self.plan.check_ranks(comm.size())?;
        // The last rank has no fewer planes than any other.
        let place = Place::of(comm.size(), comm.size() - 1, [self.plan.grid[1], self.plan.grid[2]]);
        let expected = self.expected(&place);
        let far = Footprint::new(self.plan, &place, 1, &expected);
        let card = memory::card(&far, &expected, self.lubrication, &CardSteps::default(), CardRanks::Present(comm))?;
        card.map_or(Ok(()), |card| card.check())
    }

    fn expected(&self, place: &Place) -> ExpectedCounts {
        let mut radii = self.radii.clone();
        radii.sort_by(|a, b| a.0.total_cmp(&b.0));
        ExpectedCounts::new(self.plan.edges, &radii, place)
    }

    fn need(&self, comm: &Comm) -> domain::MemoryNeed {
        let (plan, ranks) = (self.plan, Ranks { count: comm.size(), threads: rayon::current_num_threads() });
        let place = Place::of(ranks.count, comm.rank(), [plan.grid[1], plan.grid[2]]);
        let expected = self.expected(&place);
        let far = Footprint::new(plan, &place, ranks.threads, &expected);
        let tables = self.lubrication.map_or_else(Bytes::default, |_| table_bytes(&plan.radii));
        let solve = self.lubrication.map_or_else(|| far.solve(), |range| solve_bytes(&far, &expected, range));
        let (owned, all) = (expected.owned(), expected.total());
        let gathered = Particles::gathering_bytes(owned, all, self.numbers, comm.is_first());
        let besides = if comm.is_first() { self.besides } else { Bytes::default() };
        let stays = besides.then(far.mobility()).then(tables).then(Particles::bytes(owned, self.numbers));
        of_peak(stays.then(solve.freed().or(gathered.freed())), &far, comm.rank(), ranks.count)
    }
}
