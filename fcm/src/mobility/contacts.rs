//! Contacts of particles that move where the far field is evaluated.

use crate::mobility::coupled::{HeldLoads, MovingFlow};
use domain::{ColumnValues, RemoteList, Units};
use gpu::ContactLaw;

/// A far field that moves particles with stresslets, finds their contacts, and keeps the states of these.
pub trait ContactFarField {
    /// Finds the contacts of the arranged particles, which move there. Returns the known parts of their loads, added to
    /// steady loads if there are any; later solves at these positions may have their springs.
    ///
    /// # Errors
    ///
    /// With the place, in the order of ids, of the first particle that has more contacts than slots.
    fn loads(&mut self, touching: &TouchingParticles, steady: Option<&HeldLoads>) -> Result<HeldLoads, usize>;

    /// State of these contacts at the end of the substep, by velocities and angular velocities of the solution
    /// relative to the background flow: of each particle, in the order of ids, some slots with ten numbers each. These
    /// are the id of the other particle plus one, or 0 for an empty slot; the tangential force, the rolling force, the
    /// normal force, and the shares of the two springs.
    fn ends(&mut self, touching: &TouchingParticles, motions: [&RemoteList; 2]) -> ColumnValues;
}

/// Contacts of the arranged particles. Lists are in the order of ids and in the original units.
#[derive(Clone, Copy)]
pub struct TouchingParticles<'a> {
    /// Units of length and viscosity of the law, of the resistances and of the loads; the unit of force is 1.
    pub units: Units,
    /// The law in these units.
    pub law: ContactLaw,
    /// Whether the normal force grows with the power 3/2 of the overlap, instead of in proportion to it.
    pub is_hertz: bool,
    /// Largest number of contacts of a particle.
    pub slots: usize,
    /// Times over which forces are predicted along the line of centres and across.
    pub times: [f64; 2],
    /// Expected velocities with those of [`MovingFlow::carried`]; `None` for these.
    pub expected: Option<&'a RemoteList>,
    /// State at the start of the substep; `None` if there were no contacts.
    pub history: Option<&'a RemoteList>,
    /// Velocities and angular velocities of the previous solution relative to the flow; `None` for zeros.
    pub previous: Option<[&'a RemoteList; 2]>,
    /// The background flow.
    pub flow: MovingFlow,
}
