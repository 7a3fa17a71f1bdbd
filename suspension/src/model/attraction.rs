//! Attractive forces between the surfaces of spheres.

use super::Parameters;
use domain::{Number, ParameterError};
use lubrication::SurfaceForce;

/// Attraction between spheres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Attraction {
    /// Van der Waals force.
    VanDerWaals {
        /// Hamaker constant, an energy.
        hamaker: f64,
        /// Offset added to the gap, over the mean radius, which bounds the force at contact.
        closest: f64,
        /// Gap beyond which the force vanishes, over the mean radius.
        range: f64,
    },
    /// Depletion force: the osmotic pressure of small spheres that are excluded from the gap.
    Depletion {
        /// Osmotic pressure of the depletants.
        pressure: f64,
        /// Radius of the depletants.
        radius: f64,
    },
}

impl Attraction {
    /// Default of [`Attraction::VanDerWaals::closest`].
    pub const CLOSEST: f64 = 0.01;
    /// Default of [`Attraction::VanDerWaals::range`].
    pub const RANGE: f64 = 1.0;

    /// The force law between two surfaces.
    pub fn force(self) -> SurfaceForce {
        match self {
            Self::VanDerWaals { hamaker, closest, range } => SurfaceForce::VanDerWaals { hamaker, closest, range },
            Self::Depletion { pressure, radius } => SurfaceForce::Depletion { pressure, thickness: radius },
        }
    }

    pub(super) fn check(&self, p: &Parameters) -> Result<(), ParameterError> {
        if p.repulsion.is_none() && p.contacts.is_none() {
            let message = "has nothing that keeps the spheres apart; add [repulsion] or [contacts]".to_owned();
            return Err(ParameterError::new("attraction", message));
        }
        match *self {
            Self::VanDerWaals { hamaker, closest, range } => {
                ParameterError::require_positive("attraction.hamaker", hamaker)?;
                ParameterError::require_between("attraction.regularisation_length", closest, [1e-4, 1.0])?;
                ParameterError::require_between("attraction.range", range, [closest, 2.0]).map(drop)
            }
            Self::Depletion { pressure, radius } => {
                ParameterError::require_positive("attraction.osmotic_pressure", pressure)?;
                ParameterError::require_positive("attraction.depletant_radius", radius)?;
                let smallest = p.species.iter().map(|s| s.radius).fold(f64::INFINITY, f64::min);
                if radius > smallest {
                    let [radius, smallest] = [radius, smallest].map(Number);
                    let message = format!("is {radius}; depletants are smaller than the spheres, {smallest} at most");
                    return Err(ParameterError::new("attraction.depletant_radius", message));
                }
                Ok(())
            }
        }
    }
}
