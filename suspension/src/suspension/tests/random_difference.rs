//! Steps of the random finite difference, by spheres that move on an emulator of a card.

use super::brownian::{agitated, cross_faces, in_shear, under_weight};
use super::*;
use crate::evaluation::fluctuating::Noise;
use crate::evaluation::{Dynamics, StageTime};
use crate::model::BrownianScheme::{Midpoint, TwoEvaluations};
use domain::Column;
use fcm::Stream;
use gpu::DIFFERENCE_BYTES;
use hydrodynamics::brownian::{DISPLACEMENT, DRIFT_VELOCITY, FiniteDifference};
use simulation::Clock;

/// Relative error of finite differences that are compared, and their divisor.
const EXACT: f64 = 1e-8;
const OVER: f64 = 0.02;

/// Steps of a run that is compared, read or interrupted.
const SEEN: u64 = 2;

fn models() -> [Model; 3] {
    [in_shear(TwoEvaluations), under_weight(TwoEvaluations, true), under_weight(TwoEvaluations, false)]
}

/// A model whose solves have another tolerance, on which the precision depends.
fn with_tolerance(model: &Model, tolerance: f64) -> Model {
    let mut parameters = (**model).clone();
    parameters.hydrodynamics.iteration_tolerance = Some(tolerance);
    Model::new(parameters).unwrap()
}

/// In each step from a state of the card spheres move as on the host, by the same random numbers, and as many pairs
/// overlap: up to the errors of drifts, which are found to three hundredths.
#[test]
fn spheres_move_as_on_the_host() {
    for (kernel, tolerance) in [("drawn_motions_f32", 1e-5), ("drawn_motions_f64", 1e-8)] {
        for model in models().map(|model| with_tolerance(&model, tolerance)) {
            let (device, counts) = emulator(1);
            let mut card = on(started(&model, None), device);
            for step in 0..SEEN {
                let [start, mut host] = [(); 2].map(|()| started(&model, Some(&mut card)));
                for run in [&mut card, &mut host] {
                    run.step().unwrap();
                }
                assert!(card.particles.are_remote());
                let [moved, error] = [&start, &card].map(|run| distance(run, &host));
                assert!(error < 2e-2 * moved, "step {step}: {error:e} of {moved:e}");
                let [of_card, of_host] = [&card, &host].map(|run| run.overlap_counts().unwrap());
                assert_eq!(of_card.overlapping, of_host.overlapping);
                assert_eq!(of_card.at_minimum_gap, of_host.at_minimum_gap);
            }
            let runs = ["displace_all", kernel, "store_residual_all", "store_change_all", "limit_all"];
            assert_eq!(runs.map(|kernel| counts.borrow().runs[kernel]), [4, 1, 1, 1, 1].map(|each| SEEN * each));
        }
    }
}

/// The first solve of a step, and the displacement after it.
fn solve_and_displace(run: &mut Suspension) {
    let Suspension { particles, dynamics, clock, noise_source, .. } = run;
    let energy = noise_source.unwrap().energy;
    let noise = Noise { stream: Stream::new(5, 1), amplitude: (2.0 * energy / clock.dt()).sqrt(), energy };
    let start = StageTime::in_step(clock, 0.0, 0);
    dynamics.begin_step(particles, clock).unwrap();
    dynamics.draw_motions(particles, noise, 0.5 * OVER * clock.dt());
    dynamics.move_at_random(particles, &start, noise).unwrap();
    particles.displace_by([DISPLACEMENT], [1.0]);
    dynamics.wrap_and_migrate(particles, &start).unwrap();
}

/// Drift velocities and Brownian stresslets of spheres after that, in the order of ids.
fn drift(dynamics: &mut Dynamics, particles: &mut Particles, clock: &Clock) -> [Column; 2] {
    // In a periodic box the thermal energy does not matter.
    let change = FiniteDifference { over: OVER, energy: 1.0, tolerance: EXACT };
    dynamics.store_drift(particles, &StageTime::in_step(clock, 0.0, 0), change).unwrap();
    [DRIFT_VELOCITY, BROWNIAN].map(|name| sorted(dynamics, particles, name))
}

/// A column in the order of ids.
fn sorted(dynamics: &Dynamics, particles: &Particles, name: &str) -> Column {
    dynamics.fetch(particles);
    by_id(particles).columns.iter().find(|column| column.name == name).unwrap().clone()
}

