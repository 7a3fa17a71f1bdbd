//! Input and output of a coupled solve.

use crate::ambient::StrainRate;
use crate::bodies::RigidBodies;
use crate::springs::Springs;
use crate::squirming::Squirming;
use domain::parallel::FusedLoops;
use domain::{ColumnValues, RemoteHolder, RemoteList, Traceless, Vector, remote_columns};
use fcm::{GUESSED, HeldLoads, Loads, Motion, MovingFlow, PastSolutions, SolutionColumns};

/// Input of a solve: loads, ambient flow, implicit springs.
pub struct SolveInput<'a> {
    /// Forces and torques; stresslets are ignored, as they are solved for.
    pub loads: &'a Loads,
    /// Strain rate of the background flow.
    pub strain_rate: StrainRate,
    /// Springs whose resistance is part of the solve, if there are any.
    pub springs: Option<&'a Springs<'a>>,
    /// Rigid bodies, if there are any.
    pub bodies: Option<&'a RigidBodies>,
    /// Further motions of the ambient fluid at each particle, such as Brownian noise; empty lists stand for none.
    pub ambient: &'a Motion,
    /// Slip of squirmers, if there are any, on all ranks or none.
    pub squirming: Option<&'a Squirming>,
    /// Whether the forces between surfaces that the solver [has taken](crate::CoupledSolver::take_surface_forces) are
    /// added to the loads.
    pub surface_forces: bool,
    /// Whether the columns of the solution may stay where the far field is evaluated, see [`Solution::kept`].
    pub keeps_columns: bool,
    /// The background flow, if the particles move where the far field is evaluated, see
    /// [`CoupledSolver::moves_particles`](crate::CoupledSolver::moves_particles): their motions stay there with the
    /// other columns, and the loads are those of [`CoupledSolver::hold_loads`](crate::CoupledSolver::hold_loads), if
    /// there are some.
    pub moving_in: Option<MovingFlow>,
    /// Random motions and loads of particles that move there, in place of other ambient motions and loads.
    pub fluctuations: Option<&'a HeldFluctuations>,
    /// Implicit forces and contacts of particles that move there.
    pub held_forces: Option<&'a HeldForces>,
    /// Whether the flux between two walls is kept at its value without particles, by an additional flow along x.
    pub constant_flux: bool,
}

impl<'a> SolveInput<'a> {
    /// Loads on free spheres in a background flow, and nothing else.
    pub fn new(loads: &'a Loads, strain_rate: StrainRate) -> Self {
        Self {
            loads,
            strain_rate,
            springs: None,
            bodies: None,
            ambient: &NO_AMBIENT,
            squirming: None,
            surface_forces: false,
            keeps_columns: false,
            moving_in: None,
            fluctuations: None,
            held_forces: None,
            constant_flux: false,
        }
    }
}

/// Random motions and loads of particles that move where the far field is evaluated, where these are too.
pub struct HeldFluctuations {
    /// Motions of the fluid at each particle, see [`fcm::HeldMotions::ambient`]. The solve starts from spheres that are
    /// moved by them, as from [`Guess::induced_by`].
    pub ambient: ColumnValues,
    /// Steady and random loads.
    pub loads: HeldLoads,
}

/// Implicit forces and contacts of particles that move where the far field is evaluated.
#[derive(Default)]
pub struct HeldForces {
    /// Prediction of forces between surfaces for the end of a substep, if these and contacts are implicit.
    pub prediction: Option<HeldPrediction>,
    /// Steady loads with those of contacts, by [`CoupledSolver::contact_loads`](crate::CoupledSolver::contact_loads);
    /// `None` without contacts.
    pub contacts: Option<HeldLoads>,
}

/// Predicted motion of particles that move where the far field is evaluated, for forces at the end of a time.
pub struct HeldPrediction {
    /// The time from the present positions.
    pub time: f64,
    /// Predicted velocities with that of the background flow, in the order of ids.
    pub velocities: RemoteList,
}

/// Solution for the motions of the spheres.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Solution {
    /// Motions relative to the background flow.
    pub motion: Motion,
    /// Total hydrodynamic stresslets; empty with monopoles only.
    pub stresslets: Vec<Traceless>,
    /// Loads on the far field: given loads plus lubrication, and the far-field part of the stresslets.
    pub far: Loads,
    /// Loads by which the rigidity of bodies acts on their spheres: the loads on the fluid are given loads plus these.
    /// Their total force and torque on a body are zero along components of its motion that are not given. Empty without
    /// bodies.
    pub constraint_loads: Loads,
    /// Motions induced by the loads of all other spheres: total motions minus those of single spheres under their own
    /// loads.
    pub induced: Motion,
    /// Curvature `-u''` of the flow that keeps the flux; 0 without that constraint.
    pub curvature: f64,
    /// Number of applications of the mobility, not counting the initial one.
    pub iterations: usize,
    /// Estimated error of the iteration, relative to the solution.
    pub residual: f64,
    /// Columns that stay where the far field is evaluated, if they do. Then the lists above are empty, except for
    /// velocities and angular velocities of particles that do not move there.
    pub kept: Option<Box<KeptSolution>>,
}

