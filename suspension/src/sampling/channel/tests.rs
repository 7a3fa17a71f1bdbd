use super::super::{Sample, Statistics};
use super::*;
use crate::Suspension;
use crate::model::{Flow, Parameters, Species, Start};
use domain::{Comm, PeriodicBox};
use simulation::Table;

fn cell(boundaries: Boundaries) -> PeriodicBox {
    PeriodicBox::new(Vector::new(9.0, 9.0, 8.0)).unwrap().with_boundaries(boundaries).unwrap()
}

fn model(boundaries: Boundaries, flow: Flow, start: Start) -> Model {
    let count = if let Start::Positions(places) = &start { places.len() as u64 } else { 12 };
    let species = vec![Species::new("one", 1.0, count)];
    let statistics = Some(StatisticsParameters { bins: Some(16), ..StatisticsParameters::ALL });
    let usual = Parameters::new(cell(boundaries), 1.0, species, 0.05, 4);
    Model::new(Parameters { seed: 4, flow, start, statistics, ..usual }).unwrap()
}

/// Profile of a run of some steps on several ranks, on the first rank.
fn profile_of(model: &Model, ranks: usize, steps: u32) -> Table {
    let found = Comm::threads(ranks, |comm| {
        let mut suspension = Suspension::start(model, &comm).unwrap();
        let mut statistics = Statistics::new(model, model.statistics.unwrap(), suspension.particles(), &comm);
        for _ in 0..=steps {
            let (particles, [rate, _]) = (suspension.particles(), suspension.shear());
            let (time, cell, partition) = (suspension.clock().time(), suspension.cell(), suspension.partition());
            statistics.sample(&Sample {
                time,
                rate,
                cell,
                particles,
                partition,
                shear_stress: None,
                pressure_gradient: None,
            });
            suspension.step().unwrap();
        }
        statistics.tables().into_iter().find(|table| table.name == "profile")
    });
    found.into_iter().next().flatten().unwrap()
}

/// A column of a profile, for all species together.
fn numbers(table: &Table, name: &str) -> Vec<f64> {
    let index = table.columns.iter().position(|(column, _)| column == name).unwrap();
    table.rows.iter().filter(|(words, _)| words[0] == "all").map(|(_, numbers)| numbers[index]).collect()
}

/// The mean over the channel is the volume fraction, for any flow, and regions that centres cannot reach are empty.
#[test]
fn a_random_suspension_has_its_volume_fraction() {
    let model =
        model(Boundaries::Walls, Flow::Poiseuille { pressure_gradient: 1.0 }, Start::Random { minimum_gap: 0.02 });
    let table = profile_of(&model, 1, 1);
    let fractions = numbers(&table, "volume_fraction");
    let volume = 12.0 * 4.0 / 3.0 * std::f64::consts::PI / (81.0 * 8.0);
    assert!((fractions.iter().sum::<f64>() / 16.0 - volume).abs() < 1e-12);
    assert!(fractions.iter().all(|&fraction| (0.0..1.0).contains(&fraction)));
    assert!(numbers(&table, "number_density")[..2].iter().all(|&density| density == 0.0), "nearer than a radius");
}

