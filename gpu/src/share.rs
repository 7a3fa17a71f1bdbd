//! Grid that several devices share, seen from one of them.

use crate::device::{DeviceError, TransformPart};
use crate::evaluation::MODE_THREADS;
use crate::far_field::SplitFarField;
use bytemuck::{Pod, Zeroable};
use std::ops::{AddAssign, Range};

/// Numbers of the interpolation of a particle.
const SUMS: usize = 12;

/// Sums over the points of a particle's stencil: velocity, and its derivatives along the lattice.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(transparent)]
pub struct StencilSums([f64; SUMS]);

impl AddAssign for StencilSums {
    fn add_assign(&mut self, other: Self) {
        self.0.iter_mut().zip(other.0).for_each(|(sum, value)| *sum += value);
    }
}

/// Parts of a grid that several devices have: planes across z of values on the grid, and columns along z of its modes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GridShare {
    /// Planes of each device.
    pub planes: Vec<Range<usize>>,
    /// Modes along y of the columns of each device.
    pub modes: Vec<Range<usize>>,
    /// This device.
    pub own: usize,
}

impl GridShare {
    /// A grid that one device has.
    pub fn whole([_, y, z]: [usize; 3]) -> Self {
        Self { planes: std::iter::once(0..z).collect(), modes: std::iter::once(0..y).collect(), own: 0 }
    }

    /// Whether one device has the whole grid.
    pub fn is_whole(&self) -> bool {
        self.planes.len() == 1
    }

    /// Planes of this device.
    pub fn own_planes(&self) -> Range<usize> {
        self.planes[self.own].clone()
    }

    /// Modes along y of this device.
    pub fn own_modes(&self) -> Range<usize> {
        self.modes[self.own].clone()
    }

    /// Devices in the order in which their parts are exchanged: this one, and those that follow in turn.
    fn in_turn(&self) -> impl Iterator<Item = usize> {
        let count = self.planes.len();
        (self.own..count).chain(0..self.own)
    }

    /// Places in the list that is exchanged, by device, of parts with some values for each line; this device keeps its
    /// own, which would be the first.
    fn places(&self, parts: &[Range<usize>], of_line: usize) -> Vec<Range<usize>> {
        let mut places = vec![0..0; parts.len()];
        let mut end = 0;
        for device in self.in_turn().skip(1) {
            let start = end;
            end += of_line * parts[device].len();
            places[device] = start..end;
        }
        places
    }
}

/// First line and number of lines of the part to which each line belongs.
pub(crate) fn parts_of_lines(parts: &[Range<usize>]) -> Vec<i32> {
    parts.iter().flat_map(|part| part.clone().flat_map(|_| [part.start as i32, part.len() as i32])).collect()
}

/// Other devices that share a grid with one. The calls are collective: all devices make them in the same order.
pub trait Peers {
    /// Sends to each device the words of a range, and receives those of another range from it.
    fn exchange(&self, sent: (&[u64], &[Range<usize>]), received: (&mut [u64], &[Range<usize>]));

    /// Adds to sums of the particles that are present, in the order of the host, those that other devices have of the
    /// same particles, and drops those of particles that other devices own.
    fn collect(&self, sums: &mut Vec<StencilSums>);
}

impl SplitFarField {
    /// Modes of whole columns along z, by planes from the values on the grid.
    pub(crate) fn columns_from_grid(&mut self) -> Result<(), DeviceError> {
        self.transform(true, TransformPart::Planes)?;
        self.exchange_modes(["planes", "columns"])
    }

    /// Values on the grid from modes that have been transformed along z.
    pub(crate) fn grid_from_columns(&mut self) -> Result<(), DeviceError> {
        self.exchange_modes(["columns", "planes"])?;
        self.transform(false, TransformPart::Planes)
    }

