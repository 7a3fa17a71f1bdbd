use super::*;
use crate::{Pairs, Random};

const FOUR_THIRDS_PI: f64 = 4.0 / 3.0 * std::f64::consts::PI;

fn cube(radii: &[f64], fraction: f64) -> PeriodicBox {
    let volume: f64 = radii.iter().map(|a| FOUR_THIRDS_PI * a.powi(3)).sum();
    PeriodicBox::new(Vector::splat((volume / fraction).cbrt())).unwrap()
}

/// Distances of the pairs nearer than `cutoff`, and the smallest gap between surfaces.
fn distances(cell: &PeriodicBox, radii: &[f64], positions: &[Vector], cutoff: f64) -> (Vec<f64>, f64) {
    let ids: Vec<u64> = (0..radii.len() as u64).collect();
    let pairs = Pairs::find(cell, positions, &ids, ids.len(), cutoff);
    let mut gap = f64::INFINITY;
    let mut all = Vec::new();
    for pair in pairs.list() {
        let distance = pair.separation(cell, positions).length();
        gap = gap.min(distance - radii[pair.i as usize] - radii[pair.j as usize]);
        all.push(distance);
    }
    (all, gap)
}

#[test]
fn nothing_overlaps_at_any_density() {
    let equal = vec![1.0; 400];
    let two_sizes: Vec<f64> = (0..400).map(|i| if i % 4 == 0 { 2.5 } else { 1.0 }).collect();
    for radii in [equal, two_sizes] {
        for (fraction, gap) in [(0.05, 0.5), (0.12, 0.0), (0.25, 0.01), (0.4, 0.0), (0.5, 0.01), (0.6, 0.0)] {
            let cell = cube(&radii, fraction);
            let positions = random_packing(&cell, &radii, gap, 11).unwrap();
            let found = distances(&cell, &radii, &positions, 5.5).1;
            // 1e-12: round-off of the two ways to compute a distance.
            assert!(found >= gap - 1e-12, "gap {found} at a volume fraction of {fraction}");
            assert!(positions.iter().all(|&p| cell.wrap(p).1 == [0; 3]), "inside the box");
        }
    }
}

#[test]
fn a_seed_is_one_packing() {
    let radii = vec![1.0; 300];
    for fraction in [0.2, 0.45] {
        let cell = cube(&radii, fraction);
        let [first, again, other] = [1, 1, 2].map(|seed| random_packing(&cell, &radii, 0.0, seed).unwrap());
        assert_eq!(first, again);
        assert_ne!(first, other);
    }
}

/// The pair distribution is that of hard spheres: flat far away, and near contact no higher than the fluid's
/// `g(2a) = (1 - phi/2)/(1 - phi)^3` (Carnahan & Starling 1969), without an excess of touching pairs.
#[test]
fn pairs_are_spread_as_in_a_fluid() {
    let radii = vec![1.0; 2000];
    for fraction in [0.12_f64, 0.4] {
        let cell = cube(&radii, fraction);
        let positions = random_packing(&cell, &radii, 0.0, 5).unwrap();
        let (all, _) = distances(&cell, &radii, &positions, 6.0);
        let g = |low: f64, high: f64| {
            let count = all.iter().filter(|r| (low..high).contains(*r)).count() as f64;
            let density = radii.len() as f64 / cell.volume();
            count / (0.5 * radii.len() as f64 * density * FOUR_THIRDS_PI * (high.powi(3) - low.powi(3)))
        };
        assert!((g(4.5, 6.0) - 1.0).abs() < 0.05, "far: {}", g(4.5, 6.0));
        let contact = (1.0 - 0.5 * fraction) / (1.0 - fraction).powi(3);
        let near = g(2.0, 2.05);
        assert!(near > 0.5 * contact && near < 1.4 * contact, "near contact: {near}, a fluid has {contact}");
    }
}

