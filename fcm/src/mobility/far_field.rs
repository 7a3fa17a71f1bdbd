//! Interface between the mobility and what evaluates it: a method on a device.

mod dense;
mod device;
mod grid;

use crate::conjugate_gradients::{IterationOutcome, Limits};
use crate::lanczos::DrawDiagnostics;
use crate::mobility::contacts::ContactFarField;
use crate::mobility::coupled::CoupledFarField;
use crate::mobility::fluctuating::FluctuatingFarField;
use crate::mobility::loads::{Loads, Motion, Output};
use crate::mobility::noise::NoiseRequest;
use crate::mobility::work::Work;
use crate::plan::Plan;
use crate::plan::device::ComputeDevice;
use crate::plan::method::Method;
use crate::plan::sample_points::SamplePoints;
use dense::DenseFarField;
use device::DeviceFarField;
use domain::{Comm, Particles, Partition, PeriodicBox, Traceless, Vector};
use gpu::SurfaceLaws;
pub(crate) use grid::{GridFarField, MomentFarField};

/// Far field of the particles of a rank, by one method on one device.
///
/// Loads and motions are columns with a row for each particle that the rank owns, in the order of
/// [`Self::arrange`] and in the units of the plan; those of other ranks are the back end's own concern. A device may
/// keep positions, and its copies of the columns, from one call to the next. All methods are collective.
///
/// Equal calls give equal bits, from run to run and on any number of threads. A device keeps this promise on one card:
/// its sums have a fixed order. Results on several numbers of ranks, and on several cards, agree to round-off.
pub(crate) trait FarField {
    /// Sets the box and the particles, which hold until the next call.
    fn arrange(&mut self, cell: &PeriodicBox, particles: &Particles);

    /// Whether this rank's particles are arranged already as they are now: a back end that cannot tell says no.
    fn is_arranged(&self, _cell: &PeriodicBox, _particles: &Particles) -> bool {
        false
    }

    /// Motions that loads cause, as far as `output` asks for them. Lists of loads have a row for each particle, or
    /// none.
    fn apply(&mut self, loads: &Loads, output: Output) -> Motion;

    /// Motions that loads and degenerate quadrupoles, one of each particle, cause.
    fn apply_with_quadrupoles(&mut self, loads: &Loads, quadrupoles: &[Vector]) -> Motion;

    /// Random motions whose covariance is the mobility: velocities, and with dipoles angular velocities and rates of
    /// strain.
    fn noise(&mut self, draw: &NoiseRequest) -> (Motion, DrawDiagnostics);

    /// The back end itself, if it solves for the stresslets of rigid spheres too.
    fn rigid(&mut self) -> Option<&mut dyn RigidFarField> {
        None
    }

    /// The back end itself, if it adds up forces between surfaces.
    fn surface(&mut self) -> Option<&mut dyn SurfaceFarField> {
        None
    }

    /// The back end itself, if it solves together with near pairs.
    fn coupled(&mut self) -> Option<&mut dyn CoupledFarField> {
        None
    }

    /// The back end itself, if it moves particles and draws random motions and loads for them.
    fn fluctuating(&mut self) -> Option<&mut dyn FluctuatingFarField> {
        None
    }

    /// The back end itself, if it moves particles and has their contacts.
    fn contacts(&mut self) -> Option<&mut dyn ContactFarField> {
        None
    }

    /// Flow of loads and degenerate quadrupoles, if there are any on any rank, at points of the fluid; `None` from a
    /// back end whose plans do not have such points.
    fn flow(&mut self, _loads: &Loads, _quadrupoles: Option<&[Vector]>) -> Option<Box<dyn FlowAtPoints + '_>> {
        None
    }

    /// Velocity field of the last evaluation on this rank's share of the grid, `[component][z][y][x]`, x fastest;
    /// `None` without a grid.
    fn velocity_field(&self) -> Option<Vec<f64>> {
        None
    }

    /// Largest `|k . u| / (|k| |u|)` over all modes of that field. It may take the memory of the field, which is then
    /// no longer to be had; `None` without a grid.
    fn divergence(&mut self) -> Option<f64> {
        None
    }

    /// Work done so far.
    fn work(&self) -> Work;
}

/// A far field that solves for the stresslets of rigid spheres where it is evaluated.
pub(crate) trait RigidFarField {
    /// Solves a problem for the arranged particles.
    fn solve(&mut self, problem: &RigidProblem) -> RigidSolution;
}

/// A far field that adds up forces between the surfaces of the arranged particles.
pub trait SurfaceFarField {
    /// Forces of all pairs on each particle, by laws in the units of length of the far field and in any unit of force.
    fn forces(&mut self, laws: &SurfaceLaws) -> Vec<Vector>;
}

/// Problem of rigid spheres: the stresslets `-D` for which the rates of strain of all loads are minus those given.
pub(crate) struct RigidProblem<'a> {
    /// Forces, torques, and stresslets that the iteration starts from, as many as particles.
    pub loads: &'a Loads,
    /// Rate of strain at each particle besides.
    pub strain_rates: &'a [Traceless],
    /// Ranks, of which there is one.
    pub comm: &'a Comm,
    /// Limits of the iteration.
    pub limits: Limits<'a>,
}

/// Solution of such a problem.
pub(crate) struct RigidSolution {
    /// Motion that forces, torques and stresslets cause.
    pub motion: Motion,
    /// Stresslets.
    pub stresslets: Vec<Traceless>,
    /// Result of the iteration.
    pub outcome: IterationOutcome,
}

/// Flow of given loads, at points of the fluid.
pub(crate) trait FlowAtPoints {
    /// Velocities relative to the background flow at the points of the `k`-th plane of a raster across z, row by row
    /// along x; on all ranks. Collective.
    fn plane(&mut self, raster: &SamplePoints, k: usize) -> Vec<Vector>;
}

/// The far field of a plan on a device.
pub(crate) fn on_device(device: Box<dyn gpu::Device>, plan: &Plan, partition: &Partition) -> Box<dyn FarField> {
    Box::new(DeviceFarField::on(device, plan, partition))
}

/// The far field that a plan chose, on ranks that share its grid by `partition`.
pub(crate) fn of_plan(plan: &Plan, partition: &Partition) -> Box<dyn FarField> {
    match (plan.device, plan.method) {
        (ComputeDevice::Gpu, _) => Box::new(DeviceFarField::new(plan, partition)),
        (ComputeDevice::Cpu, Method::Direct | Method::Split) => Box::new(GridFarField::new(plan, partition)),
        (ComputeDevice::Cpu, Method::Dense) => Box::new(DenseFarField::new(plan, partition)),
    }
}
