//! Predicted against measured allocations.

#[path = "../../domain/tests/heap/mod.rs"]
mod heap;

use granular::disks::{AveragedProfile, DiskFlow, DiskModel, DiskParameters, Disks};
use heap::measured;

/// Asserts bounds on the ratio of predicted to measured bytes.
#[track_caller]
fn is_within(least: f64, most: f64, predicted: f64, found: f64) {
    let range = least * found..most * found;
    assert!(range.contains(&predicted), "{predicted:.3e} bytes predicted, {found:.3e} found");
}

/// A single test: allocations of other tests would count.
#[test]
fn predictions_are_what_is_allocated() {
    let disks = disks();
    profile(&disks);
}

fn disks() -> Disks {
    let parameters =
        DiskParameters { edges: [300.0, 200.0], flow: DiskFlow::Shear { rate: 0.01 }, ..DiskParameters::default() };
    let (model, sizes) = measured(|| DiskModel::new(parameters).unwrap());
    is_within(1.9, 2.1, DiskModel::size_bytes(model.sizes().len() as f64).kept, sizes.kept);
    let predicted = model.bytes(0);
    let (disks, found) = measured(|| {
        let mut disks = Disks::random(&model);
        disks.advance(40);
        disks
    });
    is_within(0.95, 1.15, predicted.kept, found.kept);
    // A search for neighbours or a checkpoint, whichever takes more.
    let (_, checkpoint) = measured(|| disks.store());
    let most = found.most.max(found.kept + checkpoint.most);
    is_within(0.9, 1.2, predicted.most, most);
    disks
}

/// Series are stored in blocks of increasing length: there is room for any number of samples.
fn profile(disks: &Disks) {
    let (snapshot, model) = (disks.snapshot(), disks.model());
    let (_, found) = measured(|| {
        let mut profile = AveragedProfile::new(500);
        (0..100).for_each(|_| profile.add(&snapshot));
        profile
    });
    is_within(1.0, 5.0, model.bytes(500).kept - model.bytes(0).kept, found.kept);
}
