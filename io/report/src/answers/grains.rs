//! The quantities that disks and shear cells are run for.

use super::course::Course;
use files::Observables;
use scene::ShearCellScene;

/// The columns of the series that they are made of.
pub(super) const COLUMNS: [&str; 9] = [
    "stress_xx",
    "stress_xy",
    "stress_yy",
    "kinetic_energy",
    "mean_free_path",
    "segregation",
    "wall_stress",
    "temperature",
    "solid_fraction",
];

/// Of disks: the stress of two dimensions, whose pressure is positive.
pub(super) fn of_disks(series: &Observables) -> Vec<Course> {
    let number = |name: &str| -> Option<Vec<f64>> { Some(series.get(name)?.column(0, 0).collect()) };
    let pressure = number("stress_xx").zip(number("stress_yy")).map(|(xx, yy)| {
        let mean = xx.iter().zip(&yy).map(|(xx, yy)| 0.5 * (xx + yy));
        mean.collect()
    });
    let list = [
        (("shear_stress", "force/length"), number("stress_xy")),
        (("pressure", "force/length"), pressure),
        (("granular_temperature", "force*length"), number("kinetic_energy")),
        (("mean_free_path", "length"), number("mean_free_path")),
        (("segregation", ""), number("segregation")),
    ];
    let course =
        |(what, values): ((&'static str, &'static str), Option<Vec<f64>>)| Some(Course::new(what.0, what.1, values?));
    list.into_iter().filter_map(course).collect()
}

/// Of a shear cell: the stress on the bottom, whose pressure is positive, and the agitation of the grains.
pub(super) fn of_shear_cell(series: &Observables) -> Vec<Course> {
    let number = |name: &str| -> Option<Vec<f64>> { Some(series.get(name)?.column(0, 0).collect()) };
    let on_bottom =
        |column: usize| -> Option<Vec<f64>> { Some(series.get("wall_stress")?.column(0, column).collect()) };
    let unit = "force/length^2";
    let list = [
        (("pressure_on_bottom", unit), on_bottom(0)),
        (("shear_stress_on_bottom", unit), on_bottom(1)),
        (("granular_temperature", "length^2/time^2"), number("temperature")),
        (("solid_fraction", ""), number("solid_fraction")),
    ];
    let course =
        |(what, values): ((&'static str, &'static str), Option<Vec<f64>>)| Some(Course::new(what.0, what.1, values?));
    list.into_iter().filter_map(course).collect()
}

/// The time from which a cell is measured.
pub(super) fn measured_from(scene: &ShearCellScene) -> f64 {
    scene.experiment.transient as f64 * scene.experiment.time_step
}
