//! Tables of the lubrication correction, one per ratio of radii.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use crate::arithmetic::Arithmetic;
use crate::block_factor::{FactorScales, LANES, PairFactors, flat_factors};
use crate::chebyshev::{Chebyshev, Powers, Samples};
use crate::coefficients::{RECORD, sizes};
use crate::far_field;
use crate::gap_series::GapSeries;
use crate::two_sphere::blocks::ResistanceBlocks;
use crate::two_sphere::{TwoSphere, TwoSphereError};

/// Smallest tabulated gap over the smaller radius.
pub const CLOSEST: f64 = 1e-7;
/// Largest tabulated gap over the larger radius.
pub const FARTHEST: f64 = 8.0;
/// Factor by which consecutive intervals of interpolation grow.
pub const GROWTH: f64 = std::f64::consts::SQRT_2;
/// Interpolation points per interval.
pub const NODES: usize = 8;

/// Factors of `R_exact - R_FCM` for radii 1 and `ratio`, viscosity 1. In each piece they are interpolated in the gap
/// `h` relative to the piece's geometric mean `m`, as functions of `(h - m) / (h + m)`: nearly half the logarithm of
/// `h / m`, and as smooth, but computed without a logarithm.
#[derive(Debug)]
pub struct FactorTable {
    pieces: Vec<TablePiece>,
    scales: FactorScales,
    sizes: [f64; 4],
}

/// Table between two gaps.
#[derive(Debug)]
struct TablePiece {
    /// Geometric mean of the two gaps.
    mean: f64,
    powers: Powers<LANES, NODES>,
}

/// Pieces begin at the gaps `2^(FIRST + k/2)`, so the piece of a gap can be read from its bits.
const FIRST: i32 = -24;
const _: () = assert!(CLOSEST > 1.0 / (1_u64 << -FIRST) as f64, "the closest gap is in a piece");

/// Table of one ratio, computed by the first thread that needs it while others wait.
type SharedTable = Arc<OnceLock<Arc<FactorTable>>>;

impl FactorTable {
    /// Table of a ratio of at least 1; computed at the first call, then shared.
    pub fn with_ratio(ratio: f64) -> Result<Arc<Self>, TwoSphereError> {
        static TABLES: OnceLock<Mutex<HashMap<u64, SharedTable>>> = OnceLock::new();
        let exact = TwoSphere::with_ratio(ratio)?;
        let tables = TABLES.get_or_init(Mutex::default);
        let entry =
            Arc::clone(tables.lock().unwrap_or_else(PoisonError::into_inner).entry(ratio.to_bits()).or_default());
        Ok(Arc::clone(entry.get_or_init(|| Arc::new(Self::compute(&exact)))))
    }

    /// Factors at a gap between the closest and the farthest, times `factor`, with numbers of any width.
    #[inline(always)]
    pub fn at<X: Arithmetic>(&self, gap: f64, factor: f64) -> PairFactors {
        let mut lanes = [0.0; LANES];
        self.write::<X>(gap, &mut lanes);
        PairFactors::from_flat(&lanes, factor, &self.scales)
    }

    /// Writes the record from which coefficients are computed, at such a gap and for a given smaller radius, for a
    /// resistance larger by `factor`.
    #[inline(always)]
    pub fn record<X: Arithmetic>(&self, gap: f64, [factor, radius]: [f64; 2], record: &mut [f64; RECORD]) {
        let (lanes, others) = record.split_first_chunk_mut().expect("a record begins with the lanes");
        self.write::<X>(gap, lanes);
        others[..2].copy_from_slice(&[factor, radius]);
        others[2..].copy_from_slice(&self.sizes);
    }

    #[inline(always)]
    fn write<X: Arithmetic>(&self, gap: f64, lanes: &mut [f64; LANES]) {
        let piece = &self.pieces[piece_of(gap).min(self.pieces.len() - 1)];
        piece.powers.write::<X, 5>(relative(gap, piece.mean), lanes);
    }

    /// Series of the factors in the pieces from one to another.
    pub fn series(&self, [first, last]: [usize; 2]) -> GapSeries {
        let mut series = GapSeries { first_piece: first, ..GapSeries::default() };
        let pieces = self.pieces.iter().take(last + 1).skip(first);
        pieces.for_each(|piece| series.push(piece.mean, &piece.powers, LANES));
        series
    }

