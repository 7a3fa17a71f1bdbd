//! The mean motion that heat causes.

use super::{Mobility, MobilityError, ROOT, turn_motion};
use crate::brownian::{self, CHANGE, Change, DISPLACEMENT};
use domain::{Traceless, Vector};
use fcm::{Loads, Multipoles, Stream};
use std::f64::consts::PI;

/// Mean motions and stresslets by heat at a thermal energy of 1, of which one draw is a random part.
#[derive(Debug, Clone, PartialEq)]
pub struct Drift {
    /// `div M` of the mobility from forces to velocities.
    pub velocities: Vec<Vector>,
    /// The same of the mobility from forces to angular velocities.
    pub angular_velocities: Vec<Vector>,
    /// Whole hydrodynamic stresslets, `-div D` of the first moments `D = -S` that forces cause.
    pub stresslets: Vec<Traceless>,
}

/// Displacements after which motions are looked at once more, over the smallest radius.
const DISPLACED: f64 = 1e-3;

impl Mobility {
    /// Random parts of the drift of rigid spheres, by draws of the same seed and numbers as [`Self::noise`]: the mean over many is
    /// the drift. Spheres that are not rigid have none but near walls.
    ///
    /// ```text
    /// [U(x + h v; v, w, e) - U(x; v, w, e)] / h
    /// ```
    ///
    /// with `v, w, e` random motions of the fluid of the covariance of the method's own mobility, whose divergence vanishes but near
    /// walls, where it is added, and `U` those of the spheres in that fluid: its scatter does not grow as `h` falls.
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
                let (fluid, _) = self.hydrodynamics.noise(&cell, &particles, (tolerance, stream));
                let loads = self.hydrodynamics.pair_noise(&cell, &particles, stream);
                brownian::set_ambient(&mut particles, &fluid, 1.0);
                brownian::displace(&mut particles, step);
                brownian::solve(&mut self.hydrodynamics, (&cell, &mut particles), (&loads, &fluid))?;
                particles.displace_by([DISPLACEMENT], [1.0]);
                particles.wrap(&cell);
                particles.migrate(&self.partition, &cell);
                let change = Change { over: step, energy: 1.0, tolerance: CHANGE };
                brownian::note_drift(&mut self.hydrodynamics, (&cell, &mut particles), change)?;
            } else {
                brownian::note_divergence(&mut self.hydrodynamics, (&cell, &mut particles), 1.0);
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

    /// The time in which random motions displace the smallest sphere as far as they are to.
    fn step(&self) -> f64 {
        let smallest = self.parameters.radii.iter().copied().fold(f64::INFINITY, f64::min);
        DISPLACED * smallest * (6.0 * PI * self.parameters.viscosity * smallest).sqrt()
    }
}
