//! Spheres put down one after another.

use crate::{PeriodicBox, Random, Vector};

/// Tries for one sphere before it is put where it overlaps.
const TRIES: usize = 20_000;

/// Spheres sorted into cells wide enough that only neighbouring cells can touch.
pub(super) struct Occupied<'a> {
    cell: &'a PeriodicBox,
    sizes: &'a [f64],
    counts: [usize; 3],
    first: Vec<u32>,
    next: Vec<u32>,
}

/// Marks the end of a list of spheres.
const NONE: u32 = u32::MAX;

impl<'a> Occupied<'a> {
    pub(super) fn new(cell: &'a PeriodicBox, sizes: &'a [f64]) -> Self {
        let widest = 2.0 * sizes.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let slant = Vector::new((1.0 + cell.strain().powi(2)).sqrt(), 1.0, 1.0);
        let most = 2.0 * (sizes.len() as f64).cbrt().ceil().max(1.0);
        let counts = (cell.edges() / (slant * widest)).floor().clamp(Vector::ONE, Vector::splat(most));
        let counts = counts.to_array().map(|c| c as usize);
        let first = vec![NONE; counts.iter().product()];
        Self { cell, sizes, counts, first, next: vec![NONE; sizes.len()] }
    }

    fn coordinates(&self, position: Vector) -> [usize; 3] {
        let fractions = (self.cell.lattice_coordinates(position) / self.cell.edges()).to_array();
        std::array::from_fn(|d| ((fractions[d] * self.counts[d] as f64).max(0.0) as usize).min(self.counts[d] - 1))
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.counts[1] + y) * self.counts[0] + x
    }

    pub(super) fn insert(&mut self, sphere: usize, position: Vector) {
        let place = self.index(self.coordinates(position));
        self.next[sphere] = self.first[place];
        self.first[place] = sphere as u32;
    }

    pub(super) fn remove(&mut self, sphere: usize, position: Vector) {
        let place = self.index(self.coordinates(position));
        if self.first[place] == sphere as u32 {
            self.first[place] = self.next[sphere];
            return;
        }
        let mut before = self.first[place] as usize;
        while self.next[before] != sphere as u32 {
            before = self.next[before] as usize;
        }
        self.next[before] = self.next[sphere];
    }

    /// Whether a sphere at this place would overlap no other.
    pub(super) fn is_free(&self, sphere: usize, position: Vector, positions: &[Vector]) -> bool {
        let home = self.coordinates(position);
        let around = |d: usize| {
            let count = self.counts[d];
            (0..count.min(3)).map(move |step| (home[d] + count + step - usize::from(count > 1)) % count)
        };
        around(2).all(|z| {
            around(1).all(|y| around(0).all(|x| self.is_clear(self.index([x, y, z]), sphere, (position, positions))))
        })
    }

    fn is_clear(&self, place: usize, sphere: usize, (position, positions): (Vector, &[Vector])) -> bool {
        let mut other = self.first[place];
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

/// Puts every sphere, the largest first, at the first of its own random places that is free. Says whether all were.
pub(super) fn place(cell: &PeriodicBox, sizes: &[f64], seed: u64) -> (Vec<Vector>, bool) {
    let mut order: Vec<usize> = (0..sizes.len()).collect();
    order.sort_by(|&i, &j| sizes[j].total_cmp(&sizes[i]));
    let mut occupied = Occupied::new(cell, sizes);
    let mut positions = vec![Vector::ZERO; sizes.len()];
    let mut all_free = true;
    for sphere in order {
        let mut random = Random::new(seed, sphere as u64);
        let mut draw = || cell.wrap(random.point() * cell.edges()).0;
        let free = (0..TRIES).map(|_| draw()).find(|&p| occupied.is_free(sphere, p, &positions));
        all_free &= free.is_some();
        positions[sphere] = free.unwrap_or_else(draw);
        occupied.insert(sphere, positions[sphere]);
    }
    (positions, all_free)
}
