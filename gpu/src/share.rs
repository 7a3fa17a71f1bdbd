//! Grid that several devices share, seen from one of them.

use bytemuck::{Pod, Zeroable};
use std::ops::{AddAssign, Range};

/// Numbers of the interpolation of a particle.
pub(crate) const SUMS: usize = 12;

/// Sums over the points of a particle's stencil: velocity, and its derivatives along the lattice.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(transparent)]
pub struct StencilSums(pub(crate) [f64; SUMS]);

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
    pub(crate) fn places(&self, parts: &[Range<usize>], of_line: usize) -> Vec<Range<usize>> {
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

    /// A device sends to another as much as that one expects, and both keep their own.
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
