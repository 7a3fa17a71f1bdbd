//! The part of a channel's Stokes kernel that its walls make, for one wavevector in its plane.

/// Functions of z of the two walls: `b0 = exp(-k z)`, `b1 = k z b0`, and `t0`, `t1` the same of the distance `H - z`.
pub(crate) const FUNCTIONS: usize = 4;

/// Coefficients of the functions of the component along the wavevector, then of that along z.
pub(crate) type Coefficients = [f64; 2 * FUNCTIONS];

/// `K(z, z') = sum_pq K_pq f_p(z) f_q(z')`, by what the force along the wavevector and the one along z, over `i`, at `z'`
/// drive at `z`; and of the force across both, in `b0` and `t0` alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Kernel {
    pub along: [Coefficients; 2 * FUNCTIONS],
    pub across: [[f64; 2]; 2],
}

/// Walls and the grid around them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Faces {
    /// How many: 0, 1 at `z = 0`, or another one at `z = height`.
    pub walls: usize,
    /// The place of the second, or any that the functions are measured from.
    pub height: f64,
    /// After which the grid repeats along z.
    pub period: f64,
}

impl Faces {
    /// The kernel between the walls less that of the grid, for `k > 0` and the viscosity 1.
    ///
    /// With `e = exp(-k |zeta|)`, `zeta = z - z'`, and z-components over `i`, unbounded fluid has
    ///
    /// ```text
    /// G = 1/(4k) [ 1 - k|zeta|    k zeta    ] e,      G_across = e / 2k.
    ///            [  -k zeta    1 + k|zeta|  ]
    /// ```
    ///
    /// Tractions on the walls that bring the fluid to rest there add `-P C P^T`, where `P` is what they drive and `C` the
    /// inverse of `G` among walls: the Schur complement. The grid has `sum_m G(zeta + m period)` instead of `G`; what is
    /// too much of that is in the span of the same functions.
    pub fn kernel(&self, k: f64) -> Kernel {
        let mut kernel = of_walls(k, self.walls, self.height);
        self.without_copies(k, &mut kernel);
        kernel
    }

    /// Subtracts what the grid's copies of forces drive, sums over `m` of `e` and of `m e`.
    fn without_copies(&self, k: f64, kernel: &mut Kernel) {
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

/// What walls add to unbounded fluid, for `k > 0` and the viscosity 1.
fn of_walls(k: f64, walls: usize, height: f64) -> Kernel {
    let mut kernel = Kernel { along: [[0.0; 2 * FUNCTIONS]; 2 * FUNCTIONS], across: [[0.0; 2]; 2] };
    match walls {
        0 => {}
        1 => one_wall(k, &mut kernel),
        _ => two_walls(k, k * height, &mut kernel),
    }
    kernel
}

/// The velocity across the walls at `z` that they add to that of a unit force across them at `z'`, both in a wave along them of
/// wavenumber `k > 0`, for the viscosity 1: with the entries `K_pq` it is `sum_pq K_pq f_p(z) f_q(z')` in the functions
/// `exp(-k z)`, `k z exp(-k z)` and the same of the distance `height - z`.
pub fn across_walls(walls: usize, height: f64, k: f64) -> [[f64; FUNCTIONS]; FUNCTIONS] {
    let Kernel { along, .. } = of_walls(k, walls, height);
    std::array::from_fn(|p| std::array::from_fn(|q| along[FUNCTIONS + p][FUNCTIONS + q]))
}

/// What unit tractions along the wavevector and along z drive, times `4k`: those of the wall below, then above.
const DRIVEN: [[Coefficients; 2]; 2] = [
    [[1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0]],
    [[0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 1.0, 1.0]],
];

/// Adds `factor v w^T`.
fn add(kernel: &mut Kernel, factor: f64, v: &Coefficients, w: &Coefficients) {
    for (row, v) in kernel.along.iter_mut().zip(v) {
        for (entry, w) in row.iter_mut().zip(w) {
            *entry += factor * v * w;
        }
    }
}

fn one_wall(k: f64, kernel: &mut Kernel) {
    for driven in &DRIVEN[0] {
        add(kernel, -0.25 / k, driven, driven);
    }
    kernel.across[0][0] = -0.5 / k;
}

/// Tractions on both walls that are mirror images (`sign = 1`), or the opposite of mirror images, do not know of each other.
fn two_walls(k: f64, height: f64, kernel: &mut Kernel) {
    let e = (-height).exp();
    for sign in [1.0, -1.0] {
        let [below, above] = DRIVEN;
        let combined = |of: usize, sign: f64| std::array::from_fn(|p| below[of][p] + sign * above[of][p]);
        let (along, normal): (Coefficients, Coefficients) = (combined(0, sign), combined(1, -sign));
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

/// `1 - 2 sign x e - e^2` with `e = exp(-x)`, which for small `x` is `x^3/3` if the sign is positive.
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

/// The kernel of the forces' mean over the plane, which drive a flow along it, between the walls less that of the grid, in
/// the functions 1, `z` and `z^2`: `-|zeta|/2` and what is linear, less `-|zeta|/2 + zeta^2/(2 period) + period/12`.
///
/// Without walls the fluid at a distance of half a height from a force rests, so that the kernel is positive definite.
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

    /// The kernel of the grid with its copies, of unbounded fluid, by components.
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
