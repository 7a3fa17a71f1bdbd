use super::*;
use crate::fourier::tests::noise;
use crate::{Field, Physical, Transform, divergence};
use domain::{Comm, Partition, PeriodicBox, Tensor, Vector};

const POINTS: [usize; 3] = [24, 18, 20];

fn grid(strain: f64) -> Grid {
    Grid::new(POINTS, PeriodicBox::sheared(Vector::new(3.0, 2.0, 2.5), strain).unwrap()).unwrap()
}

fn transform<T: Real>() -> Transform<T> {
    Transform::new(POINTS, &Partition::new(&Comm::alone(), [POINTS[1], POINTS[2]]), 0)
}

/// A tilted lattice.
fn tilted() -> Grid {
    let vectors = [Vector::X * 3.0, Vector::new(0.62, 2.0, 0.0), Vector::new(1.1, -0.7, 2.5)];
    Grid::new(POINTS, PeriodicBox::of_lattice(vectors).unwrap()).unwrap()
}

/// A field with the values of a function at each point.
fn sampled<T: Real>(grid: &Grid, value: impl Fn(Vector) -> Vector) -> Field<T, Physical> {
    let mut field = transform::<T>().field();
    for (y, z) in (0..POINTS[1]).flat_map(|y| (0..POINTS[2]).map(move |z| (y, z))) {
        for x in 0..POINTS[0] {
            let value = value(grid.position([x, y, z])).to_array();
            (0..3).for_each(|c| field.row_mut(c, y, z)[x] = T::from_f64(value[c]));
        }
    }
    field
}

fn noisy(seed: usize) -> Field<f64, Physical> {
    let mut field = transform::<f64>().field();
    let [nx, ny, nz] = POINTS;
    for (c, y, z) in (0..3).flat_map(|c| (0..ny).flat_map(move |y| (0..nz).map(move |z| (c, y, z)))) {
        let start = seed + ((c * nz + z) * ny + y) * nx;
        field.row_mut(c, y, z)[..nx].iter_mut().enumerate().for_each(|(x, v)| *v = noise(start + x));
    }
    field
}

fn dot(a: &Field<f64, Physical>, b: &Field<f64, Physical>) -> f64 {
    a.to_vec().iter().zip(b.to_vec()).map(|(a, b)| a * b).sum()
}

fn solved(field: &Field<f64, Physical>, operator: &Stokes<f64>) -> Field<f64, Physical> {
    let mut velocity = field.clone();
    transform().apply(&mut velocity, operator);
    velocity
}

/// `f = a cos(k.x + phase)` drives `u = (a - k (k.a)/k^2) m(k) cos(k.x + phase) / (mu k^2)`.
fn check_single_mode<T: Real>(grid: &Grid, mode: [usize; 3], tolerance: f64) {
    let (viscosity, amplitude, phase) = (0.7, Vector::new(0.3, -1.1, 0.8), 0.4);
    let width = if grid.cell().is_orthogonal() { 0.0 } else { 0.03 };
    let plane = |k1: f64, k2: f64| (-0.01 * (k1 * k1 + k2 * k2)).exp();
    let axis = |k3: f64| 1.0 / (1.0 + 0.1 * k3 * k3);
    let widening = 0.02;
    let k = grid.wavevector(mode);
    let wave = |x: Vector| (k.dot(x) + phase).cos();
    let mut field = sampled::<T>(grid, |x| amplitude * wave(x));
    transform()
        .apply(&mut field, &Stokes::with_multiplier(grid, viscosity, &Multiplier { plane, axis, widening, width }));
    let across = amplitude - k * (k.dot(amplitude) / k.length_squared());
    let square = k.length_squared();
    let gaussian = (-width * width * square).exp();
    let product = plane(k.x, k.y) * axis(grid.wavenumber(2, mode[2])) * gaussian;
    let factor = product * (1.0 + widening * square).powi(2) / (viscosity * square);
    let exact = sampled::<f64>(grid, |x| across * factor * wave(x)).to_vec();
    // Round-off of the force is multiplied by the largest factor, that of the longest wave: 1/(mu (2 pi/3)^2).
    let largest = 1.0 / (viscosity * (std::f64::consts::TAU / 3.0).powi(2));
    for (found, exact) in field.to_vec().iter().zip(exact) {
        assert!((found.to_f64() - exact).abs() < tolerance * largest, "{mode:?} in {:?}: {found} {exact}", grid.cell());
    }
}

