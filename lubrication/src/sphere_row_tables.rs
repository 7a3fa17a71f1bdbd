//! Tables of the resistance coefficients of each sphere of a pair, for pairs that are not close.

use crate::arithmetic::Arithmetic;
use crate::chebyshev::Powers;
use crate::coefficients::{Coefficients, RECORD};
use crate::factor_table::{NODES, mean_of, of_gaps, piece_of, relative};
use crate::gap_series::GapSeries;
use crate::lubrication_range::LubricationRange;
use crate::pair_force::PairForce;
use crate::sphere_row::{SPHERE_ROW, SphereRow};

/// Coefficients of each sphere of a pair by the correction of a [`PairForce`], interpolated between the same gaps as
/// its factors, for pairs beyond some gap. There they take half the numbers, and no products of them. Near contact,
/// where resistances are large and nearly cancel, only products of factors are positive semi-definite whatever the
/// rounding.
#[derive(Debug)]
pub struct SphereRowTables {
    species: usize,
    range: LubricationRange,
    /// By pair of species, the species of the sphere itself first.
    tables: Vec<SphereRowTable>,
}

#[derive(Debug)]
struct SphereRowTable {
    sum: f64,
    over_small: f64,
    over_large: f64,
    /// Index of its first piece among those of the factors.
    first: usize,
    pieces: Vec<(f64, Powers<SPHERE_ROW, NODES>)>,
}

impl SphereRowTables {
    /// For pairs of species at gaps from `least` on.
    pub fn new(force: &PairForce, least: impl Fn([u32; 2]) -> f64) -> Self {
        let species = force.radii().len();
        let table = |k: usize| {
            let pair = [(k / species) as u32, (k % species) as u32];
            SphereRowTable::new(force, pair, least(pair))
        };
        Self { species, range: force.range(), tables: (0..species * species).map(table).collect() }
    }

    /// Writes the numbers of a [`SphereRow`] for the first of two spheres of these species, at a distance of the
    /// centres within the cutoff, with numbers of any width.
    #[inline(always)]
    pub fn record<X: Arithmetic>(&self, distance: f64, species: [u32; 2], record: &mut [f64; SPHERE_ROW]) {
        let table = self.table(species);
        let gap = distance - table.sum;
        let scaled = gap * table.over_small;
        let piece = piece_of(scaled).saturating_sub(table.first).min(table.pieces.len() - 1);
        let (mean, powers) = &table.pieces[piece];
        powers.write::<X, 3>(relative(scaled, *mean), record);
        record[SPHERE_ROW - 1] = self.range.taper_factor(gap * table.over_large);
    }

    /// The numbers of a [`SphereRow`] for the first of two spheres of these species, without the common factor.
    pub fn series(&self, species: [u32; 2]) -> GapSeries {
        let table = self.table(species);
        let mut series = GapSeries { first_piece: table.first, ..GapSeries::default() };
        table.pieces.iter().for_each(|(mean, powers)| series.push(*mean, powers, SPHERE_ROW - 1));
        series
    }

    #[inline(always)]
    fn table(&self, species: [u32; 2]) -> &SphereRowTable {
        &self.tables[species[0] as usize * self.species + species[1] as usize]
    }
}

impl SphereRowTable {
    fn new(force: &PairForce, pair: [u32; 2], least: f64) -> Self {
        let [own, other] = pair.map(|s| force.radii()[s as usize]);
        let (small, large) = (own.min(other), own.max(other));
        let is_larger = f64::from(u8::from(own > other));
        let side = |gap: f64| {
            let mut record = [0.0; RECORD];
            force.whole_record(own + other + gap * small, pair, &mut record);
            SphereRow::of(&Coefficients::of(&record), is_larger).numbers()
        };
        let of_piece = |piece: usize| (mean_of(piece), of_gaps(mean_of(piece), side));
        let (first, last) = (piece_of(least / small), piece_of(force.range().cutoff() * large / small));
        Self {
            sum: own + other,
            over_small: 1.0 / small,
            over_large: 1.0 / large,
            first,
            pieces: (first..=last.max(first)).map(of_piece).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both spheres of unequal and equal pairs, against the coefficients themselves.
    #[test]
    fn sides_are_those_of_the_coefficients() {
        let force = PairForce::new(&[1.0, 1.7], 0.8, LubricationRange::default()).unwrap();
        let least = 0.3;
        let sides = SphereRowTables::new(&force, |_| least);
        for pair in [[0, 0], [0, 1], [1, 0], [1, 1]] {
            let [own, other] = pair.map(|s: u32| force.radii()[s as usize]);
            let (mut worst, mut gap) = (0.0_f64, least);
            while gap < 2.5 * own.max(other) {
                let distance = own + other + gap;
                let coefficients = force.coefficients(distance, pair).unwrap();
                let expected = SphereRow::of(&coefficients, f64::from(u8::from(own > other))).numbers();
                let mut record = [0.0; SPHERE_ROW];
                sides.record::<f64>(distance, pair, &mut record);
                let found = SphereRow::from_numbers(&record).numbers();
                let scale = 6.0 * std::f64::consts::PI * 0.8 * own.max(other).powi(3);
                let off = found.iter().zip(expected).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
                worst = worst.max(off / scale);
                gap *= 1.003;
            }
            println!("{pair:?} {worst:e}");
            // Where an eigenvalue is cut off at zero the factors have a kink, and the series of their products
            // converge later.
            assert!(worst < 1e-6, "{pair:?}: {worst:e} of the drag");
        }
    }

    /// Sums of the series of a piece at a gap.
    fn at(series: &GapSeries, gap: f64) -> Vec<f64> {
        let size = series.numbers.len() / series.pieces;
        let piece = piece_of(gap).saturating_sub(series.first_piece).min(series.pieces - 1);
        let (mean, powers) = series.numbers[piece * size..][..size].split_first().unwrap();
        let (functions, x) = (powers.len() / NODES, relative(gap, *mean));
        let sum = |k: usize| (0..NODES).rev().fold(0.0, |sum, power| sum * x + powers[power * functions + k]);
        (0..functions).map(sum).collect()
    }

    #[test]
    fn series_are_those_of_the_records() {
        let force = PairForce::new(&[1.0, 1.5], 2.0, LubricationRange::default()).unwrap();
        let sides = SphereRowTables::new(&force, |_| 0.3);
        for (species, sum, small) in [([0, 1], 2.5, 1.0), ([1, 0], 2.5, 1.0), ([1, 1], 3.0, 1.5)] {
            let (stiff, soft) = (force.series(species), sides.series(species));
            for gap in [2e-6, 1e-3, 0.31, 1.0, 2.4] {
                let (mut record, mut row) = ([0.0; RECORD], [0.0; SPHERE_ROW]);
                force.record::<f64>(sum + gap, species, &mut record);
                sides.record::<f64>(sum + gap, species, &mut row);
                // Distances are rounded, and the closest gaps are differences of them.
                let is_near = |found: f64, exact: f64| (found - exact).abs() < 1e-8 * (1.0 + exact.abs());
                let is_same = |series: &GapSeries, exact: &[f64]| {
                    let found = at(series, gap / small);
                    found.len() == exact.len() && found.iter().zip(exact).all(|(&found, &exact)| is_near(found, exact))
                };
                assert!(is_same(&stiff, &record[..40]), "{species:?} {gap}: {record:?}");
                assert!(gap < 0.3 || is_same(&soft, &row[..SPHERE_ROW - 1]), "{species:?} {gap}: {row:?}");
            }
        }
    }
}
