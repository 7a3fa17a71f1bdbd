//! Coupled linear system of lubrication forces and stresslets.

use crate::pairs::matrix::sparse::Padded;
use crate::pairs::search::{NearPairs, Pairs};
use crate::preconditioner::Preconditioner;
use crate::six_vector::{SixVector, SixVectors};
use crate::units::Scaled;
use crate::unknowns::{MotionsWithLoads, Residual, Unknowns, add_and_dot, resisted};
use domain::parallel::FusedLoops;
use domain::{Comm, Traceless, Vector, sphere};
use fcm::{InnerProducts, Iterate, Motion, Step, System};

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
    spheres: &'a SingleSpheres,
    /// Strain rates of the particles in the flow of the present unknowns.
    strain_rates: Vec<Traceless>,
}

/// Resistances of single spheres.
#[derive(Default)]
pub struct SingleSpheres {
    /// To motion.
    pub motion: Vec<SixVector>,
    /// To strain.
    pub strain: Vec<f64>,
}

impl SingleSpheres {
    /// For spheres of these radii.
    pub fn new(viscosity: f64, radii: &[f64]) -> Self {
        let (mut spheres, mut loops) = (Self::default(), FusedLoops::default());
        spheres.make_in(&mut loops, viscosity, radii);
        loops.run();
        spheres
    }

    /// Makes them for spheres of these radii, as two of several loops.
    pub fn make_in<'a>(&'a mut self, loops: &mut FusedLoops<'a>, viscosity: f64, radii: &'a [f64]) {
        loops.mapped(&mut self.motion, radii, move |&radius| single(viscosity, radius));
        loops.mapped(&mut self.strain, radii, move |&radius| sphere::strain_resistance(viscosity, radius));
    }

    /// [`CoupledSystem::error`] as two of several loops, whose sum it is.
    fn error_in<'a>(&'a self, loops: &mut FusedLoops<'a>, z: &'a Unknowns, [load, strain]: [&'a mut f64; 2]) {
        let (stiff, soft) = (&z.stiff.loads.0, &z.soft.loads.0);
        let squared = move |i: usize, k: usize| (stiff[i].0[k].powi(2) + soft[i].0[k].powi(2)) / self.motion[i].0[k];
        let of_sphere = move |i: usize| (0..6).map(|k| squared(i, k)).sum::<f64>();
        loops.sum(load, stiff.len(), move |rows| rows.map(of_sphere).sum());
        self.strained_in(loops, z, strain);
    }

    /// [`CoupledSystem::size`] as two of several loops, whose sum it is.
    fn size_in<'a>(&'a self, loops: &mut FusedLoops<'a>, x: &'a Unknowns, [motion, strain]: [&'a mut f64; 2]) {
        let motions = &x.stiff.motions.0;
        let squared = move |i: usize, k: usize| self.motion[i].0[k] * motions[i].0[k].powi(2);
        let of_sphere = move |i: usize| (0..6).map(|k| squared(i, k)).sum::<f64>();
        loops.sum(motion, motions.len(), move |rows| rows.map(of_sphere).sum());
        self.strained_in(loops, x, strain);
    }

    /// Strain rates under moments, contracted with the moments, as one of several loops.
    fn strained_in<'a>(&'a self, loops: &mut FusedLoops<'a>, x: &'a Unknowns, sum: &'a mut f64) {
        let of_sphere = move |i: usize| x.moments[i].contract(x.moments[i]) / self.strain[i];
        loops.sum(sum, x.moments.len(), move |rows| rows.map(of_sphere).sum());
    }
}

/// Known loads and motions of a system, and the unknowns from which the iteration starts.
#[derive(Clone, Copy)]
pub struct SystemStart<'a> {
    pub loads: &'a SixVectors,
    /// Ambient motions.
    pub ambient: &'a Motion,
    /// Degenerate quadrupoles of squirmers, in the units of the mobility.
    pub quadrupoles: Option<&'a [Vector]>,
    /// Strain rate of the background flow.
    pub strain_rate: Traceless,
    pub unknowns: &'a Unknowns,
}

/// Unknowns and residual at the end of the iteration.
pub struct FinalIterate {
    pub x: Unknowns,
    pub residual: Residual,
    /// The preconditioned residual.
    pub correction: Unknowns,
}

/// Result of a system: motions of the particles with the lubrication loads on the far field, first moments, and strain
/// rates in the far field.
pub struct SystemSolution {
    pub motions: SixVectors,
    pub loads: SixVectors,
    pub moments: Vec<Traceless>,
    pub strain_rates: Vec<Traceless>,
}

