//! Clouds: randomly placed spheres in a ball.

use super::{DENSEST_ONE_BY_ONE, Occupied, PackingError};
use crate::{Boundaries, PeriodicBox, Random, Vector};

/// Number of positions tried for a sphere.
const TRIES: usize = 100_000;

/// Random positions for spheres of the given radii, with their centres in a ball around the origin and gaps of at
/// least `gap` between surfaces: random sequential addition, the largest first. They depend on the seed and the
/// arguments only. The spheres with half the gap fill at most a quarter of the ball.
pub fn random_cloud(radius: f64, radii: &[f64], gap: f64, seed: u64) -> Result<Vec<Vector>, PackingError> {
    let sizes: Vec<f64> = radii.iter().map(|a| a + 0.5 * gap).collect();
    let fraction = sizes.iter().map(|size| (size / radius).powi(3)).sum::<f64>();
    // A single sphere fits whatever its size.
    if fraction > DENSEST_ONE_BY_ONE && sizes.len() > 1 {
        return Err(PackingError::DenseCloud { fraction, radius, limit: DENSEST_ONE_BY_ONE });
    }
    let largest = sizes.iter().copied().fold(0.0, f64::max);
    let cell = around(2.0 * (radius + largest));
    let kinds: Vec<(f64, usize)> = sizes.iter().map(|&size| (size, 1)).collect();
    let mut occupied = Occupied::new(&cell, &kinds, None);
    let mut order: Vec<usize> = (0..sizes.len()).collect();
    order.sort_by(|&i, &j| sizes[j].total_cmp(&sizes[i]));
    let mut positions = vec![Vector::ZERO; sizes.len()];
    for sphere in order {
        let (size, half) = (sizes[sphere], 0.5 * cell.edges());
        let mut tries = in_ball(radius, Random::new(seed, sphere as u64)).take(TRIES);
        let free = tries.find(|&place| occupied.is_free(size, place + half, None));
        positions[sphere] = free.ok_or(PackingError::NotFound { spheres: radii.len(), fraction })?;
        occupied.insert(size, positions[sphere] + half);
    }
    Ok(positions)
}

/// An open cube.
fn around(edge: f64) -> PeriodicBox {
    let cube = PeriodicBox::new(Vector::splat(edge)).expect("radii are positive");
    cube.with_boundaries(Boundaries::Open).expect("a cube is orthogonal")
}

/// Random positions in a ball.
fn in_ball(radius: f64, mut random: Random) -> impl Iterator<Item = Vector> {
    let in_cube = std::iter::repeat_with(move || 2.0 * random.point() - Vector::ONE);
    in_cube.filter(|place| place.length_squared() < 1.0).map(move |place| place * radius)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Spheres do not overlap, and the ball is filled uniformly: the mean square distance from its centre is
    /// `3/5 R^2`, within four standard deviations of the mean; that of one position is
    /// `sqrt(3/7 - 9/25) = 0.262 R^2`.
    #[test]
    fn a_cloud_is_an_even_ball_without_overlap() {
        let radii: Vec<f64> = (0..900).map(|k| if k % 3 == 0 { 1.5 } else { 1.0 }).collect();
        let places = random_cloud(30.0, &radii, 0.1, 7).unwrap();
        for (i, &x) in places.iter().enumerate() {
            assert!(x.length() < 30.0);
            let gaps = (0..i).map(|j| (x - places[j]).length() - radii[i] - radii[j]);
            assert!(gaps.fold(f64::INFINITY, f64::min) >= 0.1 - 1e-12);
        }
        let square = places.iter().map(|x| x.length_squared()).sum::<f64>() / (900.0 * 900.0);
        assert!((square - 0.6).abs() < 4.0 * 0.262 / 30.0, "{square}");
        assert_eq!(places, random_cloud(30.0, &radii, 0.1, 7).unwrap());
        assert_ne!(places, random_cloud(30.0, &radii, 0.1, 8).unwrap());
    }

    #[test]
    fn a_cloud_has_room_or_is_refused() {
        let cloud = |count: usize, gap: f64| random_cloud(10.0, &vec![1.0; count], gap, 1);
        assert!(cloud(249, 0.0).is_ok());
        assert_eq!(random_cloud(0.1, &[1.0], 0.0, 1).unwrap().len(), 1);
        let Err(PackingError::DenseCloud { fraction, .. }) = cloud(249, 0.1) else { panic!("too dense") };
        assert!((fraction - 0.249 * 1.05_f64.powi(3)).abs() < 1e-12);
    }
}
