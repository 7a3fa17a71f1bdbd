//! Error of an answer: 2-norm of its difference from the exact one, over the 2-norm of the exact one, over all
//! particles and components.

use super::Suspension;
use domain::{Traceless, Vector};
use fcm::Motion;

/// `|found - exact| / |exact|`; zero if both vanish.
pub fn error(found: &[f64], exact: &[f64]) -> f64 {
    assert_eq!(found.len(), exact.len());
    let difference: f64 = found.iter().zip(exact).map(|(a, b)| (a - b) * (a - b)).sum();
    if difference == 0.0 { 0.0 } else { (difference / exact.iter().map(|b| b * b).sum::<f64>()).sqrt() }
}

/// The components of vectors.
pub fn vectors(list: &[Vector]) -> Vec<f64> {
    list.iter().flat_map(Vector::to_array).collect()
}

/// All nine components of tensors.
pub fn tensors(list: &[Traceless]) -> Vec<f64> {
    list.iter().flat_map(|t| t.tensor().to_cols_array()).collect()
}

/// Errors of velocities, angular velocities and rates of strain.
pub fn errors(found: &Motion, exact: &Motion) -> [f64; 3] {
    [
        error(&vectors(&found.velocities), &vectors(&exact.velocities)),
        error(&vectors(&found.angular_velocities), &vectors(&exact.angular_velocities)),
        error(&tensors(&found.strain_rates), &tensors(&exact.strain_rates)),
    ]
}

/// Largest of the three errors; infinite if one is NaN.
pub fn worst(found: &Motion, exact: &Motion) -> f64 {
    let infinite = |error: f64| if error.is_nan() { f64::INFINITY } else { error };
    errors(found, exact).into_iter().map(infinite).fold(0.0, f64::max)
}

/// Difference of two motions.
pub fn difference(found: &Motion, exact: &Motion) -> Motion {
    let mut difference = found.clone();
    difference.velocities.iter_mut().zip(&exact.velocities).for_each(|(a, b)| *a -= b);
    difference.angular_velocities.iter_mut().zip(&exact.angular_velocities).for_each(|(a, b)| *a -= b);
    difference.strain_rates.iter_mut().zip(&exact.strain_rates).for_each(|(a, b)| *a = *a - *b);
    difference
}

/// Norms of the parts of a motion at the surfaces of the particles, `(V, a Omega, a E)`: comparable, whatever moves
/// the particles.
pub fn at_surfaces(suspension: &Suspension, motion: &Motion) -> [f64; 3] {
    let mut squares = [0.0; 3];
    for (n, a) in suspension.radii.iter().enumerate() {
        squares[0] += motion.velocities[n].length_squared();
        squares[1] += a * a * motion.angular_velocities[n].length_squared();
        squares[2] += a * a * motion.strain_rates[n].contract(motion.strain_rates[n]);
    }
    squares.map(f64::sqrt)
}
