use super::species_columns::{COLUMN_WIDTH, axis_and_width};
use super::*;
use crate::model::Flow;
use crate::model::{Axis, Parameters};
use domain::Comm;
use simulation::Table;

fn model() -> Model {
    let cell = PeriodicBox::new(Vector::splat(12.0)).unwrap();
    let species = vec![Species::new("small", 1.0, 20), Species::new("large", 1.5, 6)];
    let flow = Flow::Shear { rate: 0.5, lees_edwards: true };
    let usual = Parameters::new(cell, 1.0, species, 0.05, 6);
    Model::new(Parameters { seed: 3, flow, statistics: Some(StatisticsParameters::ALL), ..usual }).unwrap()
}

/// Takes a sample on one rank.
fn taken(statistics: &mut Statistics, time: f64, cell: &PeriodicBox, particles: &Particles) {
    let partition = &Partition::new(&Comm::alone(), [1, 1]);
    statistics.sample(&Sample {
        time,
        rate: 0.5,
        cell,
        particles,
        partition,
        shear_stress: None,
        pressure_gradient: None,
    });
}

/// Statistics without samples, on one rank.
fn empty(model: &Model) -> Statistics {
    Statistics::new(model, StatisticsParameters::ALL, &drifting(model, 0.0).1, &Comm::alone())
}

fn text(statistics: &mut Statistics) -> String {
    statistics.tables().iter().map(Table::to_csv).collect()
}

/// Particles that move with the flow plus a velocity of their own, at a time, in the box of that time.
fn drifting(model: &Model, time: f64) -> (PeriodicBox, Particles) {
    let cell = PeriodicBox::sheared(model.cell.edges(), 0.5 * time).unwrap();
    let turns = ((0.5 * time - cell.strain()).round()) as i32;
    let mut particles = Particles::default();
    for id in 0..26_u64 {
        let random = |k| domain::Random::new(k, id).point();
        let (start, own) = (random(1) * 12.0, random(2) - Vector::splat(0.5));
        // x' = rate y + u, y' = v, z' = w
        let carried = 0.5 * (start.y * time + 0.5 * own.y * time * time);
        let place = start + own * time + Vector::X * carried;
        particles.push(id, place, if id < 20 { 1.0 } else { 1.5 }, u32::from(id >= 20));
        particles.vectors(VELOCITY)[id as usize] = own;
    }
    particles.wrap(&cell);
    assert!(turns >= 0);
    for row in 0..26 {
        let flow = Vector::X * 0.5 * particles.positions[row].y;
        particles.vectors(VELOCITY)[row] += flow;
    }
    particles.vectors(ANGULAR_VELOCITY).fill(Vector::new(0.1, 0.0, -0.25));
    (cell, particles)
}

/// Without the flow they move on straight lines, also through the sides of the box and across resets of its lattice.
#[test]
fn displacements_leave_the_flow_out() {
    let model = &model();
    let mut statistics = empty(model);
    for step in 0..60 {
        let time = 0.25 * f64::from(step);
        let (cell, particles) = drifting(model, time);
        taken(&mut statistics, time, &cell, &particles);
    }
    for lag in statistics.kept[0].lagrangian.sums().lags(None) {
        let expected = lag.correlation * lag.time.powi(2);
        assert!((lag.mean_square_displacement - expected).length() < 1e-9 * (1.0 + expected.length()), "{lag:?}");
    }
    let summary = &statistics.tables()[0];
    let value = |quantity: &str, species: &str| {
        let row = summary.rows.iter().find(|(words, _)| words[0] == quantity && words[1] == species);
        row.unwrap_or_else(|| panic!("{quantity} of {species}")).1[0]
    };
    assert!((value("mean_angular_velocity_x", "large") - 0.1).abs() < 1e-14, "the flow turns spheres about z");
    assert!(value("mean_angular_velocity_z", "large").abs() < 1e-14 && value("w_zz", "small").abs() < 1e-14);
    assert!((value("samples", "all") - 60.0).abs() < 1e-14 && value("T_yy", "small") > 0.05);
    assert!(value("volume_fraction", "large") > 0.04);
}

/// In one go, or stored and restored half-way.
#[test]
fn an_interruption_changes_nothing() {
    let model = &model();
    let (mut whole, mut parts) = (empty(model), empty(model));
    for step in 0..20 {
        let time = 0.25 * f64::from(step);
        let (cell, particles) = drifting(model, time);
        taken(&mut whole, time, &cell, &particles);
        if step == 11 {
            let pieces = parts.pieces();
            parts = empty(model);
            assert!(parts.restore(&pieces));
        }
        taken(&mut parts, time, &cell, &particles);
    }
    assert_eq!(whole.pieces(), parts.pieces());
    assert_eq!(text(&mut whole), text(&mut parts));
    assert!(!empty(model).restore(&[whole.pieces()[0][8..].to_vec()]));
}

/// Columns are along the axis that is given; by default along the forces, or along the gradient without forces.
#[test]
fn columns_stand_along_the_forces_or_the_gradient() {
    let of = |change: &dyn Fn(&mut Parameters)| {
        let mut parameters = Parameters::clone(&model());
        change(&mut parameters);
        axis_and_width(&Model::new(parameters).unwrap())
    };
    assert_eq!(of(&|_| {}), (GRADIENT, COLUMN_WIDTH * 1.5));
    assert_eq!(of(&|p| p.species[0].force = Vector::Z).0, 2);
    let asked = Some(StatisticsParameters { axis: Some(Axis::X), ..StatisticsParameters::ALL });
    assert_eq!(of(&|p| (p.species[0].force, p.statistics) = (Vector::Z, asked)).0, 0);
}

/// Pairs are classified by the azimuth in shear and planar extension, and by the angle to the axis in other extensions.
#[test]
fn angles_of_pairs_are_those_of_the_flow() {
    let of = |kind| angle(&kind_of(kind).at_rate(1.0), kind_of(kind), 2);
    assert_eq!(angle(&BackgroundFlow::NONE, Flow::None, 2), Angle::Cosine(2));
    assert_eq!(angle(&BackgroundFlow::shear(1.0), model().flow, 1), Angle::Azimuth);
    let found = [Extension::Planar, Extension::Uniaxial, Extension::Biaxial].map(of);
    assert_eq!(found, [Angle::Azimuth, Angle::Cosine(0), Angle::Cosine(2)]);
}

fn kind_of(kind: Extension) -> Flow {
    Flow::Extension { kind, rate: 1.0 }
}
