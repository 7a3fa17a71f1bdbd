//! Mobility of spheres at given positions, from loads to motions.

mod bodies;
mod columns;
mod drift;
mod error;
pub mod memory;
pub mod overlaps;
mod random_motions;
mod slip;
mod square_root;

use bodies::{BodySpheres, record_bodies};
use columns::{column, fill, motions, record, traceless};
pub use drift::Drift;
pub use error::MobilityError;

use crate::ambient::StrainRate;
use crate::ambient::{check_linear, check_pressure, poiseuille};
use crate::coupled_solver::{CoupledSolver, ShortRange};
use crate::lengths::{check_box_of_noise, check_radius};
use crate::mobility::memory::SingleEvaluation;
use crate::mobility::overlaps::Overlaps;
use crate::solution::{Guess, Solution, SolveInput};
use crate::squirming::Squirming;
use domain::{AxisRotation, Bytes, Comm, Interrupt, Interrupted, Particles, Partition, PeriodicBox, Traceless, Vector};
use fcm::{
    ComputeDevice, Costs, Fixed, Loading, Loads, Method, Motion, Multipoles, Output, OutsideError, Plan, Problem,
    SolveError, check_inside,
};
use lubrication::LubricationRange;
use solver::BackgroundFlow;

/// Parameters of a mobility: spheres, fluid and accuracy.
#[derive(Debug, Clone)]
pub struct MobilityParameters {
    /// Box.
    pub cell: PeriodicBox,
    /// Radius of each sphere.
    pub radii: Vec<f64>,
    /// Viscosity of the fluid.
    pub viscosity: f64,
    /// Order of the multipole expansion.
    pub multipoles: Multipoles,
    /// Whether the spheres are rigid, so that stresslets are solved for.
    pub rigid: bool,
    /// Whether spheres may have slip, for which few of them need a more accurate plan; for rigid spheres with dipoles.
    pub swimming: bool,
    /// Relative error allowed.
    pub tolerance: f64,
    /// Gaps at which lubrication acts between rigid spheres, if it does.
    pub lubrication: Option<LubricationRange>,
    /// Method of the far field; `None` for the faster one.
    pub method: Option<Method>,
    /// Device that evaluates the far field.
    pub device: ComputeDevice,
    /// Costs of the parts of an evaluation on the machine.
    pub costs: Costs,
}

impl MobilityParameters {
    /// Rigid spheres in a fluid, evaluated with dipoles to a relative error of 1e-3, without lubrication.
    pub fn new(cell: PeriodicBox, viscosity: f64, radii: Vec<f64>) -> Self {
        Self {
            cell,
            radii,
            viscosity,
            multipoles: Multipoles::Dipole,
            rigid: true,
            swimming: false,
            tolerance: 1e-3,
            lubrication: None,
            method: None,
            device: ComputeDevice::Cpu,
            costs: Costs::default(),
        }
    }

    /// Refuses swimming spheres that have no far field of slip.
    fn check_swimming(&self) -> Result<(), MobilityError> {
        let is_known = self.rigid && self.multipoles == Multipoles::Dipole && self.device == ComputeDevice::Cpu;
        if self.swimming && !is_known { Err(MobilityError::Swimming) } else { Ok(()) }
    }

    /// Refuses a box too elongated for random motions.
    pub fn check_noise(&self) -> Result<(), MobilityError> {
        check_box_of_noise(&self.cell).map_err(MobilityError::Box)
    }
}

/// Mobility of spheres, planned once for any positions. Lists with an entry per sphere are in the order of the radii,
/// on the first rank. All calls are collective.
pub struct Mobility {
    parameters: MobilityParameters,
    problem: Problem,
    plan: Plan,
    partition: Partition,
    hydrodynamics: CoupledSolver,
    positions: Vec<Vector>,
    bodies: BodySpheres,
    /// Slip of the spheres, in the axes of the box, if any has some; on the first rank.
    slip: Option<Squirming>,
    turn: AxisRotation,
    pressure_gradient: Vector,
}

