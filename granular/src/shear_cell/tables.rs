//! The averages of a shear cell as tables.

use super::CellReport;
use domain::Vector;
use simulation::Table;

/// The walls in the order of their stresses.
pub const WALLS: [&str; 4] = ["bottom", "top", "outer", "inner"];

pub fn tables(report: &CellReport) -> Vec<Table> {
    vec![walls(report), profile(report), map(report), totals(report)]
}

fn walls(report: &CellReport) -> Table {
    let columns = ["normal", "normal_error", "along", "along_error", "across", "across_error", "deviation"];
    let mut table = Table::new("walls", &["wall"], &columns.map(|name| (name, "force/length^2")));
    for (wall, name) in report.walls.iter().zip(WALLS) {
        let stresses = [wall.normal, wall.along, wall.across].map(|stress| [stress.mean, stress.error]);
        table.add(&[name], &[stresses.as_flattened(), &[wall.deviation]].concat());
    }
    table
}

fn profile(report: &CellReport) -> Table {
    let [speed, squared] = ["length/time", "length^2/time^2"];
    let velocities = ["velocity_x", "velocity_y", "velocity_z"].map(|name| (name, speed));
    let errors = [("solid_fraction_error", ""), ("velocity_x_error", speed), ("temperature_error", squared)];
    let columns = [&[("y", "length"), ("solid_fraction", "")], &velocities[..], &[("temperature", squared)], &errors];
    let mut table = Table::new("profile", &[], &columns.concat());
    for layer in &report.layers {
        let Vector { x, y, z } = layer.velocity;
        table.add(&[], &[&[layer.y, layer.solid_fraction, x, y, z, layer.temperature][..], &layer.errors].concat());
    }
    table
}

fn map(report: &CellReport) -> Table {
    let mut table = Table::new("map", &[], &[("z", "length"), ("y", "length"), ("solid_fraction", "")]);
    let [across, up] = report.map.middles();
    let places = up.iter().flat_map(|&y| across.iter().map(move |&z| [z, y]));
    for ([z, y], solid_fraction) in places.zip(report.map.solid_fractions()) {
        table.add(&[], &[z, y, solid_fraction]);
    }
    table
}

fn totals(report: &CellReport) -> Table {
    let (tally, balance) = (&report.tally, &report.balance);
    let totals = [
        ("measured_time", "time", report.measured),
        ("height", "length", report.height.mean),
        ("height_error", "length", report.height.error),
        ("solid_fraction", "", report.solid_fraction),
        ("temperature", "length^2/time^2", report.temperature),
        ("energy_imbalance", "", balance.energy),
        ("momentum_imbalance", "", balance.momentum),
        ("largest_overlap", "", tally.largest_overlap),
        ("mean_overlap", "", tally.mean_overlap()),
        ("hits", "", tally.collisions() as f64),
    ];
    let mut table = Table::new("totals", &[], &totals.map(|(name, unit, _)| (name, unit)));
    table.add(&[], &totals.map(|(_, _, value)| value));
    table
}
