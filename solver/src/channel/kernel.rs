//! Wall part of a channel's Stokes kernel, for one wavevector in the plane of the walls.

/// Number of functions of z by the two walls: `b0 = exp(-k z)`, `b1 = k z b0`, and `t0`, `t1` the same of the
/// distance `H - z`.
pub(crate) const FUNCTIONS: usize = 4;

/// Coefficients of the functions for the component along the wavevector, then for the one along z.
pub(crate) type FunctionCoefficients = [f64; 2 * FUNCTIONS];

/// Kernel `K(z, z') = sum_pq K_pq f_p(z) f_q(z')`. It maps the forces at `z'` along the wavevector and, over `i`,
/// along z to the velocities at `z`; and the force normal to both, in `b0` and `t0` alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ChannelKernel {
    pub along: [FunctionCoefficients; 2 * FUNCTIONS],
    pub across: [[f64; 2]; 2],
}

/// Walls of a channel, and the period of the grid around them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Faces {
    /// Number of walls: 0, 1 at `z = 0`, or 2 with the other at `z = height`.
    pub walls: usize,
    /// Position of the second wall, or any reference position for its functions.
    pub height: f64,
    /// Period of the grid along z.
    pub period: f64,
}

impl Faces {
    /// Kernel between the walls minus that of the grid, for `k > 0` and viscosity 1.
    ///
    /// With `e = exp(-k |zeta|)`, `zeta = z - z'`, and z-components over `i`, unbounded fluid has
    ///
    /// ```text
    /// G = 1/(4k) [ 1 - k|zeta|    k zeta    ] e,      G_across = e / 2k.
    ///            [  -k zeta    1 + k|zeta|  ]
    /// ```
    ///
    /// Tractions on the walls that enforce no slip there add `-P C P^T`, where `P` is the flow of unit tractions and
    /// `C` the inverse of `G` among the walls: the Schur complement. The grid has `sum_m G(zeta + m period)` instead
    /// of `G`; the excess is in the span of the same functions.
    pub fn kernel(&self, k: f64) -> ChannelKernel {
        let mut kernel = of_walls(k, self.walls, self.height);
        self.without_copies(k, &mut kernel);
        kernel
    }

    /// Subtracts the flow of the grid's periodic copies, by sums over `m` of `e` and of `m e`.
    fn without_copies(&self, k: f64, kernel: &mut ChannelKernel) {
        let (length, height) = (k * self.period, k * self.height);
        let less = -(-length).exp_m1();
        let level = (height - length).exp() / less;
        let rise = length * level / less - height * level;
        let quarter = 0.25 / k;
        for (a, b, constant, slope) in [(0, 0, 1.0, -1.0), (1, 1, 1.0, 1.0), (0, 1, 0.0, 1.0), (1, 0, 0.0, -1.0)] {
            let (zeroth, first) = (quarter * (constant * level + slope * rise), quarter * slope * level);
            for (p, q, term) in [(0, 2, zeroth), (1, 2, first), (0, 3, first)] {
                let (row, column) = (a * FUNCTIONS + p, b * FUNCTIONS + q);
                kernel.along[row][column] -= term;
                kernel.along[column][row] -= term;
            }
        }
        kernel.across[0][1] -= 0.5 / k * level;
        kernel.across[1][0] -= 0.5 / k * level;
    }
}

/// Wall correction to the kernel of unbounded fluid, for `k > 0` and viscosity 1.
fn of_walls(k: f64, walls: usize, height: f64) -> ChannelKernel {
    let mut kernel = ChannelKernel { along: [[0.0; 2 * FUNCTIONS]; 2 * FUNCTIONS], across: [[0.0; 2]; 2] };
    match walls {
        0 => {}
        1 => one_wall(k, &mut kernel),
        _ => two_walls(k, k * height, &mut kernel),
    }
    kernel
}

/// Correction by walls to the normal velocity at `z` of a unit normal force at `z'`, both in a wave along the walls
/// of wavenumber `k > 0`, for viscosity 1. With the entries `K_pq` it is `sum_pq K_pq f_p(z) f_q(z')` in the
/// functions `exp(-k z)`, `k z exp(-k z)` and the same of the distance `height - z`.
pub fn across_walls(walls: usize, height: f64, k: f64) -> [[f64; FUNCTIONS]; FUNCTIONS] {
    let ChannelKernel { along, .. } = of_walls(k, walls, height);
    std::array::from_fn(|p| std::array::from_fn(|q| along[FUNCTIONS + p][FUNCTIONS + q]))
}

/// Flow of unit tractions along the wavevector and along z, times `4k`: of the lower wall, then of the upper.
const DRIVEN: [[FunctionCoefficients; 2]; 2] = [
    [[1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0]],
    [[0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 1.0, 1.0]],
];

