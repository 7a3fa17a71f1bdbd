//! Distributed transpositions: each rank of a group sends every other rank its part of the columns, so that columns
//! become whole. Large ones run in rounds, each with a part of the columns, in memory for one round.

use crate::Real;
use crate::layout::{Layout, Strides};
use crate::shared::Shared;
use domain::{Comm, Partition, Window, block};
use std::ops::Range;

/// A planned transposition among the ranks of a group. Rows are copied directly to their destination if that is on
/// this machine, or on this rank; rows for ranks on other machines are packed and sent.
pub(super) struct Transposition<T> {
    group: Comm,
    rounds: Vec<Round<T>>,
    /// Whole columns of each rank in a round, ordered by the ranks from which they come, since the split index is the
    /// slowest in memory.
    columns: Window,
    /// Send buffer for ranks on other machines.
    send_buffer: Window,
    /// Number of values in whole columns, and in the send buffer, in the largest round.
    size: usize,
    outgoing: usize,
}

/// A round: a part of the columns.
struct Round<T> {
    packing: Packing<T>,
    /// By rank on other machines: ranges to send in the send buffer, and ranges received in the columns.
    sent: Vec<Range<usize>>,
    received: Vec<Range<usize>>,
    /// Bytes for other ranks on this machine.
    local_bytes: usize,
    /// For whole columns along z: their modes along y, and their strides.
    modes: Range<usize>,
    strides: Strides,
}

/// Whole columns along z of some modes along y.
pub(super) struct WholeColumns<T> {
    pub memory: Shared<T>,
    pub strides: Strides,
    pub modes: Range<usize>,
}

/// Destinations of the rows.
pub(super) struct Packing<T> {
    strides: Strides,
    parts: Vec<PackedPart<T>>,
}

/// Part for one rank: `rows` times `width` values of each plane of each component.
struct PackedPart<T> {
    /// Index of the first value in the field.
    start: usize,
    /// Destination.
    place: Shared<T>,
    shape: PackedShape,
}

/// Exchange of a round: start of the values for each rank, and their shape by sender and receiver.
struct RoundPlan<Start, Shaped> {
    components: usize,
    shape: Shaped,
    start: Start,
    modes: Range<usize>,
    strides: Strides,
}

impl<Start: Fn(usize) -> usize, Shaped: Fn(usize, usize) -> PackedShape> RoundPlan<Start, Shaped> {
    /// Number of values from one rank to another.
    fn reals(&self, from: usize, to: usize, planes: impl Fn(usize) -> usize) -> usize {
        let PackedShape { rows, width, .. } = (self.shape)(from, to);
        self.components * planes(from) * rows * width
    }

    /// Position in a rank's columns at which those from another begin.
    fn first(&self, from: usize, to: usize, planes: impl Fn(usize) -> usize) -> usize {
        (0..from).map(|earlier| self.reals(earlier, to, &planes)).sum()
    }

    /// The round on this rank of a group, with memory for whole columns and the send buffer.
    fn round<T: Real>(
        self,
        group: &Comm,
        strides: Strides,
        planes: impl Fn(usize) -> usize,
        [columns, send_buffer]: [&Window; 2],
    ) -> Round<T> {
        let (me, ranks) = (group.rank(), group.size());
        let is_elsewhere = |rank| columns.of::<T>(rank).is_none();
        let (mut sent, mut received, mut outgoing, mut local_bytes) = (Vec::new(), Vec::new(), 0, 0);
        for rank in 0..ranks {
            let both = [self.reals(me, rank, &planes), self.reals(rank, me, &planes)];
            let [to, from] = both.map(|reals| if is_elsewhere(rank) { reals } else { 0 });
            let first = self.first(rank, me, &planes);
            sent.push(outgoing..outgoing + to);
            received.push(first..first + from);
            outgoing += to;
            local_bytes += if is_elsewhere(rank) || rank == me { 0 } else { both[0] * size_of::<T>() };
        }
        let part = |rank| {
            let (window, owner, place) = if is_elsewhere(rank) {
                (send_buffer, 0, sent[rank].start)
            } else {
                (columns, rank, self.first(me, rank, &planes))
            };
            // SAFETY: the window is large enough.
            let place = unsafe { memory::<T>(window, owner).add(place) };
            PackedPart { start: (self.start)(rank), place: Shared::from_pointer(place), shape: (self.shape)(me, rank) }
        };
        let packing = Packing { strides, parts: (0..ranks).map(part).collect() };
        Round { packing, sent, received, local_bytes, modes: self.modes, strides: self.strides }
    }
}

