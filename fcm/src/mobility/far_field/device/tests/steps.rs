//! Measures of displacements and gaps on a device, beside sums over all images of all pairs.

use super::moving::{Moving, MovingPair};
use super::*;
use crate::mobility::stepping::{
    DisplacementError, DisplacementOrders, DisplacementWeights, GapChanges, HeldSteps, HeldVelocities, Separation,
    SeparationLimits,
};
use domain::Random;
use gpu::DeviceCounts;

/// Ratios of smooth motions.
const SMOOTH: [f64; 2] = [0.25, 0.06];

/// Limits as those of implicit steps.
fn limits(closest: f64, reach: f64) -> SeparationLimits {
    SeparationLimits { closest, slack: 0.1, rounds: 100, reach }
}

/// Weights whose differences between one order and the next grow by some factors.
fn orders(seed: u64) -> [DisplacementWeights; 4] {
    let mut random = Random::new(seed, 2);
    let mut weights = [[0.0; 4]; 4];
    let growth = [1e-3, 3e-3, 0.02, 0.05];
    for order in (0..4).rev() {
        let lower = if order < 3 { weights[order + 1] } else { [0.0; 4] };
        weights[order] = lower.map(|weight| weight + growth[order] * (2.0 * random.uniform() - 1.0));
    }
    weights
}

/// Error and roughness from the differences between one order and the next.
fn estimate(differences: &[f64], smooth: [f64; 2]) -> [f64; 2] {
    match differences {
        [a, b, c] if *a <= (smooth[0] * b).max(smooth[1] * c) => [b.max(a / 4.0), 0.0],
        [a, b, _] => [*b, *a],
        all => [all[0], 0.0],
    }
}

/// All weights, the one that moves, and the ratios of smooth motions.
fn parts<'a>(orders: &'a DisplacementOrders) -> (&'a [DisplacementWeights], usize, [f64; 2]) {
    match orders {
        DisplacementOrders::Two(weights) => (&weights[..], 0, [0.0; 2]),
        DisplacementOrders::Four { weights, smooth } => (&weights[..], 1, *smooth),
    }
}

fn changes(pairs: &[MovingPair], orders: &DisplacementOrders, least: [f64; 2]) -> GapChanges {
    let (weights, moving, smooth) = parts(orders);
    let mut worst = GapChanges { gap: f64::INFINITY, loss: 0.0, error: 0.0, roughness: 0.0 };
    for pair in pairs {
        let gap = pair.separation.length() - 2.0 * pair.mean();
        worst.gap = worst.gap.min(gap);
        let sizes = least.map(|least| gap.max(least * pair.mean()));
        if sizes[0] > 0.0 {
            let gaps: Vec<f64> = weights.iter().map(|weights| pair.gap_after(weights)).collect();
            let differences: Vec<f64> = gaps.windows(2).map(|two| (two[0] - two[1]).abs()).collect();
            let [error, roughness] = estimate(&differences, smooth);
            worst.loss = worst.loss.max((gap - gaps[moving]) / sizes[0]);
            worst.error = worst.error.max(error / sizes[1]);
            worst.roughness = worst.roughness.max(roughness / sizes[1]);
        }
    }
    worst
}

fn displacement_error(moving: &Moving, orders: &DisplacementOrders) -> DisplacementError {
    let (weights, _, smooth) = parts(orders);
    let moved = |row: usize, weights: &DisplacementWeights| -> Vector {
        moving.columns.iter().zip(weights).map(|(of, &w)| of[row] * w).sum()
    };
    let mut worst = [0.0_f64; 2];
    for (row, radius) in moving.case.particles.radii.iter().enumerate() {
        let places: Vec<Vector> = weights.iter().map(|weights| moved(row, weights)).collect();
        let differences: Vec<f64> = places.windows(2).map(|two| (two[0] - two[1]).length() / radius).collect();
        let found = estimate(&differences, smooth);
        worst = [0, 1].map(|k| if found[k].is_nan() { f64::INFINITY } else { worst[k].max(found[k]) });
    }
    DisplacementError { error: worst[0], roughness: worst[1] }
}

