//! Moments of pairs against multipoles about both centres, limits and symmetries.

use super::*;
use std::f64::consts::PI;

fn pair(radii: [f64; 2], susceptibilities: [f64; 2]) -> PolarisablePair {
    PolarisablePair { radii, susceptibilities }
}

/// Moments by multipoles up to a degree about both centres, of which the sphere `i` has `b_l` with
/// `b_l + beta_l sum_n (+-) C(l, n) a_i^(2l + 1) b_n / r^(l + n + 1) = beta_1 a_i^3 delta_l1`, by iteration, with
/// `beta_l = l chi / (l (chi + 2) + 1)`.
fn by_multipoles(pair: &PolarisablePair, distance: f64, order: usize) -> [f64; 2] {
    const DEGREES: usize = 60;
    let log_factorial = |n: usize| (1..=n).map(|k| (k as f64).ln()).sum::<f64>();
    let coupling = |l: usize, n: usize| {
        let size = log_factorial(l + n) - log_factorial(l - order) - log_factorial(n + order);
        (size - (l + n + 1) as f64 * distance.ln()).exp() * if order == 0 { 1.0 } else { -1.0 }
    };
    let couplings: Vec<Vec<f64>> = (1..DEGREES).map(|l| (1..DEGREES).map(|n| coupling(l, n)).collect()).collect();
    let response = |i: usize, l: usize| {
        let chi = pair.susceptibilities[i];
        l as f64 * chi / (l as f64 * (chi + 2.0) + 1.0) * pair.radii[i].powi(2 * l as i32 + 1)
    };
    let mut multipoles = [vec![0.0; DEGREES - 1], vec![0.0; DEGREES - 1]];
    for _ in 0..400 {
        for i in 0..2 {
            for l in 1..DEGREES {
                let others: f64 = couplings[l - 1].iter().zip(&multipoles[1 - i]).map(|(c, b)| c * b).sum();
                multipoles[i][l - 1] = response(i, l) * (others + if l == 1 { 1.0 } else { 0.0 });
            }
        }
    }
    multipoles.map(|b| 4.0 * PI * b[0])
}

#[test]
fn exact_moments_are_those_of_multipoles() {
    for (radii, chi) in
        [([1.0, 1.0], [10.0, 10.0]), ([1.0, 2.0], [3.0, 0.3]), ([1.5, 1.0], [-0.6, -0.9]), ([1.0, 3.0], [1e3, 1e3])]
    {
        for gap in [0.3, 1.0, 4.0] {
            let (pair, distance) = (pair(radii, chi), radii[0] + radii[1] + gap);
            let found = exact_moments(&pair, distance);
            for (order, found) in [found.along, found.across].into_iter().enumerate() {
                let exact = by_multipoles(&pair, distance, order);
                for i in 0..2 {
                    let error = (found[i] / exact[i] - 1.0).abs();
                    assert!(error < 1e-8, "{pair:?}, gap {gap}, order {order}, sphere {i}: {error:e}");
                }
            }
        }
    }
}

/// In a field across the line of centres two touching conductors of equal radii have `3/4 zeta(3)` times the moments of
/// single ones.
#[test]
fn touching_conductors_have_moments_in_closed_form() {
    let zeta = 1.202_056_903_159_594_f64;
    let across = |gap: f64| exact_moments(&pair([1.0; 2], [1e9; 2]), 2.0 + gap).across[0] / (4.0 * PI);
    assert!((across(1e-5) - 0.75 * zeta).abs() < 1e-4, "{}", across(1e-5));
}

/// Far apart dipoles are exact: differences fall like the eighth power of the distance, and envelopes do not overlap.
#[test]
fn dipoles_are_exact_far_apart() {
    let pair = pair([1.0, 1.4], [5.0, 2.0]);
    let difference = |r: f64| exact_moments(&pair, r).minus(&dipole_moments(&pair, r));
    let (near, far) = (difference(9.0), difference(18.0));
    for (near, far) in near.along.into_iter().chain(near.across).zip(far.along.into_iter().chain(far.across)) {
        let order = (near / far).log2();
        assert!((7.7..8.6).contains(&order), "{order}");
    }
}

/// Between the nodes tables have the difference minus its tangent at the reach, and slopes are those of values.
#[test]
fn tables_have_the_difference_and_its_slope() {
    for chi in [0.3, 10.0, 1e5] {
        let pair = pair([1.0, 2.0], [chi; 2]);
        let table = PolarisedPairTable::new(&pair);
        let difference = |r: f64| exact_moments(&pair, r).minus(&dipole_moments(&pair, r)).along[0];
        let (reach, step) = (table.reach(), 1e-4);
        let slope_at_reach = (difference(reach + step) - difference(reach - step)) / (2.0 * step);
        for gap in [3e-4, 1.7e-3, 0.02, 0.31, 1.9] {
            let found = table.at(3.0 + gap).unwrap();
            let exact = difference(3.0 + gap) - difference(reach) - slope_at_reach * (3.0 + gap - reach);
            assert!((found.moments.along[0] - exact).abs() < 1e-6 * 4.0 * PI, "{chi} at {gap}");
            let step = 1e-3 * gap;
            let [after, before] = [step, -step].map(|step| table.at(3.0 + gap + step).unwrap().moments.across[1]);
            let slope = (after - before) / (2.0 * step);
            assert!((found.slopes.across[1] - slope).abs() < 1e-4 * slope.abs(), "{chi} at {gap}");
        }
        assert!(table.at(reach).is_none() && table.at(reach - 1e-9).unwrap().slopes.along[0].abs() < 1e-9);
        // Spheres that overlap have the slope of the nearest ones.
        assert_eq!(table.at(3.0 - 0.1).unwrap().slopes, table.at(3.0 + 1e-4).unwrap().slopes);
    }
}
