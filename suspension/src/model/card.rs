//! Motion of the spheres of a model on the host, if the far field is evaluated on a card.

use super::{Model, MultipoleOrder};
use domain::Boundaries;

impl Model {
    /// The first key by which spheres move on the host although the far field is on a card; `None` if they can move
    /// there: free spheres with stresslets and without orientations, in a periodic box at a given rate of flow.
    pub fn moves_on_host_by(&self) -> Option<&'static str> {
        let hydrodynamics = &self.hydrodynamics;
        let has_orientations = self.species.iter().any(|species| species.orientation.is_some());
        let keys = [
            ("hydrodynamics.multipoles", hydrodynamics.multipoles != MultipoleOrder::Dipole),
            ("hydrodynamics.preconditioner", !hydrodynamics.preconditioner),
            ("box.boundaries", self.cell.boundaries() != Boundaries::Periodic),
            ("flow.control", self.shear_rates().stress().is_some()),
            ("bodies", !self.bodies.is_empty()),
            ("filaments", !self.filaments.is_empty()),
            ("bonds", !self.bonds.is_empty()),
            ("traps", !self.traps.is_empty()),
            ("magnetic", self.magnetic.is_some()),
            ("electric", self.electric.is_some()),
            ("species.swimming", self.has_swimmers()),
            ("species.orientation", has_orientations),
        ];
        keys.into_iter().find(|(_, is_set)| *is_set).map(|(key, _)| key)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Adaptive, Flow, Integrator, Orientation, Parameters, Protocol, Species};
    use domain::{PeriodicBox, Vector};

    fn key(change: impl FnOnce(&mut Parameters)) -> Option<&'static str> {
        let cell = PeriodicBox::new(Vector::splat(9.0)).unwrap();
        let mut parameters = Parameters::new(cell, 1.0, vec![Species::new("one", 1.0, 2)], 0.01, 1);
        change(&mut parameters);
        Model::new(parameters).unwrap().moves_on_host_by()
    }

    #[test]
    fn keys_tell_why_spheres_move_on_the_host() {
        assert_eq!(key(|_| {}), None);
        assert_eq!(key(|p| p.flow = Flow::Shear { rate: 1.0, lees_edwards: true }), None);
        let monopoles = |p: &mut Parameters| p.hydrodynamics.multipoles = MultipoleOrder::Monopole;
        assert_eq!(key(monopoles), Some("hydrodynamics.multipoles"));
        let walls = |p: &mut Parameters| p.cell = p.cell.with_boundaries(Boundaries::Walls).unwrap();
        assert_eq!(key(walls), Some("box.boundaries"));
        let oriented = |p: &mut Parameters| p.species[0].orientation = Some(Orientation::Random);
        assert_eq!(key(oriented), Some("species.orientation"));
        let driven = |p: &mut Parameters| {
            p.flow = Flow::Shear { rate: 1.0, lees_edwards: true };
            p.protocol = Protocol::Stress(1.0);
            p.integrator = Integrator::Implicit(Adaptive::default());
        };
        assert_eq!(key(driven), Some("flow.control"));
    }
}
