//! Forces by which spheres attract each other.

use super::Parameters;
use domain::{Number, ParameterError};
use lubrication::SurfaceForce;

/// How spheres attract each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Attraction {
    /// By van der Waals' forces.
    VanDerWaals {
        /// The Hamaker constant, an energy.
        hamaker: f64,
        /// The gap, over the mean radius, that bounds the force at contact.
        closest: f64,
        /// The gap where it ends, over the mean radius.
        range: f64,
    },
    /// By the osmotic pressure of small spheres between them.
    Depletion {
        /// Their osmotic pressure.
        pressure: f64,
        /// Their radius.
        radius: f64,
    },
}

impl Attraction {
    /// The gap that bounds van der Waals' force, unless another one is given.
    pub const CLOSEST: f64 = 0.01;
    /// The gap where it ends, unless another one is given.
    pub const RANGE: f64 = 1.0;

    /// The force between two spheres.
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
                ParameterError::unless_positive("attraction.hamaker", hamaker)?;
                ParameterError::unless_between("attraction.closest", closest, [1e-4, 1.0])?;
                ParameterError::unless_between("attraction.range", range, [closest, 2.0]).map(drop)
            }
            Self::Depletion { pressure, radius } => {
                ParameterError::unless_positive("attraction.pressure", pressure)?;
                ParameterError::unless_positive("attraction.depletant_radius", radius)?;
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