/// Motions of the spheres, with stresslets and convergence.
#[derive(Debug, Clone, PartialEq)]
pub struct Motions {
    /// Velocities, angular velocities and strain rates relative to the background flow; the latter two are zero with
    /// forces alone.
    pub motion: Motion,
    /// Total hydrodynamic stresslets.
    pub stresslets: Vec<Traceless>,
    /// Far-field part of the stresslets.
    pub stresslets_far: Vec<Traceless>,
    /// Number of iterations.
    pub iterations: usize,
    /// Estimated error, relative to the solution.
    pub residual: f64,
    /// Motions of the rigid bodies relative to the background flow at their centres.
    pub bodies: Motion,
    /// Forces on the bodies, and torques about their centres, that the motions given by [`Mobility::move_bodies`] take
    /// in addition to the other loads; empty if none is given.
    pub driving: Loads,
}

impl Mobility {
    /// Plans the mobility, if there is memory for it; `besides` is the memory of the caller's lists on the first rank.
    pub fn new(parameters: MobilityParameters, besides: Bytes, comm: &Comm) -> Result<Self, MobilityError> {
        parameters.check_swimming()?;
        let cell = &parameters.cell;
        parameters.radii.iter().try_for_each(|&radius| check_radius(radius, cell)).map_err(MobilityError::Radius)?;
        let problem = problem(&parameters);
        let plan = Plan::choose(&problem).map_err(MobilityError::Plan)?;
        let (lubrication, radii) = (parameters.lubrication, problem.radii.clone());
        SingleEvaluation { plan: &plan, radii, lubrication, numbers: NUMBERS, besides, remedy: REMEDY }
            .check_memory(comm)?;
        let partition = Partition::new(comm, [plan.grid[1], plan.grid[2]]);
        let hydrodynamics =
            comm.agree(CoupledSolver::new(&plan, &partition, ShortRange { lubrication, springs: None }))?;
        let (positions, bodies, slip) = (Vec::new(), BodySpheres::default(), None);
        let (turn, pressure_gradient) = (AxisRotation::default(), Vector::ZERO);
        Ok(Self {
            parameters,
            problem,
            plan,
            partition,
            hydrodynamics,
            positions,
            bodies,
            slip,
            turn,
            pressure_gradient,
        })
    }

    /// Sets the rotation from the caller's axes, in which vectors and tensors are given and returned, to those of the
    /// box.
    #[must_use]
    pub fn turned(self, turn: AxisRotation) -> Self {
        Self { turn, ..self }
    }

    /// Drives the fluid between two walls by a pressure gradient. Motions are then relative to the velocity and half
    /// the vorticity of that flow at the centres.
    pub fn drive(&mut self, pressure_gradient: Vector) -> Result<(), MobilityError> {
        let gradient = self.turn.vector(pressure_gradient);
        check_pressure(&self.parameters.cell, gradient, self.last_axis())?;
        self.pressure_gradient = gradient;
        Ok(())
    }

    /// The caller's name of the box's last axis.
    fn last_axis(&self) -> char {
        self.turn.list(['x', 'y', 'z'])[2]
    }

    /// Plan of the far field.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Rotation from the caller's axes to those of the box.
    pub fn turn(&self) -> AxisRotation {
        self.turn
    }

    /// A warning if the plan is infeasible.
    pub fn infeasible(&self) -> Option<String> {
        self.plan.infeasible(&self.problem)
    }

    /// Sets the interrupt that is checked in each iteration; an interrupted evaluation has no result.
    pub fn listen(&mut self, interrupt: Interrupt) {
        self.hydrodynamics.listen(interrupt);
    }

    /// Sets the positions of the spheres, wrapped into the box if necessary. Returns overlaps, or refuses them with
    /// lubrication.
    pub fn place(&mut self, positions: &[Vector]) -> Result<Option<Overlaps>, MobilityError> {
        let cell = &self.parameters.cell;
        self.positions = positions.iter().map(|&position| self.turn.vector(position)).collect();
        self.bodies.place(&self.positions);
        self.positions.iter_mut().for_each(|position| *position = cell.wrap(*position).0);
        centre_where_open(cell, &mut self.positions);
        for (id, (&position, &radius)) in self.positions.iter().zip(&self.parameters.radii).enumerate() {
            let turned = |error: OutsideError| {
                let place = "xyz".find(error.axis).unwrap_or_default();
                OutsideError { axis: self.turn.list(['x', 'y', 'z'])[place], ..error }
            };
            check_inside(cell, id as u64, position, radius).map_err(turned)?;
        }
        let overlaps =
            Overlaps::find(cell, &self.positions, &self.parameters.radii, |pair| self.bodies.are_of_one(pair));
        match overlaps.filter(|_| self.parameters.lubrication.is_some()) {
            Some(overlaps) => Err(MobilityError::Overlap(overlaps)),
            None => Ok(overlaps),
        }
    }

