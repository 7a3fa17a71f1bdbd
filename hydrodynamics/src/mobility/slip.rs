//! Slip of a mobility's spheres.

use super::columns::{fill, traceless};
use super::{Mobility, MobilityError, MobilityParameters};
use crate::squirming::Squirming;
use domain::{Particles, Traceless, Vector};

/// Names of the columns with the modes of the slip.
const FIRST: &str = "first slip mode";
const SECOND: &str = "second slip mode";

impl Mobility {
    /// Lets spheres swim in later evaluations of [`Self::apply`]: by the slip with which they have these velocities and
    /// stresslets alone in unbounded fluid, see [`Squirming::moving_alone`], or not at all with empty lists. The first
    /// rank has the lists. Collective.
    ///
    /// # Errors
    /// If the parameters have no swimming spheres.
    pub fn swim(&mut self, velocities: &[Vector], stresslets: &[Traceless]) -> Result<(), MobilityError> {
        let MobilityParameters { viscosity, radii, .. } = &self.parameters;
        self.slip(Squirming::moving_alone(velocities, stresslets, *viscosity, radii))
    }

    /// The same for modes of the slip, an entry for each sphere in the order of the radii.
    ///
    /// # Errors
    /// If the parameters have no swimming spheres.
    pub fn slip(&mut self, squirming: Squirming) -> Result<(), MobilityError> {
        let has_slip = self.partition.comm().any(!squirming.is_empty());
        if has_slip && !self.parameters.swimming {
            return Err(MobilityError::NotSwimming);
        }
        let Squirming { first, second } = squirming;
        let turn = self.turn;
        self.slip = has_slip.then(|| Squirming {
            first: first.into_iter().map(|mode| turn.vector(mode)).collect(),
            second: second.into_iter().map(|mode| turn.traceless(mode)).collect(),
        });
        Ok(())
    }

    /// Writes the slip into columns of the particles, which are in the order of the spheres.
    pub(super) fn store_slip(&self, particles: &mut Particles) {
        if let Some(Squirming { first, second }) = &self.slip {
            fill(particles.vectors(FIRST), first);
            fill(traceless(particles, SECOND), second);
        }
    }

    /// Slip of a rank's particles, from their columns; `None` if no sphere has any.
    pub(super) fn load_slip(&self, particles: &mut Particles) -> Option<Squirming> {
        self.slip.as_ref().map(|_| Squirming {
            first: particles.vectors(FIRST).to_vec(),
            second: traceless(particles, SECOND).to_vec(),
        })
    }
}
