//! Pairs of spheres that overlap, or nearly, on a device.

use super::*;
use domain::Pairs;
use gpu::CloseSpheres;

/// Minimum gap over the mean radius, within which there are some pairs.
const GAP: f64 = 0.05;

/// Pairs on the host, with and without a minimum gap.
fn on_host(case: &Case, minimum_gap: Option<f64>) -> CloseSpheres {
    let Case { cell, particles, .. } = case;
    let (positions, radii) = (&particles.positions[..], &particles.radii);
    let cutoff = (2.0 + GAP) * radii.iter().copied().fold(0.0, f64::max);
    let pairs = Pairs::find(cell, positions, &particles.ids, particles.len(), cutoff);
    let mut found = CloseSpheres::default();
    for pair in pairs.list() {
        let contact = radii[pair.i as usize] + radii[pair.j as usize];
        let gap = pair.separation(cell, positions).length() - contact;
        found.overlapping += u64::from(gap < 0.0);
        found.at_minimum_gap += u64::from(minimum_gap.is_some_and(|least| gap < least * 0.5 * contact));
        found.depth = found.depth.max(-gap);
    }
    found
}

/// In boxes of all shapes and with radii of all ratios, whatever the order of threads is.
#[test]
fn close_spheres_are_those_of_the_host() {
    let shapes = [PERIODIC.as_slice(), &[OPEN], &CHANNELS].concat();
    let mut totals = [0, 0];
    for seed in 80..92 {
        let (shape, ratio) = (shapes[seed as usize % shapes.len()], [1.0, 8.0, 2.3][seed as usize % 3]);
        let precision = [Precision::Single, Precision::Double][seed as usize % 2];
        let case = Case::random(seed, shape, ratio);
        let plan = case.plan(precision);
        let mut devices = [1, 2].map(|order| case.on_device(&plan, emulator(&[], order)));
        for minimum_gap in [None, Some(GAP)] {
            let [found, again] = devices.each_mut().map(|far| far.fluctuating().unwrap().close_spheres(minimum_gap));
            let exact = on_host(&case, minimum_gap);
            assert_eq!(found, again);
            assert_eq!([found.overlapping, found.at_minimum_gap], [exact.overlapping, exact.at_minimum_gap]);
            assert!(
                (found.depth - exact.depth).abs() < 1e-13 * ratio,
                "{shape:?}: {} and {}",
                found.depth,
                exact.depth
            );
            totals[0] += found.overlapping;
            totals[1] += found.at_minimum_gap;
        }
    }
    assert!(totals[0] > 100 && 2 * totals[1] > totals[0] + 20, "{totals:?}");
}
