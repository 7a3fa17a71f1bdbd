//! Random sequential addition of spheres.

use crate::{PeriodicBox, Random, Vector};

/// Tries for one sphere before it is put where it overlaps others.
const TRIES: usize = 20_000;

/// Cell lists on several levels, one for each range of sizes, with cells about as wide as the spheres of that level, so
/// that all spheres that another can touch are in a few cells, however much sizes differ.
pub(super) struct Occupied<'a> {
    cell: &'a PeriodicBox,
    sizes: &'a [f64],
    levels: Vec<Level>,
    /// The level of each sphere.
    level_of: Vec<u8>,
    next: Vec<u32>,
}

/// Cells for spheres of sizes that differ by a factor of two at most.
struct Level {
    largest: f64,
    counts: [usize; 3],
    first: Vec<u32>,
}

/// Marks the end of a list of spheres.
const NONE: u32 = u32::MAX;

/// Levels beyond which no difference is made between sizes.
const MOST_LEVELS: f64 = 40.0;

impl<'a> Occupied<'a> {
    pub(super) fn new(cell: &'a PeriodicBox, sizes: &'a [f64]) -> Self {
        let largest = sizes.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let level = |size: &f64| (largest / size).log2().clamp(0.0, MOST_LEVELS) as u8;
        let level_of: Vec<u8> = sizes.iter().map(level).collect();
        let count = level_of.iter().max().map_or(0, |&last| usize::from(last) + 1);
        let mut members = vec![(0.0, 0); count];
        for (&level, &size) in level_of.iter().zip(sizes) {
            let (largest, number) = &mut members[usize::from(level)];
            (*largest, *number) = (f64::max(*largest, size), *number + 1);
        }
        let levels = members.into_iter().map(|(largest, number)| Level::new(cell, largest, number)).collect();
        Self { cell, sizes, levels, level_of, next: vec![NONE; sizes.len()] }
    }

    fn place(&self, sphere: usize, position: Vector) -> (usize, usize) {
        let level = usize::from(self.level_of[sphere]);
        (level, self.levels[level].index(self.levels[level].coordinates(self.cell, position)))
    }

    pub(super) fn insert(&mut self, sphere: usize, position: Vector) {
        let (level, place) = self.place(sphere, position);
        self.next[sphere] = std::mem::replace(&mut self.levels[level].first[place], sphere as u32);
    }

    pub(super) fn remove(&mut self, sphere: usize, position: Vector) {
        let (level, place) = self.place(sphere, position);
        let first = &mut self.levels[level].first[place];
        if *first == sphere as u32 {
            *first = self.next[sphere];
            return;
        }
        let mut before = *first as usize;
        while self.next[before] != sphere as u32 {
            before = self.next[before] as usize;
        }
        self.next[before] = self.next[sphere];
    }

    /// Whether a sphere at this position would overlap no other.
    pub(super) fn is_free(&self, sphere: usize, position: Vector, positions: &[Vector]) -> bool {
        self.levels.iter().filter(|level| level.largest > 0.0).all(|level| {
            let around = level.around(self.cell, position, self.sizes[sphere] + level.largest);
            let cells = |d: usize| (0..around[d][1]).map(move |k| (around[d][0] + k) % level.counts[d]);
            let is_clear = |place| self.is_clear(level.first[level.index(place)], sphere, (position, positions));
            cells(2).all(|z| cells(1).all(|y| cells(0).all(|x| is_clear([x, y, z]))))
        })
    }

    /// Whether a sphere touches none of a list.
    fn is_clear(&self, mut other: u32, sphere: usize, (position, positions): (Vector, &[Vector])) -> bool {
        while other != NONE {
            let j = other as usize;
            let contact = self.sizes[sphere] + self.sizes[j];
            let separation = self.cell.nearest_image(positions[j] - position);
            if j != sphere && separation.length_squared() < contact * contact {
                return false;
            }
            other = self.next[j];
        }
        true
    }
}

impl Level {
    /// For `count` spheres up to a size; `None` if there are none.
    fn new(cell: &PeriodicBox, largest: f64, number: usize) -> Self {
        let most = 2.0 * (number as f64).cbrt().ceil().max(1.0);
        let counts = (cell.edges() / (cell.slant() * 2.0 * largest)).floor().clamp(Vector::ONE, Vector::splat(most));
        let counts = counts.to_array().map(|c| c as usize);
        let first = vec![NONE; if number > 0 { counts.iter().product() } else { 0 }];
        Self { largest, counts, first }
    }

    fn coordinates(&self, cell: &PeriodicBox, position: Vector) -> [usize; 3] {
        let fractions = (cell.lattice_coordinates(position) / cell.edges()).to_array();
        std::array::from_fn(|d| ((fractions[d] * self.counts[d] as f64).max(0.0) as usize).min(self.counts[d] - 1))
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.counts[1] + y) * self.counts[0] + x
    }

    /// The cells along each axis that may hold what is within a distance of a position: from which on, and how many.
    fn around(&self, cell: &PeriodicBox, position: Vector, distance: f64) -> [[usize; 2]; 3] {
        let home = self.coordinates(cell, position);
        let reach = (cell.slant() * distance / cell.edges()).to_array();
        std::array::from_fn(|d| {
            let count = self.counts[d];
            let cells = ((reach[d] * count as f64).ceil() as usize).min(count);
            [home[d] + count - cells, (2 * cells + 1).min(count)]
        })
    }
}

/// Puts every sphere, the largest first, at the first of its random positions that is free. Returns whether all were.
pub(super) fn place(cell: &PeriodicBox, sizes: &[f64], seed: u64) -> (Vec<Vector>, bool) {
    let mut order: Vec<usize> = (0..sizes.len()).collect();
    order.sort_by(|&i, &j| sizes[j].total_cmp(&sizes[i]));
    let mut occupied = Occupied::new(cell, sizes);
    let mut positions = vec![Vector::ZERO; sizes.len()];
    let mut all_free = true;
    for sphere in order {
        let mut random = Random::new(seed, sphere as u64);
        let mut draw = || cell.wrap(cell.off_walls(random.point() * cell.edges(), sizes[sphere])).0;
        let free = (0..TRIES).map(|_| draw()).find(|&p| occupied.is_free(sphere, p, &positions));
        all_free &= free.is_some();
        positions[sphere] = free.unwrap_or_else(draw);
        occupied.insert(sphere, positions[sphere]);
    }
    (positions, all_free)
}
