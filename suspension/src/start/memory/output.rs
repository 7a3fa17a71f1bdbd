//! Memory of statistics and of what a run writes.

use super::{FRAME, Share};
use crate::columns::ORIENTATION_NUMBERS;
use crate::sampling;
use crate::start::plan::largest_strain;
use domain::{Boundaries, Bytes, IdBlocks, Particles, Vector};
use fcm::Footprint;
use simulation::Frame;

impl Share<'_> {
    pub(super) fn frame(&self) -> Bytes {
        let widths = FRAME.iter().take(if self.is_rigid() { 3 } else { 1 }).map(|(_, width)| width);
        let numbers = widths.sum::<usize>() + if self.model.has_orientations() { ORIENTATION_NUMBERS } else { 0 };
        let numbers = numbers + usize::from(!self.model.bodies.is_empty());
        let buffers = if self.is_first() { Frame::bytes(self.expected.total(), numbers) } else { Bytes::default() };
        self.by_id(numbers).then(buffers).freed()
    }

    /// A copy of the rank's particles, sent to the first rank block by block.
    fn by_id(&self, numbers: usize) -> Bytes {
        Particles::bytes(self.expected.owned(), numbers)
            .then(Particles::by_id_bytes(self.expected.owned(), self.expected.total()))
    }

    /// The rank's share of the statistics, and the number of samples.
    fn statistics(&self) -> Option<(sampling::RankCounts, u64)> {
        let wanted = self.model.statistics?;
        let distance = sampling::distance(self.model, wanted, self.expected.largest_radius());
        let of_rank = sampling::RankCounts {
            owned: self.expected.owned(),
            present: self.expected.present(distance),
            redistributed: IdBlocks::expected(self.expected.total(), self.rank_of.0, self.rank_of.1),
            is_first: self.is_first(),
            is_in_order: false,
        };
        Some((of_rank, wanted.samples.count_until(self.model.steps)))
    }

    /// Memory of accumulated statistics.
    pub(super) fn estimators(&self) -> Bytes {
        let kept = |(share, samples): (sampling::RankCounts, u64)| share.bytes(self.model, samples, self.threads);
        self.statistics().map_or_else(Bytes::default, kept)
    }

    /// Columns of the time series and of the statistics.
    pub(super) fn segregation(&self) -> Bytes {
        let columns = sampling::column_bytes(self.model);
        let series = if sampling::has_columns(self.model) { columns } else { Bytes::default() };
        let sampled = if self.model.statistics.is_some() { columns } else { Bytes::default() };
        series.then(sampled)
    }

    pub(super) fn sample(&self) -> Bytes {
        self.statistics().map_or_else(Bytes::default, |(share, _)| share.sample_bytes(self.model).freed())
    }

    pub(super) fn checkpoint(&self) -> Bytes {
        let state = self.statistics().map_or(0.0, |(share, samples)| share.state_bytes(self.model, samples));
        Bytes::keep(2.0 * state).then(self.by_id(self.numbers())).freed()
    }

    /// A velocity field on its own grid, gathered on the first rank.
    pub(super) fn field(&self) -> Bytes {
        if !self.model.fields {
            return Bytes::default();
        }
        let Some(plan) = self.far.plan_of_flow(largest_strain(self.model)) else { return Bytes::default() };
        let place = self.far.place_of(&plan);
        let far = Footprint::new(&plan, &place, self.threads, self.expected);
        let moved = Particles::bytes(self.expected.owned(), 11);
        let all = if self.is_first() { plan.points_of_flow().iter().map(|&n| n as f64).product() } else { 0.0 };
        let flow = if plan.boundaries == Boundaries::Periodic {
            // In a sheared box the coordinates of the points are written as well.
            let by_slip = if self.model.has_slip() { far.velocity_field() } else { Bytes::default() };
            far.evaluation().or(far.velocity_field().then(by_slip).then(Bytes::list::<Vector>(2.0 * all)))
        } else {
            // With rotated axes there are two copies.
            let turned = if self.model.turn.is_none() { 0.0 } else { all };
            far.flow().then(Bytes::list::<Vector>(all)).then(Bytes::list::<Vector>(turned))
        };
        moved.then(Bytes::keep(far.remote_resident_bytes())).then(far.mobility()).then(flow).freed()
    }
}