/// A solution that stays where the far field is evaluated.
#[derive(Debug, Clone, PartialEq)]
pub struct KeptSolution {
    /// Its columns.
    pub columns: SolutionColumns,
    /// Comparison with the guess, see [`fcm::CoupledSolution::compared`].
    pub compared: Option<[[f64; 2]; GUESSED]>,
}

/// Initial guess of a solution; empty lists stand for no guess.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Guess {
    /// Far-field part of the stresslets.
    pub stresslets_far: Vec<Traceless>,
    /// Velocities induced by the loads of all other spheres, see [`Solution::induced`].
    pub induced_velocities: Vec<Vector>,
    /// Angular velocities induced by the loads of all other spheres.
    pub induced_angular_velocities: Vec<Vector>,
    /// Velocities relative to the background flow: start of the iteration for the near-field motions that match the
    /// induced ones.
    pub velocities: Vec<Vector>,
    /// Angular velocities relative to the background flow.
    pub angular_velocities: Vec<Vector>,
    /// Past solutions whose extrapolation is the guess, if there are any, in place of the lists.
    pub past: Option<PastSolutions>,
}

impl Guess {
    /// Guess for particles moved by ambient motions of the fluid.
    pub fn induced_by(ambient: &Motion) -> Self {
        Self {
            induced_velocities: ambient.velocities.clone(),
            induced_angular_velocities: ambient.angular_velocities.clone(),
            ..Self::default()
        }
    }

    /// The same as lists, for particles with these ids. A memory may hold columns of past solutions.
    pub(crate) fn listed(self, ids: &[u64], holder: Option<&dyn RemoteHolder>) -> Self {
        let Some(past) = self.past else { return self };
        if let Some(holder) = holder {
            let width = |k: usize| if k == 0 { 5 } else { 3 };
            let columns = past.columns.iter().enumerate().flat_map(|(k, list)| list.iter().map(move |v| (v, width(k))));
            remote_columns::fetch(ids, &columns.collect::<Vec<_>>(), holder);
        }
        let (mut guess, past) = (Self::default(), &past.numbers());
        let Self {
            stresslets_far, induced_velocities, induced_angular_velocities, velocities, angular_velocities, ..
        } = &mut guess;
        let motions = [induced_velocities, induced_angular_velocities, velocities, angular_velocities];
        let count = |k: usize, width: usize| past.count(k) / width;
        let stresslet = |row: usize| Traceless(std::array::from_fn(|axis| past.guess(0, 5 * row + axis)));
        let mut loops = FusedLoops::default();
        loops.of_rows(stresslets_far, count(0, 5), stresslet);
        for (k, list) in (1..).zip(motions) {
            let vector = move |row: usize| Vector::from_array([0, 1, 2].map(|axis| past.guess(k, 3 * row + axis)));
            loops.of_rows(list, count(k, 3), vector);
        }
        loops.run();
        guess
    }

    /// The same as past solutions, of which lists are the last one.
    pub(crate) fn solutions(self) -> PastSolutions {
        let Self {
            stresslets_far,
            induced_velocities,
            induced_angular_velocities,
            velocities,
            angular_velocities,
            past,
        } = self;
        let vectors = |list: &[Vector]| bytemuck::cast_slice(list).to_vec().into();
        past.unwrap_or_else(|| {
            PastSolutions::last([
                bytemuck::cast_slice(&stresslets_far).to_vec().into(),
                vectors(&induced_velocities),
                vectors(&induced_angular_velocities),
                vectors(&velocities),
                vectors(&angular_velocities),
            ])
        })
    }
}

/// Zero ambient motion.
pub static NO_AMBIENT: Motion =
    Motion { velocities: Vec::new(), angular_velocities: Vec::new(), strain_rates: Vec::new() };

/// A solution for spheres under loads in a fluid with ambient motions.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StoredSolution {
    /// Velocities and angular velocities.
    pub motion: Motion,
    /// Far-field part of the stresslets.
    pub stresslets_far: Vec<Traceless>,
    /// Total stresslets.
    pub stresslets: Vec<Traceless>,
}