/// Sizes over three decades, with small spheres in the gaps of large ones, after placement and after random moves.
#[test]
fn spheres_of_very_different_sizes_do_not_overlap() {
    let radii: Vec<f64> =
        (0..2000).map(|i| if i < 4 { 1.0 } else { 10_f64.powf(-3.0 * f64::from(i) / 2000.0) }).collect();
    for fraction in [0.05, 0.2] {
        let cell = PeriodicBox::sheared(cube(&radii, fraction).edges(), 0.3).unwrap();
        let positions = random_packing(&cell, &radii, 0.0, 5).unwrap();
        let gap = |i: usize, j: usize| cell.nearest_image(positions[j] - positions[i]).length() - radii[i] - radii[j];
        let pairs = (0..radii.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
        assert!(pairs.map(|(i, j)| gap(i, j)).fold(f64::INFINITY, f64::min) > -1e-12);
    }
}

#[test]
fn boxes_of_any_shape_are_filled() {
    let radii = vec![1.0; 30];
    let cell = PeriodicBox::sheared(Vector::new(3.0, 40.0, 5.0), 0.02).unwrap();
    let positions = random_packing(&cell, &radii, 0.0, 3).unwrap();
    assert!(distances(&cell, &radii, &positions, 2.9).1 >= 0.0);
}

#[test]
fn what_cannot_be_is_refused() {
    let cell = PeriodicBox::new(Vector::splat(4.0)).unwrap();
    assert!(matches!(random_packing(&cell, &[2.1], 0.0, 1), Err(PackingError::OwnImage { .. })));
    assert!(matches!(random_packing(&cell, &[1.0; 12], 0.0, 1), Err(PackingError::TooDense { .. })));
    assert_eq!(random_packing(&cell, &[], 0.0, 1), Ok(vec![]));
}

/// By sequential addition, and dense.
#[test]
fn powers_of_two_of_lengths_are_powers_of_two_of_places() {
    for fraction in [0.2_f64, 0.4] {
        let packed = |unit: f64| {
            let edge = unit * (50.0 * 4.0 / 3.0 * std::f64::consts::PI / fraction).cbrt();
            let cell = PeriodicBox::new(Vector::splat(edge)).unwrap();
            let places = random_packing(&cell, &[unit; 50], 0.01 * unit, 5).unwrap();
            places.into_iter().map(|place| place / unit).collect::<Vec<_>>()
        };
        let expected = packed(1.0);
        for power in [-40, -20, 20, 40] {
            assert_eq!(packed(2_f64.powi(power)), expected, "2^{power} at {fraction}");
        }
    }
}

/// The definition: each sphere in turn, the largest first, at the first of its random positions that is free.
fn by_definition(cell: &PeriodicBox, sizes: &[f64], seed: u64) -> Vec<Vector> {
    let mut order: Vec<usize> = (0..sizes.len()).collect();
    order.sort_by(|&i, &j| sizes[j].total_cmp(&sizes[i]));
    let mut positions = vec![Vector::ZERO; sizes.len()];
    for (k, &i) in order.iter().enumerate() {
        let mut random = Random::new(seed, i as u64);
        let is_free = |p: &Vector| {
            let touches = |&j: &usize| {
                cell.nearest_image(positions[j] - *p).length_squared() < (sizes[i] + sizes[j]) * (sizes[i] + sizes[j])
            };
            !order[..k].iter().any(touches)
        };
        let tries = std::iter::repeat_with(|| cell.wrap(random.point() * cell.edges()).0);
        positions[i] = tries.take(20_000).find(is_free).expect("there is room");
    }
    positions
}

/// Batches, ranks and shares of the box change nothing, even if most tries hit spheres of the same batch.
#[test]
fn places_are_those_of_the_definition_on_any_ranks() {
    let one = vec![(1.0, 500)];
    let several = vec![(0.4, 300), (1.0, 60), (1.0, 20), (0.1, 300), (2.5, 0)];
    for (groups, fraction, strain) in
        [(&one, 0.12, 0.0), (&one, 0.24, 0.2), (&several, 0.12, 0.0), (&several, 0.22, -0.4)]
    {
        let radii: Vec<f64> = groups.iter().flat_map(|&(a, count)| std::iter::repeat_n(a, count)).collect();
        let cell = PeriodicBox::sheared(cube(&radii, fraction).edges(), strain).unwrap();
        let sizes: Vec<f64> = radii.iter().map(|a| a + 0.5 * 0.01).collect();
        let expected = by_definition(&cell, &sizes, 9);
        assert_eq!(random_packing(&cell, &radii, 0.01, 9).unwrap(), expected);
        for ranks in [1, 2, 3, 7] {
            let found = Comm::threads(ranks, |comm| {
                let partition = Partition::new(&comm, [20, 14]);
                let own = shared_random_packing(&cell, groups, 0.01, 9, &partition).unwrap().unwrap();
                assert!(own.iter().all(|&(_, place)| partition.owner(&cell, place) == comm.rank()));
                own
            });
            let mut all = found.concat();
            all.sort_by_key(|(id, _)| *id);
            assert!(all.into_iter().eq((0..).zip(expected.iter().copied())), "{ranks} ranks at {fraction}");
        }
    }
}

#[test]
fn what_has_to_be_moved_apart_is_not_shared() {
    let partition = Partition::new(&Comm::alone(), [4, 4]);
    let cell = cube(&[1.0; 100], 0.3);
    assert_eq!(shared_random_packing(&cell, &[(1.0, 100)], 0.0, 1, &partition), Ok(None));
    let packed = shared_random_packing(&PeriodicBox::new(Vector::splat(1.0)).unwrap(), &[(1.0, 1)], 0.0, 1, &partition);
    assert!(matches!(packed, Err(PackingError::OwnImage { .. })));
}
