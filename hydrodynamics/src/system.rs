//! Coupled linear system of lubrication forces and stresslets.

use crate::pairs::search::{NearPairs, Pairs};
use crate::preconditioner::Preconditioner;
use crate::six_vector::{SixVector, SixVectors};
use crate::units::Scaled;
use domain::parallel::{MeasuredLoop, copied, mapped, of_rows};
use domain::{Comm, Traceless, Vector, sphere};
use fcm::{Linear, Loads, Motion, System};
use rayon::prelude::*;

/// Motions of a rank's particles, and the loads of a set of near pairs in these motions.
#[derive(Debug, Clone, Default)]
pub struct MotionsWithLoads {
    /// `y`
    pub motions: SixVectors,
    /// `R y`
    pub loads: SixVectors,
}

/// Unknowns of the system: minus the motions in the loads of stiff pairs and of soft pairs, and the first moments
/// `D = -S`. Only the sum of the pair loads of the solution and of its start matters; it may be kept in either.
#[derive(Debug, Default)]
pub struct Unknowns {
    /// `y_s`
    pub stiff: MotionsWithLoads,
    /// `y_f`
    pub soft: MotionsWithLoads,
    /// `D`
    pub moments: Vec<Traceless>,
}

/// Residual: mismatch between the motions of the particles and of the fluid, and strain rates within the particles.
#[derive(Debug, Clone)]
pub struct Residual {
    pub stiff: SixVectors,
    pub soft: SixVectors,
    pub strain_rates: Vec<Traceless>,
}

impl Clone for Unknowns {
    fn clone(&self) -> Self {
        Self { stiff: self.stiff.clone(), soft: self.soft.clone(), moments: copied(&self.moments) }
    }
}

impl Linear for MotionsWithLoads {
    fn add(&mut self, factor: f64, other: &Self) {
        self.motions.add(factor, &other.motions);
        self.loads.add(factor, &other.loads);
    }

    fn scale_add(&mut self, factor: f64, other: &Self) {
        self.motions.scale_add(factor, &other.motions);
        self.loads.scale_add(factor, &other.loads);
    }
}

impl Linear for Unknowns {
    fn add(&mut self, factor: f64, other: &Self) {
        self.stiff.add(factor, &other.stiff);
        self.soft.add(factor, &other.soft);
        self.moments.add(factor, &other.moments);
    }

    fn scale_add(&mut self, factor: f64, other: &Self) {
        self.stiff.scale_add(factor, &other.stiff);
        self.soft.scale_add(factor, &other.soft);
        self.moments.scale_add(factor, &other.moments);
    }
}

impl Linear for Residual {
    fn add(&mut self, factor: f64, other: &Self) {
        self.stiff.add(factor, &other.stiff);
        self.soft.add(factor, &other.soft);
        self.strain_rates.add(factor, &other.strain_rates);
    }

    fn scale_add(&mut self, factor: f64, other: &Self) {
        self.stiff.scale_add(factor, &other.stiff);
        self.soft.scale_add(factor, &other.soft);
        self.strain_rates.scale_add(factor, &other.strain_rates);
    }
}

impl Unknowns {
    /// The unknowns for motions and the loads of all near pairs in these motions.
    pub fn of(motions: &SixVectors, resisted: &SixVectors, moments: Vec<Traceless>) -> Self {
        let (against, loads) = (motions.negative(), SixVectors::zero(motions.0.len()));
        let soft = MotionsWithLoads { motions: against.clone(), loads };
        Self { stiff: MotionsWithLoads { motions: against, loads: resisted.negative() }, soft, moments }
    }

    /// Lubrication loads on the far field.
    pub fn loads(&self) -> SixVectors {
        let mut loads = self.stiff.loads.clone();
        loads.add(1.0, &self.soft.loads);
        loads
    }
}

