//! The resistance of near pairs as a sparse matrix of 6 x 6 blocks, in lanes of vector registers.

pub mod diagonal_block;
pub mod inverse_block;
pub mod lanes;
pub mod packed_rows;
pub mod pair_rows;
pub mod row_sums;
pub mod sparse;
pub mod within_bodies;
