//! Making columns whole: each rank of a group sends every other its part of the columns.

use crate::Real;
use crate::layout::{Layout, Strides};
use crate::memory::Memory;
use crate::shared::Shared;
use domain::{Comm, Partition, block};
use rayon::prelude::*;

/// An exchange between the ranks of a group, planned. What arrives stands where the next direction needs it, since the
/// split index is the slowest in memory: only what leaves is packed.
pub(super) struct Exchange {
    group: Comm,
    planes: usize,
    strides: Strides,
    parts: Vec<Part>,
    send_counts: Vec<usize>,
    receive_counts: Vec<usize>,
}

/// What goes to one rank: `rows` times `width` reals of each plane of each component.
struct Part {
    /// Of the first real in the field and in the outbox.
    start: [usize; 2],
    rows: usize,
    width: usize,
    packed: Strides,
}

impl Exchange {
    /// The exchange of blocks along x for whole columns along y, in the ranks' column; none if they are whole already.
    pub fn along_y<T: Real>(layout: &Layout, partition: &Partition) -> Option<Self> {
        let group = partition.column();
        let blocks_in_all = (layout.points[0] / 2).div_ceil(T::LANES);
        let [rows, planes] = [layout.rows[0].len(), layout.rows[1].len()];
        let part = |rank| {
            let blocks = block(blocks_in_all, group.size(), rank);
            let width = blocks.len() * 2 * T::LANES;
            let packed = Strides { component: width, z: 3 * width, y: 3 * width * planes };
            Part { start: [blocks.start * 2 * T::LANES, 0], rows, width, packed }
        };
        let width = layout.blocks.len() * 2 * T::LANES;
        let received = |rank| block(layout.points[1], group.size(), rank).len() * planes * 3 * width;
        Self::new(group, (planes, layout.physical), part, received)
    }

    /// The exchange of modes along y for whole columns along z, in the ranks' row; none if they are whole already.
    pub fn along_z<T: Real>(layout: &Layout, partition: &Partition) -> Option<Self> {
        let group = partition.row();
        let width = layout.blocks.len() * 2 * T::LANES;
        let part = |rank| {
            let modes = block(layout.points[1], group.size(), rank);
            let packed = Strides { component: modes.len() * width, z: 3 * modes.len() * width, y: width };
            Part { start: [modes.start * layout.transposed.y, 0], rows: modes.len(), width, packed }
        };
        let received = |rank| block(layout.points[2], group.size(), rank).len() * layout.modes.len() * 3 * width;
        Self::new(group, (layout.rows[1].len(), layout.transposed), part, received)
    }

    fn new(
        group: &Comm,
        (planes, strides): (usize, Strides),
        part: impl Fn(usize) -> Part,
        received: impl Fn(usize) -> usize,
    ) -> Option<Self> {
        if group.size() == 1 {
            return None;
        }
        let mut parts: Vec<Part> = (0..group.size()).map(part).collect();
        let send_counts: Vec<usize> = parts.iter().map(|p| 3 * planes * p.rows * p.width).collect();
        let mut start = 0;
        for (part, count) in parts.iter_mut().zip(&send_counts) {
            part.start[1] = start;
            start += count;
        }
        let receive_counts = (0..group.size()).map(received).collect();
        Some(Self { group: group.clone(), planes, strides, parts, send_counts, receive_counts })
    }

    /// Reals that the outbox needs to hold.
    pub fn room(&self) -> usize {
        self.send_counts.iter().sum()
    }

    /// Sends away the field and receives the columns in its place.
    pub fn send<T: Real>(&self, field: &mut Memory<T>, outbox: &mut Memory<T>) {
        self.copy(field, outbox, |ours, packed| packed.copy_from_slice(ours));
        let received = self.receive_counts.iter().sum();
        let send = (&outbox.values()[..self.room()], self.send_counts.as_slice());
        self.group.all_to_all(send, (&mut field.values_mut()[..received], &self.receive_counts));
    }

    /// The inverse of [`Self::send`].
    pub fn send_back<T: Real>(&self, field: &mut Memory<T>, outbox: &mut Memory<T>) {
        let received = self.receive_counts.iter().sum();
        let room = self.room();
        let send = (&field.values()[..received], self.receive_counts.as_slice());
        self.group.all_to_all(send, (&mut outbox.values_mut()[..room], &self.send_counts));
        self.copy(field, outbox, |ours, packed| ours.copy_from_slice(packed));
    }

    /// Brings each row of the field together with its place in the outbox.
    fn copy<T: Real>(&self, field: &mut Memory<T>, outbox: &mut Memory<T>, work: impl Fn(&mut [T], &mut [T]) + Sync) {
        let (ours, packed) = (Shared::new(field.values_mut()), Shared::new(outbox.values_mut()));
        // The group of ranks stays on the thread that made it.
        let Self { planes, strides, parts, .. } = self;
        (0..3 * planes).into_par_iter().for_each(|i| {
            let (component, z) = (i / planes, i % planes);
            for part in parts {
                for row in 0..part.rows {
                    let from = part.start[0] + strides.at(component, row, z);
                    let to = part.start[1] + part.packed.at(component, row, z);
                    // SAFETY: rows lie inside field and outbox, and each is one thread's.
                    unsafe {
                        let from = std::slice::from_raw_parts_mut(ours.at(from), part.width);
                        work(from, std::slice::from_raw_parts_mut(packed.at(to), part.width));
                    }
                }
            }
        });
    }
}
