//! Near pairs of a solve.

use crate::coupled_solver::CoupledSolver;
use crate::pairs::search::{Connections, NearPairs};
use crate::solution::SolveInput;
use crate::springs::Springs;
use crate::units;
use domain::{DomainView, Particles, PeriodicBox};

impl CoupledSolver {
    /// Near pairs of particles in scaled units, in a box in the original units, with the strain rate and the bodies of
    /// `acting` in scaled units and its springs and slip in the original ones. Collective.
    pub(super) fn near_pairs(&mut self, cell: &PeriodicBox, own: &Particles, acting: &SolveInput) -> NearPairs {
        let (units, cell) = (self.units, &cell.scaled(1.0 / self.units.length));
        let Some(field) = &mut self.near else { return NearPairs::none(own, cell, &self.partition) };
        let SolveInput { strain_rate, springs, bodies, .. } = *acting;
        let resistance = springs.map(|springs| units::resistance(springs, &units));
        let contacts = springs.map(|springs| units::contacts(springs, &units)).unwrap_or_default();
        let tethers = springs.map(|springs| units::tethers(springs, &units)).unwrap_or_default();
        let springs =
            resistance.as_ref().map(|resistance| Springs { resistance, contacts: &contacts, tethers: &tethers });
        let connections = Connections { springs: springs.as_ref(), bodies };
        let view = DomainView { cell, partition: &self.partition };
        let mut near = NearPairs::find(field, connections, own, view, strain_rate);
        if let Some(squirming) = acting.squirming {
            near.add_slip(field, &squirming.in_units(&units));
        }
        near
    }
}
