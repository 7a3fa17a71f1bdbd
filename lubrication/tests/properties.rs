//! Properties of the two-sphere functions for any ratio of radii.

use lubrication::two_sphere::{Function, TwoSphere, TwoSphereError, named};

const RATIOS: [f64; 3] = [2.5, 4.0, 10.0];
const GAPS: [f64; 9] = [1e-6, 1e-4, 9.9e-4, 0.011, 0.3, 2.0, 7.0, 60.0, 1e4];

/// Two spheres with equal velocities along their line of centres: the series of Stimson & Jeffery (1926).
fn stimson_jeffery(gap: f64) -> f64 {
    let alpha = (1.0 + 0.5 * gap).acosh();
    let term = |n: f64| {
        let x = (n + 0.5) * alpha;
        let (s, k) = (x.sinh(), 2.0 * n + 1.0);
        let inner = (4.0 * s * s - (k * alpha.sinh()).powi(2)) / (2.0 * (2.0 * x).sinh() + k * (2.0 * alpha).sinh());
        n * (n + 1.0) / ((2.0 * n - 1.0) * (2.0 * n + 3.0)) * (1.0 - inner)
    };
    4.0 / 3.0 * alpha.sinh() * (1..(40.0 / alpha) as usize + 10).map(|n| term(n as f64)).sum::<f64>()
}

#[test]
fn equal_spheres_in_line_obey_stimson_and_jeffery() {
    let table = TwoSphere::with_ratio(1.0).unwrap();
    for gap in [1e-3, 0.02, 0.5, 5.0] {
        let along = table.resistance(gap).unwrap()[Function::XA];
        let expected = stimson_jeffery(gap);
        assert!((along[0][0] + along[0][1] - expected).abs() < 1e-9, "gap {gap}: {along:?}, sum {expected}");
    }
}

#[test]
fn reciprocal_values_agree() {
    for ratio in RATIOS {
        for gap in GAPS {
            let functions = TwoSphere::with_ratio(ratio).unwrap().resistance(gap).unwrap();
            for function in
                [Function::XA, Function::YA, Function::XC, Function::YC, Function::XM, Function::YM, Function::ZM]
            {
                let [[_, upper], [lower, _]] = functions[function];
                // Computed from two separate motions; interpolation errors differ.
                assert!((upper / lower - 1.0).abs() < 1e-9, "{function:?} ratio {ratio} gap {gap}: {upper} {lower}");
            }
        }
    }
}

#[test]
fn names_of_the_spheres_do_not_matter() {
    for ratio in [2.5, 4.0] {
        let (table, swapped) = (TwoSphere::with_ratio(ratio).unwrap(), TwoSphere::with_ratio(1.0 / ratio).unwrap());
        for gap in GAPS {
            let (a, b) = (table.resistance(gap).unwrap(), swapped.resistance(gap / ratio).unwrap());
            for function in Function::ALL {
                let sign = if matches!(function, Function::YB | Function::XG | Function::YG) { -1.0 } else { 1.0 };
                for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    let (x, y) = (a[function][i][j], sign * b[function][1 - i][1 - j]);
                    assert!((x / y - 1.0).abs() < 1e-8, "{function:?} ratio {ratio} gap {gap}: {x} {y}");
                }
            }
        }
    }
}

/// Leading terms of the method of reflections: Stokeslets, rotlets and Faxén's laws.
#[test]
fn far_field_is_the_first_reflection() {
    for ratio in [1.0, 2.5, 10.0] {
        let (s, r) = (1.0 + ratio, 1e5);
        let functions = TwoSphere::with_ratio(ratio).unwrap().resistance(r - s).unwrap();
        let cube = (s * r).powi(3);
        let expected = [
            (Function::XA, 0, 1, -3.0 * ratio / (s * r)),
            (Function::YA, 0, 1, -1.5 * ratio / (s * r)),
            (Function::XC, 0, 1, -8.0 * ratio.powi(3) / cube),
            (Function::YC, 0, 1, 4.0 * ratio.powi(3) / cube),
            (Function::YB, 0, 1, 6.0 * ratio / (s * r).powi(2)),
            (Function::XM, 0, 1, 40.0 * ratio.powi(3) / cube),
            (Function::YM, 0, 1, -20.0 * ratio.powi(3) / cube),
        ];
        for (function, i, j, value) in expected {
            let found = functions[function][i][j];
            // The next term is smaller by (a/r)² times a number of order 10, for A and B by a/r.
            assert!((found / value - 1.0).abs() < 2e-3, "{function:?} ratio {ratio}: {found}, not {value}");
        }
        let alone = functions[Function::XA][0][0] - 1.0;
        assert!((alone / (2.25 * ratio / (r * r)) - 1.0).abs() < 1e-3, "XA11 - 1 is {alone}");
    }
}

#[test]
fn infinitely_far_spheres_are_alone() {
    let functions = TwoSphere::with_ratio(4.0).unwrap().resistance(f64::INFINITY).unwrap();
    for (name, value) in named(&functions) {
        let alone = ["XA", "YA", "XC", "YC", "XM", "YM", "ZM"]
            .iter()
            .any(|f| name == format!("{f}11") || name == format!("{f}22"));
        assert!((value - f64::from(u8::from(alone))).abs() < 1e-10, "{name} is {value}");
    }
}

/// Spheres at contact that rotate about their line of centres: `lambda³/(1 + lambda)³ zeta(3, lambda/(1 + lambda))`.
#[test]
fn spin_at_contact_is_a_zeta_function() {
    for ratio in RATIOS {
        let x = ratio / (1.0 + ratio);
        let count = 20_000;
        let head: f64 = (0..count).map(|n| (f64::from(n) + x).powi(-3)).sum();
        let edge = f64::from(count) + x;
        let zeta = head + 0.5 * edge.powi(-2) + 0.5 * edge.powi(-3);
        let found = TwoSphere::with_ratio(ratio).unwrap().resistance(1e-12).unwrap()[Function::XC][0][0];
        assert!((found - x.powi(3) * zeta).abs() < 1e-9, "ratio {ratio}: {found}");
    }
}

#[test]
fn refuses_what_has_no_answer() {
    assert_eq!(TwoSphere::with_ratio(0.0).unwrap_err(), TwoSphereError::Ratio(0.0));
    assert!(TwoSphere::with_ratio(f64::NAN).unwrap_err().to_string().contains("0.05 to 20"));
    assert_eq!(TwoSphere::with_ratio(1.0).unwrap().resistance(0.0), Err(TwoSphereError::Gap(0.0)));
    assert!(TwoSphere::with_ratio(1.0).unwrap().resistance(f64::NAN).is_err());
}
