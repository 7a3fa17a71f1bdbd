//! Making columns whole: each rank of a group sends every other its part of the columns.

use crate::Real;
use crate::layout::{Layout, Strides};
use crate::memory::Memory;
use crate::shared::Shared;
use domain::{Comm, Partition, block};

/// An exchange between the ranks of a group, planned. What arrives stands where the next direction needs it, since the
/// split index is the slowest in memory: only what leaves is packed.
pub(super) struct Exchange {
    group: Comm,
    packing: Packing,
    send_counts: Vec<usize>,
    receive_counts: Vec<usize>,
}

/// Where what leaves stands in the field and in the outbox.
pub(super) struct Packing {
    strides: Strides,
    parts: Vec<Part>,
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
        let packing = Packing { strides, parts };
        Some(Self { group: group.clone(), packing, send_counts, receive_counts })
    }

    /// Reals that the outbox needs to hold.
    pub fn room(&self) -> usize {
        self.send_counts.iter().sum()
    }

    /// How to pack.
    pub fn packing(&self) -> &Packing {
        &self.packing
    }

    /// Sends what was packed and receives the columns in the field's place.
    pub fn send<T: Real>(&self, field: &mut Memory<T>, outbox: &Memory<T>) {
        let received = self.receive_counts.iter().sum();
        let send = (&outbox.values()[..self.room()], self.send_counts.as_slice());
        self.group.all_to_all(send, (&mut field.values_mut()[..received], &self.receive_counts));
    }

    /// Sends the columns back; what arrives is still to be unpacked.
    pub fn send_back<T: Real>(&self, field: &Memory<T>, outbox: &mut Memory<T>) {
        let received = self.receive_counts.iter().sum();
        let room = self.room();
        let send = (&field.values()[..received], self.receive_counts.as_slice());
        self.group.all_to_all(send, (&mut outbox.values_mut()[..room], &self.send_counts));
    }
}

impl Packing {
    /// Copies a plane to the outbox, best while it is in the cache.
    ///
    /// # Safety
    /// The field and the outbox are those of the exchange, and nobody else touches the plane.
    pub unsafe fn pack<T: Real>(&self, field: &Shared<T>, outbox: &Shared<T>, plane: [usize; 2]) {
        self.each_row(plane, |[place, packed], width| unsafe {
            std::ptr::copy_nonoverlapping(field.at(place), outbox.at(packed), width);
        });
    }

    /// Copies a plane from the outbox.
    ///
    /// # Safety
    /// As for [`Self::pack`].
    pub unsafe fn unpack<T: Real>(&self, field: &Shared<T>, outbox: &Shared<T>, plane: [usize; 2]) {
        self.each_row(plane, |[place, packed], width| unsafe {
            std::ptr::copy_nonoverlapping(outbox.at(packed), field.at(place), width);
        });
    }

    /// Where each row of a plane of a component stands in the field and in the outbox, and its reals.
    fn each_row(&self, [component, z]: [usize; 2], visit: impl Fn([usize; 2], usize)) {
        for part in &self.parts {
            for row in 0..part.rows {
                let place = part.start[0] + self.strides.at(component, row, z);
                visit([place, part.start[1] + part.packed.at(component, row, z)], part.width);
            }
        }
    }
}
