//! Flow that a wall reflects from one sphere to another, or to itself, in the wavenumbers that are not on the grid.
//!
//! For a wavevector of length `k` along the wall at `z = 0`, with the direction `n` and `t = e_z x n`, the flow of a
//! wall (Blake 1971) is that of three waves, each with the amplitude of the source in it:
//!
//! ```text
//! -(phi_1 phi_1'^H + phi_2 phi_2'^H) / 4k - phi_3 phi_3'^H / 2k
//! phi_1 = (n (1 - x) - i e_z x) w,   phi_2 = (n x + i e_z (1 + x)) w,   phi_3 = t w
//! x = k z,   w = exp(i k n.r - k z)
//! ```
//!
//! and `w` and `x w` are biharmonic, so that an envelope of width `s` acts on them exactly as `1 + (s^2/2) lap`: `x`
//! becomes `k z - k^2 s^2`. Averaged over all directions `n`, the phase between two positions at a distance `r` along
//! the wall, under an angle `psi` to `n`, is `J_0(kr) + 2 sum_m i^m J_m(kr) cos(m psi)`; motions and loads of forces
//! and dipoles involve the terms up to `m = 4`.

use crate::plan::wavenumber_split::WavenumberSplit;
use crate::walls::bessel::{LANES, ORDERS, bessel};
use domain::{Tensor, Vector};
use simd::vectorised;
use std::f64::consts::{PI, SQRT_2, TAU};

/// Number of entries of a velocity and its gradient, or of a force and a dipole: columns `d_j u` and `G_j` one after
/// the other.
const ENTRIES: usize = 12;

/// The same in the frame of a wavevector: `u_n, d_n u_z, d_z u_n, u_z, d_n u_n = -d_z u_z, u_t, d_z u_t, d_n u_t`.
const LOCAL: usize = 8;

/// Whether each of these is imaginary.
const IMAGINARY: [bool; LOCAL] = [false, false, false, true, true, false, false, true];

/// Half the number of directions that resolve the angular dependence of the Bessel functions.
const DIRECTIONS: usize = 5;

/// Sums over wavenumbers of the products of the waves at two spheres: with even Bessel functions, or with odd ones.
type WaveSums = [[[f64; LOCAL]; LOCAL]; TERMS];

/// Three waves at a sphere.
type Waves = [[f64; LOCAL]; 3];

const TERMS: usize = 3;

/// A sphere as seen from its wall: its distance, and the squared widths of its envelopes of force and dipole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SourceAtWall {
    pub distance: f64,
    pub squares: [f64; 2],
}

/// Loads of a sphere that a block is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum WallLoad {
    /// A force and a dipole.
    ForceAndDipole,
    /// A degenerate quadrupole in place of the force, and no dipole. It acts on a flow as twice the derivative with
    /// respect to the squared width of an envelope of force, and so as `lap`.
    Quadrupole,
}

/// Matrix from the force and dipole of one sphere to the velocity and its gradient of another, for viscosity 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct WallMobilityBlock([[f64; ENTRIES]; ENTRIES]);

/// Equally spaced wavenumbers with their weights, and half of the directions along the wall.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct WallKernel {
    first: f64,
    step: f64,
    weights: Vec<[f64; LANES]>,
    directions: [[f64; 2]; DIRECTIONS],
}

/// Bound of the number of wavenumbers, beyond any split.
const MOST: i32 = 1_000_000;

impl WallKernel {
    fn with(first: f64, step: f64, weights: &[f64]) -> Self {
        let direction = |number: usize| PI * number as f64 / DIRECTIONS as f64;
        let directions = std::array::from_fn(|number| [direction(number).cos(), direction(number).sin()]);
        let of_lanes = |some: &[f64]| {
            let mut lanes = [0.0; LANES];
            lanes[..some.len()].copy_from_slice(some);
            lanes
        };
        Self { first, step, weights: weights.chunks(LANES).map(of_lanes).collect(), directions }
    }

    /// Wavenumbers that a split leaves to spheres within a cutoff, whose distances from the wall add up to at least
    /// `closest`, to an error relative to the mobility of a sphere of radius 1.
    ///
    /// A sum over equally spaced wavenumbers is the integral up to periodic copies at multiples of `2 pi` over the
    /// step: these are beyond the cutoff. The highest wavenumber of the grid is the end of a step.
    pub fn new(cut: &WavenumberSplit, cutoff: f64, closest: f64, error: f64) -> Self {
        // A sharp split leaves only images of spheres in themselves, but their weights begin with a jump.
        let finer = if cut.is_sharp() { 4.0 } else { 1.0 };
        let step = cut.grid_cutoff / (finer * cut.grid_cutoff * cutoff / PI).ceil();
        let wavenumber = |number: i32| step * (f64::from(number) + 0.5);
        let weight = |number: i32| step * cut.image_fraction(wavenumber(number)) / TAU;
        let size = |number: i32, power: i32| weight(number) * 6.0 * PI * (1.0 + wavenumber(number).powi(power));
        let begins = (0..MOST).find(|&number| size(number, 2) > 0.1 * error).expect("weights grow to one");
        let decays = |&number: &i32| {
            wavenumber(number) > cut.grid_cutoff && size(number, 4) * (-wavenumber(number) * closest).exp() < error
        };
        let ends = (begins..MOST).find(decays).expect("an exponential decays");
        Self::with(wavenumber(begins), step, &(begins..ends).map(weight).collect::<Vec<_>>())
    }

