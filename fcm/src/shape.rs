//! How a load becomes values along a row of the grid, and how those values are weighed on the way back.
//!
//! At the point `(x, y, z)` relative to a particle, what is spread of component `c` is
//!
//! ```text
//! F_c (m + m' r^2) g(r) + (G_c . r)(q + q' r^2) g'(r)
//! ```
//!
//! with Gaussians `g`, `g'`. In a plane of constant `z` of a lattice sheared by `s`, `x = X + s y` where `X` belongs to
//! the column of the grid alone, this is a sum of a few products (coefficient of `X` and `z`) x (basis function of `X`
//! and `y`). A row then takes as many fused multiplications as there are basis functions. Interpolation weighs the
//! velocity with the same products, which makes it the exact adjoint of spreading.

use crate::envelope::Source;
use crate::exponential::exponential;
use domain::{Tensor, Vector};
use solver::Real;
use solver::simd::Vector as Lanes;

/// One particle's force and dipole in the grid's precision: `dipole[c][j] = G_cj`.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Load<T> {
    pub force: [T; 3],
    pub dipole: [[T; 3]; 3],
}

impl<T: Real> Load<T> {
    pub fn new(force: Vector, dipole: &Tensor) -> Self {
        let force = force.to_array().map(T::from_f64);
        let dipole = std::array::from_fn(|c| std::array::from_fn(|j| T::from_f64(dipole.col(j)[c])));
        Self { force, dipole }
    }
}

/// What has been weighed for one particle: the velocity and `gradient[c][j]`, the weight of `G_cj`.
#[derive(Clone, Copy)]
pub(crate) struct Sums<V> {
    pub velocity: [V; 3],
    pub gradient: [[V; 3]; 3],
}

/// A particle's sources and the lattice's strain.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sources {
    pub monopole: Source,
    pub dipole: Source,
    pub strain: f64,
}

/// Some columns of the stencil: their `X`, and `exp(-X^2 / (2 width^2))`, also in the grid's precision.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Columns<'a, T> {
    pub x: &'a [f64],
    pub gaussian: &'a [f64],
    pub rounded: &'a [T],
}

/// A row of the stencil: its `y`, and `exp(-(1 + s^2) y^2 / (2 width^2))` for the monopole and the dipole.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Row {
    pub y: f64,
    pub gaussian: [f64; 2],
}

/// A plane of the stencil: the columns' `X`, the plane's `z` and the Gaussians' factors that depend on `z` alone.
#[derive(Clone, Copy)]
pub(crate) struct Plane<T, V> {
    pub x: V,
    pub z: T,
    pub decay: [T; 2],
}

/// A choice of basis functions, `K` of them. All is inlined into a kernel of [`solver::simd::Work`].
pub(crate) trait Shape<const K: usize> {
    /// Writes the basis functions on a row, one after the other. Columns and row come with the Gaussians of the monopole
    /// and of the dipole.
    fn basis<T: Real, V: Lanes<T>>(sources: &Sources, columns: [Columns<T>; 2], row: Row, basis: &mut [T]);

    /// The coefficients of each component in a plane.
    fn spread<T: Real, V: Lanes<T>>(sources: &Sources, load: &Load<T>, plane: &Plane<T, V>) -> [[V; K]; 3];

    /// Adds up the sums of a plane's velocities times each basis function, `moments[c][k]`.
    fn weigh<T: Real, V: Lanes<T>>(sources: &Sources, moments: &[[V; K]; 3], plane: &Plane<T, V>, sums: &mut Sums<V>);
}

/// Force and dipole on one common Gaussian: `{1, y, y^2, y^3} g`.
pub(crate) struct Common;

/// Force alone, with the polynomial of a widened Gaussian: `{1, y, y^2} g`.
pub(crate) struct WideMonopole;

/// Force and dipole on their own Gaussians: `{g, g', y g'}`.
pub(crate) struct Own;

/// Force alone on its own Gaussian: `{g}`.
pub(crate) struct OwnMonopole;

/// Dipole alone on its own Gaussian: `{g', y g'}`.
pub(crate) struct OwnDipole;

/// `g = exp(-((x + s y)^2 + y^2) / (2 width^2))` times `1, y, y^2, ...`, as many as there is room for: the product of
/// Gaussians of `x` and of `y`, and of `exp(-s x y / width^2)`, which is 1 in a straight box.
#[inline(always)]
fn powers<T: Real, V: Lanes<T>>(
    width: f64,
    strain: f64,
    columns: Columns<T>,
    (y, of_row): (f64, f64),
    basis: &mut [T],
) {
    let Columns { x, gaussian, rounded } = columns;
    assert!(rounded.len() == T::LANES, "columns come by the vector");
    let mut bases = basis.chunks_exact_mut(T::LANES);
    let first = bases.next().expect("a basis has at least one function");
    if strain == 0.0 {
        // SAFETY: both slices have as many values as a vector.
        unsafe { V::load(rounded.as_ptr()).mul(V::splat(T::from_f64(of_row))).store(first.as_mut_ptr()) };
    } else {
        let tilt = -strain * y / (width * width);
        for ((value, &g), &x) in first.iter_mut().zip(gaussian).zip(x) {
            *value = T::from_f64(g * (of_row * exponential(tilt * x)));
        }
    }
    // SAFETY: as above, and so has each of the rest.
    let mut power = unsafe { V::load(first.as_ptr()) };
    let y = V::splat(T::from_f64(y));
    for next in bases {
        power = power.mul(y);
        unsafe { power.store(next.as_mut_ptr()) };
    }
}

