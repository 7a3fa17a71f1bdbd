//! Square root of the matrix.

use crate::lanczos::product;

/// Replaces the lower triangle of a symmetric matrix by its Cholesky factor, row by row. A pivot that is not positive,
/// as of spheres that overlap, becomes zero with its column; returns the weight of the negative pivots relative to
/// all.
pub(super) fn factorise(matrix: &mut [f64], size: usize) -> f64 {
    let (mut negative, mut all) = (0.0, 0.0);
    for i in 0..size {
        let (done, row) = matrix.split_at_mut(i * size);
        let row = &mut row[..size];
        for j in 0..i {
            let other = &done[j * size..][..size];
            let rest = row[j] - product(&row[..j], &other[..j]);
            row[j] = if other[j] > 0.0 { rest / other[j] } else { 0.0 };
        }
        let pivot = row[i] - product(&row[..i], &row[..i]);
        all += pivot.abs();
        negative += (-pivot).max(0.0);
        row[i] = pivot.max(0.0).sqrt();
    }
    if all > 0.0 { negative / all } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factor_times_its_transpose_is_the_matrix() {
        let matrix = [4.0, 2.0, -1.0, 2.0, 5.0, 0.5, -1.0, 0.5, 3.0];
        let mut factor = matrix;
        assert!(factorise(&mut factor, 3).abs() < f64::MIN_POSITIVE);
        for (i, j) in (0..3).flat_map(|i| (0..=i).map(move |j| (i, j))) {
            let found: f64 = (0..=j).map(|k| factor[3 * i + k] * factor[3 * j + k]).sum();
            assert!((found - matrix[3 * i + j]).abs() < 1e-14, "{i}, {j}: {found}");
        }
    }

    #[test]
    fn negative_directions_are_left_out() {
        let mut factor = [1.0, 0.0, 0.0, -0.25];
        assert!((factorise(&mut factor, 2) - 0.2).abs() < 1e-15);
        assert!(factor[3].abs() < f64::MIN_POSITIVE);
    }
}
