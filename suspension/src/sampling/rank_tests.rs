//! Statistics have the same bytes and tables on any number of ranks.

use super::*;
use crate::columns::PAIR_MOMENT_NUMBERS;
use crate::model::{Flow, Parameters, Start};
use domain::Random;
use simulation::Table;

/// Two species with interleaved ids, in any box.
fn model(boundaries: Boundaries, flow: Flow, change: impl FnOnce(&mut Parameters)) -> Model {
    let cell = PeriodicBox::new(Vector::new(9.0, 10.0, 12.0)).unwrap().with_boundaries(boundaries).unwrap();
    let species = vec![Species::new("one", 0.5, 20), Species::new("two", 0.7, 17)];
    let mut parameters = Parameters::new(cell, 1.0, species, 0.05, 60);
    (parameters.flow, parameters.statistics) = (flow, Some(StatisticsParameters::ALL));
    parameters.start = Start::Random { minimum_gap: 0.02 };
    change(&mut parameters);
    Model::new(parameters).unwrap()
}

/// All particles at a time, at random positions in the box, with all columns.
fn all_at(model: &Model, count: u64, step: u32) -> (PeriodicBox, Particles) {
    let cell = match model.flow {
        Flow::Shear { lees_edwards: true, .. } => {
            PeriodicBox::sheared(model.cell.edges(), 0.1 * f64::from(step % 5)).unwrap()
        }
        _ => model.cell,
    };
    let mut particles = Particles::default();
    for id in 0..count {
        let random = |k: u64| Random::new(10 * u64::from(step) + k, id).point();
        let kind = u32::from(id % 5 == 1 || id > 30) % model.species.len() as u32;
        particles.push(id, cell.wrap(random(1) * cell.edges()).0, 0.5 + 0.2 * f64::from(kind), kind);
    }
    for (name, k) in [(VELOCITY, 2), (ANGULAR_VELOCITY, 3)] {
        let random = |id: usize| Random::new(10 * u64::from(step) + k, id as u64).point() - Vector::splat(0.4);
        particles.vectors(name).iter_mut().enumerate().for_each(|(id, vector)| *vector = random(id));
    }
    for (name, width) in MORE_COLUMNS.into_iter().zip([5, PAIR_MOMENT_NUMBERS]) {
        let values = &mut particles.column(name, width).values;
        values.iter_mut().enumerate().for_each(|(k, value)| *value = 1.0 / (k as f64 + 0.7));
    }
    particles.steps.iter_mut().enumerate().for_each(|(id, steps)| *steps = [step as i32, -(id as i32), 2]);
    (cell, particles)
}

/// Pieces of the state and tables after a number of samples, with the state stored and restored between different
/// numbers of ranks.
fn found(model: &Model, count: u64, size: u64, parts: &[(usize, u32)]) -> (Vec<Vec<u8>>, String) {
    let (mut pieces, mut text, mut first) = (Vec::<Vec<u8>>::new(), String::new(), 0);
    for &(ranks, last) in parts {
        let outcomes = Comm::threads(ranks, |comm| {
            let partition = Partition::new(&comm, [12, 12]);
            let own = |(cell, all): (PeriodicBox, Particles)| {
                let rows: Vec<usize> = (0..all.len()).rev().filter(|row| row * 7 % 5 % ranks == comm.rank()).collect();
                let mut own = all.selected(&rows);
                own.migrate(&partition, &cell);
                (cell, own)
            };
            let wanted = model.statistics.unwrap();
            let mut statistics = Statistics::in_blocks_of(size, model, wanted, &own(all_at(model, count, 0)).1, &comm);
            if !pieces.is_empty() {
                let own: Vec<Vec<u8>> = pieces.iter().skip(comm.rank()).step_by(ranks).cloned().collect();
                assert!(statistics.restore(&own));
            }
            for step in first..last {
                let (cell, particles) = &own(all_at(model, count, step));
                let (time, partition) = (0.25 * f64::from(step), &partition);
                let [shear_stress, pressure_gradient] = [7, 5].map(|period| Some(f64::from(step % period)));
                let sample = Sample { time, rate: 0.5, cell, particles, partition, shear_stress, pressure_gradient };
                statistics.sample(&sample);
            }
            // Tables do not change the later results.
            let tables: String = statistics.tables().iter().map(Table::to_csv).collect();
            assert!(comm.is_first() || tables.is_empty());
            (statistics.pieces(), tables)
        });
        let blocks = outcomes.iter().map(|(pieces, _)| pieces.len()).sum();
        assert_eq!(blocks as u64, count.div_ceil(size).max(1));
        pieces = (0..blocks).map(|block| outcomes[block % ranks].0[block / ranks].clone()).collect();
        (text, first) = (outcomes[0].1.clone(), last);
    }
    (pieces, text)
}

