//! Random motions and loads of particles that move where the far field is evaluated.

use crate::coupled_solver::near_pairs::near_tables;
use crate::coupled_solver::{CoupledSolver, in_units};
use crate::noise::OF_PAIR;
use domain::{Particles, PeriodicBox};
use fcm::{CloseSpheres, DrawDiagnostics, HeldDraw, HeldLoads, HeldMotions, LoadDraw, Stream};

impl CoupledSolver {
    /// Random motions of the fluid, as of [`Self::noise`], times an amplitude, at particles that move where the far
    /// field is evaluated; `None` if it moves no particles.
    ///
    /// # Panics
    ///
    /// Unless these particles have moved there.
    pub fn draw_motions(&mut self, cell: &PeriodicBox, draw: &HeldDraw) -> Option<(HeldMotions, DrawDiagnostics)> {
        let mobility = self.far.mobility();
        mobility.follow(cell, draw.particles);
        Some(mobility.fluctuating()?.draw_motions(draw))
    }

    /// The loads of [`Self::hold_loads`] and random loads, as of [`Self::pair_noise`], times an amplitude, on particles
    /// that move where the far field is evaluated; `None` without loads that are held there.
    pub fn draw_loads(
        &mut self,
        cell: &PeriodicBox,
        particles: &Particles,
        stream: Stream,
        amplitude: f64,
    ) -> Option<HeldLoads> {
        let (units, mobility) = (self.units, self.far.mobility());
        mobility.follow(cell, particles);
        let plan = mobility.plan();
        let (viscosity, radii) = (plan.viscosity / units.viscosity, in_units(&plan.radii, units.length));
        let tables = || near_tables(self.near.as_ref(), viscosity, &radii);
        let draw = LoadDraw { ids: &particles.ids, seed: stream.seed_of(OF_PAIR), amplitude, units };
        Some(mobility.fluctuating()?.draw_loads(&tables, self.held_loads.as_ref()?, &draw))
    }

    /// Pairs of these particles that overlap, or have a gap below a minimum, over the mean radius, if there is one;
    /// `None` if the back end of the far field does not count them.
    pub fn close_spheres(
        &mut self,
        cell: &PeriodicBox,
        particles: &Particles,
        minimum_gap: Option<f64>,
    ) -> Option<CloseSpheres> {
        let mobility = self.far.mobility();
        mobility.follow(cell, particles);
        Some(mobility.fluctuating()?.close_spheres(minimum_gap))
    }
}
