//! Random motions whose covariance is the mobility.

use crate::mobility::loads::{Motion, angular_velocity};
use domain::{Comm, Random, RandomLanes, Tensor, Traceless, Vector};
use solver::{Complexes, Draw, MODES};

/// Source of the random numbers of one draw: the same numbers for the same modes and particles, on any number of
/// ranks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stream {
    /// Seed of the draw.
    seed: u64,
}

/// Random motions to draw, for the particles with these ids.
pub(crate) struct NoiseRequest<'a> {
    pub ids: &'a [u64],
    /// Relative error allowed in square roots that are found by iteration.
    pub tolerance: f64,
    pub stream: Stream,
}

/// Kinds of random numbers: of the grid's modes, and of particles.
const OF_FIELD: u64 = 1;
const OF_NEAR: u64 = 2;

impl Stream {
    /// Numbers of a draw, such as a step, by a seed.
    pub fn new(seed: u64, draw: u64) -> Self {
        Self { seed: Random::new(seed, draw).bits() }
    }

    /// Generator for a kind of numbers and the name of a mode or particle.
    pub fn of(self, kind: u64, name: u64) -> Random {
        Random::new(self.seed_of(kind), name)
    }

    fn seed_of(self, kind: u64) -> u64 {
        self.seed ^ kind.wrapping_mul(0xa076_1d64_78bd_642f)
    }

    /// Seed of the numbers of the grid's modes.
    pub(crate) fn seed_of_field(self) -> u64 {
        self.seed_of(OF_FIELD)
    }

    /// Eleven normal numbers of a particle.
    pub(crate) fn of_particle(self, id: u64) -> ParticleComponents {
        let mut random = self.of(OF_NEAR, id);
        let mut numbers = ParticleComponents::default();
        for pair in numbers.chunks_mut(2) {
            let normal = random.normal();
            pair.copy_from_slice(&normal[..pair.len()]);
        }
        numbers
    }
}

/// Many modes add little each to any velocity, so uniform numbers do.
impl Draw for Stream {
    #[inline(always)]
    fn draw(&self, modes: &[[i64; 3]; MODES]) -> Complexes {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let names = modes.map(|mode| {
            let [x, y, z] = mode.map(|m| (m + (1 << 20)) as u64);
            x << 42 | y << 21 | z
        });
        let mut random = RandomLanes::new(self.seed_of(OF_FIELD), &names);
        std::array::from_fn(|_| std::array::from_fn(|_| random.uniform_unit_variance().map(|number| half * number)))
    }
}

/// Components of a particle's motion or loads: three of the velocity, three of the angular velocity, and five of the
/// rate of strain in an orthonormal basis.
pub(crate) type ParticleComponents = [f64; COMPONENTS];

/// Number of components of a motion with dipoles.
pub(crate) const COMPONENTS: usize = 11;

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

/// Square root of 1.5.
const AXIAL: f64 = 1.224_744_871_391_589;

/// Components of a traceless tensor in the orthonormal basis.
pub(crate) fn orthonormal(tensor: Traceless) -> [f64; 5] {
    let [xx, xy, xz, yy, yz] = tensor.0;
    let root = std::f64::consts::SQRT_2;
    [-AXIAL * (xx + yy), (xx - yy) / root, root * xy, root * xz, root * yz]
}

/// Traceless tensor from its components in the orthonormal basis.
pub(crate) fn tensor([axial, planar, xy, xz, yz]: [f64; 5]) -> Traceless {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let mean = -0.5 * axial / AXIAL;
    Traceless([mean + half * planar, half * xy, half * xz, mean - half * planar, half * yz])
}

