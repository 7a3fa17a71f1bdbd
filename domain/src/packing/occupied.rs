//! Cell lists of the spheres already placed.

use crate::parallel::check_row_numbers;
use crate::{Partition, PeriodicBox, Vector};

/// Cell lists on several levels, one for each range of sizes, with cells about as wide as the spheres of that level,
/// so that all spheres that another can touch are in a few cells, however much sizes differ. They cover the whole
/// box, or a rank's share and its surroundings within reach.
pub struct Occupied<'a> {
    cell: &'a PeriodicBox,
    /// Largest size of all.
    largest: f64,
    levels: Vec<SizeLevel>,
    spheres: Vec<Sphere>,
}

/// A sphere, and the next in the list of its cell.
struct Sphere {
    position: Vector,
    size: f64,
    next: u32,
}

/// Cells for spheres whose sizes differ by a factor of two at most.
struct SizeLevel {
    largest: f64,
    counts: [usize; 3],
    /// First cell along y and along z that is stored here, and how many are.
    local_range: [[usize; 2]; 2],
    first: Vec<u32>,
}

/// End of a list of spheres.
const NONE: u32 = u32::MAX;

/// Largest number of levels; sizes below the last are not distinguished.
const MOST_LEVELS: f64 = 40.0;

impl<'a> Occupied<'a> {
    /// Empty cell lists with room for `kinds` spheres (size and number), in a rank's share or in the whole box.
    pub fn new(cell: &'a PeriodicBox, kinds: &[(f64, usize)], share: Option<&Partition>) -> Self {
        let kinds: Vec<(f64, usize)> = kinds.iter().copied().filter(|kind| kind.1 > 0).collect();
        let largest = kinds.iter().map(|kind| kind.0).fold(f64::MIN_POSITIVE, f64::max);
        let mut occupied = Self { cell, largest, levels: Vec::new(), spheres: Vec::new() };
        let count = kinds.iter().map(|kind| occupied.level_of(kind.0) + 1).max().unwrap_or(0);
        let mut members = vec![(0.0, 0); count];
        for (size, number) in kinds {
            let (largest, members) = &mut members[occupied.level_of(size)];
            (*largest, *members) = (f64::max(*largest, size), *members + number);
        }
        let level = |(own, number)| SizeLevel::new(cell, own, number, largest + own, share);
        occupied.levels = members.into_iter().map(level).collect();
        occupied
    }

    fn level_of(&self, size: f64) -> usize {
        (self.largest / size).log2().clamp(0.0, MOST_LEVELS) as usize
    }

    /// Adds a sphere, unless it is out of reach of the share; spheres are numbered from 0.
    pub fn insert(&mut self, size: f64, position: Vector) {
        check_row_numbers(self.spheres.len() + 1);
        let number = self.spheres.len() as u32;
        if let Some(first) = self.first_at(size, position) {
            let next = std::mem::replace(first, number);
            self.spheres.push(Sphere { position, size, next });
        }
    }

    /// Moves a sphere.
    pub fn shift(&mut self, number: usize, position: Vector) {
        let Sphere { position: former, size, next } = self.spheres[number];
        let first = self.first_at(size, former).expect("it was inserted");
        if *first == number as u32 {
            *first = next;
        } else {
            let mut before = *first as usize;
            while self.spheres[before].next != number as u32 {
                before = self.spheres[before].next as usize;
            }
            self.spheres[before].next = next;
        }
        let first = self.first_at(size, position).expect("a box without shares has all cells");
        let next = std::mem::replace(first, number as u32);
        self.spheres[number] = Sphere { position, size, next };
    }

    /// Start of the list of a cell, if it is stored here.
    fn first_at(&mut self, size: f64, position: Vector) -> Option<&mut u32> {
        let place = self.level_of(size);
        let level = &mut self.levels[place];
        let [x, y, z] = level.coordinates(self.cell, position);
        let rows = [level.row(0, y)?, level.row(1, z)?];
        let place = level.index(x, rows);
        Some(&mut level.first[place])
    }

