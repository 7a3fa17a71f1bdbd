//! Pair corrections of the split method: the difference between envelopes and the common Gaussian.

pub(crate) mod boys;
pub(crate) mod moment_correction;
pub(crate) mod pair_correction;
pub(crate) mod pair_functions;
pub(crate) mod radial_functions;
pub(crate) mod table;