/// Displacements that separate pairs; whether they converge.
fn moved_apart(
    moving: &Moving,
    pairs: &[MovingPair],
    weights: &DisplacementWeights,
    limits: &SeparationLimits,
) -> (Vec<Vector>, bool) {
    let mut displacements = vec![Vector::ZERO; moving.case.particles.len()];
    for _ in 0..limits.rounds {
        let mut sums = vec![(Vector::ZERO, 0.0); displacements.len()];
        for pair in pairs {
            let [i, j] = pair.rows;
            let apart = pair.after(weights) + displacements[i] - displacements[j];
            let gap = limits.closest * pair.mean();
            let missing = gap + 2.0 * pair.mean() - apart.length();
            if missing > limits.slack * gap {
                let axis = if apart == Vector::ZERO { Vector::X } else { apart.normalize() };
                let share = axis * missing / (2.0 * pair.mean());
                sums[i] = (sums[i].0 + share * pair.radii[1], sums[i].1 + 1.0);
                sums[j] = (sums[j].0 - share * pair.radii[0], sums[j].1 + 1.0);
            }
        }
        if sums.iter().all(|(_, count)| *count == 0.0) {
            return (displacements, true);
        }
        for (displacement, (sum, count)) in displacements.iter_mut().zip(sums) {
            *displacement += sum / f64::max(count, 1.0);
        }
    }
    (displacements, false)
}

fn assert_near(found: f64, exact: f64, what: &str) {
    assert!(
        found.to_bits() == exact.to_bits() || (found - exact).abs() <= 1e-9 * exact.abs(),
        "{what}: {found} instead of {exact}"
    );
}

/// Random cases in boxes of both kinds, in both precisions, with two, three and four columns, with their largest
/// radii.
fn cases(seeds: std::ops::Range<u64>) -> impl Iterator<Item = (u64, Moving, Precision, f64)> {
    seeds.map(|seed| {
        let shape = [Shape::Sheared, Shape::Upright, Shape::Tilted][seed as usize / 2 % 3];
        let precision = [Precision::Single, Precision::Double][seed as usize / 3 % 2];
        let moving = Moving::random(seed, shape, 2 + seed as usize % 3);
        let largest = moving.case.particles.radii.iter().copied().fold(0.0, f64::max);
        (seed, moving, precision, largest)
    })
}

/// In any order of threads; a NaN in a velocity does not hide other pairs.
#[test]
fn changes_of_gaps_are_those_of_all_pairs() {
    let (mut rough, mut across, mut overlapping) = (0, 0, 0);
    for (seed, mut moving, precision, largest) in cases(0..12) {
        if seed % 4 == 3 {
            moving.columns[1][3] = Vector::splat(-f64::NAN);
        }
        let (reach, weights) = ([3.0, 2.2][seed as usize % 2] * largest, orders(seed));
        let pairs = moving.near(reach);
        let held = [1, 2].map(|order| moving.on(precision, emulator(&[], order), seed % 2 == 0));
        let four = DisplacementOrders::Four { weights: &weights, smooth: SMOOTH };
        let two = DisplacementOrders::Two(&[weights[1], weights[3]]);
        for (orders, least) in [(&two, [0.0, 1e-3]), (&two, [0.1, 0.02]), (&four, [0.0, 1e-3]), (&four, [0.01, 0.1])] {
            let exact = changes(&pairs, orders, least);
            let [found, again] = held.each_ref().map(|of| of.steps.gap_changes(&of.velocities(), orders, least, reach));
            assert_eq!(found, again);
            assert_near(found.gap, exact.gap, "gap");
            assert_near(found.loss, exact.loss, "loss");
            assert_near(found.error, exact.error, "error");
            assert_near(found.roughness, exact.roughness, "roughness");
            assert!(exact.loss > 0.0 && exact.error > 0.0);
            rough += usize::from(exact.roughness > 0.0);
        }
        let smallest = |pair: &MovingPair| pair.separation.length() / pair.mean() - 2.0;
        let exact = pairs.iter().map(smallest).fold(f64::INFINITY, f64::min);
        assert_near(held[0].steps.smallest_relative_gap(reach), exact, "relative gap");
        overlapping += usize::from(exact < 0.0);
        let here = |row: usize| moving.case.particles.positions[row];
        across += pairs.iter().filter(|pair| here(pair.rows[0]) - here(pair.rows[1]) != pair.separation).count();
    }
    assert!(rough > 8 && across > 100 && overlapping > 6, "{rough} {across} {overlapping}");
}

