//! Square roots of operators times vectors, by Lanczos' iteration.

use domain::Comm;
use domain::parallel::{change, mapped, of_rows};

/// Diagnostics of a draw.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct DrawDiagnostics {
    /// Applications of the near field, or of the whole mobility.
    pub iterations: usize,
    /// Weight of the negative eigenvalues, which are replaced by zero, relative to all: 0 unless spheres overlap.
    pub clipped: f64,
    /// Relative change of the result in the last iteration.
    pub change: f64,
}

impl DrawDiagnostics {
    /// Clipped weight that needs no warning.
    pub const NEGLIGIBLE: f64 = 1e-3;
}

/// Stopping criteria of [`square_root_times`].
#[derive(Debug, Clone, Copy)]
pub struct LanczosLimits {
    /// Tolerance relative to the norm of the result.
    pub tolerance: f64,
    /// Largest number of iterations.
    pub iterations: usize,
}

/// Orthonormal basis `V` of the Krylov space of a vector and a symmetric operator `A`, and a remainder, from which the
/// next vector follows: at first the vector itself. Methods are collective.
pub(crate) trait KrylovBasis {
    /// Error of the operator.
    type Error;

    /// Appends the remainder, over its norm, as a vector `v` to the basis. The part of `A v` that is orthogonal to the
    /// basis becomes the remainder.
    fn extend(&mut self, norm: f64) -> Result<KrylovStep, Self::Error>;
}

/// Numbers by which a vector `v` extends the tridiagonal matrix `T = V^T A V`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct KrylovStep {
    /// `v . A v`
    pub diagonal: f64,
    /// Norm of the remainder.
    pub rest: f64,
}

/// Coordinates of `A^{1/2} z` in a basis, `|z| T^{1/2} e_1`, of a vector `z` with a norm above 0, see
/// [`square_root_times`]. Collective.
pub(crate) fn coordinates_of_root<B: KrylovBasis>(
    basis: &mut B,
    norm: f64,
    LanczosLimits { tolerance, iterations: most }: LanczosLimits,
) -> Result<(Vec<f64>, DrawDiagnostics), B::Error> {
    let (mut diagonal, mut beside, mut before) = (Vec::new(), Vec::new(), Vec::new());
    let mut next = norm;
    loop {
        let step = basis.extend(next)?;
        diagonal.push(step.diagonal);
        let iterations = diagonal.len();
        let (coordinates, clipped) = first_column_of_root(&diagonal, &beside);
        let change: f64 =
            coordinates.iter().enumerate().map(|(k, c)| (c - before.get(k).unwrap_or(&0.0)).powi(2)).sum();
        let size: f64 = coordinates.iter().map(|c| c * c).sum();
        let is_near = iterations > 1 && change <= tolerance * tolerance * size;
        let is_whole = step.rest <= 1e-12 * diagonal[0].abs();
        if is_near || is_whole || iterations == most {
            let change = if is_whole { 0.0 } else { (change / size).sqrt() };
            let drawn = DrawDiagnostics { iterations, clipped, change };
            return Ok((coordinates.into_iter().map(|coordinate| coordinate * norm).collect(), drawn));
        }
        before = coordinates;
        beside.push(step.rest);
        next = step.rest;
    }
}

/// A basis of vectors that are distributed over ranks by rows.
struct DistributedBasis<'a, const N: usize, F> {
    comm: &'a Comm,
    vectors: Vec<Vec<[f64; N]>>,
    remainder: Vec<[f64; N]>,
    apply: F,
}

impl<const N: usize, F> DistributedBasis<'_, N, F> {
    fn dot(&self, a: &[[f64; N]], b: &[[f64; N]]) -> f64 {
        let mut sum = [product(a.as_flattened(), b.as_flattened())];
        self.comm.sum(&mut sum);
        sum[0]
    }
}

impl<const N: usize, E, F: FnMut(&[[f64; N]]) -> Result<Vec<[f64; N]>, E>> KrylovBasis for DistributedBasis<'_, N, F> {
    type Error = E;

    fn extend(&mut self, norm: f64) -> Result<KrylovStep, E> {
        let factor = 1.0 / norm;
        let vector: Vec<[f64; N]> = mapped(&self.remainder, |numbers| numbers.map(|x| x * factor));
        let mut image = (self.apply)(&vector)?;
        let diagonal = self.dot(&vector, &image);
        self.vectors.push(vector);
        // Orthogonalised twice against the whole basis, to remove round-off.
        for _ in 0..2 {
            for vector in &self.vectors {
                let share = self.dot(vector, &image);
                subtract(&mut image, share, vector);
            }
        }
        self.remainder = image;
        Ok(KrylovStep { diagonal, rest: self.dot(&self.remainder, &self.remainder).sqrt() })
    }
}

/// `A^{1/2} z` of a symmetric operator that is positive semidefinite, or nearly, to a tolerance relative to the norm
/// of the result (Lanczos; Chow & Saad, SIAM J. Sci. Comput. 36, A588, 2014): with `V` an orthonormal basis of the
/// Krylov space of `z` and `T = V^T A V`, it is `|z| V T^{1/2} e_1`. Vectors are distributed over ranks by
/// rows. Collective.
///
/// # Errors
/// Errors of the operator, which have to occur on every rank or on none.
pub fn square_root_times<const N: usize, E>(
    comm: &Comm,
    start: &[[f64; N]],
    limits: LanczosLimits,
    apply: impl FnMut(&[[f64; N]]) -> Result<Vec<[f64; N]>, E>,
) -> Result<(Vec<[f64; N]>, DrawDiagnostics), E> {
    let mut basis = DistributedBasis { comm, vectors: Vec::new(), remainder: start.to_vec(), apply };
    let norm = basis.dot(start, start).sqrt();
    if norm == 0.0 {
        return Ok((start.to_vec(), DrawDiagnostics::default()));
    }
    let (coordinates, drawn) = coordinates_of_root(&mut basis, norm, limits)?;
    let mut root = of_rows(start.len(), |_| [0.0; N]);
    for (vector, &coordinate) in basis.vectors.iter().zip(&coordinates) {
        subtract(&mut root, -coordinate, vector);
    }
    Ok((root, drawn))
}