/// Adds `factor v w^T`.
fn add(kernel: &mut ChannelKernel, factor: f64, v: &FunctionCoefficients, w: &FunctionCoefficients) {
    for (row, v) in kernel.along.iter_mut().zip(v) {
        for (entry, w) in row.iter_mut().zip(w) {
            *entry += factor * v * w;
        }
    }
}

fn one_wall(k: f64, kernel: &mut ChannelKernel) {
    for driven in &DRIVEN[0] {
        add(kernel, -0.25 / k, driven, driven);
    }
    kernel.across[0][0] = -0.5 / k;
}

/// Tractions on both walls that are symmetric (`sign = 1`) or antisymmetric under reflection decouple.
fn two_walls(k: f64, height: f64, kernel: &mut ChannelKernel) {
    let e = (-height).exp();
    for sign in [1.0, -1.0] {
        let [below, above] = DRIVEN;
        let combined = |of: usize, sign: f64| std::array::from_fn(|p| below[of][p] + sign * above[of][p]);
        let (along, normal): (FunctionCoefficients, FunctionCoefficients) = (combined(0, sign), combined(1, -sign));
        // [[first, mixed], [mixed, second]] is G among such walls times 4k.
        let (rest, mixed) = (-(-height).exp_m1(), sign * height * e);
        let [first, second] = if sign > 0.0 {
            [1.0 + (1.0 - height) * e, rest - height * e]
        } else {
            [rest + height * e, 1.0 + (1.0 + height) * e]
        };
        let factor = -0.125 / (k * determinant(height, sign));
        add(kernel, factor * second, &along, &along);
        add(kernel, factor * first, &normal, &normal);
        add(kernel, -factor * mixed, &along, &normal);
        add(kernel, -factor * mixed, &normal, &along);
        let across = -0.25 / (k * if sign > 0.0 { 1.0 + e } else { -(-height).exp_m1() });
        for (row, w) in kernel.across.iter_mut().zip([1.0, sign]) {
            row[0] += across * w;
            row[1] += across * w * sign;
        }
    }
}

/// `1 - 2 sign x e - e^2` with `e = exp(-x)`; for a positive sign and small `x` it is `x^3/3`.
fn determinant(x: f64, sign: f64) -> f64 {
    let e = (-x).exp();
    if sign < 0.0 || x > 0.5 {
        return -(-2.0 * x).exp_m1() - 2.0 * sign * x * e;
    }
    // 2 e (sinh x - x)
    let (mut term, mut sum, mut n) = (x * x * x / 6.0, 0.0, 3.0);
    while term > 1e-18 * sum {
        sum += term;
        n += 2.0;
        term *= x * x / (n * (n - 1.0));
    }
    2.0 * e * sum
}

/// Kernel of the mean force over the plane, which drives a flow along it: between the walls minus that of the grid,
/// in the functions 1, `z` and `z^2`. It is `-|zeta|/2` plus a linear function, minus
/// `-|zeta|/2 + zeta^2/(2 period) + period/12`.
///
/// Without walls the fluid is taken to be at rest at a distance of half a height from a force, so that the kernel is
/// positive definite.
pub(crate) fn mean_kernel(faces: &Faces) -> [[f64; 3]; 3] {
    let Faces { walls, height, period } = *faces;
    let mut kernel = [[0.0; 3]; 3];
    if walls == 0 {
        kernel[0][0] = 0.5 * height;
    } else {
        (kernel[0][1], kernel[1][0]) = (0.5, 0.5);
    }
    if walls == 2 {
        kernel[1][1] = -1.0 / height;
    }
    kernel[0][0] -= period / 12.0;
    kernel[0][2] -= 0.5 / period;
    kernel[2][0] -= 0.5 / period;
    kernel[1][1] += 1.0 / period;
    kernel
}

#[cfg(test)]
mod tests {
    use super::*;

    fn functions(k: f64, z: f64, height: f64) -> [f64; FUNCTIONS] {
        let (b, t) = ((-k * z).exp(), (-k * (height - z)).exp());
        [b, k * z * b, t, k * (height - z) * t]
    }

    /// Kernel of unbounded fluid with the grid's periodic copies, by components.
    fn grid(k: f64, zeta: f64, period: f64) -> [[f64; 3]; 3] {
        let mut sum = [[0.0; 3]; 3];
        for copy in -400..=400 {
            let x = k * (zeta + f64::from(copy) * period);
            let e = (-x.abs()).exp() / (4.0 * k);
            sum[0][0] += (1.0 - x.abs()) * e;
            sum[1][1] += (1.0 + x.abs()) * e;
            sum[0][1] += x * e;
            sum[1][0] -= x * e;
            sum[2][2] += 2.0 * e;
        }
        sum
    }

