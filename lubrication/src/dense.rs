//! Small dense matrices, row by row.

/// A square matrix.
pub type Square<const N: usize> = [[f64; N]; N];

/// Solution of `matrix x = right` for several right-hand sides, by elimination with pivoting.
pub fn solve<const N: usize, const M: usize>(mut matrix: Square<N>, mut right: [[f64; M]; N]) -> [[f64; M]; N] {
    for n in 0..N {
        let pivot = (n..N).max_by(|&i, &j| matrix[i][n].abs().total_cmp(&matrix[j][n].abs())).unwrap_or(n);
        matrix.swap(n, pivot);
        right.swap(n, pivot);
        let (line, values) = (matrix[n], right[n]);
        for i in (0..N).filter(|&i| i != n) {
            let factor = matrix[i][n] / line[n];
            matrix[i].iter_mut().zip(&line).for_each(|(x, y)| *x -= factor * y);
            right[i].iter_mut().zip(&values).for_each(|(x, y)| *x -= factor * y);
        }
    }
    std::array::from_fn(|n| right[n].map(|value| value / matrix[n][n]))
}

/// Inverse of a symmetric matrix, symmetric to the last bit.
pub fn inverse<const N: usize>(matrix: Square<N>) -> Square<N> {
    let inverse = solve(matrix, identity());
    std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (inverse[i][j] + inverse[j][i])))
}

/// A matrix times a vector.
pub fn times<const N: usize>(matrix: &Square<N>, vector: &[f64; N]) -> [f64; N] {
    matrix.map(|row| row.iter().zip(vector).map(|(r, v)| r * v).sum())
}

/// `a b`.
pub fn product<const L: usize, const M: usize, const N: usize>(a: &[[f64; M]; L], b: &[[f64; N]; M]) -> [[f64; N]; L] {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..M).map(|k| a[i][k] * b[k][j]).sum()))
}

/// The transpose.
pub fn transpose<const M: usize, const N: usize>(a: &[[f64; N]; M]) -> [[f64; M]; N] {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

/// Eigenvalues of a symmetric matrix, unsorted.
pub fn eigenvalues<const N: usize>(matrix: [[f64; N]; N]) -> [f64; N] {
    eigen(matrix).0
}

/// Eigenvalues of a symmetric matrix, and its eigenvectors as columns, by Jacobi rotations.
pub fn eigen<const N: usize>(mut matrix: Square<N>) -> ([f64; N], Square<N>) {
    let mut vectors = identity();
    for _ in 0..60 {
        let off: f64 = (0..N).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| matrix[i][j].powi(2)).sum();
        let scale: f64 = (0..N).map(|i| matrix[i][i].powi(2)).sum();
        if off <= 1e-34 * scale {
            break;
        }
        for p in 0..N {
            for q in p + 1..N {
                rotate(&mut matrix, &mut vectors, p, q);
            }
        }
    }
    (std::array::from_fn(|i| matrix[i][i]), vectors)
}

/// Rotation that makes `matrix[p][q]` zero.
fn rotate<const N: usize>(matrix: &mut Square<N>, vectors: &mut Square<N>, p: usize, q: usize) {
    if matrix[p][q] == 0.0 {
        return;
    }
    let theta = (matrix[q][q] - matrix[p][p]) / (2.0 * matrix[p][q]);
    let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
    let c = 1.0 / t.hypot(1.0);
    let s = t * c;
    for line in matrix.iter_mut().chain(vectors.iter_mut()) {
        (line[p], line[q]) = (c * line[p] - s * line[q], s * line[p] + c * line[q]);
    }
    let (first, second) = (matrix[p], matrix[q]);
    matrix[p] = std::array::from_fn(|k| c * first[k] - s * second[k]);
    matrix[q] = std::array::from_fn(|k| s * first[k] + c * second[k]);
}

fn identity<const N: usize>() -> Square<N> {
    std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))))
}

#[cfg(test)]
mod tests {
    use super::*;

    const MATRIX: Square<3> = [[4.0, 1.0, -2.0], [1.0, 2.0, 0.5], [-2.0, 0.5, 3.0]];

    #[test]
    fn inverse_times_matrix_is_one() {
        let one = product(&inverse(MATRIX), &MATRIX);
        assert!((0..3).all(|i| (0..3).all(|j| (one[i][j] - f64::from(u8::from(i == j))).abs() < 1e-14)));
    }

    #[test]
    fn eigenvectors_rebuild_the_matrix() {
        let (values, vectors) = eigen(MATRIX);
        for i in 0..3 {
            for j in 0..3 {
                let sum: f64 = (0..3).map(|k| vectors[i][k] * values[k] * vectors[j][k]).sum();
                assert!((sum - MATRIX[i][j]).abs() < 1e-13);
            }
        }
    }
}
