//! What is known of a suspension and of its evaluations before it is run.

use crate::model::Model;
use crate::plan::largest_strain;
use crate::setup::Planned;

/// What is known of a suspension before it is run.
#[derive(Debug, Clone, PartialEq)]
pub struct Forecast {
    /// How many spheres.
    pub particles: f64,
    /// Seconds expected of an evaluation on one core.
    pub evaluation: f64,
    /// Points of each velocity field; 0 if none is wanted.
    pub field_points: f64,
}

impl Forecast {
    /// Of a model that counts its spheres itself; nothing of others, and nothing where there is no plan.
    pub fn of(model: &Model) -> Option<Self> {
        let planned = Planned::of_model(model).ok()??;
        let on_grid = model.fields.then(|| planned.plan.of_flow(largest_strain(model)).ok()).flatten();
        let field_points = on_grid.map_or(0.0, |plan| plan.points_of_flow().iter().map(|&n| n as f64).product());
        let particles = planned.radii.count() as f64;
        Some(Self { particles, evaluation: planned.plan.predicted_seconds, field_points })
    }
}
