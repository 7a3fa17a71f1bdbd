//! Rigid spheres with lubrication: coupled solve of the far field and the near field.

mod constant_flux;
mod fluctuations;
mod held_change;
mod held_contacts;
mod lubricated_solve;
mod near_pairs;
mod on_device;
mod perturbed_on_device;
mod perturbed_solve;
mod random_loads;
mod surface_forces;
mod swimming;

pub use held_contacts::{HeldContacts, TooManyContacts};
pub use perturbed_solve::DisplacedSpheres;

use crate::ambient::StrainRate;
use crate::pairs::lists::NearLists;
use crate::pairs::lubrication::PairLubrication;
use crate::pairs::search::NearField;
use crate::six_vector::SixVector;
use crate::solution::{Guess, Solution, SolveInput};
use crate::system::single;
use crate::units::{self, Scaled};
use constant_flux::ConstantFlux;
use domain::parallel::{FusedLoops, change, mapped, stage};
use domain::{Interrupt, Particles, Partition, PeriodicBox, RemoteHolder, Units};
use fcm::{
    DrawDiagnostics, HeldLoads, HeldSteps, Loads, Mobility, Motion, Plan, RigidInput, SolveError, Stream,
    StressletSolver, SurfaceLaws,
};
use lubricated_solve::{LubricatedSolve, SolveCase};
use lubrication::{LubricationRange, PairForce, PairForceError, WallForce};
use std::borrow::Cow;
use std::rc::Rc;
use swimming::SlipInput;

/// Motions of spheres as of [`fcm::StressletSolver`], optionally with lubrication between near pairs. Results have the
/// same digits in any units.
pub struct CoupledSolver {
    far: StressletSolver,
    /// Near field, in units of length and viscosity that scale the particles and the fluid to about 1.
    near: Option<NearField>,
    /// Forces between surfaces that the back end of the far field adds up.
    surface_laws: Option<SurfaceLaws>,
    /// The memory where the far field is evaluated, if it holds columns of solutions.
    holder: Option<Rc<dyn RemoteHolder>>,
    /// Measures of displacements in that memory.
    steps: Option<Rc<dyn HeldSteps>>,
    /// Steady loads on particles that move there.
    held_loads: Option<HeldLoads>,
    units: Units,
    preconditioned: bool,
    partition: Partition,
}

/// Short-range interactions between near particles.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ShortRange {
    /// Gaps at which lubrication acts, if it does.
    pub lubrication: Option<LubricationRange>,
    /// Distance of centres up to which springs act, if there are any.
    pub springs: Option<f64>,
}

/// Number of iterations after which a solve has failed.
const MOST_ITERATIONS: usize = 1000;

/// Relative error of the preconditioner's inner solves for the stiff pairs. The outer iteration corrects this error,
/// and hardly needs fewer steps if the inner solves are ten times more accurate.
const ROUGH: f64 = 0.1;

/// Near-field errors at the start and at the end of a solve, over the tolerance: small enough that a good guess of the
/// far field needs no iteration, and that the next guess is as good.
const START: f64 = 0.6;
const END: f64 = 0.2;

impl CoupledSolver {
    /// Sets up the far field of `plan` and the short-range interactions. Must not be called from a rayon task.
    pub fn new(plan: &Plan, partition: &Partition, short_range: ShortRange) -> Result<Self, PairForceError> {
        Self::of(StressletSolver::new(plan, partition), partition, short_range)
    }

    /// The same with a far field, on ranks that share its grid by `partition`.
    pub fn of(
        mut far: StressletSolver,
        partition: &Partition,
        short_range: ShortRange,
    ) -> Result<Self, PairForceError> {
        let plan = &far.mobility().plan().clone();
        let extreme = |radius: Option<&f64>| radius.copied().unwrap_or(1.0);
        let units = Units::of(plan.viscosity, [extreme(plan.radii.first()), extreme(plan.radii.last())]);
        let (radii, viscosity) = (in_units(&plan.radii, units.length), plan.viscosity / units.viscosity);
        let force = short_range.lubrication.map(|range| PairForce::new(&radii, viscosity, range)).transpose()?;
        let single: Vec<SixVector> = radii.iter().map(|&a| single(viscosity, a)).collect();
        let lubrication = force.map(|force| PairLubrication::new(force, &single));
        let reaches =
            [lubrication.as_ref().map(|pairs| pairs.force.reach()), short_range.springs.map(|r| r / units.length)];
        let at_walls = short_range.lubrication.filter(|_| plan.boundaries.walls() > 0);
        let at_walls = at_walls.map(|range| WallForce::new(viscosity, range));
        let near = reaches.into_iter().flatten().reduce(f64::max).map(|reach| {
            let lists = NearLists::new(reach, partition);
            NearField { lubrication, at_walls, lists, precision: plan.precision, radii }
        });
        let (partition, (holder, steps)) = (partition.clone(), memory(&mut far).unzip());
        let (surface_laws, held_loads, preconditioned) = (None, None, true);
        Ok(Self { far, near, surface_laws, holder, steps, held_loads, units, preconditioned, partition })
    }

