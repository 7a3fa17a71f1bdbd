//! Mobility: the linear map from loads to motions.

pub(crate) mod contacts;
pub(crate) mod coupled;
mod far_field;
pub(crate) mod fluctuating;
pub(crate) mod loads;
pub(crate) mod memory;
pub(crate) mod noise;
mod noise_root;
pub(crate) mod past_solutions;
pub(crate) mod rank_one;
pub(crate) mod stepping;
pub(crate) mod work;

use crate::lanczos::DrawDiagnostics;
use crate::mobility::contacts::ContactFarField;
use crate::mobility::coupled::CoupledFarField;
use crate::mobility::fluctuating::FluctuatingFarField;
use crate::plan::Plan;
use crate::plan::problem::Multipoles;
use crate::plan::sample_points::SamplePoints;
use crate::walls::wall_drift::WallDrift;
use domain::parallel::change;
use domain::{Particles, Partition, PeriodicBox, Vector};
pub use far_field::SurfaceFarField;
pub(crate) use far_field::{FarField, MomentFarField, RigidFarField, RigidProblem, RigidSolution};
use far_field::{FlowAtPoints, of_plan};
use loads::{Loads, Motion, Output};
use noise::{NoiseRequest, Stream};
use rank_one::Constraint;
use work::Work;

/// Grand mobility of the force-coupling method, `(F, T, S) -> (V, Omega, E)`, in a periodic box with no mean flow. As
/// a map from `(F, T, -S)` it is symmetric and positive definite.
///
/// An evaluation is collective. Particles are those that the rank owns; their positions are set by
/// [`Mobility::arrange`] and hold for any number of evaluations.
///
/// All arguments and results are in the units of the plan. Results have the same digits in any units, and the same
/// bits if the units differ by powers of two.
pub struct Mobility {
    plan: Plan,
    partition: Partition,
    far: Box<dyn FarField>,
    /// Made when first needed.
    wall_drift: Option<WallDrift>,
    constraint: Option<Constraint>,
}

/// Flow of given loads, at points of a box.
pub struct Flow<'a>(Box<dyn FlowAtPoints + 'a>);

impl Flow<'_> {
    /// Velocities relative to the background flow at the points of the `k`-th plane of a raster across z, row by row
    /// along x; on all ranks. Collective.
    pub fn plane(&mut self, raster: &SamplePoints, k: usize) -> Vec<Vector> {
        self.0.plane(raster, k)
    }
}

impl Mobility {
    /// Sets up the mobility of a plan, on ranks that share the grid by `partition`.
    pub fn new(plan: &Plan, partition: &Partition) -> Self {
        let (far, partition) = (of_plan(plan, partition), partition.clone());
        Self { plan: plan.clone(), partition, far, wall_drift: None, constraint: None }
    }

    /// The same with a device that evaluates the far field of a plan for it, such as an emulator.
    pub fn on(device: Box<dyn gpu::Device>, plan: &Plan, partition: &Partition) -> Self {
        let (far, partition) = (far_field::on_device(device, plan, partition), partition.clone());
        Self { plan: plan.clone(), partition, far, wall_drift: None, constraint: None }
    }

    /// The plan that is followed.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Work done so far.
    pub fn work(&self) -> Work {
        self.far.work()
    }

    /// Adds a flow whose amplitude follows from the loads to all motions of [`Self::apply`] from now on; `None`
    /// removes it.
    pub fn constrain(&mut self, constraint: Option<Constraint>) {
        self.constraint = constraint;
    }

    /// Sets the box and the particles of this rank, which are inside it and have radii of the plan.
    pub fn arrange(&mut self, cell: &PeriodicBox, particles: &Particles) {
        self.far.arrange(cell, particles);
    }

    /// [`Self::arrange`], unless the particles are arranged already at these positions. Collective.
    pub fn follow(&mut self, cell: &PeriodicBox, particles: &Particles) {
        if self.partition.comm().any(!self.far.is_arranged(cell, particles)) {
            self.arrange(cell, particles);
        }
    }

    /// Motions that the loads cause. Lists of loads have an entry for each particle that the rank owns, or none.
    pub fn apply(&mut self, loads: &Loads, output: Output) -> Motion {
        let mut motion = self.far.apply(loads, output);
        if let Some(constraint) = &self.constraint {
            constraint.add_to(&mut motion, loads, self.partition.comm());
        }
        motion
    }

    /// Motions that loads and the degenerate quadrupoles `H` of the particles cause, relative to the fluid far away,
    /// in one evaluation: velocities, angular velocities and rates of strain by the loads and by the force densities
    /// `H lap Delta'` of swimming spheres, as [`crate::Quadrupole`] defines them. The list of quadrupoles has an entry
    /// for each particle that the rank owns. A flow of [`Self::constrain`] is that of the loads. Collective.
    pub fn apply_with_quadrupoles(&mut self, loads: &Loads, quadrupoles: &[Vector]) -> Motion {
        let mut motion = self.far.apply_with_quadrupoles(loads, quadrupoles).of(self.plan.multipoles);
        if let Some(constraint) = &self.constraint {
            constraint.add_to(&mut motion, loads, self.partition.comm());
        }
        motion
    }