/// A small sphere far from walls, in Couette and Poiseuille flow: its slip is small compared to its velocity, it
/// rotates with half the vorticity, and its stresslet is Einstein's `20/3 pi mu a^3 E`, summed over its slices.
#[test]
fn a_sphere_in_a_flow_has_a_known_profile() {
    // Tolerance of an evaluation: 1e-3.
    let place = Vector::new(4.5, 4.5, 4.0);
    let start = || Start::Positions(vec![place]);
    let couette = Flow::Shear { rate: 2.0, lees_edwards: false };
    let table = profile_of(&model(Boundaries::Walls, couette, start()), 1, 0);
    let at = |name: &str| numbers(&table, name)[8];
    assert!((at("velocity_x") - 8.0).abs() < 1e-3 && at("slip_x").abs() < 1e-3, "the middle, by symmetry");
    assert!((at("angular_velocity_y") - 1.0).abs() < 0.05 && numbers(&table, "velocity_x")[0].is_nan());
    let stress = numbers(&table, "stress_xz").iter().sum::<f64>() / 16.0;
    let einstein = 20.0 / 3.0 * std::f64::consts::PI / (81.0 * 8.0);
    assert!(stress > einstein && stress < 1.3 * einstein, "walls stiffen it: {stress} for {einstein}");
    let table = profile_of(&model(Boundaries::Walls, Flow::Poiseuille { pressure_gradient: 1.0 }, start()), 1, 0);
    let slip = numbers(&table, "slip_x")[8];
    // The slip is relative to u + a^2 / 6 u'' = 8 - 1 / 6.
    assert!((numbers(&table, "velocity_x")[8] - slip - (8.0 - 1.0 / 6.0)).abs() < 1e-12 && slip.abs() < 0.05, "{slip}");
}

/// Heights of a layer are relative to its centre, wherever that is.
#[test]
fn a_layer_is_in_the_middle() {
    let places = [1.0, 4.0].map(|z| Vector::new(4.5, 4.5, z + 100.0));
    let model = model(Boundaries::OpenAlongZ, Flow::None, Start::Positions(places.to_vec()));
    let table = profile_of(&model, 1, 0);
    let densities = numbers(&table, "number_density");
    let found: Vec<f64> =
        numbers(&table, "z").into_iter().zip(densities).filter(|(_, n)| *n > 0.0).map(|(z, _)| z).collect();
    assert_eq!(found, [-1.25, 1.75], "the bins of -1.5, on whose edge it is, and 1.5");
}

#[test]
fn profiles_are_those_of_any_ranks() {
    let couette = Flow::Shear { rate: 1.0, lees_edwards: false };
    let model = model(Boundaries::Walls, couette, Start::Random { minimum_gap: 0.02 });
    let [alone, together] = [1, 3].map(|ranks| profile_of(&model, ranks, 2));
    for name in ["volume_fraction", "velocity_x", "slip_z", "stress_xz", "T_xx"] {
        for (a, b) in numbers(&alone, name).into_iter().zip(numbers(&together, name)) {
            // Tolerance of the iteration.
            assert!((a - b).abs() < 1e-3 * a.abs().max(0.1) || (a.is_nan() && b.is_nan()), "{name}: {a} {b}");
        }
    }
}

/// Statistics that are stored and restored half-way continue bit for bit.
#[test]
fn an_interruption_changes_nothing() {
    let model = model(Boundaries::Wall, Flow::None, Start::Random { minimum_gap: 0.02 });
    let suspension = Suspension::start(&model, &Comm::alone()).unwrap();
    let (particles, partition) = (suspension.particles(), suspension.partition());
    let new = || Statistics::new(&model, model.statistics.unwrap(), particles, suspension.comm());
    let (mut whole, mut parts) = (new(), new());
    for step in 0..7 {
        let (time, cell) = (f64::from(step), suspension.cell());
        let sample =
            Sample { time, rate: 0.0, cell, particles, partition, shear_stress: None, pressure_gradient: None };
        if step == 3 {
            let state = parts.pieces();
            parts = new();
            assert!(parts.restore(&state));
        }
        whole.sample(&sample);
        parts.sample(&sample);
    }
    assert_eq!(whole.pieces(), parts.pieces());
}

#[test]
fn bins_are_four_to_the_smallest_radius() {
    let model = model(Boundaries::Walls, Flow::None, Start::Random { minimum_gap: 0.02 });
    assert_eq!(bins(&model, StatisticsParameters::ALL), Some(32));
    assert_eq!(bins(&model, StatisticsParameters { bins: Some(5), ..StatisticsParameters::ALL }), Some(5));
    let periodic = Parameters { cell: cell(Boundaries::Periodic), statistics: None, ..Parameters::clone(&model) };
    assert_eq!(bins(&Model::new(periodic).unwrap(), StatisticsParameters::ALL), None);
}