    /// Whether a sphere at this position, which is in the share, would overlap no sphere other than number `except`.
    pub fn is_free(&self, size: f64, position: Vector, except: Option<usize>) -> bool {
        let except = except.map_or(NONE, |number| number as u32);
        self.levels.iter().filter(|level| level.largest > 0.0).all(|level| {
            let around = level.around(self.cell, position, size + level.largest);
            let cells = |d: usize| (0..around[d][1]).map(move |k| (around[d][0] + k) % level.counts[d]);
            let row = |axis: usize, place: usize| level.row(axis, place).expect("the share has what is in reach");
            let is_clear = |x, rows| self.is_clear(level.first[level.index(x, rows)], size, position, except);
            cells(2)
                .map(|z| row(1, z))
                .all(|z| cells(1).map(|y| row(0, y)).all(|y| cells(0).all(|x| is_clear(x, [y, z]))))
        })
    }

    /// Whether a sphere touches none of a list, apart from sphere number `except`.
    fn is_clear(&self, mut other: u32, size: f64, position: Vector, except: u32) -> bool {
        while other != NONE {
            let there = &self.spheres[other as usize];
            let contact = size + there.size;
            let separation = self.cell.nearest_image(there.position - position);
            if other != except && separation.length_squared() < contact * contact {
                return false;
            }
            other = there.next;
        }
        true
    }
}

impl SizeLevel {
    /// Level for `number` spheres up to size `largest`; with a share, it covers the surroundings within `reach`.
    /// Without spheres there are no cells.
    fn new(cell: &PeriodicBox, largest: f64, number: usize, reach: f64, share: Option<&Partition>) -> Self {
        let most = 2.0 * (number as f64).cbrt().ceil().max(1.0);
        let counts = (cell.edges() / (cell.coordinate_stretch() * 2.0 * largest))
            .floor()
            .clamp(Vector::ONE, Vector::splat(most));
        let counts = counts.to_array().map(|c| c as usize);
        let mut level = Self { largest, counts, local_range: [[0, counts[1]], [0, counts[2]]], first: Vec::new() };
        if let Some(partition) = share {
            let cells = level.cells_within(cell, reach);
            level.local_range = std::array::from_fn(|axis| {
                let (lines, count) = (partition.lines()[axis] as f64, counts[axis + 1]);
                let owned = &partition.owned()[axis];
                let [start, end] = [owned.start, owned.end].map(|line| (line as f64 / lines * count as f64) as usize);
                // One more cell to allow for rounding.
                let beyond = cells[axis + 1] + 1;
                let number = end - start + 1 + 2 * beyond;
                if number < count { [(start + count - beyond) % count, number] } else { [0, count] }
            });
        }
        level.first =
            vec![NONE; if number > 0 { counts[0] * level.local_range[0][1] * level.local_range[1][1] } else { 0 }];
        level
    }

    fn coordinates(&self, cell: &PeriodicBox, position: Vector) -> [usize; 3] {
        let fractions = (cell.lattice_coordinates(position) / cell.edges()).to_array();
        std::array::from_fn(|d| ((fractions[d] * self.counts[d] as f64).max(0.0) as usize).min(self.counts[d] - 1))
    }

    /// Index of a row along y or z, relative to the first that is stored here, if it is stored.
    fn row(&self, axis: usize, place: usize) -> Option<usize> {
        let ([first, number], count) = (self.local_range[axis], self.counts[axis + 1]);
        let row = if place >= first { place - first } else { place + count - first };
        (row < number).then_some(row)
    }

    fn index(&self, x: usize, [y, z]: [usize; 2]) -> usize {
        (z * self.local_range[0][1] + y) * self.counts[0] + x
    }

    /// Number of cells along each axis that span a distance.
    fn cells_within(&self, cell: &PeriodicBox, distance: f64) -> [usize; 3] {
        let reach = (cell.coordinate_stretch() * distance / cell.edges()).to_array();
        std::array::from_fn(|d| ((reach[d] * self.counts[d] as f64).ceil() as usize).min(self.counts[d]))
    }

    /// First cell and number of cells along each axis that may hold spheres within a distance of a position.
    fn around(&self, cell: &PeriodicBox, position: Vector, distance: f64) -> [[usize; 2]; 3] {
        let (home, cells) = (self.coordinates(cell, position), self.cells_within(cell, distance));
        std::array::from_fn(|d| {
            let count = self.counts[d];
            [home[d] + count - cells[d], (2 * cells[d] + 1).min(count)]
        })
    }
}