/// Inner product of two lists, summed in independent lanes.
pub(crate) fn product(a: &[f64], b: &[f64]) -> f64 {
    const LANES: usize = 8;
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    let mut lanes = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for (lane, (a, b)) in lanes.iter_mut().zip(a.iter().zip(b)) {
            *lane += a * b;
        }
    }
    lanes.iter().sum::<f64>() + a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum::<f64>()
}

fn subtract<const N: usize>(from: &mut [[f64; N]], factor: f64, vector: &[[f64; N]]) {
    change(from.as_flattened_mut(), vector.as_flattened(), |to, by| *to -= factor * by);
}

/// First column of the square root of a tridiagonal matrix, with negative eigenvalues replaced by zero, and the share
/// of `e_1` that belongs to their eigenvectors.
fn first_column_of_root(diagonal: &[f64], beside: &[f64]) -> (Vec<f64>, f64) {
    let count = diagonal.len();
    let mut matrix = vec![vec![0.0; count]; count];
    for k in 0..count {
        matrix[k][k] = diagonal[k];
        if k + 1 < count {
            (matrix[k][k + 1], matrix[k + 1][k]) = (beside[k], beside[k]);
        }
    }
    let (values, vectors) = eigen(matrix);
    let mut column = vec![0.0; count];
    let [mut negative, mut all] = [0.0; 2];
    for (value, vector) in values.iter().zip(&vectors) {
        let weight = vector[0] * vector[0] * value.abs();
        all += weight;
        negative += if *value < 0.0 { weight } else { 0.0 };
        for (sum, component) in column.iter_mut().zip(vector) {
            *sum += value.max(0.0).sqrt() * vector[0] * component;
        }
    }
    (column, if all > 0.0 { negative / all } else { 0.0 })
}

/// Eigenvalues and eigenvectors of a small symmetric matrix, by Jacobi rotations.
fn eigen(mut matrix: Vec<Vec<f64>>) -> (Vec<f64>, Vec<Vec<f64>>) {
    let count = matrix.len();
    let mut vectors: Vec<Vec<f64>> =
        (0..count).map(|i| (0..count).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    let size: f64 = matrix.iter().flatten().map(|a| a * a).sum();
    for _ in 0..50 {
        let off: f64 = (0..count).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| matrix[i][j].powi(2)).sum();
        if off <= 1e-30 * size {
            break;
        }
        for p in 0..count {
            for q in p + 1..count {
                if matrix[p][q] == 0.0 {
                    continue;
                }
                let theta = (matrix[q][q] - matrix[p][p]) / (2.0 * matrix[p][q]);
                let tangent = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
                let cos = 1.0 / (tangent * tangent + 1.0).sqrt();
                let sin = tangent * cos;
                for row in &mut matrix {
                    (row[p], row[q]) = (cos * row[p] - sin * row[q], sin * row[p] + cos * row[q]);
                }
                for k in 0..count {
                    (matrix[p][k], matrix[q][k]) =
                        (cos * matrix[p][k] - sin * matrix[q][k], sin * matrix[p][k] + cos * matrix[q][k]);
                }
                for k in 0..count {
                    (vectors[p][k], vectors[q][k]) =
                        (cos * vectors[p][k] - sin * vectors[q][k], sin * vectors[p][k] + cos * vectors[q][k]);
                }
            }
        }
    }
    ((0..count).map(|k| matrix[k][k]).collect(), vectors)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mobility::noise::{ParticleComponents, Stream};
    use std::convert::Infallible;

    /// The square of the root is the matrix.
    #[test]
    fn roots_are_roots() {
        const LIMITS: LanczosLimits = LanczosLimits { tolerance: 1e-12, iterations: 60 };
        let count = 7;
        let entry = |i: usize, j: usize| if i == j { 2.0 + i as f64 } else { 0.8 / (1.0 + i.abs_diff(j) as f64) };
        let apply = |x: &[ParticleComponents]| -> Result<Vec<ParticleComponents>, Infallible> {
            let flat = x.as_flattened();
            let product = |i: usize| (0..flat.len()).map(|j| entry(i, j) * flat[j]).sum::<f64>();
            let all: Vec<f64> = (0..flat.len()).map(product).collect();
            Ok(all.as_chunks::<11>().0.to_vec())
        };
        let stream = Stream::new(3, 1);
        let start: Vec<ParticleComponents> = (0..count).map(|id| stream.of_particle(id)).collect();
        let comm = Comm::alone();
        let Ok((once, drawn)) = square_root_times(&comm, &start, LIMITS, apply);
        let Ok((twice, _)) = square_root_times(&comm, &once, LIMITS, apply);
        let Ok(exact) = apply(&start);
        let error =
            twice.as_flattened().iter().zip(exact.as_flattened()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(error < 1e-8 && drawn.clipped == 0.0, "{error} after {}", drawn.iterations);
        let Ok((of_nothing, _)) = square_root_times(&comm, &vec![[0.0; 11]; 7], LIMITS, apply);
        assert_eq!(of_nothing, vec![[0.0; 11]; 7]);
        let Ok((_, cut)) = square_root_times(&comm, &start, LanczosLimits { iterations: 3, ..LIMITS }, apply);
        assert!(cut.iterations == 3 && cut.change > 1e-6 && drawn.change < 1e-11);
    }
}
