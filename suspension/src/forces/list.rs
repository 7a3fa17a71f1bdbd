//! All forces of a suspension.

use super::acting::{Acting, Configuration, Instant, Prediction, SolvedMotion};
use super::contacts::{Contacts, StiffnessAdaptation};
use super::dipoles::DipoleForces;
use super::external::ExternalForces;
use super::force::{Force, StressName};
use super::surface::SurfaceForces;
use super::tethers::{Bonds, Traps};
use super::user::AppliedForces;
use crate::error::step::StepError;
use crate::model::Model;
use crate::model::radii::Radii;
use crate::neighbourhood::{NeighbourLists, PairsWithHalo};
use domain::{Bytes, Comm, DomainView, ExpectedCounts, Particles, Partition, Tensor};
use fcm::{Loads, PlanError, Problem};
use hydrodynamics::TakenForce;
use lubrication::BarrierError;
use std::rc::Rc;

/// Column that marks particles whose velocities include a registered force, by its name.
const REGISTERED: &str = "registered force ";

/// Forces of a model and of the user. Forces with observables or a state of their own have a field; all are in
/// [`Self::all`].
pub struct Forces {
    /// Forces of the species and weight.
    pub external: ExternalForces,
    surface: SurfaceForces,
    /// Contacts of rough spheres.
    pub contacts: Option<Contacts>,
    /// Bonds.
    pub bonds: Option<Bonds>,
    /// Traps.
    pub traps: Option<Traps>,
    /// Forces on magnetic and electric moments.
    dipoles: Vec<DipoleForces>,
    /// Further forces of the model.
    others: Vec<Box<dyn Force>>,
    /// Functions of the user.
    pub applied: AppliedForces,
    /// Forces that the user registered.
    registered: Vec<Box<dyn Force>>,
    /// Neighbour lists of all forces and of those who share them.
    lists: Rc<NeighbourLists>,
    /// Longest range of forces; `None` if no force needs pairs.
    pair_range: Option<f64>,
    /// The same for the loads of solves.
    range_in_solves: Option<f64>,
    /// Distances up to which others need neighbours.
    shared: SharedRanges,
    /// Gap over the mean radius up to which spheres repel each other; 0 without repulsion.
    repulsion_range: f64,
}

/// Distances up to which others than forces need neighbours.
#[derive(Debug, Clone, Copy, Default)]
pub struct SharedRanges {
    /// Of those who need pairs at the positions of forces.
    pub with_forces: Option<f64>,
    /// Of those who need them elsewhere.
    pub others: Option<f64>,
}

impl Forces {
    /// The forces of a model, before [`Self::start`].
    pub fn of(model: &Model) -> Result<Self, BarrierError> {
        let surface = SurfaceForces::of(model)?;
        Ok(Self {
            external: ExternalForces::of(model),
            repulsion_range: surface.repulsion_range(model),
            surface,
            contacts: Contacts::of(model),
            bonds: Bonds::of(model),
            traps: Traps::of(model),
            dipoles: DipoleForces::of(model),
            others: Vec::new(),
            applied: AppliedForces::new(model.user_axes()),
            registered: Vec::new(),
            lists: Rc::default(),
            pair_range: None,
            range_in_solves: None,
            shared: SharedRanges::default(),
        })
    }

    /// These forces on particles with given radii. Collective.
    #[must_use]
    pub fn start(mut self, model: &Model, particles: &Particles, radii: &Radii, partition: &Partition) -> Self {
        let comm = partition.comm();
        let adaptation = StiffnessAdaptation::of(model, &particles.scalars);
        self.contacts = self.contacts.map(|contacts| contacts.between(radii).adapting(adaptation));
        self.bonds.iter_mut().for_each(|bonds| bonds.start(particles, comm));
        self.search(radii.largest(), partition);
        self
    }

    /// These forces with the fields of moments of the particles of a problem.
    pub fn with_fields(mut self, problem: &Problem, comm: &Comm) -> Result<Self, PlanError> {
        let dipoles = self.dipoles.into_iter().map(|dipoles| dipoles.start(problem, comm));
        self.dipoles = dipoles.collect::<Result<_, _>>()?;
        Ok(self)
    }

