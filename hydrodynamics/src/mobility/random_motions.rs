//! Random motions.

use super::columns::{moved, record_motion};
use super::{Mobility, MobilityError, NUMBERS, ROOT, turn_motion};
use crate::ambient::StrainRate;
use crate::mobility::memory::SingleEvaluation;
use crate::solution::{Guess, SolveInput};
use domain::Bytes;
use fcm::{DrawDiagnostics, Loads, Motion, Multipoles, Stream};

/// Advice for draws that need too much memory.
const FEWER_DRAWS: &str = "fewer draws at a time, fewer positions";

/// Numbers per particle and draw.
const DRAWN_NUMBERS: f64 = 11.0;

impl Mobility {
    /// Random motions of the spheres whose covariance is their mobility, one for each of `draws`: Brownian motion over
    /// a time `dt` at a thermal energy `kT = dt / 2`. The same seed and draw give the same motion, on any number of
    /// ranks. Strain rates are those of the fluctuating fluid for spheres that are not rigid, else absent.
    pub fn noise(
        &mut self,
        seed: u64,
        draws: std::ops::Range<u64>,
    ) -> Result<(Vec<Motion>, DrawDiagnostics), MobilityError> {
        self.check_draws(&draws)?;
        let (cell, mut worst) = (self.parameters.cell, DrawDiagnostics::default());
        let mut motions = Vec::new();
        let is_rigid = self.parameters.rigid && self.parameters.multipoles == Multipoles::Dipole;
        let tolerance = ROOT * self.parameters.tolerance;
        for draw in draws {
            self.unless_interrupted()?;
            let mut particles = self.placed(&Loads::default());
            let stream = Stream::new(seed, draw);
            let (ambient, drawn) = self.hydrodynamics.noise(&cell, &particles, tolerance, stream);
            worst.iterations = worst.iterations.max(drawn.iterations);
            worst.clipped = worst.clipped.max(drawn.clipped);
            let mut motion = ambient.clone();
            if is_rigid {
                let bodies = self.bodies.load(&mut particles, self.partition.comm());
                let loads = self.hydrodynamics.pair_noise(&cell, &particles, bodies.as_ref(), stream);
                let guess = Guess::induced_by(&ambient);
                let still = SolveInput::new(&loads, StrainRate::default());
                let acting = SolveInput { bodies: bodies.as_ref(), ambient: &ambient, ..still };
                motion = self.hydrodynamics.solve(&cell, &particles, &acting, guess)?.motion;
                motion.strain_rates.clear();
            }
            record_motion(&mut particles, &motion);
            let mut motion = moved(&mut particles.gathered(&self.partition));
            turn_motion(&mut motion, self.turn.inverse());
            motions.push(motion);
        }
        Ok((motions, worst))
    }

    /// Refuses draws whose motions, with the caller's copy, exceed the memory. Collective.
    pub(super) fn check_draws(&self, draws: &std::ops::Range<u64>) -> Result<(), MobilityError> {
        self.parameters.check_noise()?;
        let numbers = DRAWN_NUMBERS * draws.end.saturating_sub(draws.start) as f64 * self.parameters.radii.len() as f64;
        let (plan, radii, lubrication) = (&self.plan, self.problem.radii.clone(), self.parameters.lubrication);
        let (numbers, besides) = (NUMBERS, Bytes::keep(2.0 * 8.0 * numbers));
        let evaluation = SingleEvaluation { plan, radii, lubrication, numbers, besides, remedy: FEWER_DRAWS };
        Ok(evaluation.check_memory(self.partition.comm())?)
    }
}