impl<'a> CoupledSystem<'a> {
    /// The system for particles that are arranged in the mobility, with the resistances of single spheres to motion and
    /// to strain, and its residual at the start. Collective.
    pub fn new(
        mut mobility: Scaled<'a>,
        near: &'a NearPairs,
        matrix: Option<Preconditioner<'a>>,
        spheres: &'a SingleSpheres,
        start: SystemStart,
    ) -> (Self, Residual) {
        let SystemStart { loads, ambient, quadrupoles, strain_rate, unknowns } = start;
        let load = |row: usize| unknowns.load(row) + loads.0[row];
        let motion = mobility.apply(loads.0.len(), load, &unknowns.moments, quadrupoles);
        let motion = mobility.far_motion(&motion).with(ambient);
        let (mut residual, mut strain_rates) = (Residual::default(), Vec::new());
        let (stiff, soft) = (&unknowns.stiff.motions.0, &unknowns.soft.motions.0);
        let mut loops = FusedLoops::default();
        loops.of_rows(&mut residual.stiff.0, stiff.len(), |row| -(motion.rigid(row) + stiff[row]));
        loops.of_rows(&mut residual.soft.0, soft.len(), |row| -(motion.rigid(row) + soft[row]));
        let strain = |row: usize| (motion.strain_rate(row) + strain_rate) * -1.0;
        loops.of_rows(&mut residual.strain_rates, motion.strained(), strain);
        loops.of_rows(&mut strain_rates, motion.strained(), |row| motion.strain_rate(row));
        loops.run();
        (Self { mobility, near, matrix, spheres, strain_rates }, residual)
    }

    /// Motions of the particles and the loads on the far field, after a last correction, the preconditioned residual,
    /// without another far-field evaluation. The correction is refined to an error of `tolerance` in the near field.
    /// Lubrication is exactly that of the returned motions, so that errors of the forces do not make near pairs
    /// collide. Collective.
    pub fn finish(mut self, last: FinalIterate, tolerance: f64, comm: &Comm) -> SystemSolution {
        let FinalIterate { mut x, residual, mut correction } = last;
        let mut sizes = self.sizes([&x, &correction]);
        comm.sum(&mut sizes);
        let needed = tolerance * (sizes[0] / sizes[1]).sqrt();
        if let Some(matrix) = &mut self.matrix
            && matrix.tighten_to(needed)
        {
            let (single, residual) = (&self.spheres.motion, &residual.stiff.0);
            correction.stiff = matrix.continue_solve(correction.stiff, |row| single[row] * residual[row]);
        }
        drop(residual);
        let (z, soft) = (&correction, [&x.soft.loads.0[..], &correction.soft.loads.0]);
        let MotionsWithLoads { motions, loads } = &mut x.stiff;
        let mut loops = FusedLoops::default();
        loops.change(&mut motions.0, &z.stiff.motions.0, |motion, &by| *motion = -(*motion + by));
        loops.change_rows(&mut loads.0, |row, load| {
            *load = (*load + z.stiff.loads.0[row]) + (soft[0][row] + soft[1][row]);
        });
        loops.change(&mut x.moments, &z.moments, |moment, &by| *moment += by);
        loops.run();
        let Unknowns { stiff: MotionsWithLoads { mut motions, loads }, moments, .. } = x;
        if let Some(matrix) = &self.matrix {
            matrix.make_rigid(&mut motions);
        }
        SystemSolution { motions, loads, moments, strain_rates: self.strain_rates }
    }

    /// This rank's parts of the squares of the sizes of unknowns.
    fn sizes(&self, unknowns: [&Unknowns; 2]) -> [f64; 2] {
        let mut sums = [[0.0; 2]; 2];
        let mut loops = FusedLoops::default();
        for (x, sums) in unknowns.into_iter().zip(&mut sums) {
            self.spheres.size_in(&mut loops, x, sums.each_mut());
        }
        loops.run();
        sums.map(|[motion, strain]| motion + strain)
    }
}

/// Resistance of a single sphere to translation and rotation.
pub fn single(viscosity: f64, radius: f64) -> SixVector {
    let (force, torque) = (sphere::drag(viscosity, radius), sphere::rotational_drag(viscosity, radius));
    SixVector::new(Vector::splat(force), Vector::splat(torque))
}