    /// [`FarField::rigid`], unless the motions have a flow of [`Self::constrain`].
    pub(crate) fn rigid(&mut self) -> Option<&mut dyn RigidFarField> {
        if self.constraint.is_some() { None } else { self.far.rigid() }
    }

    /// The far field, if it solves together with near pairs for spheres with stresslets, and the motions have no flow
    /// of [`Self::constrain`].
    pub fn coupled(&mut self) -> Option<&mut dyn CoupledFarField> {
        let is_rigid = self.plan.multipoles == Multipoles::Dipole && self.constraint.is_none();
        if is_rigid { self.far.coupled() } else { None }
    }

    /// The far field, if it finds near pairs and draws their random loads, which have no flow of [`Self::constrain`].
    pub fn near_pairs(&mut self) -> Option<&mut dyn CoupledFarField> {
        self.far.coupled()
    }

    /// The far field, if it moves particles and draws random motions and loads for them.
    pub fn fluctuating(&mut self) -> Option<&mut dyn FluctuatingFarField> {
        self.far.fluctuating()
    }

    /// The far field, if it moves particles and has their contacts.
    pub fn contacts(&mut self) -> Option<&mut dyn ContactFarField> {
        self.far.contacts()
    }

    /// The far field, if it adds up forces between surfaces.
    pub fn surface(&mut self) -> Option<&mut dyn SurfaceFarField> {
        self.far.surface()
    }

    /// Random motions of the arranged particles with these ids, whose covariance is the mobility itself: velocities,
    /// and with dipoles angular velocities and rates of strain. Square roots that are found by iteration have a
    /// relative error of `tolerance`. Collective.
    pub fn noise(&mut self, ids: &[u64], tolerance: f64, stream: Stream) -> (Motion, DrawDiagnostics) {
        self.far.noise(&NoiseRequest { ids, tolerance, stream })
    }

    /// Divergence of the mobility from forces to motions with respect to the positions of all particles. It vanishes
    /// without walls (`None`); near walls it is that of each sphere's own images.
    pub fn divergence_at_walls(&mut self, cell: &PeriodicBox, particles: &Particles) -> Option<Motion> {
        if self.plan.boundaries.walls() == 0 {
            return None;
        }
        let plan = &self.plan;
        let drift = &*self.wall_drift.get_or_insert_with(|| WallDrift::new(plan));
        let places = particles.positions.iter().zip(&particles.radii);
        let (velocities, strain_rates) = places.map(|(x, &radius)| drift.at(x.z - cell.origin().z, radius)).unzip();
        let motion = Motion { velocities, angular_velocities: vec![Vector::ZERO; particles.len()], strain_rates };
        Some(motion.of(plan.multipoles))
    }

    /// Flow of loads, as of [`Mobility::apply`], and of degenerate quadrupoles, as of
    /// [`Mobility::apply_with_quadrupoles`], if there are any on any rank, at points of the fluid. Particles are
    /// arranged; the box is not periodic along all axes, and the plan is one [`Plan::with_points`]. Collective.
    ///
    /// # Panics
    /// In a periodic box, and if the plan does not use the split method.
    pub fn flow(&mut self, loads: &Loads, quadrupoles: Option<&[Vector]>) -> Flow<'_> {
        Flow(self.far.flow(loads, quadrupoles).expect("a box that does not repeat along all axes has the split method"))
    }

    /// Velocity field of loads and degenerate quadrupoles, if there are any on any rank, in the form of
    /// [`Self::velocity_field`]. Collective.
    ///
    /// # Panics
    /// If the plan has no grid.
    pub fn velocity_field_of(&mut self, loads: &Loads, quadrupoles: Option<&[Vector]>) -> Vec<f64> {
        self.apply(loads, Output::Velocities);
        let mut field = self.velocity_field();
        if let Some(quadrupoles) = quadrupoles {
            self.apply_with_quadrupoles(&Loads::default(), quadrupoles);
            change(&mut field, &self.velocity_field(), |sum, more| *sum += more);
        }
        field
    }

    /// Velocity field of the last evaluation of loads alone on this rank's share of the grid, `[component][z][y][x]`, x
    /// fastest. With the split method it is the flow of the common wide Gaussians.
    ///
    /// # Panics
    /// If the plan has no grid.
    pub fn velocity_field(&self) -> Vec<f64> {
        self.far.velocity_field().expect("the plan of a velocity field has a grid")
    }

    /// Largest `|k . u| / (|k| |u|)` over all modes of the last velocity field, whose memory it overwrites: call
    /// [`Self::velocity_field`] before it, if at all. `None` without a grid.
    pub fn divergence(&mut self) -> Option<f64> {
        self.far.divergence()
    }
}
