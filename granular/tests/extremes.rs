//! Parameters beyond all bounds end in an error with the key and an advice.

use domain::{Particles, Vector};
use granular::disks::{DiskParameters, Disks};
use granular::shear_cell::{CellModel, CellParameters, CollisionDetection, Engine, Sampling, ShearCell, Top};

fn loaded(pressure: f64) -> CellModel {
    let top = Top::Free { pressure, mass_per_area: 0.2 };
    CellModel::new(CellParameters { length: 4e-3, width: 4e-3, top, ..CellParameters::default() }).unwrap()
}

/// Whether a run under a load reaches its end, and otherwise the error.
fn run(pressure: f64, step: f64) -> Result<(), String> {
    let model = loaded(pressure);
    let mut grains = model.pack(model.count(0.2).unwrap(), 1).unwrap();
    grains.set_velocities(&model, 0.07, 1);
    let mut run =
        ShearCell::new(&model, &grains, CollisionDetection::TimeStepped { step }, Sampling::default()).unwrap();
    for _ in 0..4 {
        if !run.measure(1e-4, &|| true) {
            return Err(run.engine().failure().unwrap().to_string());
        }
        run.restart().map_err(|error| error.to_string())?;
    }
    Ok(())
}

#[test]
fn loads_too_large_for_the_time_step_are_named_with_a_step_that_is_not() {
    for pressure in [1e6, 1e7, 1e8, 1e12] {
        let error = run(pressure, 5e-7).unwrap_err();
        assert!(error.starts_with("time.collision_step is 5e-7; it needs at most about "), "{error}");
        assert!(error.contains("under top.pressure = "), "{error}");
    }
    let error = run(1e6, 5e-7).unwrap_err();
    let enough: f64 = error.split("at most about ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    // A whole number of steps per window.
    run(1e6, 5e-5 / (5e-5 / enough).ceil()).unwrap();
}

#[test]
fn loads_too_large_for_the_contact_time_are_named() {
    let model = loaded(1e20);
    let grains = model.pack(20, 1).unwrap();
    let error = Engine::new(&model, &grains, CollisionDetection::EventDriven).err().unwrap().to_string();
    assert!(error.starts_with("grains.contact_time is 1e-7; it needs at most 1.77e-13"), "{error}");
}

#[test]
fn sizes_that_no_unit_makes_are_refused_by_name() {
    for (key, change) in [
        ("cell.speed", (|p| p.speed = 1e200) as fn(&mut CellParameters)),
        ("cell.gravity", |p| p.gravity = 1e200),
        ("grains.density", |p| p.density = 1e-300),
        ("grains.contact_time", |p| p.contact_time = 1e-300),
        ("walls.friction", |p| p.wall_contact.friction = 1e300),
        ("top.pressure", |p| p.top = Top::Free { pressure: 1e200, mass_per_area: 1.0 }),
    ] {
        let mut parameters = CellParameters::default();
        change(&mut parameters);
        assert_eq!(CellModel::new(parameters).unwrap_err().key, key);
    }
}

#[test]
fn disks_that_fly_off_end_a_run() {
    let mut particles = Particles::default();
    for (id, x) in [4.0, 4.5].into_iter().enumerate() {
        particles.push(id as u64, Vector::new(x, 5.0, 0.0), 1.0, 0);
    }
    // Faster than the width of the cell per step.
    particles.vectors("velocity")[0] = Vector::X * 1e3;
    let parameters = DiskParameters { edges: [12.0; 2], ..DiskParameters::default() };
    let mut disks = Disks::flowing(parameters, &particles).unwrap();
    disks.check().unwrap();
    disks.advance(20);
    let error = disks.check().unwrap_err();
    assert_eq!(error.key, "time.step");
    assert!(error.to_string().contains("disks flew off at step 1"), "{error}");
}