/// On several numbers of ranks, in one go and in parts.
fn check(model: &Model, count: u64) {
    for size in [1.max(count / 8), 64] {
        let (pieces, text) = found(model, count, size, &[(1, 19)]);
        let runs = [&[(7, 19)][..], &[(1, 6), (3, 13), (2, 19)], &[(2, 8), (1, 19)]];
        for run in runs {
            let (others, other_text) = found(model, count, size, run);
            assert!(others == pieces, "the state on {run:?} ranks with blocks of {size}");
            assert!(other_text == text, "the tables on {run:?} ranks with blocks of {size}:\n{text}\n{other_text}");
        }
    }
}

#[test]
fn in_periodic_boxes() {
    check(&model(Boundaries::Periodic, Flow::None, |_| {}), 37);
    check(&model(Boundaries::Periodic, Flow::Shear { rate: 0.5, lees_edwards: true }, |_| {}), 37);
}

/// The largest pair distance equals the shortest edge, so that each rank sees all particles.
#[test]
fn with_pairs_far_apart() {
    let far = |p: &mut Parameters| {
        p.statistics = Some(StatisticsParameters { distance: Some(9.0), ..StatisticsParameters::ALL });
    };
    check(&model(Boundaries::Periodic, Flow::None, far), 37);
}

#[test]
#[ignore = "heavy"]
fn between_walls_and_in_layers() {
    let couette = Flow::Shear { rate: 0.5, lees_edwards: false };
    let flux = Flow::ConstantFlux { mean_velocity: 0.5 };
    for (boundaries, flow) in [
        (Boundaries::Walls, couette),
        (Boundaries::Walls, flux),
        (Boundaries::Wall, Flow::None),
        (Boundaries::OpenAlongZ, Flow::None),
    ] {
        check(&model(boundaries, flow, |_| {}), 37);
    }
}

/// With moduli, which only the first rank holds.
#[test]
fn under_oscillation() {
    let oscillating = |p: &mut Parameters| {
        p.flow = Flow::Shear { rate: 0.5, lees_edwards: true };
        p.protocol = crate::model::Protocol::Oscillation { frequency: 2.0 };
    };
    let model = model(Boundaries::Periodic, Flow::None, oscillating);
    assert!(model.shear_rates().frequency().is_some());
    check(&model, 37);
}

/// There is one block even with fewer particles than ranks, or none.
#[test]
fn of_hardly_any_particles() {
    for count in [0, 1, 2] {
        check(&model(Boundaries::Periodic, Flow::None, |_| {}), count);
        check(&model(Boundaries::Walls, Flow::None, |_| {}), count);
    }
}

/// The size of blocks changes sums by round-off only, and counts not at all.
#[test]
fn blocks_of_any_size_find_the_same() {
    let model = model(Boundaries::Periodic, Flow::None, |_| {});
    let numbers = |size: u64| -> Vec<f64> {
        let (_, text) = found(&model, 37, size, &[(1, 19)]);
        text.split([',', '\n']).filter_map(|word| word.parse().ok()).collect()
    };
    let whole = numbers(64);
    assert!(whole.len() > 1000);
    let parts = numbers(5);
    assert_eq!(whole.len(), parts.len());
    for (a, b) in whole.iter().zip(&parts) {
        assert!(
            (a - b).abs() <= 1e-9 * a.abs().max(1e-3) || (a.is_nan() && b.is_nan()) || a.to_bits() == b.to_bits(),
            "{a} {b}"
        );
    }
}

/// State of another scene, or an incomplete one, is refused on some rank, and no rank waits for it.
#[test]
fn pieces_that_do_not_fit_are_refused() {
    let model = model(Boundaries::Periodic, Flow::None, |_| {});
    let (pieces, _) = found(&model, 37, 20, &[(1, 3)]);
    assert_eq!(pieces.len(), 2);
    let (whole, _) = found(&model, 37, 64, &[(1, 3)]);
    for wrong in [&whole[..], &[pieces[1].clone(), pieces[0].clone()], &pieces[..1]] {
        for ranks in [1, 2, 3] {
            let fits = Comm::threads(ranks, |comm| {
                let own = if comm.is_first() { all_at(&model, 37, 0).1 } else { Particles::default() };
                let wanted = model.statistics.unwrap();
                let mut statistics = Statistics::in_blocks_of(20, &model, wanted, &own, &comm);
                statistics.restore(&wrong.iter().skip(comm.rank()).step_by(ranks).cloned().collect::<Vec<_>>())
            });
            assert!(!fits.iter().all(|fits| *fits), "{ranks} ranks");
        }
    }
}
