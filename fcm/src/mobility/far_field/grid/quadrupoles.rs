//! Motions by degenerate quadrupoles.

use super::{GridFarField, motion, near};
use crate::mobility::loads::{Motion, Output};
use crate::mobility::work::Stopwatch;
use crate::pairs::table::PairFunctions;
use crate::plan::problem::Precision;
use domain::Vector;
use domain::parallel::{greatest, mapped, stage};

impl GridFarField {
    /// Motions of all particles by the degenerate quadrupoles of this rank's: as with forces, by the grid and by pair
    /// corrections. There are no images in walls. Collective.
    pub(super) fn motion_by_quadrupoles(&mut self, quadrupoles: &[Vector]) -> Motion {
        self.work.evaluations += 1;
        let (mut clock, _stage) = (Stopwatch::start(), stage("quadrupoles"));
        let unit = self.unit_of(quadrupoles);
        let mut present = mapped(quadrupoles, |&h| h * (1.0 / unit));
        self.arrangement.halo.extend(&mut present);
        clock.stop(&mut self.work.seconds.exchange);
        let mut motions = self.grid.quadrupole_motions(&self.arrangement.classes, &present, &mut self.work);
        clock.restart();
        self.arrangement.collect(&mut motions);
        clock.stop(&mut self.work.seconds.exchange);
        if self.near.is_some() {
            let own = self.plan.in_units(&self.units);
            let near = self.near_quadrupoles.get_or_insert_with(|| {
                let near = match own.precision {
                    Precision::Single => near::<f32>(&own, PairFunctions::of_quadrupole),
                    Precision::Double => near::<f64>(&own, PairFunctions::of_quadrupole),
                };
                near.expect("a plan with a near field has a common Gaussian")
            });
            let loaded = self.arrangement.loaded(&present, &[]);
            near.add(&loaded, self.verlet_list.neighbours(), true, &mut motions);
            clock.stop(&mut self.work.seconds.near);
        }
        motion(&motions, Output::All, &self.units)
    }

    /// Unit of quadrupoles, with the unit of force that makes the largest about 1. Collective.
    fn unit_of(&mut self, quadrupoles: &[Vector]) -> f64 {
        let area = self.units.length * self.units.length;
        let mut largest = [greatest(quadrupoles, |h| h.abs().max_element())];
        self.partition.comm().max(&mut largest);
        self.units = self.units.with_force(largest[0] / area);
        self.units.force * area
    }
}