#[test]
fn errors_of_displacements_are_those_of_all_particles() {
    for (seed, mut moving, precision, _) in cases(20..26) {
        if seed % 4 == 3 {
            moving.columns[0][2].y = -f64::NAN;
        }
        let weights = orders(seed);
        let held = [1, 2].map(|order| moving.on(precision, emulator(&[], order), seed % 2 == 0));
        let four = DisplacementOrders::Four { weights: &weights, smooth: SMOOTH };
        for orders in [&four, &DisplacementOrders::Two(&[weights[0], [0.0; 4]])] {
            let exact = displacement_error(&moving, orders);
            let [found, again] = held.each_ref().map(|of| of.steps.displacement_error(&of.columns, orders));
            assert_eq!(found, again);
            assert_near(found.error, exact.error, "error");
            assert_near(found.roughness, exact.roughness, "roughness");
            assert_eq!(found.error.is_infinite(), seed % 4 == 3);
        }
    }
}

/// Differences of 5 or 7, 1 and 100 times the radius, of which the former is smooth; gaps are those from its own
/// images, if these are within reach.
#[test]
fn one_particle_has_an_error_and_gaps_from_its_images() {
    for (highest, error, roughness) in [(5.0, 1.25, 0.0), (7.0, 1.0, 7.0)] {
        let moving = Moving::in_cube(30.0, &[(Vector::splat(29.0), 2.0, 2.0 * Vector::Y)]);
        let held = moving.on(Precision::Single, emulator(&[], 1), false);
        let weights = [101.0 + highest, 101.0, 100.0, 0.0].map(|weight| [weight, 0.0, f64::NAN, 0.0]);
        let orders = DisplacementOrders::Four { weights: &weights, smooth: SMOOTH };
        assert_eq!(held.steps.displacement_error(&held.columns, &orders), DisplacementError { error, roughness });
        let none = GapChanges { gap: f64::INFINITY, loss: 0.0, error: 0.0, roughness: 0.0 };
        assert_eq!(held.steps.gap_changes(&held.velocities(), &orders, [0.1; 2], 6.0), none);
        assert!(held.steps.smallest_relative_gap(6.0).is_infinite());
        let own = held.steps.gap_changes(&held.velocities(), &orders, [0.1; 2], 30.5);
        assert_eq!(own, GapChanges { gap: 26.0, ..none });
        assert!((held.steps.smallest_relative_gap(30.5) - 13.0).abs() < 1e-12);
        let apart = held.steps.moved_apart(&held.velocities(), &weights[0], &limits(1e-3, 6.0));
        assert_eq!(apart, Separation::Apart);
    }
}

#[test]
fn without_particles_there_is_nothing() {
    let mut moving = Moving::random(1, Shape::Upright, 2);
    let plan = moving.case.plan(Precision::Double);
    moving.case.particles = Particles::default();
    moving.columns = vec![Vec::new(); 2];
    let mut far = moving.case.on_device(&plan, emulator(&[], 1));
    let coupled = far.coupled().unwrap();
    let (holder, steps): (_, Rc<dyn HeldSteps>) = (coupled.holder(), coupled.steps());
    let (positions, columns) = (holder.hold(&[]), [holder.hold(&[])]);
    let (flow, deformation) = (&moving.flow, moving.deformation);
    let velocities = HeldVelocities { positions: &positions, columns: &columns, flow, deformation };
    let orders = DisplacementOrders::Two(&[[1.0; 4], [0.0; 4]]);
    let error = steps.displacement_error(&columns, &orders);
    assert_eq!(error, DisplacementError { error: 0.0, roughness: 0.0 });
    assert!(steps.gap_changes(&velocities, &orders, [0.1; 2], 6.0).gap.is_infinite());
    assert_eq!(steps.moved_apart(&velocities, &[1.0; 4], &limits(1e-3, 6.0)), Separation::Apart);
    assert!(holder.copies(&[&steps.combined(&[(columns[0].clone(), 2.0)])])[0].is_empty());
}