    /// Flow from the second sphere to the first, which is at `x` from it, by a wall below both.
    pub fn block(&self, x: Vector, spheres: [SourceAtWall; 2]) -> WallMobilityBlock {
        self.block_of(WallLoad::ForceAndDipole, x, spheres)
    }

    /// The same by given loads of the second sphere.
    pub fn block_of(&self, load: WallLoad, x: Vector, spheres: [SourceAtWall; 2]) -> WallMobilityBlock {
        let distance = x.x.hypot(x.y);
        let mut sums = [[[0.0; LOCAL]; LOCAL]; TERMS];
        let mut block = [[0.0; ENTRIES]; ENTRIES];
        vectorised(
            #[inline(always)]
            || {
                let heights = spheres[0].distance + spheres[1].distance;
                let (mut k, mut decay, ratio) =
                    (self.first, (-self.first * heights).exp(), (-self.step * heights).exp());
                for weights in &self.weights {
                    let bessel = bessel([k * distance, self.step * distance]);
                    for lane in 0..LANES {
                        let factors = bessel.map(|of_order| 0.25 * weights[lane] * decay * of_order[lane]);
                        let to = waves(k, spheres[0]);
                        let from = match load {
                            WallLoad::ForceAndDipole => waves(k, spheres[1]),
                            WallLoad::Quadrupole => waves_of_quadrupole(k),
                        };
                        add_wavenumber(factors, [&to, &from], &mut sums);
                        k += self.step;
                        decay *= ratio;
                    }
                }
                for n in self.directions {
                    let cosine = if distance > 0.0 { (n[0] * x.x + n[1] * x.y) / distance } else { 0.0 };
                    add_direction(n, cosine, &sums, &mut block);
                }
            },
        );
        WallMobilityBlock(block)
    }
}

/// The three waves at a sphere, in their frame, without the factor `exp(-k z)`.
#[inline(always)]
fn waves(k: f64, SourceAtWall { distance, squares }: SourceAtWall) -> Waves {
    let [x, y] = squares.map(|square| k * distance - k * k * square);
    [
        [1.0 - x, k * y, k * (y - 2.0), -x, k * (1.0 - y), 0.0, 0.0, 0.0],
        [x, -k * (1.0 + y), k * (1.0 - y), 1.0 + x, k * y, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.0, SQRT_2, -SQRT_2 * k, SQRT_2 * k],
    ]
}

/// The Laplacian of the three waves, without the factor `exp(-k z)`.
#[inline(always)]
fn waves_of_quadrupole(k: f64) -> Waves {
    let [lap, zero] = [2.0 * k * k, 0.0];
    [[lap, zero, zero, lap, zero, zero, zero, zero], [-lap, zero, zero, -lap, zero, zero, zero, zero], [zero; LOCAL]]
}

/// Adds the products of the waves of one wavenumber at two spheres, times each Bessel function.
#[inline(always)]
fn add_wavenumber(factors: [f64; ORDERS], [to, from]: [&Waves; 2], sums: &mut WaveSums) {
    // Even orders where both or neither are imaginary, odd ones elsewhere.
    let factor = |term: usize, odd: bool| {
        if odd { factors.get(2 * term + 1).copied().unwrap_or(0.0) } else { factors[2 * term] }
    };
    let mut of_row = [[[0.0; LOCAL]; TERMS]; 2];
    for (row, terms) in of_row.iter_mut().enumerate() {
        for term in 0..TERMS {
            for j in 0..LOCAL {
                terms[term][j] = factor(term, IMAGINARY[j] != (row == 1));
            }
        }
    }
    for i in 0..LOCAL {
        let mut product = [0.0; LOCAL];
        for wave in 0..3 {
            for j in 0..LOCAL {
                product[j] = to[wave][i].mul_add(from[wave][j], product[j]);
            }
        }
        for term in 0..TERMS {
            for j in 0..LOCAL {
                sums[term][i][j] = of_row[usize::from(IMAGINARY[i])][term][j].mul_add(product[j], sums[term][i][j]);
            }
        }
    }
}