#[test]
fn a_single_wave_is_exact_in_boxes_of_any_lattice() {
    for grid in [grid(0.0), grid(0.31), grid(-0.5), grid(0.7).reduced(), tilted()] {
        for mode in [[1, 0, 0], [0, 1, 0], [0, 0, 1], [2, 3, 4], [11, 17, 19], [5, 8, 9], [3, 12, 1], [0, 10, 11]] {
            check_single_mode::<f64>(&grid, mode, 2e-15);
            check_single_mode::<f32>(&grid, mode, 3e-7);
        }
    }
}

#[test]
fn the_mean_and_the_highest_modes_are_zero() {
    for grid in [grid(0.0), grid(0.31), tilted()] {
        let [x, y, z] = POINTS.map(|n| n / 2);
        for mode in [[0, 0, 0], [x, 0, 0], [0, y, 0], [0, 0, z], [x, 2, 1], [3, y, 2], [1, 4, z], [x, y, z]] {
            // On the grid a wave is that of its lattice coordinates.
            let wave = sampled::<f64>(&grid, |x| Vector::new(1.0, 2.0, -3.0) * (grid.wavevector(mode).dot(x)).cos());
            let velocity = solved(&wave, &Stokes::new(&grid, 1.0)).to_vec();
            assert!(velocity.iter().all(|v| v.abs() < 1e-14), "{mode:?}");
        }
    }
}

#[test]
fn the_operator_is_symmetric_and_takes_no_energy() {
    for grid in [grid(0.0), grid(-0.2), grid(-0.7).reduced(), tilted()] {
        let operator = Stokes::new(&grid, 1.3);
        let (f, g) = (noisy(1), noisy(77_777));
        let (u, v) = (solved(&f, &operator), solved(&g, &operator));
        let size = (dot(&u, &u) * dot(&g, &g)).sqrt();
        assert!((dot(&u, &g) - dot(&f, &v)).abs() < 1e-14 * size, "{} {}", dot(&u, &g), dot(&f, &v));
        assert!(dot(&u, &f) > 0.0 && dot(&v, &g) > 0.0);
    }
}

#[test]
fn velocities_have_no_sources_and_no_mean() {
    for grid in [grid(0.0), grid(0.4), grid(0.7).reduced(), tilted()] {
        let mut velocity = noisy(5);
        assert!(divergence(&grid, &mut transform(), &mut velocity.clone(), &Comm::alone()) > 0.1);
        transform().apply(&mut velocity, &Stokes::new(&grid, 1.0));
        let count = grid.count();
        for component in velocity.to_vec().chunks(count) {
            let largest = component.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
            assert!(component.iter().sum::<f64>().abs() < 1e-14 * largest * count as f64);
        }
        assert!(divergence(&grid, &mut transform(), &mut velocity, &Comm::alone()) < 1e-14);
    }
}

#[test]
fn single_precision_is_as_good_as_its_roundings() {
    for grid in [grid(0.0), grid(0.37), tilted()] {
        let (double, single) = (Stokes::<f64>::new(&grid, 1.0), Stokes::<f32>::new(&grid, 1.0));
        let field = noisy(3);
        let mut rounded = transform::<f32>().field();
        for (c, y, z) in (0..3).flat_map(|c| (0..18).flat_map(move |y| (0..20).map(move |z| (c, y, z)))) {
            let values = field.row(c, y, z).iter().map(|&v| v as f32);
            rounded.row_mut(c, y, z).iter_mut().zip(values).for_each(|(to, from)| *to = from);
        }
        transform().apply(&mut rounded, &single);
        let exact = solved(&field, &double).to_vec();
        let error: f64 = rounded.to_vec().iter().zip(&exact).map(|(a, b)| (f64::from(*a) - b).powi(2)).sum();
        let size: f64 = exact.iter().map(|v| v * v).sum();
        assert!((error / size).sqrt() < 3e-7, "{}", (error / size).sqrt());
    }
}

