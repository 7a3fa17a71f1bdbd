//! Hard-sphere Monte Carlo.

use super::Occupied;
use crate::{PeriodicBox, Random, Vector};

/// Target of the acceptance ratio, to which the length of the moves is adjusted.
const ACCEPTED: f64 = 0.4;

/// Tries `sweeps` random moves of every sphere, one sphere after another, and accepts those without an overlap.
/// Spheres that do not overlap before do not overlap afterwards.
pub(super) fn shake(cell: &PeriodicBox, sizes: &[f64], positions: &mut [Vector], seed: u64, sweeps: u64) {
    let kinds: Vec<(f64, usize)> = sizes.iter().map(|&size| (size, 1)).collect();
    let mut occupied = Occupied::new(cell, &kinds, None);
    for (&size, &position) in sizes.iter().zip(&*positions) {
        occupied.insert(size, position);
    }
    let smallest = sizes.iter().copied().fold(f64::INFINITY, f64::min);
    let mut longest = 0.3 * smallest;
    for sweep in 1..=sweeps {
        let mut accepted = 0;
        for sphere in 0..sizes.len() {
            let mut random = Random::new(seed ^ (sweep << 48), sphere as u64);
            let step = (random.point() * 2.0 - Vector::ONE) * longest;
            let place = cell.wrap(positions[sphere] + step).0;
            let is_off_walls = cell.to_walls(place).all(|to| to.distance >= sizes[sphere]);
            if is_off_walls && occupied.is_free(sizes[sphere], place, Some(sphere)) {
                occupied.shift(sphere, place);
                positions[sphere] = place;
                accepted += 1;
            }
        }
        let share = f64::from(accepted) / sizes.len() as f64;
        longest = (longest * (share / ACCEPTED).clamp(0.5, 1.5)).min(2.0 * smallest);
    }
}