fn relative_error(found: &Column, exact: &Column) -> f64 {
    let square = |values: &mut dyn Iterator<Item = f64>| values.map(|value| value * value).sum::<f64>();
    let error = square(&mut found.values.iter().zip(exact.values.iter()).map(|(found, exact)| found - exact));
    (error / square(&mut exact.values.iter().copied())).sqrt()
}

/// Moves spheres after that to the end of the step, by the drift.
fn end(run: &mut Suspension) {
    let Suspension { particles, dynamics, clock, .. } = run;
    particles.displace_by([DISPLACEMENT, PAST[0], DRIFT_VELOCITY], [-1.0, clock.dt(), clock.dt()]);
    dynamics.wrap_and_migrate(particles, &StageTime::in_step(clock, 1.0, 0)).unwrap();
}

/// Drifts and Brownian stresslets are those of the host, and spheres move as there; so are those of spheres that return
/// to the host after the first solve, with all columns.
#[test]
fn drifts_are_those_of_the_host() {
    for model in models() {
        let model = with_tolerance(&model, 1e-10);
        let [mut host, mut card] = [started(&model, None), on(started(&model, None), emulator(1).0)];
        [&mut host, &mut card].into_iter().for_each(solve_and_displace);
        let exact = drift(&mut host.dynamics, &mut host.particles, &host.clock);
        let Suspension { particles, dynamics, clock, .. } = &mut card;
        assert!(particles.are_remote() && !host.particles.are_remote());
        let returning = particles.clone();
        let found = drift(dynamics, particles, clock);
        dynamics.fetch(&returning);
        let later = drift(dynamics, &mut returning.detached(), clock);
        for ((found, later), exact) in found.iter().zip(&later).zip(&exact) {
            let errors = [found, later].map(|found| relative_error(found, exact));
            assert!(errors.iter().all(|&error| error < 1e-5), "{}: {errors:?}", exact.name);
        }
        let start = started(&model, None);
        [&mut host, &mut card].into_iter().for_each(end);
        let [moved, error] = [&start, &card].map(|run| distance(run, &host));
        assert!(error < 1e-6 * moved, "{error:e} of {moved:e}");
    }
}

/// Drifts are limited as on the host: those of some spheres, while others stay as they are.
#[test]
fn drifts_are_limited_as_on_the_host() {
    let model = with_tolerance(&in_shear(TwoEvaluations), 1e-10);
    let mut runs = [started(&model, None), on(started(&model, None), emulator(1).0)];
    let mut time = 0.0;
    let [[free, limited], [_, of_card]] = runs.each_mut().map(|run| {
        solve_and_displace(run);
        let [free, _] = drift(&mut run.dynamics, &mut run.particles, &run.clock);
        if time == 0.0 {
            let lengths = free.values.as_chunks().0.iter().map(|&v| Vector::from_array(v).length());
            // The radii are at least 1.
            time = 0.1 / lengths.fold(0.0, f64::max);
        }
        run.dynamics.limit_drift(&mut run.particles, time);
        [free, sorted(&run.dynamics, &run.particles, DRIFT_VELOCITY)]
    });
    assert!(relative_error(&of_card, &limited) < 1e-5);
    let [free, limited] = [&free, &limited].map(|column| column.values.iter().map(|v| v.to_bits()).collect::<Vec<_>>());
    let rows = limited.as_chunks::<3>().0;
    let same = free.as_chunks::<3>().0.iter().zip(rows).filter(|(free, limited)| free == limited).count();
    assert!(same > 0 && same < rows.len(), "{same} drifts are not limited");
}