#[test]
fn ranks_agree_with_one_rank_to_the_bit() {
    [grid(0.25), grid(0.7).reduced(), tilted()].iter().for_each(ranks_agree_on);
}

fn ranks_agree_on(grid: &Grid) {
    let force = noisy(9);
    let one = solved(&force, &Stokes::new(grid, 1.0));
    for table in [[1, 2], [3, 1], [2, 2], [1, 7], [7, 1], [1, 13], [4, 4], [8, 8], [64, 1]] {
        Comm::threads(table[0] * table[1], |comm| {
            let partition = Partition::with_table(&comm, [POINTS[1], POINTS[2]], table);
            let mut transform = Transform::<f64>::new(POINTS, &partition, 0);
            let mut field = transform.field();
            let [ys, zs] = field.rows();
            let lines = || ys.clone().flat_map(|y| zs.clone().map(move |z| (y, z)));
            for (c, (y, z)) in (0..3).flat_map(|c| lines().map(move |line| (c, line))) {
                field.row_mut(c, y, z).copy_from_slice(force.row(c, y, z));
            }
            transform.apply(&mut field, &Stokes::new(grid, 1.0));
            for (c, (y, z)) in (0..3).flat_map(|c| lines().map(move |line| (c, line))) {
                assert_eq!(field.row(c, y, z), one.row(c, y, z));
            }
        });
    }
}

/// The velocity of a divergence-free wave of forces, times `mu k^2`, is the force again, on grids with factors 11
/// to 97.
#[test]
fn stokes_and_back_is_the_force_on_any_even_grid() {
    for points in [[22, 26, 34], [46, 106, 2], [194, 22, 6]] {
        let grid = Grid::new(points, PeriodicBox::sheared(Vector::new(3.0, 2.0, 2.5), 0.31).unwrap()).unwrap();
        let k = grid.wavevector([points[0] / 2 - 1, points[1] - 3, 0]);
        let force = |x: Vector| k.cross(Vector::new(0.2, 1.0, 0.5)).normalize() * (k.dot(x) + 0.4).cos();
        let mut transform = Transform::<f64>::new(points, &Partition::new(&Comm::alone(), grid.lines()), 0);
        let mut field = transform.field();
        let all = || (0..points[1]).flat_map(|y| (0..points[2]).map(move |z| (y, z)));
        for (x, (y, z)) in (0..points[0]).flat_map(|x| all().map(move |line| (x, line))) {
            let value = force(grid.position([x, y, z])).to_array();
            (0..3).for_each(|c| field.row_mut(c, y, z)[x] = value[c]);
        }
        transform.apply(&mut field, &Stokes::new(&grid, 0.7));
        for (x, (y, z)) in (0..points[0]).flat_map(|x| all().map(move |line| (x, line))) {
            let value = force(grid.position([x, y, z])).to_array();
            // Round-off is multiplied by the factor of the longest wave over that of this one.
            let tolerance = 3e-15 * k.length_squared() / (std::f64::consts::TAU / 3.0).powi(2);
            for c in 0..3 {
                let found = field.row(c, y, z)[x] * 0.7 * k.length_squared();
                assert!((found - value[c]).abs() < tolerance, "{points:?}: {found} {}", value[c]);
            }
        }
    }
}

