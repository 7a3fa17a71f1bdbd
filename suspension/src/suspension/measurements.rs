//! Stresses, contacts and bonds of the present state.

use super::Suspension;
use crate::evaluation::stress::ParticleStress;
use crate::forces::contacts::{ContactStatistics, contact_force};
use crate::forces::force::StressName;
use crate::forces::tethers::BondTotals;
use crate::forces::{NamedMoments, user};
use domain::Tensor;
use simulation::ContactForces;

impl Suspension {
    /// Shear stress along x and y on the wall at `z = 0` and, if there is one, on the wall at `z = Lz`, for a given
    /// particle stress; empty without walls. With `F` and `T` the steady forces and torques of the species,
    ///
    /// ```text
    /// upper wall: mu du/dz + s_xz - sum (z F_x + T_y / 2) / V,      lower wall: the same + sum F_x / A
    /// ```
    ///
    /// and likewise along y, by the first moments of all loads on the fluid. On a single wall below unbounded fluid,
    /// only forces and the flow act. Collective.
    pub fn wall_stress(&self, stress: &Tensor) -> Vec<[f64; 2]> {
        self.dynamics.wall_stress(self.particles(), stress)
    }

    /// Pressure drop per length along x that keeps the mean velocity of a [`crate::Flow::ConstantFlux`], from the last
    /// solve; `None` for other flows.
    ///
    /// With the non-hydrodynamic forces and torques `F`, `T`, the total stresslets `S`, `q = z (H - z) / 2` and the
    /// area `A` of a wall,
    ///
    /// ```text
    /// 12 mu U / H^2 - 12 / (A H^3) sum [F_x (q - a^2/6) - (S_xz - T_y / 2) dq/dz]
    /// ```
    ///
    /// at the centres; stresslets of lubrication between two spheres are taken at their midpoint.
    pub fn pressure_gradient(&self) -> Option<f64> {
        self.dynamics.pressure_gradient()
    }

    /// Stress of the particles of each species. Collective.
    pub fn stress(&self, species: usize) -> Vec<ParticleStress> {
        let (volume, moments) = (self.cell().volume(), self.moments());
        let active = self.dynamics.active_stresslets(self.particles());
        ParticleStress::by_species(self.particles(), moments, active.as_deref(), species, volume, &self.comm)
    }

    /// Contribution of each particle to the first moments of all forces between spheres, and to the moments of walls.
    /// Collective.
    pub fn pair_moments(&self) -> Vec<Tensor> {
        let moments = self.moments();
        let all = || moments.iter().flatten().filter(|moments| !moments.of_particles.is_empty());
        (0..self.particles.len()).map(|row| all().fold(Tensor::ZERO, |sum, m| sum + m.of_particles[row])).collect()
    }

    /// First moments of the forces of the model and of the user. Collective.
    fn moments(&self) -> [Vec<NamedMoments>; 2] {
        self.dynamics.forces().moments(self.particles(), self.dynamics.domain(), self.clock.time())
    }

    /// Names of the contributions of the model's forces to the stress, and of those of the user's forces; functions of
    /// the user have one only if they give moments, by the last evaluation.
    pub(crate) fn stresses_of_forces(&self) -> [Vec<StressName>; 2] {
        let forces = self.dynamics.forces();
        let applied = self.has_applied_stress().then_some(StressName::symmetric(user::NAME));
        let of_user = applied.into_iter().chain(forces.stresses_of_registered());
        [forces.stresses_of_model(), of_user.collect()]
    }

    /// Whether user-defined forces contribute to the stress, by the last evaluation.
    pub fn has_applied_stress(&self) -> bool {
        user::have_moments(self.particles())
    }

    /// Whether registered forces contribute to the stress.
    pub(crate) fn has_registered_stress(&self) -> bool {
        !self.dynamics.forces().stresses_of_registered().is_empty()
    }

    /// Mean number of contacts per particle, fractions of frictional and of sliding contacts, largest overlap over the
    /// roughness, and elastic energy; `None` for spheres without contacts. Collective.
    pub fn contact_numbers(&self) -> Option<[f64; 5]> {
        self.contacts().map(|measured| measured.numbers(&self.comm))
    }

    /// Stiffness of contacts, and whether it is constant from now on; `None` for spheres without contacts.
    pub fn contact_stiffness(&self) -> Option<(f64, bool)> {
        let stays = self.dynamics.stiffness_adaptation().is_none_or(|adaptation| adaptation.is_over());
        self.dynamics.contact_stiffness().map(|stiffness| (stiffness, stays))
    }

    /// Energies of the bonds and number of broken ones; `None` without bonds. Collective.
    pub fn bond_totals(&self) -> Option<BondTotals> {
        self.dynamics.bond_totals(self.particles())
    }

    /// Energy of the trapped spheres; `None` without traps. Collective.
    pub fn trap_energy(&self) -> Option<f64> {
        self.dynamics.trap_energy(self.particles())
    }

    /// Forces of contacts and bonds, on the first rank; `None` without either. Collective.
    pub fn contact_forces(&self) -> Option<ContactForces> {
        let own = self.dynamics.contact_forces(self.particles())?;
        let mut list: Vec<_> = self.comm.gather(&own).iter().map(contact_force).collect();
        list.sort_unstable_by_key(|contact| (contact.ids, contact.state.number()));
        let lattice = self.cell().lattice_vectors();
        Some(ContactForces { step: self.clock.step(), time: self.clock.time(), lattice, list })
    }

    /// Averages and totals over contacts; `None` for spheres without contacts. Collective.
    fn contacts(&self) -> Option<ContactStatistics> {
        self.dynamics.contact_statistics(self.particles())
    }
}
