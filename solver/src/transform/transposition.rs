//! Transpositions: each rank of a group gives every other its part of the columns, so that these are whole.

use crate::Real;
use crate::layout::{Layout, Strides};
use crate::shared::Shared;
use domain::{Comm, Partition, Window, block};
use std::ops::Range;

/// A transposition among the ranks of a group, planned. Rows are copied straight to where a rank on this machine, or this
/// rank itself, needs them for the next direction; those for ranks elsewhere are packed and sent.
pub(super) struct Transposition<T> {
    group: Comm,
    packing: Packing<T>,
    /// Whole columns of each rank. What arrives stands by the ranks it came from, since the split index is the slowest
    /// in memory.
    columns: Window,
    /// What is sent elsewhere.
    outbox: Window,
    /// By ranks elsewhere: what goes to them in the outbox, and what comes from them in the columns.
    sent: Vec<Range<usize>>,
    received: Vec<Range<usize>>,
    /// Reals of whole columns.
    size: usize,
    /// Bytes for others on this machine.
    beside: usize,
}

/// Where each row goes.
pub(super) struct Packing<T> {
    strides: Strides,
    parts: Vec<Part<T>>,
}

/// What goes to one rank: `rows` times `width` reals of each plane of each component.
struct Part<T> {
    /// Of the first real in the field.
    start: usize,
    /// Where it goes.
    place: Shared<T>,
    shape: Shape,
}

/// How rows for one rank stand together.
struct Shape {
    rows: usize,
    width: usize,
    packed: Strides,
}

impl<T: Real> Transposition<T> {
    /// The exchange of blocks along x for whole columns along y, in the ranks' column; none if they are whole already.
    pub fn along_y(layout: &Layout, partition: &Partition) -> Option<Self> {
        let group = partition.column();
        let blocks = |rank| block((layout.points[0] / 2).div_ceil(T::LANES), group.size(), rank);
        let planes = layout.rows[1].len();
        let part = |from, to| {
            let width = blocks(to).len() * 2 * T::LANES;
            let packed = Strides { component: width, z: 3 * width, y: 3 * width * planes };
            Shape { rows: block(layout.points[1], group.size(), from).len(), width, packed }
        };
        let start = |to| blocks(to).start * 2 * T::LANES;
        let planes = |_| planes;
        Self::new(group, layout.physical, planes, start, part)
    }

    /// The exchange of modes along y for whole columns along z, in the ranks' row; none if they are whole already.
    pub fn along_z(layout: &Layout, partition: &Partition) -> Option<Self> {
        let group = partition.row();
        let width = layout.blocks.len() * 2 * T::LANES;
        let modes = |rank| block(layout.points[1], group.size(), rank);
        let part = |_, to: usize| {
            let rows = modes(to).len();
            Shape { rows, width, packed: Strides { component: rows * width, z: 3 * rows * width, y: width } }
        };
        let start = |to| modes(to).start * layout.transposed.y;
        let planes = |from| block(layout.points[2], group.size(), from).len();
        Self::new(group, layout.transposed, planes, start, part)
    }

    /// From the planes of a rank, and what is for a rank: where it begins, and its shape by whom it is from.
    fn new(
        group: &Comm,
        strides: Strides,
        planes: impl Fn(usize) -> usize,
        start: impl Fn(usize) -> usize,
        shape: impl Fn(usize, usize) -> Shape,
    ) -> Option<Self> {
        let (me, ranks) = (group.rank(), group.size());
        if ranks == 1 {
            return None;
        }
        let reals = |from, to| {
            let Shape { rows, width, .. } = shape(from, to);
            3 * planes(from) * rows * width
        };
        // Where in a rank's columns those from another begin.
        let first = |from, to| (0..from).map(|earlier| reals(earlier, to)).sum::<usize>();
        let size = first(ranks, me);
        let columns = group.window(size * size_of::<T>());
        let is_elsewhere = |rank| columns.of::<T>(rank).is_none();
        let (mut sent, mut received, mut outbox, mut beside) = (Vec::new(), Vec::new(), 0, 0);
        for rank in 0..ranks {
            let [to, from] = [reals(me, rank), reals(rank, me)].map(|reals| if is_elsewhere(rank) { reals } else { 0 });
            sent.push(outbox..outbox + to);
            received.push(first(rank, me)..first(rank, me) + from);
            outbox += to;
            beside += if is_elsewhere(rank) || rank == me { 0 } else { reals(me, rank) * size_of::<T>() };
        }
        let outbox = Comm::alone().window(outbox * size_of::<T>());
        let part = |rank| {
            let (window, owner, place) =
                if is_elsewhere(rank) { (&outbox, 0, sent[rank].start) } else { (&columns, rank, first(me, rank)) };
            // SAFETY: there is room for it.
            let place = unsafe { memory::<T>(window, owner).add(place) };
            Part { start: start(rank), place: Shared::from_pointer(place), shape: shape(me, rank) }
        };
        let packing = Packing { strides, parts: (0..ranks).map(part).collect() };
        Some(Self { group: group.clone(), packing, columns, outbox, sent, received, size, beside })
    }

