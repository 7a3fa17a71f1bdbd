//! Swimming of the species of a scene.

use super::{KeyError, raw};
use domain::Vector;
use suspension::{ActiveDipole, Swimming};

/// Swimming of a section, if it has some.
pub(super) fn swimming(one: &raw::SpeciesSection, index: usize) -> Result<Option<Swimming>, KeyError> {
    let Some(raw) = &one.swimming else { return Ok(None) };
    let dipole = match (raw.beta, raw.stresslet) {
        (Some(_), Some(_)) => {
            let message = "is set, and beta too, the ratio of the modes; leave one of them out";
            return Err(KeyError::new(format!("species[{index}].swimming.stresslet"), message));
        }
        (Some(beta), None) if raw.speed == 0.0 && beta != 0.0 => {
            let message = "is a multiple of the first mode, and speed is 0; give the stresslet of shakers instead";
            return Err(KeyError::new(format!("species[{index}].swimming.beta"), message));
        }
        (beta, None) => ActiveDipole::Ratio(beta.unwrap_or(0.0)),
        (None, Some(stresslet)) => ActiveDipole::Stresslet(stresslet),
    };
    Ok(Some(Swimming {
        speed: raw.speed,
        dipole,
        angular_velocity: raw.angular_velocity.map_or(Vector::ZERO, Vector::from_array),
        gyrotactic_time: raw.gyrotactic_time,
        rotational_diffusion: raw.rotational_diffusion.unwrap_or(0.0),
        tumbling_rate: raw.tumbling_rate.unwrap_or(0.0),
    }))
}