    /// Bytes of the table of a ratio.
    pub fn bytes(ratio: f64) -> f64 {
        Self::pieces_of(ratio) as f64 * (size_of::<TablePiece>() + size_of::<Samples<LANES, NODES>>()) as f64
    }

    fn pieces_of(ratio: f64) -> usize {
        piece_of(FARTHEST * ratio) + 1
    }

    fn compute(exact: &TwoSphere) -> Self {
        let piece = |k: usize| {
            let mean = mean_of(k);
            TablePiece { mean, powers: of_gaps(mean, |gap| factors_at(exact, gap)) }
        };
        Self {
            pieces: (0..Self::pieces_of(exact.ratio())).map(piece).collect(),
            scales: FactorScales::new(exact.ratio()),
            sizes: sizes(exact.ratio()),
        }
    }
}

/// Geometric mean of the gaps of a piece.
pub fn mean_of(piece: usize) -> f64 {
    2.0_f64.powi(FIRST) * GROWTH.powi(piece as i32) * GROWTH.sqrt()
}

/// Power series of functions of the gap, for the piece with the given mean.
pub fn of_gaps<const N: usize, const M: usize>(mean: f64, values: impl Fn(f64) -> [f64; N]) -> Powers<N, M> {
    let edge = (GROWTH.sqrt() - 1.0) / (GROWTH.sqrt() + 1.0);
    let at = |u: f64| values(mean * (1.0 + u) / (1.0 - u));
    Powers::from(&Chebyshev::through(-edge, edge, &Chebyshev::<N, M>::nodes(-edge, edge).map(at)))
}

/// Gap relative to the mean of its piece: the variable of interpolation.
#[inline(always)]
pub fn relative(gap: f64, mean: f64) -> f64 {
    (gap - mean) / (gap + mean)
}

/// Piece of a gap: twice its binary exponent, plus one in the upper half of an octave.
#[inline(always)]
pub fn piece_of(gap: f64) -> usize {
    const MANTISSA: u64 = (1 << 52) - 1;
    let bits = gap.to_bits();
    let exponent = (bits >> 52) as i32 - 1023;
    let is_upper = bits & MANTISSA >= GROWTH.to_bits() & MANTISSA;
    (2 * (exponent - FIRST) + i32::from(is_upper)).max(0) as usize
}

/// Factors at one gap, without interpolation.
fn factors_at(exact: &TwoSphere, gap: f64) -> [f64; LANES] {
    let radii = [1.0, exact.ratio()];
    let known = far_field::resistance(radii, radii[0] + radii[1] + gap);
    flat_factors(&ResistanceBlocks::exact(&exact.at(gap), radii), &known, exact.ratio())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `L L^T` of the largest block.
    fn product(factors: &PairFactors) -> Vec<f64> {
        let factor = &factors.transverse.factor;
        let entry = |i: usize, j: usize| (0..4).map(|k| factor[i][k] * factor[j][k]).sum();
        (0..16).map(|k| entry(k / 4, k % 4)).collect()
    }

    #[test]
    fn bytes_are_those_of_its_pieces() {
        for ratio in [1.0, 2.0] {
            let table = FactorTable::with_ratio(ratio).unwrap();
            let piece = size_of_val(&table.pieces[0]) + size_of::<Samples<LANES, NODES>>();
            assert_eq!(FactorTable::bytes(ratio) as usize, table.pieces.len() * piece);
        }
    }

    #[test]
    fn interpolates_between_the_nodes() {
        for ratio in [1.0, 2.0] {
            let exact = TwoSphere::with_ratio(ratio).unwrap();
            let table = FactorTable::with_ratio(ratio).unwrap();
            for k in 0..60 {
                let gap = 1.3e-6 * 1.29_f64.powi(k);
                let (wanted, found) =
                    (PairFactors::from_flat(&factors_at(&exact, gap), 1.0, &table.scales), table.at::<f64>(gap, 1.0));
                // The approach of the surfaces is smooth; eigenvalues that change sign perturb the other modes by
                // 1e-4 of the drag.
                assert!(gap > 1.0 || (found.axial.factor[0][0] / wanted.axial.factor[0][0] - 1.0).abs() < 1e-9);
                let worst =
                    product(&found).iter().zip(product(&wanted)).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
                assert!(worst < 1e-3 * 6.0 * std::f64::consts::PI, "ratio {ratio} gap {gap}: off by {worst}");
            }
        }
    }
}