    /// Switches the preconditioner of the solve with lubrication on (the default) or off, for comparison.
    #[must_use]
    pub fn preconditioned(self, preconditioned: bool) -> Self {
        Self { preconditioned, ..self }
    }

    /// Extends the distance of centres up to which springs act.
    pub fn extend_springs(&mut self, distance: f64) {
        let (reach, plan) = (distance / self.units.length, self.far.mobility().plan());
        let (precision, radii) = (plan.precision, in_units(&plan.radii, self.units.length));
        let lists = NearLists::new(reach, &self.partition);
        match &mut self.near {
            Some(near) if near.lists.reach() >= reach => {}
            Some(near) => near.lists = lists,
            None => self.near = Some(NearField { lubrication: None, at_walls: None, lists, precision, radii }),
        }
    }

    /// Continues with another plan for the same radii and fluid, and with the partition of its grid.
    pub fn replan(&mut self, plan: &Plan, partition: &Partition) {
        self.set_far_field(StressletSolver::new(plan, partition));
        if let Some(near) = &mut self.near {
            near.lists = NearLists::new(near.lists.reach(), partition);
        }
        self.partition = partition.clone();
    }

    /// Continues with another far field of the same plan, such as one on a device. Columns of solutions that the one
    /// before holds must have been fetched.
    pub fn set_far_field(&mut self, mut far: StressletSolver) {
        (self.holder, self.steps) = memory(&mut far).unzip();
        self.held_loads = None;
        let interrupt = std::mem::replace(&mut self.far, far).interrupt().clone();
        self.far.listen(interrupt);
    }

    /// Brings the numbers of columns that are where the far field is evaluated.
    pub fn fetch(&self, particles: &Particles) {
        if let Some(holder) = &self.holder {
            particles.fetch(&**holder);
        }
    }

    /// Mobility of the far field.
    pub fn mobility(&mut self) -> &mut Mobility {
        self.far.mobility()
    }

    /// Sets the interrupt that is checked at each evaluation of a solve.
    pub fn listen(&mut self, interrupt: Interrupt) {
        self.far.listen(interrupt);
    }

    /// The interrupt that is checked.
    pub fn interrupt(&self) -> &Interrupt {
        self.far.interrupt()
    }

    /// Motions of the particles relative to the background flow. Without near pairs this is the far field alone.
    /// The memory of the guess is used for the solve. Collective; an error is an error on all ranks.
    pub fn solve(
        &mut self,
        cell: &PeriodicBox,
        particles: &Particles,
        acting: &SolveInput,
        guess: Guess,
    ) -> Result<Solution, SolveError> {
        let _stage = stage("coupled solve");
        let SolveInput { loads, strain_rate, bodies, ambient, constant_flux, .. } = *acting;
        let swimming = self.swimming(particles, acting);
        let (ambient, quadrupoles) = swimming.as_ref().map_or((ambient, None), SlipInput::parts);
        let sloping = sloping(strain_rate, particles, ambient);
        let ambient = sloping.as_ref().unwrap_or(ambient);
        let flux = constant_flux.then(|| self.flux(cell, particles, strain_rate));
        self.far.mobility().constrain(flux.as_ref().map(ConstantFlux::constraint));
        if self.near.is_some() || bodies.is_some() || acting.keeps_columns && self.solves_on_device(acting) {
            let units = self.units;
            let own = self.in_units(particles, acting);
            let strain_rate = strain_rate.in_units(units.rate(), units.length);
            let bodies = bodies.map(|bodies| bodies.in_units(&units));
            let acting = SolveInput { strain_rate, bodies: bodies.as_ref(), ..*acting };
            let near = self.pairs_of_solve(cell, [particles, &own], &acting);
            if bodies.is_some() || near.is_on_device() || self.partition.comm().any(!near.is_empty()) {
                let interrupt = self.far.interrupt().clone();
                let added = if near.is_on_device() { None } else { self.with_surface_forces(cell, particles, &acting) };
                let loads = added.as_ref().unwrap_or(loads);
                let mobility = self.far.mobility();
                if flux.is_none() {
                    mobility.follow(cell, particles);
                }
                let ambient =
                    &flux.as_ref().map_or_else(|| Cow::Borrowed(ambient), |flux| Cow::Owned(flux.ambient(ambient)));
                let solve = LubricatedSolve {
                    comm: self.partition.comm(),
                    interrupt: &interrupt,
                    near: &near,
                    holder: self.holder.as_deref(),
                    bodies: bodies.as_ref(),
                    is_preconditioned: self.preconditioned,
                    quadrupoles,
                    particles: &own,
                    strain_rate,
                };
                let SolveInput { keeps_columns, moving_in, fluctuations, held_forces, .. } = acting;
                let of_contacts = held_forces.and_then(|forces| forces.contacts.as_ref());
                let held = of_contacts.or(self.held_loads.as_ref()).filter(|_| moving_in.is_some());
                let case = SolveCase { loads, held, fluctuations, ambient, guess, keeps_columns, moving_in };
                let solved = solve.run(Scaled { mobility, units }, case)?;
                return Ok(self.with_flux(solved, flux.as_ref()));
            }
        }
        let added = self.with_surface_forces(cell, particles, acting);
        let loads = added.as_ref().unwrap_or(loads);
        let Guess { stresslets_far: guess, .. } = &guess.listed(&particles.ids, self.holder.as_deref());
        let input = RigidInput { loads, ambient, background: strain_rate.at_zero, guess, quadrupoles };
        let solved = self.solve_far(cell, particles, &input)?;
        Ok(self.with_flux(solved, flux.as_ref()))
    }