/// The coupled system. With `M` the mobility of the method, `R = B B^T` the resistance of near pairs to motions `U`
/// relative to the ambient flow, and `F` the known loads, the far field is that of the forces `F - R U` and of the
/// first moments `D` that cancel the strain rate within the spheres. The amplitudes of the pairs' modes, `g = -B^T U`,
/// solve
///
/// ```text
/// [ I + B^T M_UF B   B^T M_UD ] [g]   [ -B^T M_UF F    ]
/// [ M_EF B           M_ED     ] [D] = [ -E_inf - M_EF F ]
/// ```
///
/// which is symmetric and positive definite. The preconditioner replaces `M` by the mobility `M_0` of single spheres
/// and `B` by its columns `B_s` of the stiff pairs: for `g` its inverse is `I - B_s^T (M_0^-1 + R_s)^-1 B_s`, by
/// Woodbury's identity.
///
/// There are more modes than motions, and every vector of the iteration is `B^T` times some motions. So the motions are
/// stored: `g_s = B_s^T y_s` of the stiff pairs and `g_f = B_f^T y_f` of the soft pairs, and residuals likewise. Then
///
/// ```text
/// B g = R_s y_s + R_f y_f
/// A (y_s, y_f, D) = (y_s + V, y_f + V, E)         with V, E the method's motions under B g and D
/// P^-1 (r_s, r_f, e) = ((M_0^-1 + R_s)^-1 M_0^-1 r_s, r_f, d e)
/// r . y = r_s . R_s y_s + r_f . R_f y_f + e : D
/// ```
///
/// with `d` the resistance of single spheres to strain. No small difference of large numbers is taken, however small
/// the gaps.
///
/// Spheres of rigid bodies move as `K Q`, with six numbers `Q` a body, and loads `lambda` without total force and
/// torque on a body, `K^T lambda = 0`, keep them so. Then `-y_s` is in the range of `K`, and the loads stored with it
/// are `R_s y_s + lambda`. The product `r_s . (R_s y_s + lambda)` with the image of other such unknowns stays
/// symmetric and positive definite, since `lambda . K Q = 0`, and the preconditioner is projected:
///
/// ```text
/// K^T (M_0^-1 + R_s) K Q = K^T M_0^-1 r_s,        y_s = K Q,        R_s y_s + lambda = M_0^-1 (r_s - y_s)
/// ```
///
/// In an ambient flow that strains, rigid motions are `K Q` plus known differences from that flow, which are in the
/// start of the iteration.
pub struct CoupledSystem<'a> {
    mobility: Scaled<'a>,
    near: &'a NearPairs,
    /// Preconditioner of the stiff pairs, if there is one.
    pub(super) matrix: Option<Preconditioner<'a>>,
    /// Resistances of single spheres to motion and to strain.
    single: &'a [SixVector],
    strain_resistance: &'a [f64],
    motion: Motion,
    step: Motion,
}

/// Resistances of single spheres.
pub struct SingleSpheres {
    /// To motion.
    pub motion: Vec<SixVector>,
    /// To strain.
    pub strain: Vec<f64>,
}

impl SingleSpheres {
    /// For spheres of these radii.
    pub fn new(viscosity: f64, radii: &[f64]) -> Self {
        let strain = |&radius: &f64| sphere::strain_resistance(viscosity, radius);
        Self { motion: mapped(radii, |&radius| single(viscosity, radius)), strain: mapped(radii, strain) }
    }
}

/// Known loads and ambient motions of a system, and the unknowns from which the iteration starts.
#[derive(Clone, Copy)]
pub struct SystemStart<'a> {
    pub loads: &'a SixVectors,
    pub ambient: &'a Motion,
    /// Degenerate quadrupoles of squirmers, in the units of the mobility.
    pub quadrupoles: Option<&'a [Vector]>,
    pub unknowns: &'a Unknowns,
}

/// Unknowns and residual at the end of the iteration.
pub struct FinalIterate<'a> {
    pub x: Unknowns,
    pub residual: &'a Residual,
    /// The preconditioned residual.
    pub correction: Unknowns,
}