/// Adds a direction's part of the mean over all, whose opposite has the complex conjugate, by the cosine of its angle
/// to the vector from the second sphere to the first.
#[inline(always)]
fn add_direction(n: [f64; 2], cosine: f64, sums: &WaveSums, block: &mut [[f64; ENTRIES]; ENTRIES]) {
    let double = 2.0 * cosine * cosine - 1.0;
    let (first, second) = (2.0 * cosine, 2.0 * double);
    let (third, fourth) = (first * (second - 1.0), second * second - 2.0);
    // From the loads to the frame of the wavevector, and from there to motions.
    let mut rows = [[0.0; ENTRIES]; LOCAL];
    for i in 0..LOCAL {
        let mut row = [0.0; LOCAL];
        for j in 0..LOCAL {
            let [s0, s1, s2] = [sums[0][i][j], sums[1][i][j], sums[2][i][j]];
            row[j] = match (IMAGINARY[i], IMAGINARY[j]) {
                (true, false) => third * s1 - first * s0,
                (false, true) => first * s0 - third * s1,
                _ => s0 - second * s1 + fourth * s2,
            };
        }
        rows[i] = in_space(n, row);
    }
    for load in 0..ENTRIES {
        // The image flow opposes the load. For a dipole it is the derivative with respect to the position of the
        // source, which adds another sign.
        let sign = if load < 3 { -1.0 } else { 1.0 } / DIRECTIONS as f64;
        let mut column = [0.0; LOCAL];
        for i in 0..LOCAL {
            column[i] = rows[i][load];
        }
        let column = in_space(n, column);
        for entry in 0..ENTRIES {
            block[entry][load] += sign * column[entry];
        }
    }
}

/// From the frame of a wavevector's direction to Cartesian components.
#[inline(always)]
fn in_space([c, s]: [f64; 2], [un, zn, nz, uz, nn, ut, tz, tn]: [f64; LOCAL]) -> [f64; ENTRIES] {
    let turned = |n: f64, t: f64| [c * n - s * t, s * n + c * t];
    let ([ux, uy], [dx, dy], [xz, yz]) = (turned(un, ut), turned(nn, tn), turned(nz, tz));
    [ux, uy, uz, c * dx, c * dy, c * zn, s * dx, s * dy, s * zn, xz, yz, -nn]
}

/// Whether a reflection in a plane parallel to the walls changes the sign of a component.
fn is_turned(entry: usize) -> bool {
    let (along_z, derivative_z) = (entry % 3 == 2, entry >= 9);
    along_z != derivative_z
}

impl WallMobilityBlock {
    /// The matrix by rows, gradients and dipoles column by column.
    pub fn entries(&self) -> [[f64; ENTRIES]; ENTRIES] {
        self.0
    }

    /// The same for a wall above both.
    #[must_use]
    pub fn reflected(mut self) -> Self {
        for (i, row) in self.0.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                if is_turned(i) != is_turned(j) {
                    *entry = -*entry;
                }
            }
        }
        self
    }

    /// Velocity and gradient `D_ij = d_j u_i` by a force and a dipole.
    #[inline(always)]
    pub fn motion(&self, force: Vector, dipole: &Tensor) -> (Vector, Tensor) {
        let mut motion = [0.0; ENTRIES];
        for (row, entry) in self.0.iter().zip(&mut motion) {
            for (m, load) in row.iter().zip(load(force, dipole)) {
                *entry = m.mul_add(load, *entry);
            }
        }
        let [x, y, z, gradient @ ..] = motion;
        (Vector::new(x, y, z), Tensor::from_cols_array(&gradient))
    }

    /// The same for the flow from the first of the two spheres to the second: gradients and loads of dipoles have the
    /// opposite sign.
    #[inline(always)]
    pub fn motion_of_second(&self, force: Vector, dipole: &Tensor) -> (Vector, Tensor) {
        let mut motion = [0.0; ENTRIES];
        for (row, load) in self.0.iter().zip(load(force, &-*dipole)) {
            for (entry, m) in motion.iter_mut().zip(row) {
                *entry = m.mul_add(load, *entry);
            }
        }
        let [x, y, z, gradient @ ..] = motion;
        (Vector::new(x, y, z), -Tensor::from_cols_array(&gradient))
    }

    /// Approximate upper bound of the block, as a fraction of the mobility of an isolated sphere of this radius.
    pub fn share(&self, radius: f64) -> f64 {
        let most = |entries: std::ops::Range<usize>| entries.map(|i| self.0[i][i].abs()).fold(0.0, f64::max);
        (most(0..3) * 3.0 * TAU * radius).max(most(3..ENTRIES) * 4.0 * TAU * radius.powi(3))
    }
}

/// A force and a dipole as a list of entries.
#[inline(always)]
fn load(force: Vector, dipole: &Tensor) -> [f64; ENTRIES] {
    let mut load = [0.0; ENTRIES];
    load[..3].copy_from_slice(&force.to_array());
    load[3..].copy_from_slice(&dipole.to_cols_array());
    load
}

impl std::ops::AddAssign for WallMobilityBlock {
    fn add_assign(&mut self, other: Self) {
        for (row, other) in self.0.iter_mut().zip(&other.0) {
            for (entry, other) in row.iter_mut().zip(other) {
                *entry += other;
            }
        }
    }
}

#[cfg(test)]
mod tests;