    /// A solution with the flow that keeps the flux, if there is one. Collective.
    fn with_flux(&self, mut solved: Solution, flux: Option<&ConstantFlux>) -> Solution {
        if let Some(flux) = flux {
            flux.complete(&mut solved, self.partition.comm());
        }
        solved
    }

    /// Particles in scaled units, or as they are if they move where the far field is evaluated.
    fn in_units<'a>(&self, particles: &'a Particles, acting: &SolveInput) -> Cow<'a, Particles> {
        match acting.moving_in {
            Some(_) => Cow::Borrowed(particles),
            None => Cow::Owned(units::particles(particles, &self.units)),
        }
    }

    /// Motions of particles without near pairs.
    fn solve_far(
        &mut self,
        cell: &PeriodicBox,
        particles: &Particles,
        input: &RigidInput,
    ) -> Result<Solution, SolveError> {
        let solved = self.far.solve_in(cell, particles, input)?;
        let fcm::Solved { motion, stresslets, iterations, residual } = solved;
        let far = Loads { stresslets: stresslets.clone(), ..input.loads.clone() };
        let viscosity = self.far.mobility().plan().viscosity;
        let induced = induced(viscosity, &particles.radii, &motion, &far);
        Ok(Solution { motion, stresslets, far, induced, iterations, residual, ..Solution::default() })
    }
}

impl CoupledSolver {
    /// Random motions whose covariance is the mobility of the method, to a tolerance: motions of particles without
    /// resistance to strain in a fluctuating fluid. Collective.
    pub fn noise(
        &mut self,
        cell: &PeriodicBox,
        particles: &Particles,
        tolerance: f64,
        stream: Stream,
    ) -> (Motion, DrawDiagnostics) {
        let mobility = self.far.mobility();
        mobility.follow(cell, particles);
        mobility.noise(&particles.ids, tolerance, stream)
    }

    /// Adds `times` the divergence of the mobility, which is nonzero only near walls, to motions of particles.
    pub fn add_divergence(&mut self, cell: &PeriodicBox, particles: &Particles, times: f64, motion: &mut Motion) {
        if let Some(divergence) = self.far.mobility().divergence_at_walls(cell, particles) {
            motion.add(times, &divergence);
        }
    }
}

fn in_units(lengths: &[f64], unit: f64) -> Vec<f64> {
    lengths.iter().map(|length| length / unit).collect()
}

/// Ambient motions plus the variation of a non-uniform background strain rate with z; `None` if the strain rate is
/// uniform.
fn sloping(strain_rate: StrainRate, particles: &Particles, ambient: &Motion) -> Option<Motion> {
    (!strain_rate.is_uniform()).then(|| {
        let mut strain_rates = mapped(&particles.positions, |x| strain_rate.beyond(x.z));
        change(&mut strain_rates, &ambient.strain_rates, |sum, &own| *sum += own);
        Motion { strain_rates, ..ambient.clone() }
    })
}

/// The memory where a far field is evaluated, if it holds columns of solutions, and measures of displacements there.
fn memory(far: &mut StressletSolver) -> Option<(Rc<dyn RemoteHolder>, Rc<dyn HeldSteps>)> {
    far.mobility().coupled().map(|far| (far.holder(), far.steps()))
}

/// Motions minus those of single spheres under their own loads.
fn induced(viscosity: f64, radii: &[f64], motion: &Motion, loads: &Loads) -> Motion {
    let of_row = |row: usize| {
        let load = SixVector::of_row(row, &loads.forces, &loads.torques);
        SixVector::of_row(row, &motion.velocities, &motion.angular_velocities) - load / single(viscosity, radii[row])
    };
    let (mut induced, mut loops) = (Motion::default(), FusedLoops::default());
    loops.of_rows(&mut induced.velocities, radii.len(), |row| of_row(row).linear());
    loops.of_rows(&mut induced.angular_velocities, radii.len(), |row| of_row(row).angular());
    loops.run();
    induced
}

#[cfg(test)]
mod tests;
