//! Runs of grains as seen by the code that writes their results.

use domain::Comm;
use granular::disks::{self, DiskRun, Preparation, RunLength};
use granular::shear_cell::{self, CellRun, CollisionDetection, Experiment, Sampling};
use simulation::Simulation;

/// Asserts that the observed values match the columns in number, and are not NaN.
fn is_observed_as_named(run: &mut impl Simulation) {
    let expected: Vec<usize> = run.quantities().iter().map(|quantity| quantity.columns().len()).collect();
    let values = run.observe();
    assert!(expected.len() > 1);
    assert_eq!(values.iter().map(Vec::len).collect::<Vec<_>>(), expected);
    assert!(values.iter().flatten().all(|value| value.is_finite()), "{values:?}");
}

#[test]
fn a_run_of_disks_says_its_plan_and_what_it_observes() {
    let preparation = Preparation { settled: 2.0, mixed: 4.0, ..disks::DiskParameters::default().preparation };
    let parameters = disks::DiskParameters { edges: [40.0; 2], preparation, ..disks::DiskParameters::default() };
    let model = disks::DiskModel::new(parameters).unwrap();
    let length = RunLength { steps: 10, profile_strips: 4 };
    let mut run = DiskRun::start(&model, length, None, &Comm::alone(), &mut |_| {}).unwrap();
    assert_eq!(run.plan(), disks::outline(&model, 10).text());
    run.advance(10).unwrap();
    is_observed_as_named(&mut run);
}

#[test]
fn a_run_of_a_shear_cell_says_its_plan_and_what_it_observes() {
    let parameters = shear_cell::CellParameters { length: 4e-3, width: 4e-3, ..shear_cell::CellParameters::default() };
    let experiment = Experiment {
        model: shear_cell::CellModel::new(parameters).unwrap(),
        seed: 1,
        count: 20,
        agitation: 0.1,
        collisions: CollisionDetection::EventDriven,
        sampling: Sampling { layers: 4, pixels: [3, 2], ..Sampling::default() },
        transient: 0,
        time_step: 1e-3,
        steps: 1,
    };
    let mut run = CellRun::start(&experiment, &Comm::alone(), &mut |_| {}).unwrap();
    assert_eq!(run.plan(), experiment.outline().text());
    run.advance(1).unwrap();
    is_observed_as_named(&mut run);
}
