//! Boundary conditions of a case, as the user specifies them.

use domain::{AxisRotation, Boundaries};
use serde::{Deserialize, Serialize};

/// Boundary condition along one axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CaseBoundary {
    /// Periodic.
    Periodic,
    /// Walls at 0 and at the edge.
    Walls,
    /// A wall at 0, and unbounded fluid above.
    Wall,
    /// Open fluid.
    Open,
}

/// An unknown boundary condition.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("a boundary is {0:?}; it needs to be \"periodic\", \"walls\", \"wall\" or \"open\"")]
pub struct UnknownBoundary(String);

impl CaseBoundary {
    /// Boundary condition of this name.
    pub fn of_word(word: &str) -> Result<Self, UnknownBoundary> {
        serde_json::from_value(serde_json::Value::from(word)).map_err(|_| UnknownBoundary(word.to_owned()))
    }
}

/// An impossible combination of boundary conditions.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "boundaries are {0:?}; possible are \"periodic\" along all axes, \"walls\", \"wall\" or \"open\" along one and \
     \"periodic\" along the others, or \"open\" along all"
)]
pub struct BoundariesError([CaseBoundary; 3]);

/// Boundaries of a box whose non-periodic axis is the last, and the rotation of axes to it.
pub fn boundaries_of(axes: [CaseBoundary; 3]) -> Result<(Boundaries, AxisRotation), BoundariesError> {
    use CaseBoundary::{Open, Periodic, Wall, Walls};
    if axes == [Open; 3] {
        return Ok((Boundaries::Open, AxisRotation::default()));
    }
    let special: Vec<usize> = (0..3).filter(|&axis| axes[axis] != Periodic).collect();
    match special[..] {
        [] => Ok((Boundaries::Periodic, AxisRotation::default())),
        [axis] => {
            let boundaries = match axes[axis] {
                Walls => Boundaries::Walls,
                Wall => Boundaries::Wall,
                Open | Periodic => Boundaries::OpenAlongZ,
            };
            Ok((boundaries, AxisRotation::to_last(axis)))
        }
        _ => Err(BoundariesError(axes)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use CaseBoundary::{Open, Periodic, Wall, Walls};

    #[test]
    fn one_axis_or_all_are_special() {
        let of = |axes| boundaries_of(axes).unwrap();
        assert_eq!(of([Periodic; 3]), (Boundaries::Periodic, AxisRotation::default()));
        assert_eq!(of([Open; 3]), (Boundaries::Open, AxisRotation::default()));
        assert_eq!(of([Periodic, Walls, Periodic]), (Boundaries::Walls, AxisRotation::to_last(1)));
        assert_eq!(of([Wall, Periodic, Periodic]), (Boundaries::Wall, AxisRotation::to_last(0)));
        assert_eq!(of([Periodic, Periodic, Open]), (Boundaries::OpenAlongZ, AxisRotation::default()));
        for axes in [[Walls, Walls, Periodic], [Open, Open, Periodic], [Wall, Open, Open]] {
            assert!(boundaries_of(axes).unwrap_err().to_string().contains("possible are"));
        }
        assert_eq!(CaseBoundary::of_word("walls"), Ok(Walls));
        assert!(CaseBoundary::of_word("wand").unwrap_err().to_string().contains("\"wand\"; it needs to be"));
    }
}
