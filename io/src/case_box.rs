//! The box of a case: edges, or lattice vectors.

use domain::{BoxError, PeriodicBox, Vector};
use serde::{Deserialize, Serialize};

/// The periodic box that a user gives.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "box needs to be three edges, or three lattice vectors of three numbers each")]
pub enum CaseBox {
    /// Edges along x, y and z, of a box that may be sheared.
    Edges([f64; 3]),
    /// Three vectors of a lattice, one of which is at right angles to the other two.
    Vectors([[f64; 3]; 3]),
}

/// Why a box can't be.
#[derive(Debug, thiserror::Error)]
pub enum CaseBoxError {
    /// A box that has no volume.
    #[error("{0}")]
    Box(#[from] BoxError),
    /// Lattice vectors and a strain besides.
    #[error("strain is for a box of three edges; lattice vectors have it in them")]
    Strain,
    /// No vector is at right angles to the others.
    #[error("none of the box's lattice vectors is at right angles to the other two; one needs to be")]
    Leaning,
}

impl CaseBox {
    /// The box, at a strain.
    pub fn cell(&self, strain: f64) -> Result<PeriodicBox, CaseBoxError> {
        let vectors = match self {
            Self::Edges(edges) => return Ok(PeriodicBox::sheared(Vector::from_array(*edges), strain)?),
            Self::Vectors(vectors) => vectors.map(Vector::from_array),
        };
        if strain != 0.0 {
            return Err(CaseBoxError::Strain);
        }
        let [a, b, c] = vectors;
        for vectors in [[a, b, c], [b, c, a], [c, a, b]] {
            let cell = PeriodicBox::of_lattice(vectors)?;
            if cell.is_upright() {
                return Ok(cell);
            }
        }
        Err(CaseBoxError::Leaning)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_vector_at_right_angles_is_the_third() {
        let [a, b, c] = [[3.0, 1.0, 0.0], [-1.0, 4.0, 0.0], [0.0, 0.0, 5.0]];
        for vectors in [[a, b, c], [b, c, a], [c, a, b]] {
            let cell = CaseBox::Vectors(vectors).cell(0.0).unwrap();
            assert_eq!(cell.lattice_vectors()[2].round(), Vector::from_array(c));
            assert!((cell.volume() - 65.0).abs() < 1e-13);
        }
    }

    #[test]
    fn what_can_not_be_is_named() {
        let [x, y, z] = [[3.0, 0.0, 0.0], [1.0, 3.0, 0.0], [0.5, 0.5, 3.0]];
        let error = |vectors, strain| CaseBox::Vectors(vectors).cell(strain).unwrap_err().to_string();
        assert!(error([x, y, z], 0.0).contains("right angles"));
        assert!(error([x, y, [0.0, 0.0, 3.0]], 0.1).contains("strain is for a box of three edges"));
        assert!(error([y, x, [0.0, 0.0, 3.0]], 0.0).contains("right-handed"));
        assert!(CaseBox::Edges([1.0, 0.0, 1.0]).cell(0.0).unwrap_err().to_string().contains("box edge y is 0"));
    }
}
