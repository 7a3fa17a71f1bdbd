use super::{DensityMap, LayerProfile};
use crate::shear_cell::{CellModel, CollisionRule, FrictionLaw, GrainMotion, Grains};
use domain::Vector;
use std::f64::consts::PI;

fn gas() -> CellModel {
    let contact = CollisionRule { restitution: 1.0, friction: 0.0, law: FrictionLaw::Box };
    CellModel::gas(Vector::new(5.0, 4.0, 6.0), 1.0, 1.0, contact).unwrap()
}

/// Grains at given heights with given velocities.
fn grains(given: &[(f64, Vector)]) -> Grains {
    let place = |&(y, _): &(f64, Vector)| Vector::new(1.0, y, 1.5);
    let motion = |&(_, velocity): &(f64, Vector)| GrainMotion { velocity, spin: Vector::ZERO };
    Grains { positions: given.iter().map(place).collect(), motions: given.iter().map(motion).collect() }
}

/// One grain in the lower of two layers, one half in each, sampled twice.
#[test]
fn grains_count_by_their_volume_in_a_layer() {
    let (model, [up, along]) = (gas(), [Vector::new(1.0, 2.0, -3.0), Vector::new(4.0, 0.0, 0.0)]);
    let mut profile = LayerProfile::new(&model, 4.0, 2);
    profile.add(&model, &grains(&[(1.0, up), (2.0, along)]));
    profile.add(&model, &grains(&[(1.2, up), (2.0, 2.0 * along)]));
    let [low, high] = profile.layers()[..] else { panic!("two layers") };
    let volume = PI / 6.0 / (5.0 * 2.0 * 6.0);
    let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    near(low.y, 1.0);
    near(high.y, 3.0);
    near(low.solid_fraction, 1.5 * volume);
    near(high.solid_fraction, 0.5 * volume);
    // Of three grain volumes in the lower layer, two have `up`, a half has `along` and a half twice that.
    let velocities = [(up * 2.0 + along * 1.5) / 3.0, along * 1.5];
    near((low.velocity - velocities[0]).length(), 0.0);
    near((high.velocity - velocities[1]).length(), 0.0);
    let squares = [(2.0 * 14.0 + 0.5 * 16.0 + 0.5 * 64.0) / 3.0, 0.5 * 16.0 + 0.5 * 64.0];
    let temperature = |k: usize| (squares[k] - velocities[k].length_squared()) / 3.0;
    near(low.temperature, temperature(0));
    near(high.temperature, temperature(1));
    near(profile.temperature(), (3.0 * temperature(0) + temperature(1)) / 4.0);
}

/// Pixels as wide as a grain, sampled at a third of their width: one grain in the middle of a pixel, then one between
/// two. The third sample is an empty cell.
#[test]
fn a_map_has_the_mean_chord_of_each_pixel() {
    let model = gas();
    let mut map = DensityMap::new(&model, 4.0, [6, 4]);
    for heights in [&[0.5][..], &[3.0], &[]] {
        let still: Vec<_> = heights.iter().map(|&y| (y, Vector::ZERO)).collect();
        map.add(&model, &grains(&still));
    }
    assert_eq!(map.middles(), [vec![0.5, 1.5, 2.5, 3.5, 4.5, 5.5], vec![0.5, 1.5, 2.5, 3.5]]);
    let chord = |square: f64| 2.0 * (0.25 - square).sqrt();
    let lines = 9.0 * 5.0 * 3.0;
    let whole = (chord(0.0) + 4.0 * chord(1.0 / 9.0) + 4.0 * chord(2.0 / 9.0)) / lines;
    let half = (chord(1.0 / 36.0) + 2.0 * chord(1.0 / 36.0 + 1.0 / 9.0)) / lines;
    let expected = |pixel: usize| match pixel {
        1 => whole,
        13 | 19 => half,
        _ => 0.0,
    };
    for (pixel, found) in map.solid_fractions().into_iter().enumerate() {
        assert!((found - expected(pixel)).abs() < 1e-12, "{pixel}: {found}");
    }
}
