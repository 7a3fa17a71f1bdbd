//! Resistance functions of a sphere at a wall against published and independently computed values.

use lubrication::two_sphere::{Function, SphereWall, TwoSphere, TwoSphereError, WallFunctions};

fn at(gap: f64) -> WallFunctions {
    SphereWall::get().resistance(gap).unwrap()
}

/// Force on a sphere that moves towards a plane, over that of an isolated one, Brenner (Chem. Eng. Sci. 16, 242,
/// 1961), eq. (2.19).
fn brenner(gap: f64) -> f64 {
    let alpha = (1.0 + gap).acosh();
    let term = |n: f64| {
        let (x, k) = ((n + 0.5) * alpha, 2.0 * n + 1.0);
        let upper = 2.0 * (2.0 * x).sinh() + k * (2.0 * alpha).sinh();
        let lower = 4.0 * x.sinh().powi(2) - (k * alpha.sinh()).powi(2);
        n * (n + 1.0) / ((2.0 * n - 1.0) * (2.0 * n + 3.0)) * (upper / lower - 1.0)
    };
    4.0 / 3.0 * alpha.sinh() * (1..(40.0 / alpha) as usize + 10).map(|n| term(n as f64)).sum::<f64>()
}

/// Torque on a sphere that rotates about the normal, over that of an isolated one, Jeffery (Proc. Lond. Math. Soc.
/// 14, 327, 1915).
fn jeffery(gap: f64) -> f64 {
    let alpha = (1.0 + gap).acosh();
    let terms = (1..(40.0 / alpha) as usize + 10).map(|n| (alpha.sinh() / (n as f64 * alpha).sinh()).powi(3));
    terms.sum()
}

#[test]
fn approach_obeys_brenner_and_spin_jeffery() {
    for gap in [1e-6, 1e-5, 1e-4, 1e-3, 0.01, 0.1, 0.54308, 1.0, 3.0, 10.0] {
        let found = at(gap);
        let (approach, spin) = (found[Function::XA] / brenner(gap) - 1.0, found[Function::XC] / jeffery(gap) - 1.0);
        // Error of the tables, and round-off of Brenner's terms, which cancel to a fourth power of the angle alpha.
        assert!(approach.abs() < 3e-8 && spin.abs() < 1e-8, "gap {gap}: off by {approach} and {spin}");
    }
}

/// Distance of the centre over the radius, the hyperbolic cosines of 1, 0.5 and 0.3 to four digits; force F/6 pi and
/// torque T/8 pi of a sphere that moves along the wall without rotation, Goldman, Cox & Brenner (Chem. Eng. Sci. 22,
/// 637, 1967), part I, tables 1 and 2.
const ALONG: [(f64, f64, f64); 3] =
    [(1.5431, 1.567447, 0.0146486), (1.1276, 2.151578, 0.0737300), (1.0453, 2.647967, 0.145587)];

#[test]
fn motion_along_the_wall_is_that_of_goldman_cox_and_brenner() {
    for (distance, force, torque) in ALONG {
        let found = at(distance - 1.0);
        // Six digits.
        assert!((found[Function::YA] - force).abs() < 2e-6, "{distance}: {}", found[Function::YA]);
        assert!((-0.5 * found[Function::YB] - torque).abs() < 1e-6, "{distance}: {}", found[Function::YB]);
    }
}

/// Single layer on the sphere in vector spherical harmonics, solved by Galerkin's method with the wall's images: gap,
/// YA, YB, YC, YM.
#[rustfmt::skip]
const SINGLE_LAYER: [(f64, [f64; 4]); 6] = [
    (0.2, [1.9527071, -0.099275316, 1.2766392, 1.66312]),
    (0.3, [1.7855781, -0.064590123, 1.1925058, 1.4718943]),
    (0.5, [1.5957066, -0.033147924, 1.1104955, 1.2820567]),
    (1.0, [1.3827524, -0.010049422, 1.0417836, 1.1144329]),
    (2.0, [1.2271551, -0.0020404531, 1.0117958, 1.0343627]),
    (10.0, [1.0538016, -1.2356155e-05, 1.0002349, 1.0007112]),
];

#[test]
fn transverse_functions_agree_with_a_single_layer() {
    for (gap, expected) in SINGLE_LAYER {
        let found = at(gap);
        for (function, expected) in [Function::YA, Function::YB, Function::YC, Function::YM].into_iter().zip(expected) {
            // Accuracy of the printed digits.
            assert!((found[function] - expected).abs() < 6e-8, "{function:?} at {gap}: {}", found[function]);
        }
    }
}

/// A sphere 20 times as large is the largest in the two-sphere tables: its functions differ from those of a wall by
/// about 1/20, and by twice that for a sphere half as large, up to second-order terms of 3/20 of that.
#[test]
fn a_wall_is_where_ever_larger_spheres_lead_to() {
    for gap in [1e-5, 0.02, 0.3] {
        let [ten, twenty] = [10.0, 20.0].map(|ratio| TwoSphere::with_ratio(ratio).unwrap().resistance(gap).unwrap());
        let wall = at(gap);
        for function in Function::ALL {
            let own = |functions: &lubrication::two_sphere::ResistanceFunctions| functions[function][0][0];
            let [ten, twenty, flat] = [own(&ten), own(&twenty), wall[function]];
            let halved = (twenty - flat) / (ten - flat);
            assert!((halved - 0.5).abs() < 0.15, "{function:?} at {gap}: {ten}, {twenty}, {flat}");
        }
    }
}

#[test]
fn a_far_wall_is_none() {
    let found = at(f64::INFINITY);
    for function in Function::ALL {
        let alone = matches!(
            function,
            Function::XA | Function::YA | Function::XC | Function::YC | Function::XM | Function::YM | Function::ZM
        );
        assert!((found[function] - f64::from(u8::from(alone))).abs() < 1e-10, "{function:?}: {}", found[function]);
    }
    assert_eq!(SphereWall::get().resistance(0.0), Err(TwoSphereError::Gap(0.0)));
}