/// Shape and strides of the rows for one rank.
struct PackedShape {
    rows: usize,
    width: usize,
    packed: Strides,
}

impl<T: Real> Transposition<T> {
    /// Exchange of blocks along x for whole columns along y, in the ranks' column; `None` if they are whole already.
    pub fn along_y(layout: &Layout, partition: &Partition) -> Option<Self> {
        let group = partition.column();
        let blocks = |rank| block((layout.points[0] / 2).div_ceil(T::LANES), group.size(), rank);
        let (components, planes) = (layout.components, layout.rows[1].len());
        let part = |from, to| {
            let width = blocks(to).len() * 2 * T::LANES;
            let packed = Strides { component: width, z: components * width, y: components * width * planes };
            PackedShape { rows: block(layout.points[1], group.size(), from).len(), width, packed }
        };
        let start = |to| blocks(to).start * 2 * T::LANES;
        let planes = |_| planes;
        let plan = RoundPlan { components, shape: part, start, modes: layout.modes.clone(), strides: layout.spectral };
        Self::new(group, layout.physical, planes, vec![plan])
    }

    /// Exchange of modes along y for whole columns along z, in the ranks' row, in `rounds` rounds; `None` if they are
    /// whole already.
    pub fn along_z(layout: &Layout, partition: &Partition, rounds: usize) -> Option<Self> {
        let group = partition.row();
        let width = layout.blocks.len() * 2 * T::LANES;
        let modes = |rank, round| {
            let all = block(layout.points[1], group.size(), rank);
            let part = block(all.len(), rounds, round);
            all.start + part.start..all.start + part.end
        };
        let components = layout.components;
        let packed = |rows: usize| Strides { component: rows * width, z: components * rows * width, y: width };
        let planes = |from| block(layout.points[2], group.size(), from).len();
        let plans = (0..rounds).map(|round| RoundPlan {
            components,
            shape: move |_: usize, to: usize| {
                let rows = modes(to, round).len();
                PackedShape { rows, width, packed: packed(rows) }
            },
            start: move |to| modes(to, round).start * layout.transposed.y,
            modes: modes(group.rank(), round),
            strides: packed(modes(group.rank(), round).len()),
        });
        Self::new(group, layout.transposed, planes, plans.collect())
    }

    /// From the planes of each rank, and the exchange of each round.
    fn new(
        group: &Comm,
        strides: Strides,
        planes: impl Fn(usize) -> usize,
        plans: Vec<RoundPlan<impl Fn(usize) -> usize, impl Fn(usize, usize) -> PackedShape>>,
    ) -> Option<Self> {
        let (me, ranks) = (group.rank(), group.size());
        if ranks == 1 {
            return None;
        }
        let sizes = plans.iter().map(|plan| plan.first(ranks, me, &planes));
        let size = sizes.max().unwrap_or(0);
        let columns = group.window(size * size_of::<T>());
        let to_elsewhere = |plan: &RoundPlan<_, _>| -> usize {
            let elsewhere = (0..ranks).filter(|&rank| columns.of::<T>(rank).is_none());
            elsewhere.map(|rank| plan.reals(me, rank, &planes)).sum()
        };
        let outgoing = plans.iter().map(to_elsewhere).max().unwrap_or(0);
        let send_buffer = Comm::alone().window(outgoing * size_of::<T>());
        let rounds =
            plans.into_iter().map(|plan| plan.round(group, strides, &planes, [&columns, &send_buffer])).collect();
        Some(Self { group: group.clone(), rounds, columns, send_buffer, size, outgoing })
    }

    /// Number of values in whole columns.
    #[cfg(test)]
    pub fn reals(&self) -> usize {
        self.size
    }

