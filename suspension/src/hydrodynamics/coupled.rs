//! The coupled system of lubrication forces and stresslets.

use super::near_pairs::{Modes, NearPairs};
use super::particle_matrix::ParticleMatrix;
use super::scaled::Scaled;
use super::screw::{Screw, Screws};
use domain::Traceless;
use fcm::{Loads, Motion, System, Unknowns};

/// Amplitudes of the modes of the pairs that a rank keeps, `g`, and first moments of the particles that it owns,
/// `D = -S`.
#[derive(Debug, Clone)]
pub struct PairsAndMoments {
    /// `g`
    pub modes: Vec<Modes>,
    /// `D`
    pub moments: Vec<Traceless>,
}

impl Unknowns for PairsAndMoments {
    fn dot(&self, other: &Self) -> f64 {
        let (a, b) = (self.modes.as_flattened(), other.modes.as_flattened());
        a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() + self.moments.dot(&other.moments)
    }

    fn add(&mut self, factor: f64, other: &Self) {
        let (a, b) = (self.modes.as_flattened_mut(), other.modes.as_flattened());
        a.iter_mut().zip(b).for_each(|(a, b)| *a += factor * b);
        self.moments.add(factor, &other.moments);
    }
}

/// With `M` the mobility of the method, `B B^T` what near pairs resist to motions and `C` their coupling to rates of
/// strain, the forces that the method sees are `F + C E_inf + B g` with
/// `g = -B^T (U - U_inf, Omega - Omega_inf, -E_inf)`, and its first moments `D` leave no strain within the spheres.
/// With `F` for all that is known from the start,
///
/// ```text
/// [ I + B^T M_UF B   B^T M_UD ] [g]   [ -B^T M_UF F + B_E^T E_inf ]
/// [ M_EF B           M_ED     ] [D] = [ -E_inf - M_EF F           ]
/// ```
///
/// with `B` for its rows of forces and torques and `B_E` for those of first moments. It is symmetric and positive
/// definite. The preconditioner has the mobility `M_0` of single spheres in the place of `M`, and the stiff pairs'
/// columns alone of `B`: for `g` the inverse is `I - B^T (M_0^-1 + B B^T)^-1 B`, by Woodbury's identity.
pub struct Coupled<'a> {
    mobility: Scaled<'a>,
    near: &'a NearPairs,
    /// What preconditions the modes, if anything does.
    matrix: Option<ParticleMatrix<'a>>,
    /// Resistances of single spheres to motion and to strain.
    single: &'a [Screw],
    strain_resistance: &'a [f64],
    motion: Motion,
    loads: Screws,
    step: (Motion, Screws),
    correction: Screws,
}

impl<'a> Coupled<'a> {
    /// The system for particles that are in place in the mobility, with the resistances of single spheres to motion and
    /// to strain; and the motion under `loads` and the unknowns' `start`. Collective.
    pub fn new(
        mut mobility: Scaled<'a>,
        near: &'a NearPairs,
        matrix: Option<ParticleMatrix<'a>>,
        (single, strain_resistance): (&'a [Screw], &'a [f64]),
        (loads, start): (&Loads, &PairsAndMoments),
    ) -> Self {
        let lubrication = near.loads(&start.modes);
        let mut all = Screws::new(single.len(), &loads.forces, &loads.torques);
        all.add(1.0, &lubrication);
        let motion = mobility.apply(&far_loads(&all, &start.moments));
        let nothing = Screws::default();
        let step = (Motion::default(), nothing.clone());
        Self {
            mobility,
            near,
            matrix,
            single,
            strain_resistance,
            motion,
            loads: lubrication,
            step,
            correction: nothing,
        }
    }

    /// What the unknowns of the start leave over, in an ambient flow of a rate of strain.
    pub fn residual(&self, start: &PairsAndMoments, ambient: Traceless) -> PairsAndMoments {
        let mut modes = self.near.modes(&self.rigid_motion(), ambient);
        for (mode, g) in modes.as_flattened_mut().iter_mut().zip(start.modes.as_flattened()) {
            *mode = -(*mode + g);
        }
        let moments = self.motion.strain_rates.iter().map(|&e| -(e + ambient)).collect();
        PairsAndMoments { modes, moments }
    }

    /// The motions of the particles and the unknowns after a last step of the preconditioner alone, which is known
    /// already: the motions `U` then have `g = -B^T U` exactly, so that near pairs do not run into each other by the
    /// error of their forces.
    pub fn finish(
        self,
        (mut x, residual): (PairsAndMoments, &PairsAndMoments),
        ambient: Traceless,
    ) -> (Motion, PairsAndMoments) {
        let mut rigid = self.rigid_motion();
        rigid.add(1.0, &self.correction);
        x.modes = self.near.modes(&rigid, ambient);
        x.modes.as_flattened_mut().iter_mut().for_each(|g| *g = -*g);
        for ((d, &r), &resistance) in x.moments.iter_mut().zip(&residual.moments).zip(self.strain_resistance) {
            *d += r * resistance;
        }
        let strain_rates = self.motion.strain_rates;
        (Motion { velocities: rigid.linear(), angular_velocities: rigid.angular(), strain_rates }, x)
    }

    fn rigid_motion(&self) -> Screws {
        Screws::new(self.single.len(), &self.motion.velocities, &self.motion.angular_velocities)
    }
}

impl System for Coupled<'_> {
    type Unknowns = PairsAndMoments;

    fn apply(&mut self, direction: &PairsAndMoments) -> PairsAndMoments {
        let loads = self.near.loads(&direction.modes);
        let motion = self.mobility.apply(&far_loads(&loads, &direction.moments));
        let rigid = Screws::new(self.single.len(), &motion.velocities, &motion.angular_velocities);
        let mut modes = self.near.rigid_modes(&rigid, direction.modes.len());
        for (mode, g) in modes.as_flattened_mut().iter_mut().zip(direction.modes.as_flattened()) {
            *mode += g;
        }
        let moments = motion.strain_rates.clone();
        self.step = (motion, loads);
        PairsAndMoments { modes, moments }
    }

    fn stepped(&mut self, length: f64) {
        self.motion.add(length, &self.step.0);
        self.loads.add(length, &self.step.1);
    }

    fn precondition(&mut self, residual: &PairsAndMoments) -> PairsAndMoments {
        let mut modes = residual.modes.clone();
        if let Some(matrix) = &mut self.matrix {
            self.correction = matrix.relieve(&mut modes);
        }
        let moments = residual.moments.iter().zip(self.strain_resistance).map(|(&r, &d)| r * d).collect();
        PairsAndMoments { modes, moments }
    }

    fn sharpen(&mut self) -> bool {
        self.matrix.as_mut().is_some_and(ParticleMatrix::sharpen)
    }

    fn size(&self, x: &PairsAndMoments) -> f64 {
        let moved = |(load, single): (&Screw, &Screw)| -> f64 { (0..6).map(|k| load.0[k].powi(2) / single.0[k]).sum() };
        let strained = |(d, &resistance): (&Traceless, &f64)| d.contract(*d) / resistance;
        x.modes.as_flattened().iter().map(|g| g * g).sum::<f64>()
            + self.loads.0.iter().zip(self.single).map(moved).sum::<f64>()
            + x.moments.iter().zip(self.strain_resistance).map(strained).sum::<f64>()
    }
}

/// Loads on the far field: forces, torques, and stresslets `-D`.
pub fn far_loads(loads: &Screws, moments: &[Traceless]) -> Loads {
    let stresslets = moments.iter().map(|&d| -d).collect();
    Loads { forces: loads.linear(), torques: loads.angular(), stresslets }
}