impl<'a> CoupledSystem<'a> {
    /// The system for particles that are arranged in the mobility, with the resistances of single spheres to motion and
    /// to strain. Computes the motion at the start. Collective.
    pub fn new(
        mut mobility: Scaled<'a>,
        near: &'a NearPairs,
        matrix: Option<Preconditioner<'a>>,
        spheres: &'a SingleSpheres,
        start: SystemStart,
    ) -> Self {
        let SystemStart { loads, ambient, quadrupoles, unknowns } = start;
        let mut all = unknowns.loads();
        all.add(1.0, loads);
        let all = far_loads(&all, &unknowns.moments);
        let mut motion = match quadrupoles {
            Some(quadrupoles) => mobility.apply_with_quadrupoles(&all, quadrupoles),
            None => mobility.apply(&all),
        };
        motion.add(1.0, ambient);
        let (single, strain_resistance) = (&spheres.motion[..], &spheres.strain[..]);
        Self { mobility, near, matrix, single, strain_resistance, motion, step: Motion::default() }
    }

    /// Residual of the start, in a background flow with the strain rate `ambient`.
    pub fn residual(&self, start: &Unknowns, ambient: Traceless) -> Residual {
        let sums = image(&start.stiff.motions, &start.soft.motions, &self.motion);
        let strain_rates = mapped(&sums.strain_rates, |&e| (e + ambient) * -1.0);
        Residual { stiff: sums.stiff.negative(), soft: sums.soft.negative(), strain_rates }
    }

    /// Motions of the particles and the final unknowns, after a last correction, the preconditioned residual, without
    /// another far-field evaluation. The correction is refined to an error of `tolerance` in the near field.
    /// Lubrication is exactly that of the returned motions, so that errors of the forces do not make near pairs
    /// collide. Collective.
    pub fn finish(mut self, last: FinalIterate, tolerance: f64, comm: &Comm) -> (Motion, Unknowns) {
        let FinalIterate { mut x, residual, mut correction } = last;
        let mut sizes = [self.size(&x), self.size(&correction)];
        comm.sum(&mut sizes);
        let needed = tolerance * (sizes[0] / sizes[1]).sqrt();
        if let Some(matrix) = &mut self.matrix
            && matrix.tighten_to(needed)
        {
            let MotionsWithLoads { motions, loads } = correction.stiff;
            let [motions, loads] = matrix.continue_solve([motions, loads], &residual.stiff.resisted(self.single));
            correction.stiff = MotionsWithLoads { motions, loads };
        }
        x.add(1.0, &correction);
        let mut rigid = x.stiff.motions.negative();
        if let Some(matrix) = &self.matrix {
            matrix.make_rigid(&mut rigid);
        }
        let (velocities, angular_velocities) = (rigid.linear(), rigid.angular());
        (Motion { velocities, angular_velocities, strain_rates: self.motion.strain_rates }, x)
    }
}

/// Resistance of a single sphere to translation and rotation.
pub fn single(viscosity: f64, radius: f64) -> SixVector {
    let (force, torque) = (sphere::drag(viscosity, radius), sphere::rotational_drag(viscosity, radius));
    SixVector::new(Vector::splat(force), Vector::splat(torque))
}

/// Left-hand side of the system, from the unknown motions and the far-field motion that the unknown loads cause.
fn image(stiff: &SixVectors, soft: &SixVectors, motion: &Motion) -> Residual {
    let plus = |motions: &SixVectors| {
        let mut sum = SixVectors::new(motions.0.len(), &motion.velocities, &motion.angular_velocities);
        sum.add(1.0, motions);
        sum
    };
    Residual { stiff: plus(stiff), soft: plus(soft), strain_rates: copied(&motion.strain_rates) }
}

