//! Lubrication between near spheres of several species.

use std::sync::Arc;

use domain::{Number, Vector};
use thiserror::Error;

use crate::arithmetic::Arithmetic;
use crate::coefficients::{Coefficients, RECORD};
use crate::factor_table::{FactorTable, piece_of};
use crate::gap_series::GapSeries;
use crate::lubrication_range::LubricationRange;
use crate::pair_factor::PairFactor;
use crate::pair_motion::{PairLoads, PairMotion};
use crate::two_sphere::TwoSphereError;

/// Pair correction `R_lub = R_exact - R_FCM` of the force-coupling method, Dance & Maxey (2003), Yeo & Maxey (2010):
/// exact two-sphere resistance minus that of the method itself for two spheres in free space.
///
/// The resistance to the spheres' motions is kept positive semi-definite: the tables store, interpolate and taper a
/// factor `B` of it, `B B^T`, so any numbers in them are valid. That changes the drag on a pair that moves as one by
/// half a percent at most for radii up to 10:1, and nothing else: rates of strain of rigid spheres are known, not
/// solved for, so their coupling to motions is stored directly.
#[derive(Debug, Clone)]
pub struct PairForce {
    radii: Vec<f64>,
    viscosity: f64,
    range: LubricationRange,
    /// Upper triangle of the species, row by row: `i <= j`.
    tables: Vec<SpeciesTable>,
}

/// Table of two species, with their sizes.
#[derive(Debug, Clone)]
struct SpeciesTable {
    factors: Arc<FactorTable>,
    sum: f64,
    small: f64,
    over_small: f64,
    over_large: f64,
    /// Gap below which the resistance is constant.
    minimum_gap: f64,
}

/// Gap of a pair over its smaller radius, that radius, and the viscosity times it, tapered.
pub(crate) struct PairGap {
    pub over_small: f64,
    pub small: f64,
    pub factor: f64,
}

/// Error for species between which lubrication cannot be computed.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum PairForceError {
    /// A radius or the viscosity is not a positive number.
    #[error("{name} is {}; lubrication needs a positive, finite number", Number(*value))]
    Positive {
        /// Name of the quantity.
        name: &'static str,
        /// Value of the quantity.
        value: f64,
    },
    /// Two radii differ too much.
    #[error("no lubrication between radii {} and {}: {}", Number(*.0), Number(*.1), .2)]
    Radii(f64, f64, TwoSphereError),
}

impl PairForce {
    /// Tables for every pair of species; `radii` has one entry per species. Computes tables at first use, with rayon;
    /// must not be called from a rayon task.
    pub fn new(radii: &[f64], viscosity: f64, range: LubricationRange) -> Result<Self, PairForceError> {
        let named = radii.iter().map(|&radius| ("particle radius", radius)).chain([("viscosity", viscosity)]);
        if let Some((name, value)) = named.into_iter().find(|(_, value)| !(value.is_finite() && *value > 0.0)) {
            return Err(PairForceError::Positive { name, value });
        }
        let mut tables = Vec::new();
        for (i, &a) in radii.iter().enumerate() {
            for &b in &radii[i..] {
                let factors =
                    FactorTable::with_ratio(a.max(b) / a.min(b)).map_err(|error| PairForceError::Radii(a, b, error))?;
                let (small, sum, minimum_gap) = (a.min(b), a + b, range.minimum_gap() * 0.5 * (a + b));
                tables.push(SpeciesTable {
                    factors,
                    sum,
                    small,
                    over_small: 1.0 / small,
                    over_large: 1.0 / a.max(b),
                    minimum_gap,
                });
            }
        }
        Ok(Self { radii: radii.to_vec(), viscosity, range, tables })
    }

    /// Radii of the species.
    pub fn radii(&self) -> &[f64] {
        &self.radii
    }

    /// Range of gaps of the correction.
    pub fn range(&self) -> LubricationRange {
        self.range
    }

    /// Largest distance of centres at which any pair is lubricated.
    pub fn reach(&self) -> f64 {
        self.radii.iter().copied().fold(0.0, f64::max) * (2.0 + self.range.cutoff())
    }

    /// Factors of the resistance of two species, 40 functions in the order of [`Coefficients`], at all gaps at which
    /// they are lubricated.
    pub fn series(&self, species: [u32; 2]) -> GapSeries {
        let table = self.table(species);
        let gaps = [table.minimum_gap, self.range.cutoff() / table.over_large];
        table.factors.series(gaps.map(|gap| piece_of(gap * table.over_small)))
    }

