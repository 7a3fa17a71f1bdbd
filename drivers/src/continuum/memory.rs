//! What solving the continuum's equations takes.

use super::Problem;
use super::equations::WIDTH;
use domain::Bytes;

/// Intervals on which most problems are resolved.
const USUAL: usize = 192;

impl Problem {
    /// Newton's matrix of all unknowns, and the integrals between collocation points.
    pub fn bytes() -> Bytes {
        let unknowns = (WIDTH * (USUAL + 1) + 1) as f64;
        Bytes::list::<f64>(unknowns * unknowns).then(Bytes::list::<f64>(((USUAL + 1) * (USUAL + 1)) as f64)).freed()
    }
}