#[test]
fn a_rotation_of_axes_rotates_the_velocity() {
    // A cube's axes can be rotated into each other: x -> y -> z -> x.
    let grid = Grid::new([12; 3], PeriodicBox::new(Vector::splat(1.5)).unwrap()).unwrap();
    let turn = Tensor::from_cols(Vector::Y, Vector::Z, Vector::X);
    let mut transform = Transform::<f64>::new([12; 3], &Partition::new(&Comm::alone(), [12; 2]), 0);
    let mut solve = |point: [usize; 3], force: Vector| {
        let mut field = transform.field();
        (0..3).for_each(|c| field.row_mut(c, point[1], point[2])[point[0]] = force[c]);
        transform.apply(&mut field, &Stokes::new(&grid, 1.0));
        move |[x, y, z]: [usize; 3]| Vector::from_array(std::array::from_fn(|c| field.row(c, y, z)[x]))
    };
    let force = Vector::new(1.0, 0.2, -0.6);
    let (straight, turned) = (solve([1, 2, 3], force), solve([3, 1, 2], turn * force));
    for [x, y, z] in [[0, 0, 0], [5, 7, 11], [1, 2, 3], [10, 3, 6]] {
        assert!((turn * straight([x, y, z]) - turned([z, x, y])).length() < 1e-16);
    }
}

/// `|k.u|` over `|k| |u|` of a wave `a cos(k.x) + b sin(k.x)`, whose coefficient is `(a - i b) / 2`.
#[test]
fn the_divergence_of_a_wave_is_that_of_its_amplitudes() {
    let measured = |grid: &Grid, value: &dyn Fn(Vector) -> Vector| {
        divergence(grid, &mut transform(), &mut sampled::<f64>(grid, value), &Comm::alone())
    };
    for strain in [0.0, 0.31] {
        let grid = grid(strain);
        assert!(measured(&grid, &|_| Vector::ZERO).abs() < 1e-300);
        let k = grid.wavevector([3, 4, 2]);
        let across = k.cross(Vector::X).normalize();
        let amplitudes =
            [(k, Vector::ZERO), (across, across * 2.0), (k + across, across - k), (Vector::new(0.3, -1.0, 2.0), k)];
        for (a, b) in amplitudes {
            let wave = |x: Vector| a * k.dot(x).cos() + b * k.dot(x).sin();
            let exact = k.dot(a).hypot(k.dot(b)) / (k.length() * a.length().hypot(b.length()));
            assert!((measured(&grid, &wave) - exact).abs() < 1e-14, "strain {strain}, {a} and {b}");
        }
        // The largest of one wave over the largest of another; the highest mode, also a gradient, is left out.
        let (other, highest) = (grid.wavevector([1, 2, 0]), grid.wavevector([0, POINTS[1] / 2, 0]));
        let three =
            |x: Vector| across * k.dot(x).cos() + other * 0.1 * other.dot(x).cos() + highest * (highest.dot(x)).cos();
        let exact = 0.1 * other.length_squared() / k.length();
        assert!(exact < 1.0 && (measured(&grid, &three) - exact).abs() < 1e-14, "strain {strain}");
    }
}

#[test]
fn every_rank_knows_the_divergence_of_all() {
    let grid = grid(0.31);
    let k = grid.wavevector([3, 4, 2]);
    let whole = sampled::<f64>(&grid, |x| (k + Vector::X) * k.dot(x).cos());
    let alone = divergence(&grid, &mut transform(), &mut whole.clone(), &Comm::alone());
    let found = Comm::threads(3, |comm| {
        let mut transform = Transform::<f64>::new(POINTS, &Partition::new(&comm, [POINTS[1], POINTS[2]]), 0);
        let mut field = transform.field();
        let [ys, zs] = field.rows();
        for (c, (y, z)) in
            (0..3).flat_map(|c| ys.clone().flat_map(|y| zs.clone().map(move |z| (y, z))).map(move |l| (c, l)))
        {
            field.row_mut(c, y, z).copy_from_slice(whole.row(c, y, z));
        }
        divergence(&grid, &mut transform, &mut field, &comm)
    });
    assert!(alone > 0.5 && found.iter().all(|one| one.to_bits() == alone.to_bits()), "{alone} and {found:?}");
}