    /// Gap below which the resistance of two species is constant.
    pub fn minimum_gap(&self, species: [u32; 2]) -> f64 {
        self.table(species).minimum_gap
    }

    /// Gap of a pair of species at a distance of their centres; `None` beyond the cutoff.
    #[inline(always)]
    pub fn gap(&self, distance: f64, species: [u32; 2]) -> Option<f64> {
        let table = self.table(species);
        let gap = distance - table.sum;
        (gap * table.over_large < self.range.cutoff() && distance > 0.0).then_some(gap)
    }

    /// Gap of a pair of species in tables, and the factor of its loads; `None` beyond the cutoff.
    #[inline(always)]
    pub(crate) fn pair_gap(&self, distance: f64, species: [u32; 2]) -> Option<PairGap> {
        let (table, gap) = (self.table(species), self.gap(distance, species)?);
        let over_small = self.range.effective_gap(gap, table.minimum_gap) * table.over_small;
        let factor = self.viscosity * table.small * self.range.taper_factor(gap * table.over_large);
        Some(PairGap { over_small, small: table.small, factor })
    }

    /// Factor of a pair, with `separation` from the first centre to the second; `None` beyond the cutoff.
    pub fn factor(&self, separation: Vector, species: [u32; 2]) -> Option<PairFactor> {
        self.factor_by::<f64>(separation, species)
    }

    /// The same with numbers of any width.
    #[inline(always)]
    pub fn factor_by<X: Arithmetic>(&self, separation: Vector, species: [u32; 2]) -> Option<PairFactor> {
        let [first, second] = species.map(|s| self.radii[s as usize]);
        let table = self.table(species);
        let distance = separation.length();
        let gap = self.gap(distance, species)?;
        let (order, axis) =
            if first <= second { ([0, 1], separation / distance) } else { ([1, 0], -separation / distance) };
        let factor = (self.viscosity * table.small).sqrt() * self.range.taper(gap * table.over_large);
        let factors =
            table.factors.at::<X>(self.range.effective_gap(gap, table.minimum_gap) * table.over_small, factor);
        Some(PairFactor::new(&factors, axis, order, [table.small, first.max(second) / table.small]))
    }

    /// Writes the record from which the [`Coefficients`] of a pair are computed, at a distance of the centres within
    /// the cutoff, with numbers of any width.
    #[inline(always)]
    pub fn record<X: Arithmetic>(&self, distance: f64, species: [u32; 2], record: &mut [f64; RECORD]) {
        let table = self.table(species);
        let factor = self.range.taper_factor((distance - table.sum) * table.over_large);
        self.record_of::<X>(table, distance, factor, record);
    }

    /// The same without a cutoff.
    pub(crate) fn whole_record(&self, distance: f64, species: [u32; 2], record: &mut [f64; RECORD]) {
        self.record_of::<f64>(self.table(species), distance, 1.0, record);
    }

    #[inline(always)]
    fn record_of<X: Arithmetic>(&self, table: &SpeciesTable, distance: f64, factor: f64, record: &mut [f64; RECORD]) {
        let gap = self.range.effective_gap(distance - table.sum, table.minimum_gap);
        table.factors.record::<X>(gap * table.over_small, [self.viscosity * table.small * factor, table.small], record);
    }

    /// Coefficients at a distance of the centres; `None` beyond the cutoff.
    pub fn coefficients(&self, distance: f64, species: [u32; 2]) -> Option<Coefficients<f64>> {
        self.gap(distance, species)?;
        let mut record = [0.0; RECORD];
        self.record::<f64>(distance, species, &mut record);
        Some(Coefficients::of(&record))
    }

    /// Lubrication loads of a pair on the fluid, `R_lub` times its motion; `None` beyond the cutoff.
    pub fn loads(&self, separation: Vector, species: [u32; 2], motion: &PairMotion) -> Option<PairLoads> {
        Some(self.factor(separation, species)?.resistance(motion))
    }

    #[inline(always)]
    fn table(&self, species: [u32; 2]) -> &SpeciesTable {
        let (low, high) = (species[0].min(species[1]) as usize, species[0].max(species[1]) as usize);
        let before = low * self.radii.len() - low * low.saturating_sub(1) / 2;
        &self.tables[before + high - low]
    }
}