    /// Number of rounds.
    pub fn rounds(&self) -> usize {
        self.rounds.len()
    }

    /// Destinations of the rows in a round.
    pub fn packing(&self, round: usize) -> &Packing<T> {
        &self.rounds[round].packing
    }

    /// This rank's whole columns.
    pub fn columns(&self) -> Shared<T> {
        Shared::from_pointer(memory(&self.columns, self.group.rank()))
    }

    /// This rank's whole columns along z in a round.
    pub fn columns_along_z(&self, round: usize) -> WholeColumns<T> {
        let Round { modes, strides, .. } = &self.rounds[round];
        WholeColumns { memory: self.columns(), strides: *strides, modes: modes.clone() }
    }

    /// Waits until the columns of the last exchange are no longer needed. Packing comes next.
    pub fn begin(&self) {
        self.columns.barrier();
    }

    /// Makes columns whole once all ranks have packed a round.
    pub fn exchange(&self, round: usize) {
        let Round { sent, received, .. } = self.barrier(round);
        if self.columns.is_divided() {
            // SAFETY: all ranks on this machine have packed, and none unpacks yet.
            let [columns, send_buffer] = unsafe { self.values() };
            self.group.all_to_all_ranges((send_buffer, sent), (columns, received));
        }
    }

    /// Makes columns available for unpacking once all ranks have finished with them. Unpacking comes next.
    pub fn exchange_back(&self, round: usize) {
        let Round { sent, received, .. } = self.barrier(round);
        if self.columns.is_divided() {
            // SAFETY: columns are not written before the next call of `begin`.
            let [columns, send_buffer] = unsafe { self.values() };
            self.group.all_to_all_ranges((columns, received), (send_buffer, sent));
        }
    }

    /// Barrier for the ranks on this machine.
    fn barrier(&self, round: usize) -> &Round<T> {
        self.columns.barrier();
        self.group.count_sent(self.rounds[round].local_bytes);
        &self.rounds[round]
    }

    /// This rank's columns and send buffer.
    ///
    /// # Safety
    /// They are written only through these slices meanwhile.
    #[expect(clippy::mut_from_ref, reason = "they are not behind the reference")]
    unsafe fn values(&self) -> [&mut [T]; 2] {
        // SAFETY: the windows hold this many values, initially zero.
        [(&self.columns, self.group.rank(), self.size), (&self.send_buffer, 0, self.outgoing)]
            .map(|(window, rank, count)| unsafe { std::slice::from_raw_parts_mut(memory(window, rank), count) })
    }
}

/// Memory of a rank on this machine.
fn memory<T: Real>(window: &Window, rank: usize) -> *mut T {
    window.of(rank).expect("memory that can be reached")
}

impl<T: Real> Packing<T> {
    /// Copies the rows of a plane to their destinations, best while it is in the cache.
    ///
    /// # Safety
    /// The field is that of the exchange, it has begun, and there is no concurrent access to the plane.
    pub unsafe fn pack(&self, field: &Shared<T>, plane: [usize; 2]) {
        self.each_row(plane, |row, place, width| unsafe {
            std::ptr::copy_nonoverlapping(field.at(row), place, width);
        });
    }

    /// Copies the rows of a plane back from their destinations.
    ///
    /// # Safety
    /// As for [`Self::pack`], and columns were given back.
    pub unsafe fn unpack(&self, field: &Shared<T>, plane: [usize; 2]) {
        self.each_row(plane, |row, place, width| unsafe {
            std::ptr::copy_nonoverlapping(place, field.at(row), width);
        });
    }

    /// Visits each row of a plane of a component: position in the field, destination, and number of values.
    fn each_row(&self, [component, z]: [usize; 2], visit: impl Fn(usize, *mut T, usize)) {
        for PackedPart { start, place, shape } in &self.parts {
            for row in 0..shape.rows {
                // SAFETY: the part has these rows.
                let packed = unsafe { place.at(shape.packed.at(component, row, z)) };
                visit(start + self.strides.at(component, row, z), packed, shape.width);
            }
        }
    }
}