/// Pairs that are moved by a small part of a radius are separated, with the same bits in any order of threads.
#[test]
fn pairs_are_moved_apart_as_all_images_are() {
    let (mut converged, mut failed, mut largest_push) = (0, 0, 0.0_f64);
    for (seed, moving, precision, largest) in cases(40..52) {
        let (reach, weights) = (3.0 * largest, orders(seed)[1]);
        let limits = SeparationLimits { rounds: [100, 30][seed as usize % 2], ..limits(1e-2, reach) };
        let (exact, is_done) = moved_apart(&moving, &moving.near(reach), &weights, &limits);
        let [found, again] = [1, 2].map(|order| {
            let held = moving.on(precision, emulator(&[], order), seed % 2 == 0);
            match held.steps.moved_apart(&held.velocities(), &weights, &limits) {
                Separation::By(list) => Some(held.vectors(&list)),
                Separation::Fails => None,
                Separation::Apart => panic!("there are close pairs"),
            }
        });
        assert_eq!(found, again);
        assert_eq!(found.is_some(), is_done, "{seed}");
        for (found, exact) in found.iter().flatten().zip(&exact) {
            assert!((*found - *exact).length() < 1e-9 * largest, "{seed}: {found} instead of {exact}");
            largest_push = largest_push.max(exact.length() / largest);
        }
        converged += usize::from(is_done);
        failed += usize::from(!is_done);
    }
    assert!(converged > 3 && failed > 0 && largest_push > 1e-3, "{converged} {failed} {largest_push}");
}

/// The host looks after several rounds at a time. Those after the last one that moves spheres, and one more that finds
/// that none are too close, change nothing; with one fewer the separation fails.
#[test]
fn displacements_stay_as_they_are_after_the_last_round() {
    let mut numbers = Vec::new();
    for (seed, moving, precision, largest) in cases(60..70) {
        let (reach, weights) = (3.0 * largest, orders(seed)[1]);
        let within = |rounds| SeparationLimits { rounds, ..limits(1e-2, reach) };
        let near = moving.near(reach);
        let Some(needed) = (1..=100).find(|&rounds| moved_apart(&moving, &near, &weights, &within(rounds)).1) else {
            continue;
        };
        let (device, counts) = Counted::new(emulator(&[], 1));
        let held = moving.on(precision, Box::new(device), false);
        let moved = |rounds| match held.steps.moved_apart(&held.velocities(), &weights, &within(rounds)) {
            Separation::By(list) => Some(held.vectors(&list)),
            Separation::Fails => None,
            Separation::Apart => panic!("there are close pairs"),
        };
        assert_eq!(moved(needed - 1), None);
        let exact = moved(needed);
        assert!(exact.is_some());
        for more in 1..=needed.next_power_of_two() {
            assert_eq!(moved(needed + more), exact, "{more} rounds after {needed}");
        }
        let before = counts.borrow().waits;
        held.steps.moved_apart(&held.velocities(), &weights, &within(200));
        assert!(counts.borrow().waits - before <= 5 + needed as u64 / 16, "waits of {needed} rounds");
        numbers.push(needed);
    }
    assert!(numbers.len() > 3 && numbers.iter().any(|&needed| needed > 16), "{numbers:?}");
}