impl System for CoupledSystem<'_> {
    type Unknowns = Unknowns;
    type Residual = Residual;

    fn product(&self, residual: &Residual, x: &Unknowns) -> f64 {
        let mut sums = [0.0; 3];
        let mut loops = FusedLoops::default();
        residual.product_in(&mut loops, x, sums.each_mut());
        loops.run();
        sums.iter().sum()
    }

    fn apply(&mut self, direction: &Unknowns) -> Residual {
        let (stiff, soft) = (&direction.stiff.motions.0, &direction.soft.motions.0);
        let motion = self.mobility.apply(stiff.len(), |row| direction.load(row), &direction.moments, None);
        let (motion, mut image) = (self.mobility.far_motion(&motion), Residual::default());
        let mut loops = FusedLoops::default();
        loops.of_rows(&mut image.stiff.0, stiff.len(), |row| motion.rigid(row) + stiff[row]);
        loops.of_rows(&mut image.soft.0, soft.len(), |row| motion.rigid(row) + soft[row]);
        loops.of_rows(&mut image.strain_rates, motion.strained(), |row| motion.strain_rate(row));
        loops.run();
        image
    }

    fn on_step(&mut self, _: f64) {}

    fn precondition(&mut self, residual: &Residual) -> Unknowns {
        let stiff = self.precondition_stiff(residual);
        let (rates, strain) = (&residual.strain_rates, &self.spheres.strain);
        let (mut soft, mut moments, mut present) = (SixVectors::default(), Vec::new(), Vec::new());
        let mut loops = FusedLoops::default();
        loops.of_rows(&mut moments, rates.len(), |row| rates[row] * strain[row]);
        loops.copied(&mut soft.0, &residual.soft.0);
        loops.mapped(&mut present, &residual.soft.0, Padded::of);
        loops.run();
        let (loads, _) = self.near.times_present(&[Pairs::Soft], present, |_, _| 0.0);
        Unknowns { stiff, soft: MotionsWithLoads { motions: soft, loads }, moments }
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
        let mut sums = [0.0; 2];
        let mut loops = FusedLoops::default();
        self.spheres.error_in(&mut loops, z, sums.each_mut());
        loops.run();
        sums.iter().sum()
    }

    /// Squared norm of motions and moments, weighted by the resistances of single spheres.
    fn size(&self, x: &Unknowns) -> f64 {
        let [size, _] = self.sizes([x, &Unknowns::default()]);
        size
    }

    fn step_and_measure(
        &mut self,
        at: Iterate<Unknowns, Residual>,
        step: Option<Step<Unknowns, Residual>>,
    ) -> InnerProducts {
        let Iterate { x, residual, z } = at;
        let former = step.map_or(0.0, |step| self.take_step(Iterate { x, residual, z }, &step));
        // Released before the next one is computed.
        *z = Unknowns::default();
        *z = self.precondition(residual);
        let (mut product, mut error, mut size) = ([0.0; 3], [0.0; 2], [0.0; 2]);
        let mut loops = FusedLoops::default();
        residual.product_in(&mut loops, z, product.each_mut());
        self.spheres.error_in(&mut loops, z, error.each_mut());
        self.spheres.size_in(&mut loops, x, size.each_mut());
        loops.run();
        InnerProducts { product: product.iter().sum(), former, error: error.iter().sum(), size: size.iter().sum() }
    }
}

impl CoupledSystem<'_> {
    /// The part of stiff pairs of a preconditioned residual. Collective.
    fn precondition_stiff(&mut self, residual: &Residual) -> MotionsWithLoads {
        let Some(matrix) = &mut self.matrix else { return resisted(self.near, Pairs::Stiff, &residual.stiff) };
        let (single, residual) = (&self.spheres.motion, &residual.stiff.0);
        matrix.solve(|row| single[row] * residual[row])
    }

    /// Takes a step. Returns this rank's part of the product of the new residual and the former preconditioned one.
    fn take_step(&mut self, at: Iterate<Unknowns, Residual>, step: &Step<Unknowns, Residual>) -> f64 {
        let Iterate { x, residual, z } = at;
        let (&Step { length, direction, ref image }, mut sums) = (step, [0.0; 3]);
        let ([of_stiff, of_soft, of_strain], z) = (sums.each_mut(), &*z);
        let Residual { stiff, soft, strain_rates } = residual;
        let mut loops = FusedLoops::default();
        x.change_in(&mut loops, direction, move |a, b| *a += length * b);
        loops.change_and_sum(&mut stiff.0, of_stiff, move |first, rows| {
            add_and_dot(rows, -length, &image.stiff.0[first..], &z.stiff.loads.0[first..])
        });
        loops.change_and_sum(&mut soft.0, of_soft, move |first, rows| {
            add_and_dot(rows, -length, &image.soft.0[first..], &z.soft.loads.0[first..])
        });
        loops.change_and_sum(strain_rates, of_strain, move |first, rows| {
            rows.iter_mut().zip(&image.strain_rates[first..]).for_each(|(rate, &by)| *rate += by * -length);
            rows.iter().zip(&z.moments[first..]).map(|(rate, &moment)| rate.contract(moment)).sum()
        });
        loops.change(&mut self.strain_rates, &image.strain_rates, move |rate, &by| *rate += by * length);
        loops.run();
        sums.iter().sum()
    }
}
