//! Free-space kernels on a grid, of the Stokes flow and of the potential, and their transforms.

use crate::open_space::entries;
use crate::{Field, Grid, OpenSpace, Physical, Real, Spectral, Transform};
use domain::parallel::MeasuredLoop;
use domain::{Comm, Partition, PeriodicBox, Vector};
use num_complex::Complex;
use rayon::prelude::*;
use std::f64::consts::PI;

const DIAGONAL: [usize; 3] = [0, 3, 5];

/// Largest number of entries of a kernel.
const MOST: usize = entries(3);

/// Modes that one thread processes at a time.
const BATCH: usize = 1024;

impl<T: Real, const C: usize> OpenSpace<T, C> {
    /// Kernel for a viscosity and an even multiplier `m(k)`, as of [`crate::Multiplier`], whose kernel differs from
    /// that of points only up to a distance `reach`. Complete on every rank.
    pub fn new(grid: &Grid, viscosity: f64, multiplier: impl Fn(Vector) -> f64 + Sync, reach: f64) -> Self {
        let points = grid.points();
        let [columns, modes, last] = points.map(|n| n / 2 + 1);
        let blocks = (columns - 1).div_ceil(T::LANES);
        let mut table = vec![T::default(); modes * blocks * last * entries(C) * T::LANES];
        let scale = 1.0 / (viscosity * grid.count() as f64);
        transforms::<C>(grid, multiplier, reach, |[m1, m2, m3], entry, value| {
            let panel = m2 * blocks + m1 / T::LANES;
            let place = (panel * last + m3) * entries(C) + entry;
            table[place * T::LANES + m1 % T::LANES] = T::from_f64(scale * value);
        });
        Self { points, table, blocks }
    }
}

/// Calls `keep(mode, entry, value)` for the discrete transform of the kernel at all modes up to half the points,
/// except for the highest of x.
///
/// The biharmonic kernel `-r / 8 pi`, plus `(R^2 + r^2) / 16 pi R` so that it vanishes smoothly at a radius `R` as
/// `(R - r)^2 / 16 pi R`, has the transform
///
/// ```text
/// B(k) = (2 + cos q - 3 sin q / q) / (2 k^4),      q = k R,
/// ```
///
/// an entire function. (Vico, Greengard & Ferrando 2016 truncate the kernel with a step, whose transform decays like
/// `R^2 / k^2` and is cut off at the highest wavenumbers of a grid.) On a grid so long that no periodic copy of the
/// cutoff reaches the particles, the sum of `(k^2 I - k k) B(k) m(k)` over its wavevectors is the decaying kernel at
/// every separation that occurs, apart from `-m(0) / 4 pi R` on the diagonal by the term that was added. Separations
/// of half the grid's points do not occur.
///
/// The kernel of a potential, `1 / 4 pi r`, less `1 / 4 pi R`, vanishes at the radius `R` and has the transform
/// `(1 - sin q / q) / k^2`.
fn transforms<const C: usize>(
    grid: &Grid,
    multiplier: impl Fn(Vector) -> f64 + Sync,
    reach: f64,
    mut keep: impl FnMut([usize; 3], usize, f64),
) {
    let half = grid.points().map(|n| n / 2);
    let spacing = grid.spacing();
    let lengths = Vector::from_array(half.map(|n| n as f64)) * spacing;
    let cut = lengths.length() + reach;
    let needed = (lengths + Vector::splat(cut + reach)) / spacing;
    let long = needed.to_array().map(|n| Grid::good_size(n.ceil() as usize));
    let cell = PeriodicBox::new(Vector::from_array(long.map(|n| n as f64)) * spacing).expect("lengths are positive");
    let long = Grid::new(long, cell).expect("a good size is one that can be transformed");
    let over = 1.0 / long.count() as f64;
    let added = multiplier(Vector::ZERO) / (4.0 * PI * cut) * spacing.element_product();
    // Even along each axis: an octant represents all modes.
    let [mx, my, mz] = long.points().map(|n| n / 2);
    let factor = |at: usize| {
        let k = long.wavevector([at % mx, at / mx % my, at / (mx * my)]);
        (if C == 1 { harmonic(k.length(), cut) } else { biharmonic(k.length(), cut) }) * multiplier(k) * over
    };
    let factors: Vec<f64> = (0..mx * my * mz).into_par_iter().with_min_len(BATCH).map(factor).measured().collect();
    for first in (0..entries(C)).step_by(C) {
        let values = |mode: [usize; 3]| {
            let k = long.wavevector(mode);
            if (0..3).any(|axis| long.is_nyquist(axis, mode)) {
                return [Complex::new(0.0, 0.0); C];
            }
            let [m1, m2, m3] = [0, 1, 2].map(|axis| mode[axis].min(long.points()[axis] - mode[axis]));
            let factor = factors[m1 + mx * (m2 + my * m3)];
            let entries = if C == 1 { [1.0; MOST] } else { across(k) };
            std::array::from_fn(|c| Complex::new(factor * entries[first + c], 0.0))
        };
        let diagonal = std::array::from_fn(|c| if DIAGONAL.contains(&(first + c)) { added } else { 0.0 });
        let kernel: Field<f64, Physical, C> = cropped(&on_grid(&long, values), diagonal, &long, half);
        let spectrum = planned(grid).forward(kernel);
        spectrum.for_each_mode(|mode, values| {
            if mode.iter().zip(half).all(|(mode, half)| *mode <= half) {
                (0..C).for_each(|c| keep(mode, first + c, values[c].re));
            }
        });
    }
}

