use super::*;
use crate::model::{Hydrodynamics, Parameters, StatisticsParameters};
use crate::start::plan::plan;
use domain::PeriodicBox;
use fcm::Method;

/// Sedimenting spheres of radius 1 at a volume fraction.
fn settling(count: u64, fraction: f64) -> Parameters {
    let edge = (count as f64 * 4.0 / 3.0 * std::f64::consts::PI / fraction).cbrt();
    let cell = PeriodicBox::new(Vector::splat(edge)).unwrap();
    let spheres = Species { force: -18.85 * Vector::Z, ..Species::new("heavy", 1.0, count) };
    Parameters { start: Start::Random { minimum_gap: 0.02 }, ..Parameters::new(cell, 1.0, vec![spheres], 0.001, 2) }
}

/// Memory of each of several single-threaded ranks of a released program, in MB.
fn needed(parameters: Parameters, ranks: usize) -> Vec<f64> {
    let model = Model::new(parameters).unwrap();
    let radii = Radii::of_model(&model).unwrap();
    let plan = plan(&model, &radii).unwrap();
    let needs = needs(&model, &radii, &plan, Ranks { count: ranks, threads: 1 });
    needs.iter().map(|need| (need.resident - Process::CHECKS) / 1e6).collect()
}

/// The predictions that `docs/src/memory.md` compares with measured peaks.
#[test]
fn predictions_are_those_that_were_compared_with_peaks() {
    let cases: [(_, _, &[f64]); 6] = [
        (Some(Method::Split), false, &[306.0]),
        (Some(Method::Split), false, &[239.0, 232.0]),
        (Some(Method::Split), true, &[651.0]),
        (Some(Method::Split), true, &[412.0, 405.0]),
        (Some(Method::Direct), true, &[1209.0]),
        (Some(Method::Direct), false, &[552.0, 545.0]),
    ];
    let found = cases.map(|(method, lubrication, expected)| {
        let hydrodynamics = Hydrodynamics { method, lubrication, ..Hydrodynamics::default() };
        needed(Parameters { hydrodynamics, ..settling(100_000, 0.12) }, expected.len())
    });
    let near = |(found, expected): (&f64, &f64)| (found / expected - 1.0).abs() < 0.005;
    let all_near = cases.iter().zip(&found).all(|((.., expected), found)| found.iter().zip(*expected).all(near));
    assert!(all_near, "{found:.0?} MB");
}

#[test]
fn statistics_of_more_samples_take_more() {
    let needed = |statistics, steps| needed(Parameters { steps, statistics, ..settling(10_000, 0.12) }, 2);
    let none = needed(None, 2000);
    let [few, many] = [20, 2000].map(|steps| needed(Some(StatisticsParameters::ALL), steps));
    assert!(none[0] < few[0] && few[0] < many[0], "{none:?} {few:?} {many:?}");
    assert!((few[1] - many[1]).abs() < 1e-9, "the first rank has them: {few:?} {many:?}");
}

/// Dense packings need pairs and displacements.
#[test]
fn dense_spheres_take_more_to_be_placed() {
    let placed = |fraction: f64| {
        let model = Model::new(settling(100_000, fraction)).unwrap();
        placing(&model, &Radii::of_model(&model).unwrap()).resident
    };
    assert!(placed(0.26) > placed(0.24));
}

/// Implicit repulsion needs pairs, and repeated substeps need a copy.
#[test]
fn implicit_steps_take_more() {
    let with = |integrator, repulsion| needed(Parameters { repulsion, integrator, ..settling(100_000, 0.12) }, 1)[0];
    let control = crate::model::Adaptive::default();
    let repulsion = Some(crate::model::Repulsion::new(1.0));
    let [adaptive, implicit] =
        [Integrator::Adaptive(control), Integrator::Implicit(control)].map(|i| with(i, repulsion));
    assert!(implicit > 1.05 * adaptive, "{implicit} {adaptive} MB");
    assert!(with(Integrator::Implicit(control), None) < implicit);
}
