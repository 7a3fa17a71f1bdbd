//! Charts of a suspension's time series.

use super::over_time::numbers;
use crate::about::About;
use crate::chart::Chart;
use files::{Observables, Observed};

/// Charts of motion, stress, gaps, segregation, order, swimming, and solver iterations.
pub(super) fn charts(about: &About, series: &Observables) -> Vec<Chart> {
    let Some(means) = series.get("mean_velocity") else { return Vec::new() };
    let stresses = [
        ("first_normal_stress_difference", "first difference"),
        ("second_normal_stress_difference", "second difference"),
        ("particle_pressure", "particle pressure"),
    ];
    let charts = [
        about.force_axis().map(|(axis, name)| mean_velocity(series, means, axis, name)),
        series.get("velocity_variance").map(|variances| fluctuations(series, variances)),
        numbers(series, "Relative viscosity", "viscosity over the fluid's", &[("relative_viscosity", "")]),
        numbers(series, "Shear rate", "rate", &[("shear_rate", "")]).map(|chart| chart.with_level(0.0)),
        numbers(series, "Rate of extension", "rate", &[("extension_rate", "")]).map(|chart| chart.with_level(0.0)),
        numbers(series, "Extensional stress of the suspension", "stress", &[("extensional_stress", "")])
            .map(|chart| chart.with_level(0.0)),
        numbers(series, "Shear stress of the suspension", "stress", &[("shear_stress", "")])
            .map(|chart| chart.with_level(0.0)),
        numbers(series, "Pressure gradient that keeps the flux", "pressure over length", &[("pressure_gradient", "")]),
        numbers(series, "Normal stress differences and pressure", "stress", &stresses)
            .map(|chart| chart.with_level(0.0)),
        numbers(series, "Smallest gap between surfaces", "gap", &[("smallest_gap", "")])
            .map(|chart| chart.with_level(0.0)),
        numbers(series, "Segregation of the species", "intensity, 0 if mixed", &[("segregation", "")]),
        series
            .get("orientation")
            .map(|orders| by_species(series, orders, 3, ["Polar order", "length of the mean axis"])),
        series
            .get("swimming")
            .map(|speeds| by_species(series, speeds, 0, ["Swimming speed", "mean velocity along the axis"])),
        numbers(
            series,
            "Work of a step",
            "number",
            &[("iterations", "iterations of the last solve"), ("evaluations", "evaluations")],
        ),
    ];
    charts.into_iter().flatten().collect()
}

/// Mean velocity of each species along the force.
fn mean_velocity(series: &Observables, means: &Observed, axis: usize, name: char) -> Chart {
    by_species(series, means, axis, [&format!("Mean velocity along {name}"), "mean velocity"])
}

/// A column of a quantity of each species.
fn by_species(series: &Observables, table: &Observed, column: usize, [title, label]: [&str; 2]) -> Chart {
    let mut chart = Chart::new(title, ("time", "time"), (label, &table.unit)).with_level(0.0);
    for (row, species) in table.rows.iter().enumerate() {
        chart.add(species, series.over_time(table.column(row, column)), Vec::new());
    }
    chart
}

/// Standard deviation of the velocity: along each axis for a single species, in total for several.
fn fluctuations(series: &Observables, variances: &Observed) -> Chart {
    let unit = "length/time";
    let mut chart = Chart::new("Velocity fluctuations", ("time", "time"), ("standard deviation", unit)).with_level(0.0);
    let components = |row: usize| [0, 1, 2].map(|axis| variances.column(row, axis).collect::<Vec<f64>>());
    if variances.rows.len() == 1 {
        for (name, variance) in ["along x", "along y", "along z"].iter().zip(components(0)) {
            chart.add(name, series.over_time(variance.into_iter().map(f64::sqrt)), Vec::new());
        }
        return chart;
    }
    for (row, species) in variances.rows.iter().enumerate() {
        let [x, y, z] = components(row);
        let size = x.iter().zip(&y).zip(&z).map(|((x, y), z)| (x + y + z).sqrt());
        chart.add(species, series.over_time(size), Vec::new());
    }
    chart
}