    /// Reals of whole columns.
    #[cfg(test)]
    pub fn reals(&self) -> usize {
        self.size
    }

    /// Where rows go, and come from.
    pub fn packing(&self) -> &Packing<T> {
        &self.packing
    }

    /// This rank's whole columns.
    pub fn columns(&self) -> Shared<T> {
        Shared::from_pointer(memory(&self.columns, self.group.rank()))
    }

    /// The values of this rank's whole columns, while no rank packs or unpacks.
    pub fn columns_mut(&mut self) -> &mut [T] {
        // SAFETY: the caller has this exchange for itself, and other ranks come here only while all do.
        let [columns, _] = unsafe { self.values() };
        columns
    }

    /// Waits until the columns of the last time are needed no more. Packing comes next.
    pub fn open(&self) {
        self.columns.barrier();
    }

    /// Makes columns whole once all is packed.
    pub fn deliver(&self) {
        self.meet();
        if self.columns.is_divided() {
            // SAFETY: all on this machine have packed, and nobody unpacks yet.
            let [columns, outbox] = unsafe { self.values() };
            self.group.all_to_all_ranges((outbox, &self.sent), (columns, &self.received));
        }
    }

    /// Lets columns be fetched once all have done with them. Unpacking comes next.
    pub fn give_back(&self) {
        self.meet();
        if self.columns.is_divided() {
            // SAFETY: nobody writes to columns before they are opened again.
            let [columns, outbox] = unsafe { self.values() };
            self.group.all_to_all_ranges((columns, &self.received), (outbox, &self.sent));
        }
    }

    /// Waits for the ranks on this machine to have done what comes before.
    fn meet(&self) {
        self.columns.barrier();
        self.group.count_sent(self.beside);
    }

    /// This rank's columns and outbox.
    ///
    /// # Safety
    /// Nobody writes there meanwhile but through these.
    #[expect(clippy::mut_from_ref, reason = "they are not behind the reference")]
    unsafe fn values(&self) -> [&mut [T]; 2] {
        let outgoing = self.sent.last().map_or(0, |last| last.end);
        // SAFETY: there are so many, zeros at first.
        [(&self.columns, self.group.rank(), self.size), (&self.outbox, 0, outgoing)]
            .map(|(window, rank, count)| unsafe { std::slice::from_raw_parts_mut(memory(window, rank), count) })
    }
}

/// The memory of a rank that can be reached.
fn memory<T: Real>(window: &Window, rank: usize) -> *mut T {
    window.of(rank).expect("memory that can be reached")
}

impl<T: Real> Packing<T> {
    /// Copies a plane to where its rows go, best while it is in the cache.
    ///
    /// # Safety
    /// The field is that of the exchange, it is open, and nobody else touches the plane.
    pub unsafe fn pack(&self, field: &Shared<T>, plane: [usize; 2]) {
        self.each_row(plane, |row, place, width| unsafe {
            std::ptr::copy_nonoverlapping(field.at(row), place, width);
        });
    }

    /// Copies a plane from where its rows went.
    ///
    /// # Safety
    /// As for [`Self::pack`], and columns were given back.
    pub unsafe fn unpack(&self, field: &Shared<T>, plane: [usize; 2]) {
        self.each_row(plane, |row, place, width| unsafe {
            std::ptr::copy_nonoverlapping(place, field.at(row), width);
        });
    }

    /// Where each row of a plane of a component stands in the field, where it goes, and its reals.
    fn each_row(&self, [component, z]: [usize; 2], visit: impl Fn(usize, *mut T, usize)) {
        for Part { start, place, shape } in &self.parts {
            for row in 0..shape.rows {
                // SAFETY: the part has these rows.
                let packed = unsafe { place.at(shape.packed.at(component, row, z)) };
                visit(start + self.strides.at(component, row, z), packed, shape.width);
            }
        }
    }
}