/// `m + m' r^2 = m0 + m1 y + m2 y^2` in a plane, times the plane's decay.
#[inline(always)]
fn radial<T: Real, V: Lanes<T>>(source: &Source, strain: f64, plane: &Plane<T, V>) -> [V; 3] {
    let quadratic = T::from_f64(source.quadratic) * plane.decay[0];
    let constant = T::from_f64(source.constant) * plane.decay[0];
    let level = (plane.z * plane.z).mul_add(quadratic, constant);
    let spread = V::splat(quadratic);
    [
        plane.x.mul(spread).mul_add(plane.x, V::splat(level)),
        plane.x.mul(V::splat(T::from_f64(2.0 * strain) * quadratic)),
        V::splat(T::from_f64(1.0 + strain * strain) * quadratic),
    ]
}

/// `a . b` of three lanes each.
#[inline(always)]
fn dot<T: Real, V: Lanes<T>>(a: [V; 3], b: [V; 3]) -> V {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2].mul(b[2])))
}

impl Shape<4> for Common {
    #[inline(always)]
    fn basis<T: Real, V: Lanes<T>>(sources: &Sources, [columns, _]: [Columns<T>; 2], row: Row, basis: &mut [T]) {
        powers::<T, V>(sources.monopole.width, sources.strain, columns, (row.y, row.gaussian[0]), basis);
    }

    #[inline(always)]
    fn spread<T: Real, V: Lanes<T>>(s: &Sources, load: &Load<T>, plane: &Plane<T, V>) -> [[V; 4]; 3] {
        let m = radial(&s.monopole, s.strain, plane);
        let q = radial(&s.dipole, s.strain, plane);
        let strain = T::from_f64(s.strain);
        let mut coefficients = [[V::splat(T::default()); 4]; 3];
        for c in 0..3 {
            let [gx, gy, gz] = load.dipole[c];
            let force = V::splat(load.force[c]);
            let along = V::splat(strain.mul_add(gx, gy));
            let across = plane.x.mul_add(V::splat(gx), V::splat(gz * plane.z));
            coefficients[c] = [
                force.mul_add(m[0], across.mul(q[0])),
                force.mul_add(m[1], across.mul_add(q[1], along.mul(q[0]))),
                force.mul_add(m[2], across.mul_add(q[2], along.mul(q[1]))),
                along.mul(q[2]),
            ];
        }
        coefficients
    }

    #[inline(always)]
    fn weigh<T: Real, V: Lanes<T>>(s: &Sources, moments: &[[V; 4]; 3], plane: &Plane<T, V>, sums: &mut Sums<V>) {
        let m = radial(&s.monopole, s.strain, plane);
        let q = radial(&s.dipole, s.strain, plane);
        let (strain, z) = (V::splat(T::from_f64(s.strain)), V::splat(plane.z));
        for c in 0..3 {
            let [u0, u1, u2, u3] = moments[c];
            let level = dot(q, [u0, u1, u2]);
            let tilted = dot(q, [u1, u2, u3]);
            sums.velocity[c] = sums.velocity[c].add(dot(m, [u0, u1, u2]));
            let [x, y, up] = sums.gradient[c];
            sums.gradient[c] = [plane.x.mul_add(level, strain.mul_add(tilted, x)), y.add(tilted), z.mul_add(level, up)];
        }
    }
}

impl Shape<3> for WideMonopole {
    #[inline(always)]
    fn basis<T: Real, V: Lanes<T>>(sources: &Sources, [columns, _]: [Columns<T>; 2], row: Row, basis: &mut [T]) {
        powers::<T, V>(sources.monopole.width, sources.strain, columns, (row.y, row.gaussian[0]), basis);
    }

    #[inline(always)]
    fn spread<T: Real, V: Lanes<T>>(s: &Sources, load: &Load<T>, plane: &Plane<T, V>) -> [[V; 3]; 3] {
        let m = radial(&s.monopole, s.strain, plane);
        let mut coefficients = [m; 3];
        for c in 0..3 {
            let force = V::splat(load.force[c]);
            coefficients[c] = [m[0].mul(force), m[1].mul(force), m[2].mul(force)];
        }
        coefficients
    }

