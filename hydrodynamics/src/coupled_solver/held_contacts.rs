//! Contacts of particles that move where the far field is evaluated.

use crate::coupled_solver::CoupledSolver;
use domain::{ColumnValues, Particles, PeriodicBox, RemoteList};
use fcm::HeldLoads;
use lubrication::Contact;
use solver::BackgroundFlow;

/// Contacts of particles that move where the far field is evaluated. Lists are in the order of ids and all numbers in
/// the original units.
#[derive(Clone, Copy)]
pub struct HeldContacts<'a> {
    /// Law of all contacts.
    pub law: &'a Contact,
    /// Largest number of contacts of a particle.
    pub slots: usize,
    /// Times over which implicit forces are predicted: from the present positions for springs along the line of centres,
    /// and from the start of the substep for tangential springs; 0 for forces at present.
    pub times: [f64; 2],
    /// Expected velocities with that of the flow; `None` for those of the flow.
    pub expected: Option<&'a RemoteList>,
    /// State of the contacts at the start of the substep: ten numbers a slot; `None` if there were none.
    pub history: Option<&'a RemoteList>,
    /// Velocities and angular velocities of the previous solution relative to the flow; `None` for zeros.
    pub previous: Option<[&'a RemoteList; 2]>,
    /// The background flow.
    pub flow: &'a BackgroundFlow,
}

/// A particle with more contacts than slots.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TooManyContacts {
    /// Its id.
    pub id: u64,
}

impl CoupledSolver {
    /// The loads of [`Self::hold_loads`] plus the known parts of contact forces and torques. Their resistances are those
    /// of the solves that follow at the same positions with [`HeldForces::contacts`].
    ///
    /// [`HeldForces::contacts`]: crate::HeldForces::contacts
    pub fn contact_loads(
        &mut self,
        cell: &PeriodicBox,
        particles: &Particles,
        contacts: &HeldContacts,
    ) -> Result<HeldLoads, TooManyContacts> {
        let _ = (cell, particles, contacts);
        unimplemented!()
    }

    /// State of the contacts that [`Self::contact_loads`] found, at the end of the substep: ten numbers a slot, from
    /// velocities and angular velocities of the solution relative to the flow.
    pub fn contact_ends(&mut self, motions: [&RemoteList; 2], contacts: &HeldContacts) -> ColumnValues {
        let _ = (motions, contacts);
        unimplemented!()
    }
}
