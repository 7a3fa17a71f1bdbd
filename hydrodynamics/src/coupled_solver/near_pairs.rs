//! Near pairs of a solve.

use crate::ambient::StrainRate;
use crate::coupled_solver::{CoupledSolver, in_units};
use crate::pairs::device_tables;
use crate::pairs::search::{Connections, NearField, NearPairs};
use crate::solution::{HeldForces, HeldPrediction, SolveInput};
use crate::springs::Springs;
use crate::system::SingleSpheres;
use crate::units;
use domain::{Boundaries, DomainView, Particles, PeriodicBox, RemoteHolder, Traceless, Units};
use fcm::{HeldSprings, HeldSteps, Loads, NearInput, NearTables, PredictedVelocities};
use std::rc::Rc;

impl CoupledSolver {
    /// Near pairs of particles in scaled units, in a box in the original units, with the strain rate and the bodies of
    /// `acting` in scaled units and its springs and slip in the original ones. Collective.
    pub(super) fn near_pairs(&mut self, cell: &PeriodicBox, own: &Particles, acting: &SolveInput) -> NearPairs {
        self.pairs_of_host(cell, own, acting, false)
    }

    /// The same, or those by springs, spheres at walls and loads by slip alone.
    fn pairs_of_host(
        &mut self,
        cell: &PeriodicBox,
        own: &Particles,
        acting: &SolveInput,
        without_lubrication: bool,
    ) -> NearPairs {
        let (units, cell) = (self.units, &cell.scaled(1.0 / self.units.length));
        let SolveInput { strain_rate, springs, bodies, .. } = *acting;
        let view = DomainView { cell, partition: &self.partition };
        let Some(field) = &mut self.near else { return NearPairs::none(own, cell, &self.partition) };
        if without_lubrication && springs.is_none() && acting.squirming.is_none() {
            return match &field.at_walls {
                Some(force) => NearPairs::at_walls(force, own, view, strain_rate),
                None => NearPairs::none(own, cell, &self.partition),
            };
        }
        let resistance = springs.map(|springs| units::resistance(springs, &units));
        let contacts = springs.map(|springs| units::contacts(springs, &units)).unwrap_or_default();
        let tethers = springs.map(|springs| units::tethers(springs, &units)).unwrap_or_default();
        let springs =
            resistance.as_ref().map(|resistance| Springs { resistance, contacts: &contacts, tethers: &tethers });
        let connections = Connections { springs: springs.as_ref(), bodies, without_lubrication };
        let mut near = NearPairs::find(field, connections, own, view, strain_rate);
        if let Some(squirming) = acting.squirming {
            near.add_slip(field, &squirming.in_units(&units));
        }
        near
    }

    /// [`Self::near_pairs`] for a solve of particles that are given in the original units too: with the lubrication
    /// where the far field is evaluated, if it is solved for there. Collective.
    pub(super) fn pairs_of_solve(
        &mut self,
        cell: &PeriodicBox,
        [particles, own]: [&Particles; 2],
        acting: &SolveInput,
    ) -> NearPairs {
        if !self.solves_on_device(acting) {
            assert!(acting.moving_in.is_none(), "particles move where their near pairs are");
            return self.near_pairs(cell, own, acting);
        }
        let mut near = match acting.moving_in {
            Some(_) => NearPairs::elsewhere(particles.len(), cell, &self.partition),
            None => self.pairs_of_host(cell, own, acting, true),
        };
        let plan = self.far.mobility().plan();
        let (viscosity, radii) = (plan.viscosity / self.units.viscosity, in_units(&plan.radii, self.units.length));
        let tables = || near_tables(self.near.as_ref(), viscosity, &radii);
        let given = near.has_rows().then(|| near.rows());
        let surface = self.surface_laws.as_ref().filter(|_| acting.surface_forces);
        let StrainRate { at_zero: Traceless(background), slope } = acting.strain_rate;
        let input = NearInput { background, slope, given: given.as_ref(), surface, ..NearInput::default() };
        let mobility = self.far.mobility();
        mobility.follow(cell, particles);
        if let Some(far) = mobility.coupled() {
            let springs = held_springs(acting, self.units);
            near.note_found(far.assemble(&tables, &input, &springs).iter().sum());
        }
        near
    }

    /// Whether free particles can move where the far field is evaluated, in a periodic box.
    pub fn moves_particles(&mut self) -> bool {
        let is_periodic = self.far.mobility().plan().boundaries == Boundaries::Periodic;
        is_periodic && self.solves_on_device(&SolveInput::new(&Loads::default(), StrainRate::default()))
    }

    /// The memory where particles can move.
    pub fn holder(&self) -> Option<&dyn RemoteHolder> {
        self.holder.as_deref()
    }

    /// Measures of displacements in that memory.
    pub fn steps(&self) -> Option<&Rc<dyn HeldSteps>> {
        self.steps.as_ref()
    }

    /// Whether the back end of the far field solves for the motions of free spheres, together with near pairs if there
    /// are some.
    pub(super) fn solves_on_device(&mut self, acting: &SolveInput) -> bool {
        acting.bodies.is_none() && self.preconditioned && self.far.mobility().coupled().is_some()
    }
}

/// Tables of the near field between spheres of some radii, with lubrication if it has some, and the resistances of
/// single spheres.
pub(super) fn near_tables(near: Option<&NearField>, viscosity: f64, radii: &[f64]) -> NearTables {
    let SingleSpheres { motion, strain } = SingleSpheres::new(viscosity, radii);
    let alone = motion.iter().zip(&strain).map(|(motion, &strain)| [motion.0[0], motion.0[3], strain]);
    let resistances = alone.collect();
    match near {
        Some(NearField { lubrication: Some(lubrication), .. }) => lubrication.tables(viscosity, resistances),
        _ => device_tables::without_lubrication(radii, resistances),
    }
}

/// Implicit springs of a solve for particles that move where the far field is evaluated: those of contacts and surfaces
/// if there is a prediction.
fn held_springs<'a>(acting: &'a SolveInput, units: Units) -> HeldSprings<'a> {
    let (Some(forces), Some(flow)) = (acting.held_forces, &acting.moving_in) else { return HeldSprings::default() };
    let HeldForces { prediction, contacts } = forces;
    let predicted = prediction.as_ref().map(|&HeldPrediction { time, ref velocities }| PredictedVelocities {
        velocities,
        carried: &flow.carried,
        time,
        units,
    });
    HeldSprings { are_touching: prediction.is_some() && contacts.is_some(), predicted }
}
