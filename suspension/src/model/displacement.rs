//! Displacements of spheres by steady forces in one step.

use super::{Parameters, Species};
use domain::{Number, ParameterError, Vector, sphere};

/// Largest displacement of an isolated sphere in a step, over the longest edge of the box.
const MOST_LENGTHS: f64 = 100.0;

impl Parameters {
    /// Displacement in one step of an isolated sphere under the steady force of its species.
    pub(crate) fn displacement_per_step(&self, species: &Species) -> f64 {
        let force = species.force_on(species.radius, self.gravity).length();
        force / sphere::drag(self.viscosity, species.radius) * self.time_step
    }
}

/// Refuses forces that would move spheres through the box many times in one step: no division into substeps could
/// resolve how they pass each other.
pub(super) fn check(p: &Parameters) -> Result<(), ParameterError> {
    let most = MOST_LENGTHS * p.cell.edges().max_element();
    for (index, species) in p.species.iter().enumerate() {
        check_swimming(p, index, most)?;
        let travel = p.displacement_per_step(species);
        // Also refuses NaN.
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
            "is {step}, too large for {force}: in a step a sphere of species \"{}\" alone would move by {travel:.2}, \
             with a longest edge of the box of {edge:.3}; take {longest:.2} or much less, or a smaller force",
            species.name
        );
        return Err(ParameterError::new("time.step", message));
    }
    Ok(())
}

/// Refuses speeds with which swimmers would pass through the box many times in one step.
fn check_swimming(p: &Parameters, index: usize, most: f64) -> Result<(), ParameterError> {
    let Some(swimming) = p.species[index].swimming.as_ref() else { return Ok(()) };
    let travel = swimming.speed * p.time_step;
    if travel <= most {
        return Ok(());
    }
    let message = format!(
        "is {}, too large for time.step = {}: in a step a swimmer would swim {:.2}, with a longest edge of the box of \
         {:.3}; take {:.2} or much less, or a shorter step",
        Number(swimming.speed),
        Number(p.time_step),
        Number(travel),
        Number(p.cell.edges().max_element()),
        Number(most / p.time_step)
    );
    Err(ParameterError::new(format!("species[{index}].swimming.speed"), message))
}
