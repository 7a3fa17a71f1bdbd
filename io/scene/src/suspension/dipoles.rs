//! Magnetic and electric fields of a scene, and the moments of its species.

use super::{KeyError, raw};
use domain::Vector;
use suspension::{AppliedField, FieldVariation, SphereMoment};

/// The magnetic field of a scene.
pub(super) fn magnetic(raw: raw::MagneticSection) -> Result<AppliedField, KeyError> {
    let variation = variation("magnetic", raw.frequency, raw.rotation_axis)?;
    let (constant, tolerance) = (raw.permeability.unwrap_or(1.0), raw.tolerance);
    Ok(AppliedField { amplitude: raw.field.into(), variation, constant, tolerance })
}

/// The electric field of a scene.
pub(super) fn electric(raw: raw::ElectricSection) -> Result<AppliedField, KeyError> {
    let variation = variation("electric", raw.frequency, raw.rotation_axis)?;
    let (constant, tolerance) = (raw.permittivity.unwrap_or(1.0), raw.tolerance);
    Ok(AppliedField { amplitude: raw.field.into(), variation, constant, tolerance })
}

fn variation(section: &str, frequency: Option<f64>, axis: Option<[f64; 3]>) -> Result<FieldVariation, KeyError> {
    match (frequency, axis) {
        (None, None) => Ok(FieldVariation::Constant),
        (Some(frequency), None) => Ok(FieldVariation::Alternating { frequency }),
        (Some(frequency), Some(axis)) => Ok(FieldVariation::Rotating { frequency, axis: Vector::from_array(axis) }),
        (None, Some(_)) => {
            let message = format!("is set, but the field does not rotate; give {section}.frequency, or leave it out");
            Err(KeyError::new(format!("{section}.rotation_axis"), message))
        }
    }
}

/// The magnetic moment of the spheres of a section.
pub(super) fn magnetic_moment(one: &raw::SpeciesSection) -> SphereMoment {
    SphereMoment {
        permanent: one.magnetic_moment.unwrap_or(0.0),
        susceptibility: one.magnetic_susceptibility.unwrap_or(0.0),
        saturation: one.magnetic_saturation,
    }
}

/// The electric moment of the spheres of a section: a permanent one over the permittivity of the fluid.
pub(super) fn electric_moment(
    one: &raw::SpeciesSection,
    index: usize,
    field: Option<raw::ElectricSection>,
) -> Result<SphereMoment, KeyError> {
    let keys = [("electric_moment", one.electric_moment), ("permittivity", one.permittivity)];
    let Some(field) = field else {
        return match keys.into_iter().find(|(_, value)| value.is_some()) {
            None => Ok(SphereMoment::NONE),
            Some((key, _)) => {
                let message = "is set, but there is no [electric]; write [electric] field = [x, y, z]";
                Err(KeyError::new(format!("species[{index}].{key}"), message))
            }
        };
    };
    let fluid = field.permittivity.unwrap_or(1.0);
    Ok(SphereMoment {
        permanent: one.electric_moment.unwrap_or(0.0) / fluid,
        susceptibility: one.permittivity.map_or(0.0, |permittivity| permittivity / fluid - 1.0),
        saturation: None,
    })
}