    /// Motions of the spheres under loads, relative to a background flow. Empty lists stand for zero loads; stresslets
    /// are loads on spheres that are not rigid.
    pub fn apply(&mut self, loads: &Loads, background: &BackgroundFlow) -> Result<Motions, MobilityError> {
        let turn = self.turn;
        let background =
            BackgroundFlow::with_gradient(turn.tensor(&background.gradient())).expect("a turn changes no trace");
        check_linear(&self.parameters.cell, &background, self.last_axis())?;
        let mut particles = self.placed(loads);
        let comm = self.partition.comm();
        let has = |list: usize| comm.any(list > 0);
        let given = [loads.forces.len(), loads.torques.len(), loads.stresslets.len()].map(has);
        let solved = self.solve(&mut particles, given, &background)?;
        record(&mut particles, &solved);
        Ok(motions(particles.gathered(&self.partition), &solved, &self.bodies).turned(turn.inverse()))
    }

    /// Fails if any rank is asked to stop. Collective.
    fn unless_interrupted(&self) -> Result<(), MobilityError> {
        let is_requested = self.partition.comm().any(self.hydrodynamics.interrupt().is_requested());
        if is_requested { Err(SolveError::from(Interrupted).into()) } else { Ok(()) }
    }

    /// The particles with their loads, on the ranks that own them.
    fn placed(&self, loads: &Loads) -> Particles {
        let mut particles = Particles::default();
        if self.partition.comm().is_first() {
            for (id, (&position, &radius)) in self.positions.iter().zip(&self.parameters.radii).enumerate() {
                particles.push(id as u64, position, radius, 0);
            }
        }
        let vectors = |list: &[Vector]| list.iter().map(|&v| self.turn.vector(v)).collect::<Vec<_>>();
        let stresslets: Vec<_> = loads.stresslets.iter().map(|&s| self.turn.traceless(s)).collect();
        fill(particles.vectors(column::FORCE), &vectors(&loads.forces));
        fill(particles.vectors(column::TORQUE), &vectors(&loads.torques));
        fill(traceless(&mut particles, column::STRESSLET), &stresslets);
        self.bodies.store(&mut particles);
        self.store_slip(&mut particles);
        particles.wrap(&self.parameters.cell);
        particles.migrate(&self.partition, &self.parameters.cell);
        particles
    }

    fn solve(
        &mut self,
        particles: &mut Particles,
        [forces, torques, stresslets]: [bool; 3],
        background: &BackgroundFlow,
    ) -> Result<Solution, SolveError> {
        let (cell, multipoles) = (&self.parameters.cell, self.parameters.multipoles);
        let mut loads = Loads::default();
        if forces {
            loads.forces = particles.vectors(column::FORCE).to_vec();
        }
        if torques && multipoles == Multipoles::Dipole {
            loads.torques = particles.vectors(column::TORQUE).to_vec();
        }
        let (by_pressure, bend) = poiseuille(cell, self.parameters.viscosity, self.pressure_gradient);
        if self.parameters.rigid || multipoles == Multipoles::Monopole {
            let strain_rate = StrainRate::uniform(background.strain_rate()) + by_pressure;
            let bodies = self.bodies.load_moved(particles, self.partition.comm());
            let squirming = self.load_slip(particles);
            let (bodies_of, squirming) = (bodies.as_ref(), squirming.as_ref());
            let acting = SolveInput { bodies: bodies_of, squirming, ..SolveInput::new(&loads, strain_rate) };
            let mut solved = self.hydrodynamics.solve(cell, particles, &acting, Guess::default())?;
            if let Some(bodies) = &bodies {
                let motions = bodies.motions_in(strain_rate, particles, &solved.motion);
                record_bodies(particles, bodies, &motions);
                self.bodies.record_driving(particles, bodies, &solved.constraint_loads);
            }
            carry(&mut solved.motion, &particles.radii, bend);
            return Ok(solved);
        }
        if stresslets {
            loads.stresslets = traceless(particles, column::STRESSLET).to_vec();
        }
        let mobility = self.hydrodynamics.mobility();
        mobility.arrange(cell, particles);
        let mut motion = mobility.apply(&loads, Output::All);
        carry(&mut motion, &particles.radii, bend);
        let stresslets = traceless(particles, column::STRESSLET).to_vec();
        Ok(Solution { motion, stresslets, far: loads, ..Solution::default() })
    }
}