    /// These forces with lists that others share.
    #[must_use]
    pub fn sharing(mut self, shared: SharedRanges) -> Self {
        self.shared = shared;
        self
    }

    /// Leaves the forces of pairs between surfaces to the solver, if there are any and `solver_takes` them.
    pub fn leave_surfaces(&mut self, largest_radius: f64, solver_takes: impl FnOnce(&[TakenForce]) -> bool) {
        let forces = self.surface.between_spheres();
        if !forces.is_empty() && solver_takes(&forces) {
            self.surface.leave_to_solver();
            self.range_in_solves = self.longest_in_solves(largest_radius);
        }
    }

    /// Forces between surfaces, as the solver takes them.
    pub fn between_surfaces(&self) -> Vec<TakenForce> {
        self.surface.between_spheres()
    }

    /// Whether the solver adds the forces of pairs between surfaces.
    pub fn surfaces_are_solved(&self) -> bool {
        self.surface.is_left_to_solver()
    }

    /// Registers a force of the user.
    pub fn register(&mut self, force: Box<dyn Force>, largest_radius: f64, partition: &Partition) {
        self.registered.push(force);
        self.search(largest_radius, partition);
    }

    /// Whether the user registered forces, which may read any column.
    pub fn have_registered(&self) -> bool {
        !self.registered.is_empty()
    }

    /// Removes the force that was registered last.
    pub fn remove_last(&mut self, largest_radius: f64, partition: &Partition) {
        self.registered.pop();
        self.search(largest_radius, partition);
    }

    /// Names of registered forces that the velocities of particles include.
    pub fn registered_in(particles: &Particles) -> Vec<String> {
        let names = particles.columns.iter().filter_map(|column| column.name.strip_prefix(REGISTERED));
        names.map(str::to_owned).collect()
    }

    /// Whether a column marks a registered force.
    pub fn is_mark(name: &str) -> bool {
        name.starts_with(REGISTERED)
    }

    /// Forces of the model, in the order of their contributions to the stress.
    fn of_model(&self) -> impl Iterator<Item = &dyn Force> {
        let fixed = [&self.external as &dyn Force, &self.surface].into_iter();
        let contacts = self.contacts.iter().map(|contacts| contacts as &dyn Force);
        let bonds = self.bonds.iter().map(|bonds| bonds as &dyn Force);
        let traps = self.traps.iter().map(|traps| traps as &dyn Force);
        let dipoles = self.dipoles.iter().map(|dipoles| dipoles as &dyn Force);
        fixed.chain(contacts).chain(bonds).chain(traps).chain(dipoles).chain(self.others.iter().map(|force| &**force))
    }

    /// Forces of the user.
    fn of_user(&self) -> impl Iterator<Item = &dyn Force> {
        std::iter::once(&self.applied as &dyn Force).chain(self.registered.iter().map(|force| &**force))
    }

    /// All forces: those of the model, then those of the user.
    pub fn all(&self) -> impl Iterator<Item = &dyn Force> {
        self.of_model().chain(self.of_user())
    }

    fn all_mut(&mut self) -> Vec<&mut dyn Force> {
        let mut all: Vec<&mut dyn Force> = vec![&mut self.external, &mut self.surface];
        all.extend(self.contacts.iter_mut().map(|contacts| contacts as &mut dyn Force));
        all.extend(self.bonds.iter_mut().map(|bonds| bonds as &mut dyn Force));
        all.extend(self.traps.iter_mut().map(|traps| traps as &mut dyn Force));
        all.extend(self.dipoles.iter_mut().map(|dipoles| dipoles as &mut dyn Force));
        all.extend(self.others.iter_mut().map(|force| &mut **force as &mut dyn Force));
        all.push(&mut self.applied);
        all.extend(self.registered.iter_mut().map(|force| &mut **force as &mut dyn Force));
        all
    }

