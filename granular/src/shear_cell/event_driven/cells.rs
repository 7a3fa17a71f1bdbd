//! Cell lists: cells of a diameter or more, each with a short list of its grains.

use super::super::CellModel;
use bytemuck::Zeroable;
use domain::Vector;

/// Initial capacity of a cell; when one is full, the capacity of all is doubled.
const ROOM: usize = 8;
/// Largest number of cells per grain; it leaves at least three cells along each axis.
const MOST: f64 = 64.0;
/// Largest number of grains that are examined together.
pub const NEAR: usize = 512;

/// A grid of cells over the box. A walled axis begins and ends at its walls; the last cell along y extends up to the
/// top wall, wherever that is.
pub struct GrainCells {
    pub counts: [usize; 3],
    pub edges: Vector,
    pub walled: [bool; 3],
    /// Lengths of the periodic axes; infinite where there are walls.
    pub periods: [f64; 3],
    room: usize,
    filled: Vec<u32>,
    /// `room` entries for each cell.
    slots: Vec<u32>,
}

/// The nearest image of a coordinate of a separation.
#[inline(always)]
pub fn nearest_image(x: f64, period: f64) -> f64 {
    let back = if x > 0.5 * period { period } else { 0.0 };
    let forth = if x < -0.5 * period { period } else { 0.0 };
    x - back + forth
}

/// The grains in a block of cells.
#[derive(Zeroable)]
pub struct NearGrains {
    list: [u32; NEAR],
    count: usize,
}

impl NearGrains {
    pub fn list(&self) -> &[u32] {
        &self.list[..self.count]
    }
}

impl GrainCells {
    /// Cells for `count` grains under a top wall at `height`, about one per grain.
    pub fn fitting(model: &CellModel, height: f64, count: usize) -> Self {
        let walled = std::array::from_fn(|k| model.is_walled(k));
        let extent = Vector { y: if walled[1] { height } else { model.edges().y }, ..model.edges() };
        let aim = (extent.element_product() / count.max(1) as f64).cbrt();
        let counts = Self::counts(extent, walled, model.parameters().diameter, aim, count as f64);
        let edges = extent / Vector::from(counts);
        let counts = counts.map(|n| n as usize);
        let period = |k: usize| if walled[k] { f64::INFINITY } else { edges[k] * counts[k] as f64 };
        let (periods, total) = (std::array::from_fn(period), counts.iter().product());
        Self { counts, edges, walled, periods, room: ROOM, filled: vec![0; total], slots: vec![0; ROOM * total] }
    }

    /// Bytes of the cells for `count` grains.
    pub fn bytes(model: &CellModel, count: f64) -> f64 {
        let walled = std::array::from_fn(|k| model.is_walled(k));
        let aim = (model.edges().element_product() / count.max(1.0)).cbrt();
        let counts = Self::counts(model.edges(), walled, model.parameters().diameter, aim, count);
        counts.iter().product::<f64>() * (size_of::<u32>() * (1 + ROOM)) as f64
    }

    /// Numbers of cells along the edges of the box: with edges no shorter than `least` and near `aim` if that is
    /// larger; longer where a box is so elongated that there would be many more cells than grains.
    fn counts(extent: Vector, walled: [bool; 3], least: f64, aim: f64, grains: f64) -> [f64; 3] {
        let mut counts: [f64; 3] = std::array::from_fn(|k| {
            let fitting = (extent[k] / least).floor().clamp(1.0, f64::from(u32::MAX));
            let wanted = (extent[k] / aim.max(least)).floor();
            // A periodic axis needs three cells, or a grain would meet its neighbours twice.
            wanted.clamp(if walled[k] { 1.0 } else { f64::min(3.0, fitting) }, fitting)
        });
        while counts.iter().product::<f64>() > MOST * grains.max(1.0) {
            let longest = (0..3).fold(0, |longest, k| if counts[k] > counts[longest] { k } else { longest });
            counts[longest] = (0.5 * counts[longest]).ceil();
        }
        counts
    }

