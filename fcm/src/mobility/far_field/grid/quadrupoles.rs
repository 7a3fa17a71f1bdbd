//! Degenerate quadrupoles on the grid and in pairs.

use super::spectral_grid::GridPart;
use super::{GridFarField, near};
use crate::pairs::table::PairFunctions;
use crate::plan::problem::Precision;
use domain::Vector;
use domain::parallel::mapped;

impl<G: GridPart + ?Sized> GridFarField<G> {
    /// Degenerate quadrupoles of all particles present, in internal units; makes their pair correction when it is first
    /// needed. Collective.
    pub(super) fn present_quadrupoles(&mut self, quadrupoles: &[Vector]) -> Vec<Vector> {
        if self.near.is_some() && self.near_quadrupoles.is_none() {
            let own = self.plan.in_units(&self.units);
            self.near_quadrupoles = match own.precision {
                Precision::Single => near::<f32>(&own, PairFunctions::of_quadrupole),
                Precision::Double => near::<f64>(&own, PairFunctions::of_quadrupole),
            };
        }
        let unit = self.units.force * self.units.length * self.units.length;
        let mut present = mapped(quadrupoles, |&h| h * (1.0 / unit));
        self.arrangement.halo.extend(&mut present);
        present
    }
}
