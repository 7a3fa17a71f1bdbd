use super::*;
use crate::envelope::Envelope;
use num_complex::Complex;

type Wave = [Complex<f64>; 3];

fn seen(distance: f64, radius: f64) -> SourceAtWall {
    let Envelope { monopole, dipole } = Envelope::of_sphere(radius);
    SourceAtWall { distance, squares: [monopole * monopole, dipole * dipole] }
}

/// All wavenumbers from nearly zero on, in steps that are exact for spheres within 30 radii.
fn all() -> WallKernel {
    WallKernel::with(0.0025, 0.005, &vec![0.005 / TAU; 4000])
}

/// Kernel of a wavevector at the height `z`, without envelopes.
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
fn of_sphere(
    k: f64,
    angle: f64,
    SourceAtWall { distance, squares: [s, d] }: SourceAtWall,
) -> [[Complex<f64>; ENTRIES]; 3] {
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
        let WallMobilityBlock(found) = WallKernel::with(1.3, 0.8, &nodes.map(|node| node.1)).block(x, spheres);
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
    let point = |distance: f64| SourceAtWall { distance, squares: [0.0; 2] };
    for (x, heights) in [(Vector::new(3.0, 0.0, 0.0), [1.2, 2.1]), (Vector::ZERO, [1.4, 0.9])] {
        let WallMobilityBlock(found) = all().block(x, heights.map(point));
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
    let waves = WallKernel::with(1.0, 0.4, &[0.1; 20]);
    let sign = |load: usize| if load < 3 { 1.0 } else { -1.0 };
    for reflect in [false, true] {
        let of = |block: WallMobilityBlock| if reflect { block.reflected().0 } else { block.0 };
        let (there, back) = (of(waves.block(x, spheres)), of(waves.block(-x, [spheres[1], spheres[0]])));
        for (i, j) in (0..ENTRIES).flat_map(|i| (0..ENTRIES).map(move |j| (i, j))) {
            let difference = there[i][j] * sign(j) - back[j][i] * sign(i);
            assert!(difference.abs() < 1e-12, "{i} {j}: {difference:e}");
        }
        let force = Vector::new(0.3, -0.2, 0.9);
        let dipole = Tensor::from_cols_array(&[0.1, 0.4, -0.7, 1.1, 0.5, 0.2, 0.9, -1.3, -0.6]);
        let ((u, d), (v, g)) =
            (WallMobilityBlock(there).motion_of_second(force, &dipole), WallMobilityBlock(back).motion(force, &dipole));
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
