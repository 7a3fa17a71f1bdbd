//! The box of a case: edges, or lattice vectors.

use super::boundaries::{BoundariesError, CaseBoundary, boundaries_of};
use crate::document::{Alternative, NumberOr};
use domain::{AxisRotation, Boundaries, BoxError, PeriodicBox, Vector};
use serde::{Deserialize, Serialize};

/// A box as the user specifies it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged, try_from = "[NumberOr<[f64; 3]>; 3]")]
pub enum CaseBox {
    /// Edges along x, y and z, for a box that may be sheared.
    Edges([f64; 3]),
    /// Three lattice vectors.
    Vectors([[f64; 3]; 3]),
}

impl Alternative for [f64; 3] {
    const WORDS: &'static str = "an edge or a lattice vector of three numbers";
}

impl TryFrom<[NumberOr<[f64; 3]>; 3]> for CaseBox {
    type Error = &'static str;

    fn try_from(given: [NumberOr<[f64; 3]>; 3]) -> Result<Self, Self::Error> {
        match given {
            [NumberOr::Number(x), NumberOr::Number(y), NumberOr::Number(z)] => Ok(Self::Edges([x, y, z])),
            [NumberOr::Other(a), NumberOr::Other(b), NumberOr::Other(c)] => Ok(Self::Vectors([a, b, c])),
            _ => {
                Err("has edges beside lattice vectors; it needs to be three edges, or three lattice vectors of three \
                 numbers each")
            }
        }
    }
}

/// Errors of a box.
#[derive(Debug, thiserror::Error)]
pub enum CaseBoxError {
    /// A box without volume.
    #[error("{0}")]
    Box(#[from] BoxError),
    /// Lattice vectors together with a strain.
    #[error("strain is for a box of three edges; lattice vectors have it in them")]
    Strain,
    /// An impossible combination of boundary conditions.
    #[error(transparent)]
    Boundaries(#[from] BoundariesError),
    /// Lattice vectors or a strain together with an axis that is not periodic.
    #[error("boundaries other than \"periodic\" are for a box of three edges that is not sheared")]
    Bounded,
    /// No box where one is needed.
    #[error("box is missing; only spheres that are in unbounded fluid along all axes need none")]
    Missing,
}

impl CaseBox {
    /// The box at a strain, with its non-periodic axis last, and the rotation of axes to it. Without a box, which is
    /// allowed in unbounded fluid only, a box around the spheres.
    pub fn bounded(
        given: Option<Self>,
        strain: f64,
        axes: [CaseBoundary; 3],
        spheres: (&[[f64; 3]], &[f64]),
    ) -> Result<(PeriodicBox, AxisRotation), CaseBoxError> {
        let (boundaries, turn) = boundaries_of(axes)?;
        let of_box = match given {
            Some(of_box) => of_box,
            None if boundaries == Boundaries::Open => Self::Edges(around(spheres.0, spheres.1)),
            None => return Err(CaseBoxError::Missing),
        };
        match of_box {
            _ if boundaries == Boundaries::Periodic => Ok((of_box.cell(strain)?, turn)),
            Self::Edges(edges) if strain == 0.0 => {
                let cell = Self::Edges(turn.list(edges)).cell(0.0)?;
                Ok((cell.with_boundaries(boundaries)?, turn))
            }
            _ => Err(CaseBoxError::Bounded),
        }
    }

    /// The box at a strain.
    pub fn cell(&self, strain: f64) -> Result<PeriodicBox, CaseBoxError> {
        let vectors = match self {
            Self::Edges(edges) => return Ok(PeriodicBox::sheared(Vector::from_array(*edges), strain)?),
            Self::Vectors(vectors) => vectors.map(Vector::from_array),
        };
        if strain != 0.0 {
            return Err(CaseBoxError::Strain);
        }
        // A grid is cheaper if the last vector is perpendicular to the others.
        let [a, b, c] = vectors;
        let cell = PeriodicBox::of_lattice(vectors)?;
        let others = [[b, c, a], [c, a, b]].map(PeriodicBox::of_lattice).into_iter().flatten();
        Ok([cell].into_iter().chain(others).find(PeriodicBox::is_orthogonal).unwrap_or(cell))
    }
}

/// Edges of a box around the spheres.
fn around(positions: &[[f64; 3]], radii: &[f64]) -> [f64; 3] {
    let radius = radii.iter().copied().fold(0.0, f64::max);
    std::array::from_fn(|axis| {
        let lowest = positions.iter().map(|x| x[axis]).fold(f64::INFINITY, f64::min);
        let highest = positions.iter().map(|x| x[axis]).fold(f64::NEG_INFINITY, f64::max);
        // Wider than two radii, as every box must be.
        (highest - lowest).max(0.0) + 2.5 * radius
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_special_axis_is_the_last() {
        use CaseBoundary::{Open, Periodic, Walls};
        let edges = CaseBox::Edges([3.0, 4.0, 5.0]);
        let spheres: (&[[f64; 3]], &[f64]) = (&[[0.0; 3], [-2.0, 1.0, 7.0]], &[1.0, 2.0]);
        let of = |given, strain, axes| CaseBox::bounded(given, strain, axes, spheres);
        let (cell, turn) = of(Some(edges), 0.0, [Periodic, Walls, Periodic]).unwrap();
        assert_eq!((cell.edges(), turn), (Vector::new(3.0, 5.0, 4.0), AxisRotation::to_last(1)));
        assert_eq!(of(None, 0.0, [Open; 3]).unwrap().0.edges(), Vector::new(7.0, 6.0, 12.0));
        let error = |given, strain, axes| of(given, strain, axes).unwrap_err().to_string();
        assert!(error(None, 0.0, [Periodic; 3]).contains("box is missing"));
        assert!(error(Some(edges), 0.1, [Walls, Periodic, Periodic]).contains("not sheared"));
        assert!(error(Some(edges), 0.0, [Walls, Walls, Periodic]).contains("possible are"));
    }

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
    fn vectors_of_which_none_is_at_right_angles_stay_as_they_are() {
        let vectors = [[3.0, 1.0, 0.5], [-1.0, 4.0, 0.2], [0.7, 0.3, 5.0]];
        let cell = CaseBox::Vectors(vectors).cell(0.0).unwrap();
        for (found, given) in cell.lattice_vectors().into_iter().zip(vectors) {
            assert!((found - Vector::from_array(given)).length() < 1e-14);
        }
    }

    #[test]
    fn what_can_not_be_is_named() {
        let [x, y, z] = [[3.0, 0.0, 0.0], [1.0, 3.0, 0.0], [0.0, 0.0, 3.0]];
        let error = |vectors, strain| CaseBox::Vectors(vectors).cell(strain).unwrap_err().to_string();
        assert!(error([x, y, z], 0.1).contains("strain is for a box of three edges"));
        assert!(error([y, x, z], 0.0).contains("right-handed"));
        assert!(CaseBox::Edges([1.0, 0.0, 1.0]).cell(0.0).unwrap_err().to_string().contains("box edge y is 0"));
    }
}