    #[inline(always)]
    fn weigh<T: Real, V: Lanes<T>>(s: &Sources, moments: &[[V; 3]; 3], plane: &Plane<T, V>, sums: &mut Sums<V>) {
        let m = radial(&s.monopole, s.strain, plane);
        for c in 0..3 {
            sums.velocity[c] = sums.velocity[c].add(dot(m, moments[c]));
        }
    }
}

impl Shape<1> for OwnMonopole {
    #[inline(always)]
    fn basis<T: Real, V: Lanes<T>>(sources: &Sources, [columns, _]: [Columns<T>; 2], row: Row, basis: &mut [T]) {
        powers::<T, V>(sources.monopole.width, sources.strain, columns, (row.y, row.gaussian[0]), basis);
    }

    #[inline(always)]
    fn spread<T: Real, V: Lanes<T>>(s: &Sources, load: &Load<T>, plane: &Plane<T, V>) -> [[V; 1]; 3] {
        let factor = T::from_f64(s.monopole.constant) * plane.decay[0];
        let [x, y, z] = load.force;
        [[V::splat(x * factor)], [V::splat(y * factor)], [V::splat(z * factor)]]
    }

    #[inline(always)]
    fn weigh<T: Real, V: Lanes<T>>(s: &Sources, moments: &[[V; 1]; 3], plane: &Plane<T, V>, sums: &mut Sums<V>) {
        let factor = V::splat(T::from_f64(s.monopole.constant) * plane.decay[0]);
        for c in 0..3 {
            sums.velocity[c] = factor.mul_add(moments[c][0], sums.velocity[c]);
        }
    }
}

impl Shape<2> for OwnDipole {
    #[inline(always)]
    fn basis<T: Real, V: Lanes<T>>(sources: &Sources, [_, columns]: [Columns<T>; 2], row: Row, basis: &mut [T]) {
        powers::<T, V>(sources.dipole.width, sources.strain, columns, (row.y, row.gaussian[1]), basis);
    }

    #[inline(always)]
    fn spread<T: Real, V: Lanes<T>>(s: &Sources, load: &Load<T>, plane: &Plane<T, V>) -> [[V; 2]; 3] {
        let factor = T::from_f64(s.dipole.constant) * plane.decay[1];
        let strain = T::from_f64(s.strain);
        let mut coefficients = [[plane.x; 2]; 3];
        for c in 0..3 {
            let [gx, gy, gz] = load.dipole[c];
            let level = plane.x.mul_add(V::splat(gx * factor), V::splat(gz * plane.z * factor));
            coefficients[c] = [level, V::splat(strain.mul_add(gx, gy) * factor)];
        }
        coefficients
    }

    #[inline(always)]
    fn weigh<T: Real, V: Lanes<T>>(s: &Sources, moments: &[[V; 2]; 3], plane: &Plane<T, V>, sums: &mut Sums<V>) {
        let factor = V::splat(T::from_f64(s.dipole.constant) * plane.decay[1]);
        let (strain, z) = (V::splat(T::from_f64(s.strain)), V::splat(plane.z));
        for c in 0..3 {
            let (level, tilted) = (factor.mul(moments[c][0]), factor.mul(moments[c][1]));
            let [x, y, up] = sums.gradient[c];
            sums.gradient[c] = [plane.x.mul_add(level, strain.mul_add(tilted, x)), y.add(tilted), z.mul_add(level, up)];
        }
    }
}

impl Shape<3> for Own {
    #[inline(always)]
    fn basis<T: Real, V: Lanes<T>>(sources: &Sources, columns: [Columns<T>; 2], row: Row, basis: &mut [T]) {
        let (monopole, dipole) = basis.split_at_mut(columns[0].x.len());
        OwnMonopole::basis::<T, V>(sources, columns, row, monopole);
        OwnDipole::basis::<T, V>(sources, columns, row, dipole);
    }

    #[inline(always)]
    fn spread<T: Real, V: Lanes<T>>(s: &Sources, load: &Load<T>, plane: &Plane<T, V>) -> [[V; 3]; 3] {
        let [[x], [y], [z]] = OwnMonopole::spread(s, load, plane);
        let [dx, dy, dz] = OwnDipole::spread(s, load, plane);
        [[x, dx[0], dx[1]], [y, dy[0], dy[1]], [z, dz[0], dz[1]]]
    }

    #[inline(always)]
    fn weigh<T: Real, V: Lanes<T>>(s: &Sources, moments: &[[V; 3]; 3], plane: &Plane<T, V>, sums: &mut Sums<V>) {
        let [a, b, c] = moments;
        OwnMonopole::weigh(s, &[[a[0]], [b[0]], [c[0]]], plane, sums);
        OwnDipole::weigh(s, &[[a[1], a[2]], [b[1], b[2]], [c[1], c[2]]], plane, sums);
    }
}
