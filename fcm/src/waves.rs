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

use crate::bessel::{LANES, ORDERS, bessel};
use crate::wall_cut::WallCut;
use domain::{Tensor, Vector};
use solver::simd::vectorised;
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
type Sums = [[[f64; LOCAL]; LOCAL]; TERMS];
const TERMS: usize = 3;

/// A sphere as seen from its wall: its distance, and the squared widths of its envelopes of force and dipole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Seen {
    pub distance: f64,
    pub squares: [f64; 2],
}

/// Matrix from the force and dipole of one sphere to the velocity and its gradient of another, for viscosity 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Block([[f64; ENTRIES]; ENTRIES]);

/// Equally spaced wavenumbers with their weights, and half of the directions along the wall.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Waves {
    first: f64,
    step: f64,
    weights: Vec<[f64; LANES]>,
    directions: [[f64; 2]; DIRECTIONS],
}

/// Bound of the number of wavenumbers, beyond any split.
const MOST: i32 = 1_000_000;

impl Waves {
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
    pub fn new(cut: &WallCut, cutoff: f64, closest: f64, error: f64) -> Self {
        // A sharp split leaves only images of spheres in themselves, but their weights begin with a jump.
        let finer = if cut.is_sharp() { 4.0 } else { 1.0 };
        let step = cut.highest / (finer * cut.highest * cutoff / PI).ceil();
        let wavenumber = |number: i32| step * (f64::from(number) + 0.5);
        let weight = |number: i32| step * cut.between_spheres(wavenumber(number)) / TAU;
        let size = |number: i32, power: i32| weight(number) * 6.0 * PI * (1.0 + wavenumber(number).powi(power));
        let begins = (0..MOST).find(|&number| size(number, 2) > 0.1 * error).expect("weights grow to one");
        let decays = |&number: &i32| {
            wavenumber(number) > cut.highest && size(number, 4) * (-wavenumber(number) * closest).exp() < error
        };
        let ends = (begins..MOST).find(decays).expect("an exponential decays");
        Self::with(wavenumber(begins), step, &(begins..ends).map(weight).collect::<Vec<_>>())
    }

    /// Flow from the second sphere to the first, which is at `x` from it, by a wall below both.
    pub fn block(&self, x: Vector, spheres: [Seen; 2]) -> Block {
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
                        add_wavenumber(k, factors, &spheres, &mut sums);
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
        Block(block)
    }
}

/// The three waves at a sphere, in their frame, without the factor `exp(-k z)`.
#[inline(always)]
fn waves(k: f64, Seen { distance, squares }: Seen) -> [[f64; LOCAL]; 3] {
    let [x, y] = squares.map(|square| k * distance - k * k * square);
    [
        [1.0 - x, k * y, k * (y - 2.0), -x, k * (1.0 - y), 0.0, 0.0, 0.0],
        [x, -k * (1.0 + y), k * (1.0 - y), 1.0 + x, k * y, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.0, SQRT_2, -SQRT_2 * k, SQRT_2 * k],
    ]
}