/// Stopping criteria of [`square_root_times`].
#[derive(Debug, Clone, Copy)]
pub struct LanczosLimits {
    /// Tolerance relative to the norm of the result.
    pub tolerance: f64,
    /// Largest number of iterations.
    pub iterations: usize,
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
    LanczosLimits { tolerance, iterations: most }: LanczosLimits,
    mut apply: impl FnMut(&[[f64; N]]) -> Result<Vec<[f64; N]>, E>,
) -> Result<(Vec<[f64; N]>, DrawDiagnostics), E> {
    let dot = |a: &[[f64; N]], b: &[[f64; N]]| {
        let mut sum = [product(a.as_flattened(), b.as_flattened())];
        comm.sum(&mut sum);
        sum[0]
    };
    let length = dot(start, start).sqrt();
    if length == 0.0 {
        return Ok((start.to_vec(), DrawDiagnostics::default()));
    }
    let scaled = |vector: &[[f64; N]], factor: f64| -> Vec<[f64; N]> {
        vector.iter().map(|components| components.map(|c| c * factor)).collect()
    };
    let (mut basis, mut diagonal, mut beside) = (vec![scaled(start, 1.0 / length)], Vec::new(), Vec::<f64>::new());
    let mut before = Vec::new();
    loop {
        let last = basis.len() - 1;
        let mut next = apply(&basis[last])?;
        diagonal.push(dot(&basis[last], &next));
        // Orthogonalised twice against the whole basis, to remove round-off.
        for _ in 0..2 {
            for vector in &basis {
                let share = dot(vector, &next);
                subtract(&mut next, share, vector);
            }
        }
        let (coordinates, clipped) = first_column_of_root(&diagonal, &beside);
        let change: f64 =
            coordinates.iter().enumerate().map(|(k, c)| (c - before.get(k).unwrap_or(&0.0)).powi(2)).sum();
        let size: f64 = coordinates.iter().map(|c| c * c).sum();
        let rest = dot(&next, &next).sqrt();
        let is_near = last > 0 && change <= tolerance * tolerance * size;
        let is_whole = rest <= 1e-12 * diagonal[0].abs();
        if is_near || is_whole || basis.len() == most {
            let mut root = vec![[0.0; N]; start.len()];
            for (vector, coordinate) in basis.iter().zip(&coordinates) {
                subtract(&mut root, -coordinate * length, vector);
            }
            let change = if is_whole { 0.0 } else { (change / size).sqrt() };
            return Ok((root, DrawDiagnostics { iterations: basis.len(), clipped, change }));
        }
        before = coordinates;
        beside.push(rest);
        basis.push(scaled(&next, 1.0 / rest));
    }
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
    for (to, by) in from.as_flattened_mut().iter_mut().zip(vector.as_flattened()) {
        *to -= factor * by;
    }
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

/// Velocity, angular velocity and rate of strain as components, from a velocity and its gradient.
pub(crate) fn components(motion: &(Vector, Tensor)) -> ParticleComponents {
    let (velocity, gradient) = motion;
    let (rotation, strain) = (angular_velocity(gradient), orthonormal(Traceless::part_of(gradient)));
    let mut components = [0.0; COMPONENTS];
    components[..3].copy_from_slice(&velocity.to_array());
    components[3..6].copy_from_slice(&rotation.to_array());
    components[6..].copy_from_slice(&strain);
    components
}

/// Motion of particles from their components.
pub(crate) fn motion(components: impl Iterator<Item = ParticleComponents>) -> Motion {
    let mut motion = Motion::default();
    for [x, y, z, a, b, c, strain @ ..] in components {
        motion.velocities.push(Vector::new(x, y, z));
        motion.angular_velocities.push(Vector::new(a, b, c));
        motion.strain_rates.push(tensor(strain));
    }
    motion
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    #[test]
    fn the_basis_is_orthonormal() {
        for k in 0..5 {
            let mut unit = [0.0; 5];
            unit[k] = 1.0;
            let there = tensor(unit);
            assert!((there.contract(there) - 1.0).abs() < 1e-14);
            let back = orthonormal(there);
            assert!((0..5).all(|l| (back[l] - unit[l]).abs() < 1e-14), "{back:?}");
        }
    }

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