/// Two spheres that almost touch, whose drift is limited in a step, move as on the host.
#[test]
fn touching_spheres_move_as_on_the_host() {
    let model = agitated(TwoEvaluations, |parameters| {
        parameters.thermal_energy = Some(1e3);
        parameters.hydrodynamics.lubrication = true;
        parameters.hydrodynamics.iteration_tolerance = Some(1e-10);
        parameters.species = vec![Species::new("one", 1.0, 3)];
        let places = [1.0, 3.0 + 1e-6, 6.0].map(|x| Vector::new(x, 1.0, 1.0));
        parameters.start = Start::Positions(places.to_vec());
    });
    let start = started(&model, None);
    let [host, card] = [started(&model, None), on(started(&model, None), emulator(1).0)].map(|mut run| {
        solve_and_displace(&mut run);
        let [drift, _] = drift(&mut run.dynamics, &mut run.particles, &run.clock);
        let farthest = drift.values.as_chunks().0.iter().map(|&v| Vector::from_array(v).length()).fold(0.0, f64::max);
        assert!(farthest * run.clock.dt() > 0.05, "{farthest}");
        run.dynamics.limit_drift(&mut run.particles, run.clock.dt());
        end(&mut run);
        run
    });
    let [moved, error] = [&start, &card].map(|run| distance(run, &host));
    assert!(card.particles.are_remote() && error < 1e-6 * moved, "{error:e} of {moved:e}");
}

/// A step copies settings and sums, however many spheres there are.
#[test]
fn particles_stay_on_the_card() {
    stays_on_the_card(&in_shear(TwoEvaluations), 3);
}

/// After a step from the same state all columns, Brownian stresslets among them, are those of the host, up to the
/// errors of drifts, which change gaps.
#[test]
fn columns_are_those_of_the_host() {
    for model in models() {
        let mut card = advanced(on(started(&model, None), emulator(1).0), 1);
        let mut host = advanced(started(&model, Some(&mut card)), 1);
        card.step().unwrap();
        agree_in_columns([&mut card, &mut host], 5e-2);
    }
}

/// Spheres cross the faces of a sheared box, whose lattice vectors change at half a period of its strain, as on the
/// host; a run that is resumed between, on a card whose threads run in another order, has the same bits.
#[test]
fn a_resumed_run_has_the_same_bits() {
    cross_faces(TwoEvaluations, &[STEPS - 2]);
}

/// A run whose columns are read after each step has the bits of one that keeps them on the card; so has one that goes
/// back to the start of a step that was interrupted. A run whose steps are not seen has the same positions.
#[test]
fn reading_columns_and_going_back_change_nothing() {
    for model in [in_shear(TwoEvaluations), under_weight(TwoEvaluations, false)] {
        let state = advanced(on(started(&model, None), emulator(1).0), SEEN).state();
        let mut read = on(started(&model, None), emulator(1).0);
        for _ in 0..SEEN {
            assert!(read.particles().columns.iter().all(|column| column.values.is_here()));
            read.step().unwrap();
        }
        assert_eq!(read.state(), state);
        let mut interrupted = on(started(&model, None), emulator(1).0);
        (0..SEEN).for_each(|step| step_interrupted(&mut interrupted, step == 1));
        assert_eq!(interrupted.state(), state);
        let mut unseen = on(started(&model, None), emulator(1).0);
        (0..SEEN).for_each(|_| unseen.step_seen(false).unwrap());
        assert!(unseen.particles.are_remote());
        assert_eq!(by_id(unseen.particles()).positions, by_id(&state.particles).positions);
    }
}

/// A sphere that is lost ends the step with the message of the host, and the state before it is there.
#[test]
fn lost_spheres_are_named() {
    let lost = Parameters { thermal_energy: Some(1e24), ..(*under_weight(TwoEvaluations, true)).clone() };
    let model = Model::new(lost).unwrap();
    let [mut host, mut card] = [started(&model, None), on(started(&model, None), emulator(1).0)];
    let before = by_id(&card.state().particles);
    let errors = [&mut host, &mut card].map(|run| run.step().unwrap_err().to_string());
    // Which of the lost spheres is named depends on their order.
    let ends = errors.each_ref().map(|error| error.split("], ").last().unwrap());
    assert!(ends[1].contains("which is no place") && ends[0] == ends[1], "{errors:?}");
    assert_eq!(by_id(&card.state().particles), before);
}

/// Steps with two solves take as much more memory than those with one as the forecast has.
#[test]
fn differences_take_what_is_predicted() {
    let most = |scheme| {
        let (device, counts) = emulator(1);
        drop(advanced(on(started(&in_shear(scheme), None), device), 3));
        let counts = counts.borrow();
        counts.memory[1] as f64
    };
    let more = (most(TwoEvaluations) - most(Midpoint)) / 20.0;
    assert!((0.9 * DIFFERENCE_BYTES..1.01 * DIFFERENCE_BYTES).contains(&more), "{more} of {DIFFERENCE_BYTES}");
}