    /// Makes lists for all ranges, with another partition of space as well.
    pub fn search(&mut self, largest_radius: f64, partition: &Partition) {
        self.pair_range = self.range(largest_radius);
        self.range_in_solves = self.longest_in_solves(largest_radius);
        let contacts = self.contacts.as_ref().map(Contacts::reach);
        let ranges = [self.range_with_forces(), self.shared.others, contacts].into_iter().flatten();
        self.lists = Rc::new(NeighbourLists::new(ranges, partition));
    }

    /// Longest range of forces and of those who need pairs at their positions; `None` if nobody needs pairs there.
    fn range_with_forces(&self) -> Option<f64> {
        self.pair_range.into_iter().chain(self.shared.with_forces).reduce(f64::max)
    }

    /// Neighbour lists of all forces and of those who share them.
    pub fn lists(&self) -> &Rc<NeighbourLists> {
        &self.lists
    }

    /// Longest range of all forces; `None` if no force needs pairs.
    pub fn range(&self, largest_radius: f64) -> Option<f64> {
        self.all().filter_map(|force| force.range(largest_radius)).reduce(f64::max)
    }

    /// Longest range of forces in the loads of solves.
    fn longest_in_solves(&self, largest_radius: f64) -> Option<f64> {
        self.all().filter_map(|force| force.range_in_solves(largest_radius)).reduce(f64::max)
    }

    /// Distance up to which forces have implicit resistances; `None` if none has.
    pub fn implicit_range(&self, largest_radius: f64) -> Option<f64> {
        self.all().filter_map(|force| force.implicit_range(largest_radius)).reduce(f64::max)
    }

    /// Gap over the mean radius up to which spheres repel each other; 0 without repulsion.
    pub fn repulsion_range(&self) -> f64 {
        self.repulsion_range
    }

    /// Whether some bonds resist bending, for which predictions need angular velocities.
    pub fn have_beams(&self) -> bool {
        self.bonds.as_ref().is_some_and(Bonds::have_beams)
    }

    /// Whether a force between free particles, or one of the user, needs positions here in each evaluation of particles
    /// that move where the far field is evaluated. Forces between surfaces and at contacts do not, if they are added
    /// there.
    pub fn need_positions(&self, are_added: bool) -> bool {
        let are_near = !are_added && (self.range_in_solves.is_some() || self.contacts.is_some());
        let are_given = self.others.is_empty() && self.registered.is_empty() && self.applied.is_empty();
        are_near || !are_given
    }

    /// Whether a force follows the motions of solutions.
    pub fn follow_motion(&self) -> bool {
        self.all().any(Force::follows_motion)
    }

    /// Pairs within the longest range, if a force needs pairs. Collective.
    pub fn near(&self, particles: &Particles, domain: DomainView) -> Option<PairsWithHalo> {
        self.pair_range.and_then(|_| self.shared_near(particles, domain))
    }

    /// The same, if a force needs pairs for the loads of solves. Collective.
    pub fn near_in_solves(&self, particles: &Particles, domain: DomainView) -> Option<PairsWithHalo> {
        self.range_in_solves.and_then(|_| self.shared_near(particles, domain))
    }

    /// Pairs within the longest range of forces and of those who need pairs at the positions of forces. Collective.
    pub fn shared_near(&self, particles: &Particles, domain: DomainView) -> Option<PairsWithHalo> {
        self.range_with_forces().map(|range| self.lists.pairs(particles, domain, range))
    }

    /// Loads and resistances for a solve; forces that follow motions come last. Collective.
    pub fn acting(&mut self, at: &mut Instant, step: u64) -> Result<Acting, StepError> {
        self.mark(at.particles);
        let mut acting = Acting::default();
        for is_last in [false, true] {
            for force in self.all_mut().into_iter().filter(|force| force.follows_motion() == is_last) {
                force.add_loads(at, &mut acting).map_err(|source| force.explain(step, source))?;
            }
        }
        Ok(acting)
    }

    /// Keeps columns that mark the registered forces.
    fn mark(&self, particles: &mut Particles) {
        let names: Vec<String> = self.registered.iter().map(|force| format!("{REGISTERED}{}", force.name())).collect();
        particles.columns.retain(|column| !Self::is_mark(&column.name) || names.contains(&column.name));
        for name in &names {
            particles.column(name, 1);
        }
    }

