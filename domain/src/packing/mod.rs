//! Random packings: positions for spheres that do not overlap.

mod relax;
mod sequential;
mod shake;

use crate::{PeriodicBox, Vector};
use relax::relax;
use sequential::Occupied;

/// Why spheres could not be placed.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum PackingError {
    /// A sphere overlaps its own periodic image.
    #[error(
        "a sphere of radius {radius} with the gap {gap} touches its own image in a box whose shortest edge is {edge}; \
         take a larger box or smaller spheres"
    )]
    OwnImage {
        /// The sphere's radius.
        radius: f64,
        /// The gap that was asked for.
        gap: f64,
        /// The box's shortest edge.
        edge: f64,
    },
    /// A volume fraction above that of random packings.
    #[error(
        "spheres with the gap would fill {fraction:.3} of the box; random packings reach {limit}: take fewer or smaller \
         spheres, or a smaller gap"
    )]
    TooDense {
        /// Volume fraction of the spheres with half the gap added to their radii.
        fraction: f64,
        /// The largest that is tried.
        limit: f64,
    },
    /// Overlaps were left after the largest number of iterations.
    #[error(
        "no places without overlap found for {spheres} spheres at a volume fraction of {fraction:.3}; try another seed"
    )]
    NotFound {
        /// How many spheres.
        spheres: usize,
        /// Volume fraction of the spheres with half the gap added to their radii.
        fraction: f64,
    },
}

/// The densest that is tried: just below random close packing of equal spheres.
const DENSEST: f64 = 0.63;
/// Up to this volume fraction spheres are added one after another (random sequential addition); above, that takes too
/// many tries.
const DENSEST_ONE_BY_ONE: f64 = 0.25;
/// Relative increase of the radii while overlaps are removed, so that none is left at the true radii.
const MARGIN: f64 = 1e-3;
/// Monte Carlo moves of every sphere after overlaps were removed, so that the touching pairs left by that disappear.
const SWEEPS: u64 = 20;

/// Random positions in a box for spheres of the given radii, with gaps of at least `gap` between surfaces. They depend
/// on the seed and the arguments only.
///
/// Up to a volume fraction of 1/4: random sequential addition, largest spheres first. Above: smaller spheres are added
/// that way and enlarged at once, minimisation of the elastic energy removes the overlaps, and hard-sphere Monte Carlo
/// moves follow.
pub fn random_packing(cell: &PeriodicBox, radii: &[f64], gap: f64, seed: u64) -> Result<Vec<Vector>, PackingError> {
    let sizes: Vec<f64> = radii.iter().map(|a| a + 0.5 * gap).collect();
    let fraction = check(cell, &sizes, gap)?;
    let shrunk = (DENSEST_ONE_BY_ONE / fraction).cbrt().min(1.0);
    let smaller: Vec<f64> = sizes.iter().map(|a| a * shrunk).collect();
    let (mut positions, all_free) = sequential::place(cell, &smaller, seed);
    if fraction <= DENSEST_ONE_BY_ONE && all_free {
        return Ok(positions);
    }
    relax(cell, &sizes, MARGIN, &mut positions).ok_or(PackingError::NotFound { spheres: radii.len(), fraction })?;
    shake::shake(cell, &sizes, &mut positions, (seed, SWEEPS));
    Ok(positions)
}

fn check(cell: &PeriodicBox, sizes: &[f64], gap: f64) -> Result<f64, PackingError> {
    let edge = cell.edges().min_element();
    if let Some(size) = sizes.iter().find(|&&a| 2.0 * a >= edge) {
        return Err(PackingError::OwnImage { radius: size - 0.5 * gap, gap, edge });
    }
    let volume: f64 = sizes.iter().map(|a| 4.0 / 3.0 * std::f64::consts::PI * a.powi(3)).sum();
    let fraction = volume / cell.volume();
    if fraction > DENSEST { Err(PackingError::TooDense { fraction, limit: DENSEST }) } else { Ok(fraction) }
}

#[cfg(test)]
mod tests;