    #[inline]
    pub fn coordinates(&self, cell: u32) -> [usize; 3] {
        let (cell, [nx, ny, _]) = (cell as usize, self.counts);
        [cell % nx, cell / nx % ny, cell / (nx * ny)]
    }

    #[inline]
    pub fn index(&self, [x, y, z]: [usize; 3]) -> u32 {
        ((z * self.counts[1] + y) * self.counts[0] + x) as u32
    }

    pub fn at(&self, position: Vector) -> u32 {
        let place = |k: usize| ((position[k] / self.edges[k]).max(0.0) as usize).min(self.counts[k] - 1);
        self.index([place(0), place(1), place(2)])
    }

    pub fn grains(&self, cell: u32) -> &[u32] {
        let first = cell as usize * self.room;
        &self.slots[first..first + self.filled[cell as usize] as usize]
    }

    pub fn enter(&mut self, i: u32, cell: u32) {
        let filled = self.filled[cell as usize] as usize;
        if filled == self.room {
            self.widen();
        }
        self.slots[cell as usize * self.room + filled] = i;
        self.filled[cell as usize] += 1;
    }

    /// Removes a grain from the cell that holds it.
    pub fn leave(&mut self, i: u32, cell: u32) {
        let place = self.grains(cell).iter().position(|&j| j == i).expect("a grain is in its cell");
        let first = cell as usize * self.room;
        self.filled[cell as usize] -= 1;
        self.slots[first + place] = self.slots[first + self.filled[cell as usize] as usize];
    }

    fn widen(&mut self) {
        let wider =
            self.slots.chunks_exact(self.room).flat_map(|c| c.iter().copied().chain(std::iter::repeat_n(0, self.room)));
        self.slots = wider.collect();
        self.room *= 2;
    }

    /// Lists the grains in the cells at offsets `reach` from `home` along each axis: across periodic
    /// faces, but not across walls.
    #[inline]
    pub fn near(&self, home: [usize; 3], reach: [[isize; 2]; 3], near: &mut NearGrains) {
        // With the usual capacity as a constant, the copies become two moves.
        if self.room == ROOM { self.copy(home, reach, near, ROOM) } else { self.copy(home, reach, near, self.room) }
    }

    #[inline(always)]
    fn copy(&self, home: [usize; 3], reach: [[isize; 2]; 3], near: &mut NearGrains, room: usize) {
        let [xs, ys, zs]: [_; 3] = std::array::from_fn(|axis| self.around(axis, home[axis], reach[axis]));
        near.count = 0;
        for z in zs.clone() {
            for y in ys.clone() {
                for x in xs.clone() {
                    let cell = self.index([x, y, z]) as usize;
                    let slots = &self.slots[cell * room..(cell + 1) * room];
                    // Copies all slots and keeps the filled ones: no branch depends on their number.
                    near.list[near.count..near.count + room].copy_from_slice(slots);
                    near.count += self.filled[cell] as usize;
                }
            }
        }
    }

    /// The cells around a cell along an axis.
    #[inline(always)]
    fn around(&self, axis: usize, place: usize, [from, to]: [isize; 2]) -> impl Iterator<Item = usize> + Clone {
        let (n, place, walled) = (self.counts[axis] as isize, place as isize, self.walled[axis]);
        let cells = (place + from..=place + to).filter(move |c| !walled || (0..n).contains(c));
        cells.map(move |c| (c + if c < 0 { n } else { 0 } - if c >= n { n } else { 0 }) as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_box_has_no_more_cells_than_allowed_for_its_grains() {
        let extent = |length| Vector::new(length, 8.0, 1.0);
        let counts = |length| GrainCells::counts(extent(length), [true; 3], 1.0, 0.5, 1.0).map(|n| n as u32);
        assert_eq!(counts(8.0), [8, 8, 1]);
        assert_eq!(counts(9.0), [5, 8, 1]);
        assert_eq!(counts(16.0), [8, 8, 1]);
    }
}