    /// Loads at present positions, between steps; without those of contacts. Collective.
    pub fn present_loads(&self, particles: &Particles, domain: DomainView, time: f64) -> Loads {
        let near = self.near(particles, domain);
        let at = Configuration { particles, domain, near: near.as_ref(), time, lists: &self.lists };
        let mut loads = Loads::default();
        self.all().for_each(|force| force.add_present_loads(&at, &mut loads));
        loads
    }

    /// Steady loads on particles.
    pub fn steady_loads(&self, particles: &Particles) -> Loads {
        let mut loads = Loads::default();
        self.external.add_steady_loads(particles, &mut loads);
        loads
    }

    /// Passes the motions of a solution on. Collective.
    pub fn solved(&mut self, particles: &mut Particles, solved: &SolvedMotion, step: u64) -> Result<(), StepError> {
        for force in self.all_mut().into_iter().filter(|force| force.follows_motion()) {
            force.solved(particles, solved).map_err(|source| force.explain(step, source))?;
        }
        Ok(())
    }

    /// Ends a step. Collective.
    pub fn end_step(&mut self, particles: &mut Particles, domain: DomainView, step: u64) -> Result<(), StepError> {
        for force in self.all_mut() {
            force.end_step(particles, domain).map_err(|source| force.explain(step, source))?;
        }
        Ok(())
    }

    /// The `xy` component of the sum of the first moments of this rank's particles, added to `sum` force by force, for
    /// forces that change `beyond` a prediction. Collective.
    pub fn add_shear_moments(&self, sum: f64, at: &Configuration, beyond: Option<&Prediction>) -> f64 {
        self.all().fold(sum, |sum, force| sum + force.shear_moment(at, beyond))
    }

    /// First moments of the forces of the model and of those of the user, by name. Collective.
    pub fn moments(&self, particles: &Particles, domain: DomainView, time: f64) -> [Vec<NamedMoments>; 2] {
        let near = self.near(particles, domain);
        let at = Configuration { particles, domain, near: near.as_ref(), time, lists: &self.lists };
        [self.of_model().collect::<Vec<_>>(), self.of_user().collect()].map(|forces| named_moments(&forces, &at))
    }

    /// Names of the contributions of the model's forces to the stress.
    pub fn stresses_of_model(&self) -> Vec<StressName> {
        self.of_model().flat_map(Force::stresses).collect()
    }

    /// Names of the contributions of registered forces to the stress.
    pub fn stresses_of_registered(&self) -> Vec<StressName> {
        self.registered.iter().flat_map(|force| force.stresses()).collect()
    }

    /// Warnings about a model, one sentence each.
    pub fn warnings(&self, model: &Model, radii: &Radii) -> Vec<String> {
        self.all().flat_map(|force| force.warnings(model, radii)).collect()
    }

    /// Numbers for each particle in the columns of forces.
    pub fn numbers(&self, expected: &ExpectedCounts) -> usize {
        self.all().map(|force| force.numbers(expected)).sum()
    }

    /// Memory of an evaluation, in which lists of neighbours persist.
    pub fn bytes(&self, expected: &ExpectedCounts) -> Bytes {
        let of_range =
            |range| NeighbourLists::bytes(range, expected).then(PairsWithHalo::bytes(range, expected).freed());
        let pairs = self.range(expected.largest_radius()).map_or_else(Bytes::default, of_range);
        self.all().fold(pairs, |bytes, force| bytes.then(force.bytes(expected)))
    }
}

/// First moments of this rank's particles, with the name of their contribution to the stress; empty for zeros.
pub struct NamedMoments {
    /// Name of the contribution.
    pub name: StressName,
    /// Moments.
    pub of_particles: Vec<Tensor>,
}

fn named_moments(forces: &[&dyn Force], at: &Configuration) -> Vec<NamedMoments> {
    let of_force = |force: &&dyn Force| {
        let mut moments = force.moments(at, None).into_iter();
        let named = |name| NamedMoments { name, of_particles: moments.next().unwrap_or_default() };
        force.stresses().into_iter().map(named).collect::<Vec<_>>()
    };
    forces.iter().flat_map(of_force).collect()
}
