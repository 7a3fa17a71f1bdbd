//! Random packings: positions for spheres that do not overlap.

mod cloud;
mod occupied;
mod relax;
mod sequential;
mod shake;

use crate::{Comm, Partition, PeriodicBox, Vector, sphere};
pub use cloud::random_cloud;
pub use occupied::Occupied;
use relax::relax;

/// Reason why spheres could not be placed.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum PackingError {
    /// A sphere overlaps its own periodic image.
    #[error(
        "a sphere of radius {radius} with the gap {gap} touches its own image in a box whose shortest edge is {edge}; \
         take a larger box or smaller spheres"
    )]
    OwnImage {
        /// Radius of the sphere.
        radius: f64,
        /// Gap between surfaces.
        gap: f64,
        /// Shortest edge of the box.
        edge: f64,
    },
    /// A volume fraction above that of random packings.
    #[error(
        "spheres with the gap would fill {fraction:.3} of the box; random packings reach {limit}: take fewer or \
         smaller spheres, or a smaller gap"
    )]
    TooDense {
        /// Volume fraction of the spheres with half the gap added to their radii.
        fraction: f64,
        /// Largest volume fraction that is tried.
        limit: f64,
    },
    /// A cloud without enough room.
    #[error(
        "spheres with the gap would fill {fraction:.3} of the ball of radius {radius}; a cloud at random has up to \
         {limit}: take a larger ball, fewer or smaller spheres, or a smaller gap"
    )]
    DenseCloud {
        /// Volume of the spheres with half the gap added to their radii over that of the ball.
        fraction: f64,
        /// Radius of the ball.
        radius: f64,
        /// Largest volume fraction that is tried.
        limit: f64,
    },
    /// Overlaps remain after the largest number of iterations.
    #[error(
        "no places without overlap found for {spheres} spheres at a volume fraction of {fraction:.3}; try another seed"
    )]
    NotFound {
        /// Number of spheres.
        spheres: usize,
        /// Volume fraction of the spheres with half the gap added to their radii.
        fraction: f64,
    },
}

/// Largest volume fraction that is tried: just below random close packing of equal spheres.
const DENSEST: f64 = 0.63;
/// Volume fraction up to which spheres are added one after another (random sequential addition); above, that takes
/// too many tries.
const DENSEST_ONE_BY_ONE: f64 = 0.25;
/// Relative increase of the radii while overlaps are removed, so that none remains at the true radii.
const MARGIN: f64 = 1e-3;
/// Monte Carlo moves of every sphere after overlaps were removed, to disperse the touching pairs that remain.
const SWEEPS: u64 = 20;

/// Random positions in a box for spheres of the given radii, with gaps of at least `gap` between surfaces. They
/// depend on the seed and the arguments only.
///
/// Up to a volume fraction of 1/4: random sequential addition, largest spheres first. Above: smaller spheres are
/// added that way and enlarged at once, minimisation of the elastic energy removes the overlaps, and hard-sphere
/// Monte Carlo moves follow.
pub fn random_packing(cell: &PeriodicBox, radii: &[f64], gap: f64, seed: u64) -> Result<Vec<Vector>, PackingError> {
    let sizes: Vec<f64> = radii.iter().map(|a| a + 0.5 * gap).collect();
    let fraction = check(cell, sizes.iter().map(|&a| (a, 1)), gap)?;
    let shrunk = (DENSEST_ONE_BY_ONE / fraction).cbrt().min(1.0);
    let (mut positions, all_free) = one_by_one(cell, &sizes.iter().map(|a| a * shrunk).collect::<Vec<_>>(), seed);
    if fraction <= DENSEST_ONE_BY_ONE && all_free {
        return Ok(positions);
    }
    relax(cell, &sizes, MARGIN, &mut positions).ok_or(PackingError::NotFound { spheres: radii.len(), fraction })?;
    shake::shake(cell, &sizes, &mut positions, seed, SWEEPS);
    Ok(positions)
}

/// Spheres added one after another, and whether none overlaps.
fn one_by_one(cell: &PeriodicBox, sizes: &[f64], seed: u64) -> (Vec<Vector>, bool) {
    let mut order: Vec<usize> = (0..sizes.len()).collect();
    order.sort_by(|&i, &j| sizes[j].total_cmp(&sizes[i]));
    let kinds: Vec<(f64, usize)> = sizes.iter().map(|&size| (size, 1)).collect();
    let partition = Partition::new(&Comm::alone(), [1, 1]);
    let spheres = order.into_iter().map(|sphere| (sphere as u64, sizes[sphere]));
    let (placed, all_free) = sequential::place(cell, &partition, &kinds, spheres, seed);
    let mut positions = vec![Vector::ZERO; sizes.len()];
    for (sphere, place) in placed {
        positions[sphere as usize] = place;
    }
    (positions, all_free)
}

/// The positions of [`random_packing`] for spheres in groups of one radius; the first group has the ids from 0 on,
/// the next the following ids. Returns this rank's spheres by id, in any order. Each rank knows only the spheres in
/// its share of the box and those that reach into it. `None` if sequential addition is not enough, beyond a volume
/// fraction of 1/4. Collective.
pub fn shared_random_packing(
    cell: &PeriodicBox,
    groups: &[(f64, usize)],
    gap: f64,
    seed: u64,
    partition: &Partition,
) -> Result<Option<Vec<(u64, Vector)>>, PackingError> {
    let kinds: Vec<(f64, usize)> = groups.iter().map(|&(radius, count)| (radius + 0.5 * gap, count)).collect();
    let fraction = check(cell, kinds.iter().copied(), gap)?;
    // Sums over groups and over spheres may differ in the last digits.
    if fraction > DENSEST_ONE_BY_ONE * (1.0 - 1e-9) {
        return Ok(None);
    }
    let starts = kinds.iter().scan(0, |end, &(_, count)| Some(std::mem::replace(end, *end + count as u64)));
    let mut groups: Vec<(u64, (f64, usize))> = starts.zip(kinds.iter().copied()).collect();
    groups.sort_by(|(_, (a, _)), (_, (b, _))| b.total_cmp(a));
    let spheres =
        groups.into_iter().flat_map(|(start, (size, count))| (start..start + count as u64).map(move |id| (id, size)));
    let (own, all_free) = sequential::place(cell, partition, &kinds, spheres, seed);
    Ok(all_free.then_some(own))
}

/// Volume fraction of spheres given by size and number, if they can be placed.
fn check(cell: &PeriodicBox, kinds: impl Iterator<Item = (f64, usize)> + Clone, gap: f64) -> Result<f64, PackingError> {
    let edge = cell.edges().min_element();
    if let Some((size, _)) = kinds.clone().find(|&(a, count)| count > 0 && 2.0 * a >= edge) {
        return Err(PackingError::OwnImage { radius: size - 0.5 * gap, gap, edge });
    }
    let volume: f64 = kinds.map(|(a, count)| sphere::volume(a) * count as f64).sum();
    let fraction = volume / cell.volume();
    if fraction > DENSEST { Err(PackingError::TooDense { fraction, limit: DENSEST }) } else { Ok(fraction) }
}

#[cfg(test)]
mod tests;