/// Adds the velocities `a^2/6 u''` that spheres have, by Faxen's law, in addition to the velocity of a flow with the
/// second derivative `u''`.
fn carry(motion: &mut Motion, radii: &[f64], bend: Vector) {
    if bend != Vector::ZERO {
        motion.velocities.iter_mut().zip(radii).for_each(|(v, a)| *v += bend * (a * a / 6.0));
    }
}

impl Motions {
    /// The same in rotated axes.
    #[must_use]
    fn turned(mut self, turn: AxisRotation) -> Self {
        if turn == AxisRotation::default() {
            return self;
        }
        turn_motion(&mut self.motion, turn);
        turn_motion(&mut self.bodies, turn);
        self.driving.forces.iter_mut().chain(&mut self.driving.torques).for_each(|v| *v = turn.vector(*v));
        for tensor in self.stresslets.iter_mut().chain(&mut self.stresslets_far) {
            *tensor = turn.traceless(*tensor);
        }
        self
    }
}

fn turn_motion(motion: &mut Motion, turn: AxisRotation) {
    let Motion { velocities, angular_velocities, strain_rates } = motion;
    velocities.iter_mut().chain(angular_velocities).for_each(|v| *v = turn.vector(*v));
    for tensor in strain_rates {
        *tensor = turn.traceless(*tensor);
    }
}

/// Centres the spheres in the box along open axes without walls, where the choice of the origin does not matter.
fn centre_where_open(cell: &PeriodicBox, positions: &mut [Vector]) {
    let is_open = |axis: usize| !cell.is_periodic(axis) && cell.boundaries().walls() == 0;
    let lowest = positions.iter().copied().fold(Vector::INFINITY, Vector::min);
    let highest = positions.iter().copied().fold(Vector::NEG_INFINITY, Vector::max);
    for axis in (0..3).filter(|&axis| is_open(axis)) {
        let by = 0.5 * (cell.edges()[axis] - lowest[axis] - highest[axis]);
        for position in &mut *positions {
            position[axis] += by;
        }
    }
}

/// Relative error of the square root over the tolerance.
const ROOT: f64 = 0.3;

/// Advice for a problem that needs too much memory.
const REMEDY: &str = "fewer positions, a larger tolerance";

/// Approximate numbers per particle in columns.
const NUMBERS: usize = 32;

fn problem(parameters: &MobilityParameters) -> Problem {
    Problem {
        edges: parameters.cell.edges(),
        boundaries: parameters.cell.boundaries(),
        volume: parameters.cell.edges().element_product(),
        shortest_vector: Problem::shortest_vector_of(&parameters.cell),
        smallest_edge_ratio: 1.0,
        largest_strain: parameters.cell.strain().abs(),
        largest_tilts: Problem::tilts_of(&parameters.cell),
        radii: parameters.radii.iter().map(|&radius| (radius, 1)).collect(),
        viscosity: parameters.viscosity,
        multipoles: parameters.multipoles,
        rigid: parameters.rigid,
        lubricated: parameters.lubrication.is_some(),
        loading: if parameters.swimming { Loading::Swimming } else { Loading::UniformOnLattice },
        tolerance: parameters.tolerance,
        threads: 1,
        ranks: 1,
        costs: parameters.costs,
        network: None,
        fixed: Fixed { method: parameters.method, device: parameters.device, ..Fixed::default() },
    }
}
