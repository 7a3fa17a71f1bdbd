//! Brownian drift.

use super::{Mobility, MobilityError, ROOT, turn_motion};
use crate::brownian::{self, CHANGE, DISPLACEMENT, FiniteDifference};
use domain::{Traceless, Vector, sphere};
use fcm::{Loads, Multipoles, Stream};

/// Brownian drift and stresslets at a thermal energy of 1; each draw is a random estimate whose mean is exact.
#[derive(Debug, Clone, PartialEq)]
pub struct Drift {
    /// `div M` of the mobility from forces to velocities.
    pub velocities: Vec<Vector>,
    /// `div M` of the mobility from forces to angular velocities.
    pub angular_velocities: Vec<Vector>,
    /// Total hydrodynamic stresslets, `-div D` of the first moments `D = -S` caused by forces.
    pub stresslets: Vec<Traceless>,
}

/// Displacement of the finite difference, over the smallest radius.
const DISPLACED: f64 = 1e-3;

impl Mobility {
    /// Random estimates of the drift of rigid spheres, from draws with the same seed and numbers as in [`Self::noise`];
    /// their mean is the drift. Spheres that are not rigid have a drift only near walls.
    ///
    /// ```text
    /// [U(x + h v; v, w, e) - U(x; v, w, e)] / h
    /// ```
    ///
    /// Here `v, w, e` are random motions of the fluid with the covariance of the method's own mobility, and `U` are the
    /// motions of the spheres in that fluid. The divergence of the method's mobility vanishes except near walls, where
    /// it is added. The variance does not grow as `h` decreases.
    pub fn drift(&mut self, seed: u64, draws: std::ops::Range<u64>) -> Result<Vec<Drift>, MobilityError> {
        self.check_draws(&draws)?;
        let (cell, tolerance) = (self.parameters.cell, ROOT * self.parameters.tolerance);
        let is_rigid = self.parameters.rigid && self.parameters.multipoles == Multipoles::Dipole;
        let step = self.step();
        let mut drifts = Vec::new();
        for draw in draws {
            self.unless_interrupted()?;
            let mut particles = self.placed(&Loads::default());
            let stream = Stream::new(seed, draw);
            if is_rigid {
                let (fluid, _) = self.hydrodynamics.noise(&cell, &particles, tolerance, stream);
                let loads = self.hydrodynamics.pair_noise(&cell, &particles, None, stream);
                brownian::set_ambient(&mut particles, &fluid, 1.0);
                brownian::displace(&mut particles, step);
                brownian::solve(&mut self.hydrodynamics, &cell, &mut particles, &loads, &fluid)?;
                particles.displace_by([DISPLACEMENT], [1.0]);
                particles.wrap(&cell);
                particles.migrate(&self.partition, &cell);
                let change = FiniteDifference { over: step, energy: 1.0, tolerance: CHANGE };
                brownian::store_drift(&mut self.hydrodynamics, &cell, &mut particles, change)?;
            } else {
                brownian::store_divergence(&mut self.hydrodynamics, &cell, &mut particles, 1.0);
            }
            let (mut motion, mut stresslets) = brownian::drift(&mut particles.gathered(&self.partition));
            turn_motion(&mut motion, self.turn.inverse());
            for tensor in &mut stresslets {
                *tensor = self.turn.inverse().traceless(*tensor);
            }
            let fcm::Motion { velocities, angular_velocities, .. } = motion;
            drifts.push(Drift { velocities, angular_velocities, stresslets });
        }
        Ok(drifts)
    }

    /// Time in which random motions displace the smallest sphere by [`DISPLACED`] radii.
    fn step(&self) -> f64 {
        let smallest = self.parameters.radii.iter().copied().fold(f64::INFINITY, f64::min);
        DISPLACED * smallest * sphere::drag(self.parameters.viscosity, smallest).sqrt()
    }
}