    fn total(faces: &Faces, k: f64, z: f64, source: f64) -> [[f64; 3]; 3] {
        let (kernel, mut sum) = (faces.kernel(k), grid(k, z - source, faces.period));
        let [at, from] = [z, source].map(|z| functions(k, z, faces.height));
        for (a, b) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            for (p, q) in (0..FUNCTIONS).flat_map(|p| (0..FUNCTIONS).map(move |q| (p, q))) {
                sum[a][b] += kernel.along[a * FUNCTIONS + p][b * FUNCTIONS + q] * at[p] * from[q];
            }
        }
        for (p, q) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            sum[2][2] += kernel.across[p][q] * at[2 * p] * from[2 * q];
        }
        sum
    }

    #[test]
    fn the_fluid_rests_on_the_walls() {
        for walls in [1, 2] {
            for k in [0.02_f64, 0.3, 1.0, 7.0, 200.0] {
                let faces = Faces { walls, height: 4.0, period: 5.5 };
                let size = 1.0 / k;
                for z in [0.0, 4.0].into_iter().take(walls) {
                    for source in [0.3, 1.9, 3.8] {
                        // Entries of the kernel are larger than their sum by up to 1/(k height)^3.
                        let round_off = 1e-15 * size * (1.0 + 10.0 / (k * 4.0).powi(3));
                        for entry in total(&faces, k, z, source).as_flattened() {
                            assert!(entry.abs() < round_off, "{entry} at {z}, k = {k}, {walls} walls");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn without_walls_the_copies_vanish() {
        let faces = Faces { walls: 0, height: 4.0, period: 5.5 };
        for k in [0.3, 2.0] {
            for (z, source) in [(0.1, 3.7), (3.0, 2.0), (2.0, 2.0)] {
                let (found, free) = (total(&faces, k, z, source), grid(k, z - source, 1e9));
                for (found, free) in found.as_flattened().iter().zip(free.as_flattened()) {
                    assert!((found - free).abs() < 1e-14 / k, "{found} is not {free}");
                }
            }
        }
    }

    #[test]
    fn a_far_wall_is_none_and_one_wall_is_blake_s() {
        let (k, z, source) = (0.8, 0.7, 1.1);
        let near = total(&Faces { walls: 1, height: 3.0, period: 4.0 }, k, z, source);
        let far = total(&Faces { walls: 2, height: 60.0, period: 61.0 }, k, z, source);
        for (near, far) in near.as_flattened().iter().zip(far.as_flattened()) {
            assert!((near - far).abs() < 1e-14, "{near} is not {far}");
        }
        // Blake (1971) in Fourier space, with the z-components over i.
        let (sum, product) = (k * (z + source), 2.0 * k * k * z * source);
        let e = (-sum).exp() / (4.0 * k);
        let image =
            [[1.0 - sum + product, k * (z - source) + product], [k * (source - z) + product, 1.0 + sum + product]];
        let free = grid(k, z - source, 1e9);
        for (a, b) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let expected = free[a][b] - e * image[a][b];
            assert!((near[a][b] - expected).abs() < 1e-14, "{a}{b}: {} is not {expected}", near[a][b]);
        }
        assert!((near[2][2] - free[2][2] + 2.0 * e).abs() < 1e-14);
    }

    #[test]
    fn the_kernel_is_symmetric_and_fluid_between_walls_is_positive() {
        for walls in [0, 1, 2] {
            let kernel = Faces { walls, height: 4.0, period: 5.5 }.kernel(0.7);
            for (p, q) in (0..8).flat_map(|p| (0..8).map(move |q| (p, q))) {
                assert!((kernel.along[p][q] - kernel.along[q][p]).abs() < 1e-13);
            }
            assert!((kernel.across[0][1] - kernel.across[1][0]).abs() < 1e-15);
        }
        let at_one_place = total(&Faces { walls: 2, height: 4.0, period: 5.5 }, 0.05, 1.3, 1.3);
        assert!((0..3).all(|c| at_one_place[c][c] > 0.0));
    }

    #[test]
    fn a_mean_force_between_walls_drives_two_linear_flows() {
        let faces = Faces { walls: 2, height: 4.0, period: 5.5 };
        let (z, source): (f64, f64) = (1.2, 3.1);
        let kernel = mean_kernel(&faces);
        let [at, from] = [z, source].map(|z| [1.0, z, z * z]);
        let mut sum: f64 =
            (0..3).flat_map(|p| (0..3).map(move |q| (p, q))).map(|(p, q)| kernel[p][q] * at[p] * from[q]).sum();
        let zeta = (z - source).abs();
        sum += -0.5 * zeta + 0.5 * zeta * zeta / faces.period + faces.period / 12.0;
        assert!((sum - z * (faces.height - source) / faces.height).abs() < 1e-14);
    }
}