/// Entries of `k^2 I - k k`.
fn across(k: Vector) -> [f64; MOST] {
    let square = k.length_squared();
    [square - k.x * k.x, -k.x * k.y, -k.x * k.z, square - k.y * k.y, -k.y * k.z, square - k.z * k.z]
}

/// `(1 - sin q / q) / k^2`
fn harmonic(k: f64, cut: f64) -> f64 {
    let q = k * cut;
    if q < 1e-3 { (1.0 / 6.0 - q * q / 120.0) * cut * cut } else { (1.0 - q.sin() / q) / (k * k) }
}

/// `B(k)`, with any value at `k = 0`.
fn biharmonic(k: f64, cut: f64) -> f64 {
    let q = k * cut;
    if q == 0.0 {
        return 0.0;
    }
    (2.0 + q.cos() - 3.0 * q.sin() / q) / (2.0 * k.powi(4))
}

fn planned<const C: usize>(grid: &Grid) -> Transform<f64, C> {
    Transform::of_components(grid.points(), &Partition::new(&Comm::alone(), grid.lines()), 0)
}

/// Values with the given coefficients.
fn on_grid<const C: usize>(
    grid: &Grid,
    values: impl Fn([usize; 3]) -> [Complex<f64>; C] + Sync,
) -> Field<f64, Physical, C> {
    let mut transform = planned(grid);
    let mut field: Field<f64, Spectral, C> = transform.field().into_space();
    field.set_modes(values);
    transform.backward(field)
}

/// Values at separations of fewer points than half a grid, plus a constant for each component, on that grid.
/// Separations of half the points along x do not occur, so their values are free: those set here leave nothing in the
/// highest mode of x, which is not kept.
fn cropped<const C: usize>(
    from: &Field<f64, Physical, C>,
    more: [f64; C],
    long: &Grid,
    half: [usize; 3],
) -> Field<f64, Physical, C> {
    let points = half.map(|n| 2 * n);
    let grid = Grid::new(points, PeriodicBox::new(Vector::ONE).expect("a cube")).expect("as the one that was given");
    let mut field = planned(&grid).field();
    // Index on the long grid of a point of the short one, if there is one.
    let place = |axis: usize, point: usize| {
        let beyond = points[axis] - point;
        if point < half[axis] { Some(point) } else { (beyond < half[axis]).then(|| long.points()[axis] - beyond) }
    };
    for (c, z, y) in (0..C).flat_map(|c| (0..points[2]).flat_map(move |z| (0..points[1]).map(move |y| (c, z, y)))) {
        let (Some(from_y), Some(from_z)) = (place(1, y), place(2, z)) else { continue };
        let row = from.row(c, from_y, from_z);
        let to = field.row_mut(c, y, z);
        for x in 0..points[0] {
            to[x] = place(0, x).map_or(0.0, |x| row[x] + more[c]);
        }
        let sign = |x: usize| if x.is_multiple_of(2) { 1.0 } else { -1.0 };
        let highest: f64 = (0..points[0]).map(|x| sign(x) * to[x]).sum();
        to[half[0]] = -sign(half[0]) * highest;
    }
    field
}