/// Adds the products of the waves of one wavenumber at two spheres, times each Bessel function.
#[inline(always)]
fn add_wavenumber(k: f64, factors: [f64; ORDERS], [first, second]: &[Seen; 2], sums: &mut Sums) {
    let (to, from) = (waves(k, *first), waves(k, *second));
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
fn add_direction(n: [f64; 2], cosine: f64, sums: &Sums, block: &mut [[f64; ENTRIES]; ENTRIES]) {
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

impl Block {
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

impl std::ops::AddAssign for Block {
    fn add_assign(&mut self, other: Self) {
        for (row, other) in self.0.iter_mut().zip(&other.0) {
            for (entry, other) in row.iter_mut().zip(other) {
                *entry += other;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envelope::Envelope;
    use num_complex::Complex;

    type Wave = [Complex<f64>; 3];

    fn seen(distance: f64, radius: f64) -> Seen {
        let Envelope { monopole, dipole } = Envelope::of_sphere(radius);
        Seen { distance, squares: [monopole * monopole, dipole * dipole] }
    }

    /// All wavenumbers from nearly zero on, in steps that are exact for spheres within 30 radii.
    fn all() -> Waves {
        Waves::with(0.0025, 0.005, &vec![0.005 / TAU; 4000])
    }

    /// Waves of a wavevector at the height `z`, without envelopes.
    fn at_height(k: f64, angle: f64, z: f64) -> [Wave; 3] {
        let (n, e, x) = ([angle.cos(), angle.sin()], (-k * z).exp(), k * z);
        let wave = |along: f64, across: f64, up: f64| {
            let plane = [n[0] * along - n[1] * across, n[1] * along + n[0] * across];
            [Complex::new(plane[0] * e, 0.0), Complex::new(plane[1] * e, 0.0), Complex::new(0.0, up * e)]
        };
        [wave(1.0 - x, 0.0, -x), wave(x, 0.0, 1.0 + x), wave(0.0, 1.0, 0.0)]
    }

    /// Velocity and gradient, by columns, of the waves with a sphere's envelopes: derivatives along z by finite
    /// differences.
    fn of_sphere(k: f64, angle: f64, Seen { distance, squares: [s, d] }: Seen) -> [[Complex<f64>; ENTRIES]; 3] {
        let h = 4e-3;
        let values = [-3, -2, -1, 0, 1, 2, 3].map(|step: i32| at_height(k, angle, distance + f64::from(step) * h));
        std::array::from_fn(|wave| {
            let value = |c: usize, step: i32| values[(step + 3) as usize][wave][c];
            let sum = |c: usize, weights: [f64; 7]| -> Complex<f64> {
                (-3..=3).zip(weights).map(|(step, weight)| value(c, step) * weight).sum()
            };
            let first = |c: usize| sum(c, [-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0].map(|w| w / (60.0 * h)));
            let second = |c: usize| sum(c, [2.0, -27.0, 270.0, -490.0, 270.0, -27.0, 2.0].map(|w| w / (180.0 * h * h)));
            let third = |c: usize| sum(c, [1.0, -8.0, 13.0, 0.0, -13.0, 8.0, -1.0].map(|w| w / (8.0 * h * h * h)));
            let mut motion = [Complex::default(); ENTRIES];
            for c in 0..3 {
                let smooth = |width: f64| value(c, 0) + 0.5 * width * (second(c) - k * k * value(c, 0));
                motion[c] = smooth(s);
                for (j, part) in [angle.cos(), angle.sin()].into_iter().enumerate() {
                    motion[3 + 3 * j + c] = Complex::new(0.0, k * part) * smooth(d);
                }
                motion[9 + c] = first(c) + 0.5 * d * (third(c) - k * k * first(c));
            }
            motion
        })
    }

    /// By waves in many directions, with derivatives by differences of sixth order, the third one of fourth: accurate
    /// to about 1e-7 for waves a hundred times longer than the step of the differences.
    #[test]
    fn blocks_are_sums_over_plane_waves() {
        let nodes = [(1.3, 0.7), (2.1, 0.4), (2.9, 0.9)];
        for (x, spheres) in [
            (Vector::new(1.7, -2.3, 0.4), [seen(1.1, 1.0), seen(1.9, 1.5)]),
            (Vector::new(-0.3, 0.2, 0.0), [seen(1.2, 1.0), seen(1.0, 1.0)]),
            (Vector::ZERO, [seen(1.3, 1.2); 2]),
        ] {
            let mut expected = [[0.0; ENTRIES]; ENTRIES];
            let directions = 64;
            for (k, weight) in &nodes {
                for direction in 0..directions {
                    let angle = TAU * f64::from(direction) / f64::from(directions);
                    let phase = Complex::cis(k * (x.x * angle.cos() + x.y * angle.sin()));
                    let [to, from] = spheres.map(|sphere| of_sphere(*k, angle, sphere));
                    for (wave, factor) in [0.25, 0.25, 0.5].into_iter().enumerate() {
                        for (row, a) in expected.iter_mut().zip(to[wave]) {
                            for (load, (entry, b)) in row.iter_mut().zip(from[wave]).enumerate() {
                                let sign = if load < 3 { -1.0 } else { 1.0 };
                                *entry += sign * weight * factor / f64::from(directions) * (a * b.conj() * phase).re;
                            }
                        }
                    }
                }
            }
            let Block(found) = Waves::with(1.3, 0.8, &nodes.map(|node| node.1)).block(x, spheres);
            let largest = expected.as_flattened().iter().fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
            for (i, j) in (0..ENTRIES).flat_map(|i| (0..ENTRIES).map(move |j| (i, j))) {
                let (f, e) = (found[i][j], expected[i][j]);
                assert!((f - e).abs() < 1e-6 * largest, "{i} {j} at {x}: {f}, not {e}");
            }
        }
    }

    /// Blake's image of a point force, for spheres of zero width: across the wall, and along it.
    #[test]
    fn all_wavenumbers_make_the_image_of_a_point() {
        let point = |distance: f64| Seen { distance, squares: [0.0; 2] };
        for (x, heights) in [(Vector::new(3.0, 0.0, 0.0), [1.2, 2.1]), (Vector::ZERO, [1.4, 0.9])] {
            let Block(found) = all().block(x, heights.map(point));
            let [z, source] = heights;
            let (sum, across) = (z + source, x.x);
            let r = across.hypot(sum);
            // Opposite Stokeslet, twice a source doublet and a Stokeslet doublet (Blake 1971).
            let axial =
                -(1.0 / r + sum * sum / r.powi(3)) + 2.0 * source * z * (1.0 / r.powi(3) - 3.0 * sum * sum / r.powi(5));
            let expected = axial / (8.0 * PI);
            assert!((found[2][2] - expected).abs() < 1e-6, "{} {expected}", found[2][2]);
            let along = -(1.0 / r + across * across / r.powi(3))
                - 2.0 * source * z * (1.0 / r.powi(3) - 3.0 * across * across / r.powi(5));
            assert!((found[0][0] - along / (8.0 * PI)).abs() < 1e-6, "{} {}", found[0][0], along / (8.0 * PI));
        }
    }

    /// The flow from the first to the second is that from the second to the first, and no load gains power from its
    /// own image.
    #[test]
    fn blocks_are_symmetric_and_take_mobility_away() {
        let (x, spheres) = (Vector::new(1.2, 0.9, 0.0), [seen(1.1, 1.0), seen(1.4, 1.3)]);
        let waves = Waves::with(1.0, 0.4, &[0.1; 20]);
        let sign = |load: usize| if load < 3 { 1.0 } else { -1.0 };
        for reflect in [false, true] {
            let of = |block: Block| if reflect { block.reflected().0 } else { block.0 };
            let (there, back) = (of(waves.block(x, spheres)), of(waves.block(-x, [spheres[1], spheres[0]])));
            for (i, j) in (0..ENTRIES).flat_map(|i| (0..ENTRIES).map(move |j| (i, j))) {
                let difference = there[i][j] * sign(j) - back[j][i] * sign(i);
                assert!(difference.abs() < 1e-12, "{i} {j}: {difference:e}");
            }
            let force = Vector::new(0.3, -0.2, 0.9);
            let dipole = Tensor::from_cols_array(&[0.1, 0.4, -0.7, 1.1, 0.5, 0.2, 0.9, -1.3, -0.6]);
            let ((u, d), (v, g)) = (Block(there).motion_of_second(force, &dipole), Block(back).motion(force, &dipole));
            assert!((u - v).length() < 1e-12 && (d - g).to_cols_array().iter().all(|entry| entry.abs() < 1e-12));
            let own = of(waves.block(Vector::ZERO, [spheres[0]; 2]));
            for load in 0..50 {
                let load: [f64; ENTRIES] = std::array::from_fn(|i| {
                    let number = (load * ENTRIES + i) as f64;
                    (number * 1.7).sin() * (1.0 + number).cos()
                });
                let entries = (0..ENTRIES).flat_map(|i| (0..ENTRIES).map(move |j| (i, j)));
                let power: f64 = entries.map(|(i, j)| load[i] * own[i][j] * sign(j) * load[j]).sum();
                assert!(power < 0.0, "{power}");
            }
        }
    }
}