impl System for CoupledSystem<'_> {
    type Unknowns = Unknowns;
    type Residual = Residual;

    fn product(&self, residual: &Residual, x: &Unknowns) -> f64 {
        let strained = sum(x.moments.len(), |k| residual.strain_rates[k].contract(x.moments[k]));
        residual.stiff.dot(&x.stiff.loads) + residual.soft.dot(&x.soft.loads) + strained
    }

    fn apply(&mut self, direction: &Unknowns) -> Residual {
        self.step = self.mobility.apply(&far_loads(&direction.loads(), &direction.moments));
        image(&direction.stiff.motions, &direction.soft.motions, &self.step)
    }

    fn on_step(&mut self, length: f64) {
        self.motion.add(length, &self.step);
    }

    fn precondition(&mut self, residual: &Residual) -> Unknowns {
        let stiff = self.of_stiff(&residual.stiff);
        let soft = resisted(self.near, Pairs::Soft, &residual.soft);
        let rates = &residual.strain_rates;
        let moments = of_rows(rates.len(), |row| rates[row] * self.strain_resistance[row]);
        Unknowns { stiff, soft, moments }
    }

    fn refine_preconditioner(&mut self) -> bool {
        self.matrix.as_mut().is_some_and(Preconditioner::refine_preconditioner)
    }

    /// Squared norm of the error estimate: the motions of single spheres under the loads of a preconditioned residual,
    /// and its moments. Motions without resistance follow from the others in [`CoupledSystem::finish`], and the energy
    /// norm would overweight stiff pairs, whose large resistance hardly moves them. Loads of stiff and of soft pairs
    /// count separately: their sum may vanish in some directions of a symmetric arrangement, since each step leaves a
    /// residual orthogonal to the last direction. Separately they vanish only at the solution.
    fn error(&self, _: &Residual, z: &Unknowns) -> f64 {
        let (stiff, soft) = (&z.stiff.loads.0, &z.soft.loads.0);
        let squared = |i: usize, k: usize| (stiff[i].0[k].powi(2) + soft[i].0[k].powi(2)) / self.single[i].0[k];
        sum(stiff.len(), |i| (0..6).map(|k| squared(i, k)).sum()) + self.strained(z)
    }

    /// Squared norm of motions and moments, weighted by the resistances of single spheres.
    fn size(&self, x: &Unknowns) -> f64 {
        let squared = |i: usize, k: usize| self.single[i].0[k] * x.stiff.motions.0[i].0[k].powi(2);
        sum(x.stiff.motions.0.len(), |i| (0..6).map(|k| squared(i, k)).sum()) + self.strained(x)
    }
}

impl CoupledSystem<'_> {
    /// Preconditioned residual of the stiff pairs.
    fn of_stiff(&mut self, residual: &SixVectors) -> MotionsWithLoads {
        let Some(matrix) = &mut self.matrix else { return resisted(self.near, Pairs::Stiff, residual) };
        let [motions, loads] = matrix.solve(&residual.resisted(self.single));
        MotionsWithLoads { motions, loads }
    }

    /// Strain rate of single spheres under moments, contracted with the moments.
    fn strained(&self, x: &Unknowns) -> f64 {
        sum(x.moments.len(), |i| x.moments[i].contract(x.moments[i]) / self.strain_resistance[i])
    }
}

/// Number of particles whose terms one thread sums.
const BATCH: usize = 1024;

/// Sum of `count` terms, the same on any number of threads.
fn sum(count: usize, term: impl Fn(usize) -> f64 + Sync) -> f64 {
    let of_batch = |batch: usize| (batch * BATCH..count.min((batch + 1) * BATCH)).map(&term).sum();
    let sums: Vec<f64> = (0..count.div_ceil(BATCH)).into_par_iter().map(of_batch).measured().collect();
    sums.iter().sum()
}

/// Motions with the loads of a set of near pairs. Collective.
pub fn resisted(near: &NearPairs, pairs: Pairs, motions: &SixVectors) -> MotionsWithLoads {
    MotionsWithLoads { loads: near.times(&[pairs], motions), motions: motions.clone() }
}

/// Loads on the far field: forces, torques, and stresslets `-D`.
pub fn far_loads(loads: &SixVectors, moments: &[Traceless]) -> Loads {
    let stresslets = mapped(moments, |&d| -d);
    Loads { forces: loads.linear(), torques: loads.angular(), stresslets }
}
