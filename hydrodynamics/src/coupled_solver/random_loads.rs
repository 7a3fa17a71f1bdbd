//! Random forces and torques of lubrication.

use crate::bodies::RigidBodies;
use crate::coupled_solver::near_pairs::near_tables;
use crate::coupled_solver::{CoupledSolver, in_units};
use crate::noise::{self, OF_PAIR};
use crate::six_vector::SixVector;
use crate::units;
use domain::parallel::mapped;
use domain::{DomainView, Particles, PeriodicBox};
use fcm::{Loads, Stream};

impl CoupledSolver {
    /// Random forces and torques whose covariance is the lubrication resistance of free spheres and of those of bodies;
    /// empty without lubrication. Those of pairs of free spheres are added up where the far field is evaluated, if it
    /// does that. Collective.
    pub fn pair_noise(
        &mut self,
        cell: &PeriodicBox,
        particles: &Particles,
        bodies: Option<&RigidBodies>,
        stream: Stream,
    ) -> Loads {
        let added_up = if bodies.is_none() { self.loads_on_device(cell, particles, stream) } else { None };
        let Some(field) = self.near.as_mut().filter(|field| field.lubrication.is_some()) else {
            return Loads::default();
        };
        let (units, own) = (self.units, units::particles(particles, &self.units));
        let cell = &cell.scaled(1.0 / units.length);
        let mut loads = added_up.unwrap_or_else(|| {
            let bodies = bodies.map(|bodies| bodies.in_units(&units));
            noise::loads_of_pairs(field, &own, bodies.as_ref(), DomainView { cell, partition: &self.partition }, stream)
        });
        if let Some(force) = &field.at_walls {
            noise::add_at_walls(&mut loads, force, &own, cell, stream);
        }
        // Square roots of the units of translational and rotational resistance.
        let [force, torque] = [units.length, units.length.powi(3)].map(|size| (size * units.viscosity).sqrt());
        Loads {
            forces: mapped(&loads.forces, |&f| f * force),
            torques: mapped(&loads.torques, |&t| t * torque),
            stresslets: Vec::new(),
        }
    }

    /// Loads of pairs of free spheres in scaled units by the back end of the far field.
    fn loads_on_device(&mut self, cell: &PeriodicBox, particles: &Particles, stream: Stream) -> Option<Loads> {
        self.near.as_ref()?.lubrication.as_ref()?;
        let mobility = self.far.mobility();
        mobility.near_pairs()?;
        let plan = mobility.plan();
        let (viscosity, radii) = (plan.viscosity / self.units.viscosity, in_units(&plan.radii, self.units.length));
        mobility.follow(cell, particles);
        let tables = || near_tables(self.near.as_ref(), viscosity, &radii);
        let numbers = mobility.near_pairs()?.random_loads(&tables, particles, stream.seed_of(OF_PAIR));
        let loads = numbers.as_chunks().0;
        let forces = mapped(loads, |&load| SixVector(load).linear());
        let torques = mapped(loads, |&load| SixVector(load).angular());
        Some(Loads { forces, torques, stresslets: Vec::new() })
    }
}
