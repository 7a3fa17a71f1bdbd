//! Random places for spheres that do not overlap.

mod relax;
mod sequential;
mod shake;

use crate::{PeriodicBox, Vector};
use relax::relax;
use sequential::Occupied;

/// Why spheres could not be placed.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum PackingError {
    /// A sphere meets its own image.
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
    /// More than random spheres can fill.
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
    /// The search did not end.
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
/// Up to here spheres are put down one after another; beyond, that takes too many tries.
const DENSEST_ONE_BY_ONE: f64 = 0.25;
/// Radii are larger by this much while overlaps are removed, so that what remains of them is none.
const MARGIN: f64 = 1e-3;
/// Random moves of every sphere after overlaps were removed, which wipe out the contacts that this leaves behind.
const SWEEPS: u64 = 20;

/// Places for spheres of the given radii, inside the box, at random and so that the gap between the surfaces of any two
/// is at least `gap`. They depend on the seed and the arguments alone.
///
/// Up to a volume fraction of 1/4 the spheres are put down one after another, largest first, each at the first of its
/// random places that is free. Beyond, spheres that are small enough for that grow to their size at once, a descent of
/// the elastic energy removes the overlaps, and hard-sphere Monte Carlo moves follow.
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
