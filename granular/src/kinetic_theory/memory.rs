//! Predicted memory of solving the continuum equations.

use super::Problem;
use super::equations::WIDTH;
use domain::Bytes;

/// Intervals that resolve most problems.
const USUAL: usize = 192;

impl Problem {
    /// Newton's matrix of all unknowns, and the matrix of integrals between collocation points.
    pub fn bytes() -> Bytes {
        let unknowns = (WIDTH * (USUAL + 1) + 1) as f64;
        Bytes::list::<f64>(unknowns * unknowns).then(Bytes::list::<f64>(((USUAL + 1) * (USUAL + 1)) as f64)).freed()
    }
}