    /// Exchanges modes with other devices, from one layout to another: those that leave and arrive are in the memory of
    /// the field.
    fn exchange_modes(&mut self, [from, to]: [&str; 2]) -> Result<(), DeviceError> {
        let Some(peers) = self.peers.clone() else { return Ok(()) };
        let share = self.tables.share.clone();
        let (own_planes, own_modes) = (share.own_planes().len(), share.own_modes().len());
        // Three complex values for each mode along x.
        let row_words = 6 * (self.tables.grid[0] / 2 + 1) * self.tables.numbers.size() / size_of::<u64>();
        let of_planes = share.places(&share.modes, row_words * own_planes);
        let of_columns = share.places(&share.planes, row_words * own_modes);
        let is_forward = from == "planes";
        let (leaving, arriving) = if is_forward { (of_planes, of_columns) } else { (of_columns, of_planes) };
        let kept = self.task.field + (size_of::<u64>() * row_words * own_planes * own_modes) as u64;
        let total = |places: &[Range<usize>]| places.iter().map(Range::len).sum();
        let [mut sent, mut received] = [vec![0_u64; total(&leaving)], vec![0_u64; total(&arriving)]];
        self.move_modes("pack", from)?;
        if !sent.is_empty() {
            self.device.download(kept, bytemuck::cast_slice_mut(&mut sent))?;
        }
        peers.exchange((&sent, &leaving), (&mut received, &arriving));
        self.device.upload(kept, bytemuck::cast_slice(&received))?;
        self.move_modes("unpack", to)
    }

    /// Runs a kernel over the modes in a layout.
    fn move_modes(&mut self, kernel: &str, layout: &str) -> Result<(), DeviceError> {
        let modes = if layout == "planes" { self.tables.modes_of_planes() } else { self.tables.modes() };
        let name = format!("{kernel}_{layout}_{}", self.tables.numbers.suffix());
        self.launch(&name, modes.div_ceil(MODE_THREADS), MODE_THREADS)
    }

    /// Adds to the sums of the interpolation those that other devices have found in their planes.
    pub(crate) fn collect_sums(&mut self) -> Result<(), DeviceError> {
        let Some(peers) = self.peers.clone() else { return Ok(()) };
        let (count, numbers) = (self.task.particles as usize, self.tables.numbers);
        let mut by_place = self.download(self.task.interpolated, SUMS * count, numbers)?;
        let mut by_row = vec![StencilSums::zeroed(); count];
        for (&row, sums) in self.host_rows.iter().zip(by_place.as_chunks().0) {
            by_row[row as usize] = StencilSums(*sums);
        }
        peers.collect(&mut by_row);
        for (&row, sums) in self.host_rows.iter().zip(by_place.as_chunks_mut().0) {
            if let Some(all) = by_row.get(row as usize) {
                *sums = all.0;
            }
        }
        self.device.upload(self.task.interpolated, &numbers.bytes_of(by_place.into_iter()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn share(own: usize) -> GridShare {
        GridShare { planes: vec![0..3, 3..5, 5..8], modes: vec![0..2, 2..2, 2..6], own }
    }

    #[test]
    fn lines_know_their_part() {
        assert_eq!(parts_of_lines(&share(0).modes), [0, 2, 0, 2, 2, 4, 2, 4, 2, 4, 2, 4]);
    }

    /// What a device sends to another is as long as what that one expects, and both keep their own.
    #[test]
    fn parts_fit_together() {
        let devices = [0, 1, 2].map(share);
        for (own, a) in devices.iter().enumerate() {
            let leaving = a.places(&a.modes, a.own_planes().len());
            assert!(leaving[own].is_empty());
            for (other, b) in devices.iter().enumerate() {
                let arriving = b.places(&b.planes, b.own_modes().len());
                assert_eq!(leaving[other].len(), arriving[own].len());
                let expected = if own == other { 0 } else { a.own_planes().len() * b.own_modes().len() };
                assert_eq!(leaving[other].len(), expected);
            }
        }
        assert_eq!(share(1).places(&share(1).planes, 10), [30..60, 0..0, 0..30]);
    }
}
