//! Properties of a suspension and its evaluations that are known before a run.

pub mod calibrate_repulsion;
pub mod cost_growth;
mod network;
pub mod scaling;
pub mod stable_step;
pub mod step_lengths;
pub mod summary;
pub mod warnings;

use crate::evaluation::prepared::Planned;
use crate::model::Model;
use crate::start::plan::largest_strain;

/// Properties of a suspension that are known before a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Forecast {
    /// Number of spheres.
    pub particles: f64,
    /// Predicted seconds per evaluation on one core.
    pub evaluation: f64,
    /// Points of each velocity field; 0 if there are no fields.
    pub field_points: f64,
}

impl Forecast {
    /// The forecast for a model that gives its number of spheres; `None` for others, or without a plan.
    pub fn of(model: &Model) -> Option<Self> {
        let planned = Planned::of_model(model).ok()??;
        let on_grid = model.fields.then(|| planned.plan.of_flow(largest_strain(model)).ok()).flatten();
        let field_points = on_grid.map_or(0.0, |plan| plan.points_of_flow().iter().map(|&n| n as f64).product());
        let particles = planned.radii.count() as f64;
        Some(Self { particles, evaluation: planned.plan.predicted_seconds, field_points })
    }
}
