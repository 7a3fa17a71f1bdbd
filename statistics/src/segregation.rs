//! Segregation of species.

use domain::{Bytes, PeriodicBox, Vector};

/// Number of particles of each species in columns along an axis, into which sedimenting suspensions segregate.
#[derive(Debug, Clone, PartialEq)]
pub struct SpeciesColumns {
    across: [usize; 2],
    widths: [f64; 2],
    table: [usize; 2],
    species: usize,
    counts: Vec<f64>,
}

/// Largest number of columns along an axis; in larger boxes columns are wider.
const MOST: f64 = 1024.0;

impl SpeciesColumns {
    /// Columns about `width` wide along an axis of a box.
    pub fn new(cell: &PeriodicBox, axis: usize, width: f64, species: usize) -> Self {
        let across = Self::across(axis);
        let table = Self::table(cell, axis, width);
        let widths = [0, 1].map(|d| cell.edges()[across[d]] / table[d] as f64);
        Self { across, widths, table, species, counts: vec![0.0; table[0] * table[1] * species] }
    }

    fn across(axis: usize) -> [usize; 2] {
        [(axis + 1) % 3, (axis + 2) % 3]
    }

    /// Number of columns along each of the other axes.
    fn table(cell: &PeriodicBox, axis: usize, width: f64) -> [usize; 2] {
        Self::across(axis).map(|d| (cell.edges()[d] / width).round().clamp(1.0, MOST) as usize)
    }

    /// Memory of such columns.
    pub fn bytes(cell: &PeriodicBox, axis: usize, width: f64, species: usize) -> Bytes {
        let [nx, ny] = Self::table(cell, axis, width).map(|n| n as f64);
        Bytes::list::<f64>(nx * ny * species as f64)
    }

    /// Counts a particle.
    pub fn add(&mut self, position: Vector, species: u32) {
        let place = |d: usize| (position[self.across[d]] / self.widths[d]).floor() as i64;
        let [i, j] = [0, 1].map(|d| place(d).rem_euclid(self.table[d] as i64) as usize);
        self.counts[(j * self.table[0] + i) * self.species + species as usize] += 1.0;
    }

    /// Number of particles of each species in each column, for sums over ranks.
    pub fn counts(&mut self) -> &mut [f64] {
        &mut self.counts
    }

    /// Intensity of segregation (Danckwerts, Appl. Sci. Res. A 3, 279, 1952). With `n_c` the number of particles in
    /// column `c`, `p_cs` the fraction of species `s` among them, `p_s` that among all `N`, and `C` the number of
    /// columns with particles,
    ///
    /// ```text
    /// I = (sum_s sum_c n_c (p_cs - p_s)^2 / N - R) / (sum_s p_s (1 - p_s) - R)
    /// R = sum_s p_s (1 - p_s) (C - 1) / (N - 1)
    /// ```
    ///
    /// It is 0 on average for particles mixed at random, 1 if each column has one species only, and 0 for a single
    /// species.
    pub fn intensity(&self) -> f64 {
        let columns = || self.counts.chunks_exact(self.species);
        let total: f64 = self.counts.iter().sum();
        let shares: Vec<f64> = (0..self.species).map(|s| columns().map(|c| c[s]).sum::<f64>() / total).collect();
        let apart: f64 = shares.iter().map(|p| p * (1.0 - p)).sum();
        let mut moments = 0.0;
        let mut occupied = 0.0;
        for column in columns() {
            let count: f64 = column.iter().sum();
            if count > 0.0 {
                occupied += 1.0;
                moments +=
                    column.iter().zip(&shares).map(|(n, p)| (n / count - p).powi(2)).sum::<f64>() * count / total;
            }
        }
        let random = apart * (occupied - 1.0) / (total - 1.0);
        if apart > random { (moments - random) / (apart - random) } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::Random;

    fn intensity(kind: impl Fn(Vector, &mut Random) -> u32, seed: u64) -> f64 {
        let cell = PeriodicBox::new(Vector::new(20.0, 30.0, 10.0)).unwrap();
        let mut columns = SpeciesColumns::new(&cell, 2, 4.9, 2);
        assert_eq!(columns.table, [4, 6]);
        assert_eq!(SpeciesColumns::bytes(&cell, 2, 4.9, 2), Bytes::list::<f64>(columns.counts.len() as f64));
        for id in 0..400 {
            let mut random = Random::new(seed, id);
            let position = random.point() * cell.edges();
            columns.add(position, kind(position, &mut random));
        }
        columns.intensity()
    }

    #[test]
    fn mixed_particles_have_zero_and_separate_ones_have_one() {
        let mixed = |_: Vector, random: &mut Random| u32::from(random.uniform() < 0.3);
        let found: Vec<f64> = (0..200).map(|seed| intensity(mixed, seed)).collect();
        let mean = found.iter().sum::<f64>() / 200.0;
        let error = (found.iter().map(|i| (i - mean).powi(2)).sum::<f64>() / 200.0 / 199.0).sqrt();
        assert!(mean.abs() < 4.0 * error && error < 0.002, "{mean} +- {error}");
        assert!((intensity(|p, _| u32::from(p.y < 15.0), 1) - 1.0).abs() < 1e-12);
        assert!(intensity(|_, _| 0, 1).abs() < 1e-12);
    }

    #[test]
    fn counts_may_be_added_in_parts() {
        let cell = PeriodicBox::new(Vector::splat(9.0)).unwrap();
        let [mut all, mut even, mut odd] = std::array::from_fn(|_| SpeciesColumns::new(&cell, 1, 3.0, 2));
        for id in 0..50_u32 {
            let position = Random::new(1, u64::from(id)).point() * 9.0;
            all.add(position, id % 2);
            if id % 3 == 0 { &mut even } else { &mut odd }.add(position, id % 2);
        }
        even.counts().iter_mut().zip(odd.counts()).for_each(|(sum, part)| *sum += *part);
        assert_eq!(even, all);
    }
}
