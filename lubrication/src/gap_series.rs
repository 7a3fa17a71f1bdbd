//! Tables of the resistance of pairs as plain numbers, for a device.

use crate::chebyshev::Powers;

/// Functions of the gap `h` of a pair over its smaller radius, as power series in `(h - m) / (h + m)` with the
/// geometric mean `m` of a piece. Piece `k` begins at the gap `2^(k/2 - 24)`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GapSeries {
    /// First piece.
    pub first_piece: usize,
    /// Number of pieces.
    pub pieces: usize,
    /// Mean of a piece, then the coefficients of each power of all functions, from the constant on; piece by piece.
    pub numbers: Vec<f64>,
}

impl GapSeries {
    /// Appends a piece of the first `functions` functions.
    pub(crate) fn push<const N: usize, const M: usize>(&mut self, mean: f64, powers: &Powers<N, M>, functions: usize) {
        self.pieces += 1;
        self.numbers.push(mean);
        self.numbers.extend(powers.rows().iter().flat_map(|row| &row[..functions]));
    }
}
