//! Displacements of spheres by forces in a step.

use super::{Parameters, Species};
use domain::{Number, ParameterError, Vector};
use std::f64::consts::PI;

/// Lengths of the box through which a sphere alone may go in a step at most.
const MOST_LENGTHS: f64 = 100.0;

impl Parameters {
    /// Displacement in a step of a sphere alone under the steady force of its species.
    pub(crate) fn travel(&self, species: &Species) -> f64 {
        let force = species.force_on(species.radius, self.gravity).length();
        force / (6.0 * PI * self.viscosity * species.radius) * self.time_step
    }
}

/// Refuses forces that move spheres through the box again and again in one step: no step can be divided into parts that are short
/// enough to see them pass each other.
pub(super) fn check(p: &Parameters) -> Result<(), ParameterError> {
    let most = MOST_LENGTHS * p.cell.edges().max_element();
    for (index, species) in p.species.iter().enumerate() {
        let travel = p.travel(species);
        // One that is no number is refused, too.
        if travel <= most {
            continue;
        }
        let is_own = species.force.length() >= (species.force_on(species.radius, p.gravity) - species.force).length();
        let force = if is_own || p.gravity == Vector::ZERO {
            format!("species[{index}].force")
        } else {
            "gravity.acceleration".to_owned()
        };
        let (step, longest) = (Number(p.time_step), Number(p.time_step * most / travel));
        let (travel, edge) = (Number(travel), Number(p.cell.edges().max_element()));
        let message = format!(
            "is {step}, too large for {force}: in a step a sphere of species \"{}\" alone would move by {travel:.2}, with a longest \
             edge of the box of {edge:.3}; take {longest:.2} or much less, or a smaller force",
            species.name
        );
        return Err(ParameterError::new("time.step", message));
    }
    Ok(())
}
