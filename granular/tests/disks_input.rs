//! Sheared disks: invalid input is refused with the key.

use domain::{Particles, Vector};
use granular::ParameterError;
use granular::disks::{DiskFlow, DiskModel, DiskParameters, DiskSpecies, Disks, Preparation, Sizes};

fn refusal(change: impl FnOnce(&mut DiskParameters)) -> ParameterError {
    let mut parameters = DiskParameters::default();
    change(&mut parameters);
    DiskModel::new(parameters).unwrap_err()
}

#[test]
fn each_parameter_is_refused_by_its_key() {
    let late = Preparation { mixed: 10.0, ..DiskParameters::default().preparation };
    let refusals = [
        ("box.edges", refusal(|p| p.edges = [100.0, -1.0])),
        ("box.edges", refusal(|p| p.edges = [20.0, 100.0])),
        ("particles.area_fraction", refusal(|p| p.area_fraction = 0.9)),
        ("species", refusal(|p| p.sizes = Sizes::DiskSpecies(Vec::new()))),
        ("species.radius", refusal(|p| p.sizes = Sizes::DiskSpecies(vec![DiskSpecies { radius: 0.0, share: 1.0 }]))),
        (
            "particles.spread.largest",
            refusal(|p| p.sizes = Sizes::Spread { smallest: 2.0, largest: 1.0, exponent: 0.0 }),
        ),
        ("particles.mass_exponent", refusal(|p| p.mass_exponent = 0)),
        ("contact.restitution", refusal(|p| p.restitution = 1.1)),
        ("preparation.restitution", refusal(|p| p.preparation.restitution = 0.0)),
        ("preparation.elastic_until", refusal(|p| p.preparation = late)),
        ("time.step", refusal(|p| p.time_step = f64::NAN)),
        ("time.step", refusal(|p| p.time_step = 5e-321)),
        ("fluid.viscosity", refusal(|p| p.viscosity = 0.2)),
        ("flow.rate", refusal(|p| p.flow = DiskFlow::Shear { rate: f64::INFINITY })),
        ("flow", refusal(|p| p.flow = DiskFlow::Shear { rate: 3.0 })),
        ("output.measure_every", refusal(|p| p.measure_every = 0)),
    ];
    for (key, error) in refusals {
        assert_eq!(error.key, key, "{error}");
    }
    let error = refusal(|p| p.viscosity = 0.2);
    assert_eq!(
        error.to_string(),
        "fluid.viscosity is 0.2; it needs 0 <= viscosity <= 0.0928, where the integrator is stable"
    );
}

#[test]
fn radii_whose_squares_are_beyond_all_numbers_are_refused() {
    let list = [(1e-200, 0.5), (1.0, 1.0)].map(|(radius, share)| DiskSpecies { radius, share });
    assert_eq!(refusal(|p| p.sizes = Sizes::DiskSpecies(list.to_vec())).key, "species");
}

#[test]
fn particles_that_make_no_sense_are_refused() {
    let mut particles = Particles::default();
    particles.push(0, Vector::new(f64::NAN, 0.0, 0.0), 1.0, 0);
    let error = Disks::flowing(DiskParameters::default(), &particles).unwrap_err();
    assert_eq!(error.key, "particles.position");
    particles.positions[0] = Vector::ONE;
    particles.push(1, Vector::new(1.0, 101.0, 3.0), 1.0, 0);
    let error = Disks::flowing(DiskParameters::default(), &particles).unwrap_err();
    assert_eq!(error.to_string(), "particles.position is [1, 1] of two disks; it needs a place of its own for each");
    let model = DiskModel::new(DiskParameters::default()).unwrap();
    let (mut stored, progress) = Disks::random(&model).store();
    for (number, value) in [(1, 1e300), (6, f64::NAN), (5, -500.0)] {
        let list = stored.columns.iter_mut().find(|column| column.name == "list").unwrap();
        let before = std::mem::replace(&mut list.values[number], value);
        let error = Disks::resume(&model, &stored, &progress).unwrap_err();
        assert!(error.to_string().ends_with("a place in the box, and the disk near it"), "{error}");
        stored.columns.iter_mut().find(|column| column.name == "list").unwrap().values[number] = before;
    }
    assert!(Disks::resume(&model, &stored, &progress).is_ok());
    stored.radii[0] = -1.0;
    let error = Disks::resume(&model, &stored, &progress).unwrap_err();
    assert_eq!(error.to_string(), "radius is -1; it needs a radius that the scene has");
    let error = Disks::resume(&model, &particles, &progress).unwrap_err();
    assert_eq!(
        error.to_string(),
        "gear is missing from the particles; it needs the columns that a checkpoint of disks has"
    );
}