/// A chain of nearly touching spheres that is pressed from both ends across a face keeps its gaps; one that is let go
/// stays as it is; and one that fills the box cannot be separated. Spheres with the same centre move along x.
#[test]
fn a_chain_that_is_pressed_keeps_its_gaps() {
    let sphere = |x: f64, radius: f64, velocity: f64| (Vector::new(x, 5.0, 5.0), radius, velocity * Vector::X);
    let chain = Moving::in_cube(10.0, &[sphere(9.0, 1.0, 0.1), sphere(0.5, 0.5, 0.0), sphere(2.0, 1.0, -0.2)]);
    let held = chain.on(Precision::Double, emulator(&[], 3), false);
    let limits = limits(1e-3, 3.0);
    let apart = |weight: f64| held.steps.moved_apart(&held.velocities(), &[weight, 0.0, 0.0, 0.0], &limits);
    let Separation::By(list) = apart(1.0) else { panic!("the chain is pressed") };
    let moved: Vec<Vector> = held.vectors(&list).iter().zip(&chain.columns[0]).map(|(&push, &v)| push + v).collect();
    let place = |row: usize| chain.case.particles.positions[row].x + moved[row].x;
    let gaps = [place(1) + 10.0 - place(0) - 1.5, place(2) - place(1) - 1.5];
    assert!(gaps.iter().all(|gap| (0.6e-3..1.2e-3).contains(gap)), "{gaps:?}");
    assert!(moved.iter().all(|m| m.y == 0.0 && m.z == 0.0));
    assert_eq!(apart(-1.0), Separation::Apart);
    let full: Vec<_> = (0..5).map(|k| sphere(1.9 * f64::from(k) + 0.2, 1.0, 0.0)).collect();
    let held = Moving::in_cube(9.5, &full).on(Precision::Single, emulator(&[], 3), false);
    assert_eq!(held.steps.moved_apart(&held.velocities(), &[1.0; 4], &limits), Separation::Fails);
    let same = [sphere(4.0, 1.0, 0.0), sphere(4.0, 0.5, 0.0)];
    let held = Moving::in_cube(10.0, &same).on(Precision::Double, emulator(&[], 3), true);
    let Separation::By(list) = held.steps.moved_apart(&held.velocities(), &[1.0; 4], &limits) else {
        panic!("both overlap")
    };
    let [first, second] = held.vectors(&list)[..] else { panic!("two spheres") };
    assert!((first.x + 0.50025).abs() < 1e-9 && (second.x - 1.0005).abs() < 1e-9, "{first} {second}");
}

#[test]
fn columns_are_combined() {
    let moving = Moving::random(3, Shape::Sheared, 4);
    let held = moving.on(Precision::Single, emulator(&[], 1), true);
    for count in [1, 4, 5, 9] {
        let terms: Vec<_> = (0..count).map(|k| (held.columns[k % 4].clone(), 0.3 * k as f64 - 1.0)).collect();
        let found = held.vectors(&held.steps.combined(&terms));
        for (row, found) in found.iter().enumerate() {
            let exact: Vector = (0..count).map(|k| moving.columns[k % 4][row] * (0.3 * k as f64 - 1.0)).sum();
            assert!((*found - exact).length() < 1e-14 * (1.0 + count as f64) * 100.0, "{found} instead of {exact}");
        }
    }
}

/// Calls copy arguments that have changed, and a few sums; no list is left.
#[test]
fn copies_of_a_call_do_not_grow_with_the_particles() {
    let copied = |many: bool| {
        let mut moving = Moving::random(5, Shape::Sheared, 3);
        if !many {
            let rows: Vec<usize> = (0..7).collect();
            moving.case.particles = moving.case.particles.selected(&rows);
            moving.columns.iter_mut().for_each(|column| column.truncate(7));
        }
        let (device, counts) = Counted::new(emulator(&[], 1));
        let held = moving.on(Precision::Single, Box::new(device), false);
        let (weights, reach) = (orders(5), 9.0 * 0.2);
        let orders = DisplacementOrders::Four { weights: &weights, smooth: SMOOTH };
        let call = |kind: usize| match kind {
            0 => drop(held.steps.displacement_error(&held.columns, &orders)),
            1 => drop(held.steps.gap_changes(&held.velocities(), &orders, [0.1; 2], reach)),
            2 => drop(held.steps.smallest_relative_gap(reach)),
            3 => drop(held.steps.moved_apart(&held.velocities(), &weights[0], &limits(1e-9, reach))),
            _ => drop(held.steps.combined(&[(held.columns[0].clone(), 2.0)])),
        };
        (0..5).for_each(call);
        let all = |counts: &DeviceCounts| [counts.uploads, counts.downloads];
        let memory = counts.borrow().memory[0];
        let before = all(&counts.borrow());
        (0..5).for_each(call);
        let after = all(&counts.borrow());
        assert_eq!(counts.borrow().memory[0], memory);
        [0, 1].map(|k| [0, 1].map(|part| after[k][part] - before[k][part]))
    };
    let [few, many] = [false, true].map(copied);
    for [[copies, bytes], downloads] in [few, many] {
        assert!(copies <= 5 && bytes <= 5 * 400, "{copies} copies of {bytes} bytes to the device");
        assert!(downloads[1] <= 128 * downloads[0], "{downloads:?}");
    }
    assert!(few[1][0] >= 4 && many[1][0] >= few[1][0]);
}
