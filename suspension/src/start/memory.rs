//! Prediction of the peak memory of each rank of a run, from the model and the plan.

mod dipoles;
mod output;
#[cfg(test)]
mod tests;

use crate::columns::VELOCITY;
use crate::columns::{
    ANGULAR_VELOCITY, CONSTRAINT_LOAD_NUMBERS, CONSTRAINT_MOMENT_NUMBERS, ORIENTATION_NUMBERS, STRESSLET,
};
use crate::evaluation::gap_control::WATCHED;
use crate::evaluation::initial_guess::WarmStart;
use crate::flow::open_cell;
use crate::forces::Forces;
use crate::forces::contacts::Contacts;
use crate::forces::surface::{SurfaceForces, repulsion};
use crate::integrators::adams_bashforth::{AdamsBashforth, PAST_OF_ANY_LENGTH};
use crate::integrators::adaptive;
use crate::model::radii::Radii;
use crate::model::{BrownianScheme, Integrator, Model, MultipoleOrder, Species, Start};
use crate::neighbourhood::{NeighbourLists, PairsWithHalo};
use crate::sampling;
use crate::scalars::STRESS_CONTROL_NUMBERS;
use crate::start::plan::dipole_plans;
use domain::{
    Bytes, ExpectedCounts, MemoryNeed, Particles, Place, Process, Traceless, Vector, packing_bytes, readable_bytes,
};
use fcm::{CardMemory, CardRanks, CardSteps, Footprint, Plan, PlanError};
use hydrodynamics::brownian::{AMBIENT_NUMBERS, RANDOM_NUMBERS};
use hydrodynamics::memory::{Ranks, of_peak, solve_bytes, table_bytes};
use lubrication::LubricationRange;

/// Numbers in each column of a frame of the trajectory.
const FRAME: [(&str, usize); 3] = [(VELOCITY, 3), (ANGULAR_VELOCITY, 3), (STRESSLET, 5)];

/// Volume fraction above which random placement has to move spheres apart, see [`domain::random_packing`].
const DENSE: f64 = 0.25;

/// Number of species above which the advice mentions the columns of the segregation between species.
const MANY: usize = 16;

/// Peak memory of each rank of a run.
pub fn needs(model: &Model, radii: &Radii, plan: &Plan, ranks: Ranks) -> Vec<MemoryNeed> {
    (0..ranks.count).map(|rank| need(model, radii, plan, ranks, rank)).collect()
}

/// Memory that a run takes of a card, if its plan is for one. Collective.
pub fn card(model: &Model, radii: &Radii, plan: &Plan, ranks: CardRanks) -> Result<Option<CardMemory>, PlanError> {
    plan.check_ranks(ranks.count())?;
    // The last rank has no fewer planes than any other.
    let place = Place::of(ranks.count(), ranks.count() - 1, [plan.grid[1], plan.grid[2]]);
    let expected = &ExpectedCounts::new(plan.edges, radii.kinds(), &place);
    let far = Footprint::new(plan, &place, 1, expected);
    let share = Share { model, far, expected, threads: 1, rank_of: (0, 1), dipoles: &[] };
    hydrodynamics::memory::card(&share.far, expected, share.near_field(), &share.steps_on_card(), ranks)
}

/// Peak memory of one rank of a run.
pub fn need(model: &Model, radii: &Radii, plan: &Plan, ranks: Ranks, rank: usize) -> MemoryNeed {
    let place = Place::of(ranks.count, rank, [plan.grid[1], plan.grid[2]]);
    let expected = ExpectedCounts::new(plan.edges, radii.kinds(), &place);
    let far = Footprint::new(plan, &place, ranks.threads, &expected);
    let (threads, rank_of, dipoles) = (ranks.threads, (rank, ranks.count), &dipole_plans(model, radii)[..]);
    let share = Share { model, far, expected: &expected, threads, rank_of, dipoles };
    of_peak(share.peak(), &share.far, rank, ranks.count)
}

/// Advice for a scene that needs too much memory.
pub fn advice(model: &Model, radii: &Radii) -> String {
    let chosen = &model.hydrodynamics;
    let grid = if chosen.grid.is_some() { "a smaller hydrodynamics.grid" } else { "a larger hydrodynamics.tolerance" };
    let far = if repels_far(model, radii) { "a shorter repulsion.screening_length, " } else { "" };
    let near = if chosen.lubrication { ", a smaller hydrodynamics.lubrication_cutoff" } else { "" };
    let samples = if model.statistics.is_some() { ", no [statistics]" } else { "" };
    let columns = readable_bytes(sampling::column_bytes(model).most);
    let species = if model.species.len() > MANY {
        format!(", fewer [[species]] (their columns take {columns})")
    } else {
        String::new()
    };
    format!(
        "the scene has {} spheres: take {far}fewer of them (species.count, species.volume_fraction, or smaller \
         box.edges), {grid}{near}{samples}{species}, or more machines with ranks on each",
        radii.count()
    )
}

/// Whether screened repulsion extends beyond the width of the box: then all images take memory.
fn repels_far(model: &Model, radii: &Radii) -> bool {
    let is_screened = model.repulsion.is_some_and(|repulsion| repulsion.screening_length.is_some());
    let reach = SurfaceForces::of(model).ok().and_then(|forces| forces.reach([radii.largest(); 2].into()));
    is_screened && reach.is_some_and(|reach| reach > model.shortest_vector())
}

/// Memory of the placement of the particles on a single rank.
pub fn placing(model: &Model, radii: &Radii) -> MemoryNeed {
    MemoryNeed {
        resident: Process::ALONE.resident(placing_bytes(model, radii.count() as f64).most),
        ..MemoryNeed::default()
    }
}

/// Memory of the positions of all spheres on the rank that makes them.
fn placing_bytes(model: &Model, count: f64) -> Bytes {
    let listed = Bytes::list::<(u32, f64)>(count);
    let places = match model.start {
        Start::Random { minimum_gap } => packing_bytes(count, filled(model, minimum_gap) > DENSE),
        Start::Cloud { .. } => packing_bytes(count, false),
        Start::Lattice(_) => lattice_bytes(model, count),
        // Lists of a file in its order, and sorted by id.
        _ => Bytes::list::<(Vector, Vector, usize)>(2.0 * count),
    };
    listed.then(places).then(Bytes::list::<Vector>(count)).freed()
}

/// Memory of a rank's part of a lattice: a byte for each sphere of all ranks if species are mixed, and the rank's
/// spheres.
fn lattice_bytes(model: &Model, own: f64) -> Bytes {
    let is_mixed = model.species.len() > 1;
    let all = model.species.iter().map(|kind| kind.count.unwrap_or(0) as f64).sum::<f64>();
    let mixed = Bytes::list::<u8>(if is_mixed { all } else { 0.0 });
    mixed.then(Particles::bytes(own, 0)).then(Bytes::list::<(Vector, u32)>(own)).freed()
}

/// Volume fraction of the spheres enlarged by half the gap that is kept around each.
fn filled(model: &Model, gap: f64) -> f64 {
    let of_kind = |s: &Species| s.count.unwrap_or(0) as f64 * (s.radius + 0.5 * gap).powi(3);
    4.0 / 3.0 * std::f64::consts::PI * model.species.iter().map(of_kind).sum::<f64>() / model.cell.volume()
}

/// One rank's share of a run.
struct Share<'a> {
    model: &'a Model,
    far: Footprint<'a>,
    expected: &'a ExpectedCounts,
    threads: usize,
    /// The rank and the number of ranks.
    rank_of: (usize, usize),
    /// Plans of the fields of moments.
    dipoles: &'a [Plan],
}

/// Lanczos vectors of random motions.
const VECTORS: f64 = 24.0;

impl Share<'_> {
    /// Peak from the start to the end of a run.
    fn peak(&self) -> Bytes {
        let particles = Particles::bytes(self.expected.owned(), self.numbers());
        let stays = self.fluid().then(particles).then(self.estimators()).then(self.segregation());
        let passes =
            self.step().or(self.report()).or(self.frame()).or(self.sample()).or(self.checkpoint()).or(self.field());
        self.start().then(stays).then(passes)
    }

    fn start(&self) -> Bytes {
        let placed = match self.model.start {
            Start::Random { minimum_gap }
                if self.model.placed_together().is_empty() && filled(self.model, minimum_gap) <= DENSE =>
            {
                self.shared_placing(minimum_gap)
            }
            Start::Lattice(_) => lattice_bytes(self.model, self.expected.owned()),
            _ if self.is_first() => placing_bytes(self.model, self.expected.total()),
            _ => Bytes::default(),
        };
        let own = Particles::bytes(self.expected.owned(), 0);
        let divided = own.then(Particles::migration_bytes(self.expected.owned())).freed();
        placed.or(divided).or(own.then(self.near(self.gap_search())).freed())
    }

    /// Memory of a rank that places its own spheres and stores those around them.
    fn shared_placing(&self, gap: f64) -> Bytes {
        let present = self.expected.present(2.0 * self.expected.largest_radius() + gap);
        let listed = Bytes::list::<(u64, Vector)>(domain::GROWING * self.expected.owned());
        listed
            .then(packing_bytes(present, false))
            .then(Particles::bytes(domain::GROWING * self.expected.owned(), 0))
            .freed()
    }

    fn fluid(&self) -> Bytes {
        let tables = if self.range().is_some() { table_bytes(self.far.radii()) } else { Bytes::default() };
        let far = self.far.mobility();
        // If the grid follows the spheres, the old grid exists until the new one is complete.
        let again = if open_cell::follows(self.model.cell.boundaries()) { far.freed() } else { Bytes::default() };
        far.then(again).then(tables).then(self.dipoles())
    }

    fn range(&self) -> Option<LubricationRange> {
        let chosen = &self.model.hydrodynamics;
        let cutoff = chosen.lubrication_cutoff.unwrap_or(LubricationRange::WIDE);
        chosen.lubrication.then(|| LubricationRange::new(cutoff, LubricationRange::MINIMUM_GAP).ok()).flatten()
    }

    /// Gaps at which forces between near spheres are part of the solve: lubrication, or implicit repulsion.
    fn near_field(&self) -> Option<LubricationRange> {
        let springs = || {
            let repulsion = repulsion(self.model).ok()?.filter(|_| self.is_implicit())?;
            let largest = self.expected.largest_radius();
            LubricationRange::new(repulsion.reach([largest; 2]) / largest - 2.0, LubricationRange::MINIMUM_GAP).ok()
        };
        self.range().or_else(springs)
    }

    /// Numbers in all columns of a particle.
    fn numbers(&self) -> usize {
        let velocities = 3 * match self.model.integrator {
            Integrator::AdamsBashforth { order } => AdamsBashforth::of_order(order).velocity_columns(),
            Integrator::Adaptive(_) => 1 + adaptive::PAST_VELOCITIES,
            // The mean and the predicted velocity are stored as well.
            Integrator::Implicit(_) => 1 + PAST_OF_ANY_LENGTH + 2,
            Integrator::Brownian(_) => 2,
        };
        let velocities = velocities + self.orientation_numbers(velocities) + self.body_numbers(velocities);
        let velocities = velocities + usize::from(self.model.flow.keeps_flux());
        let velocities =
            velocities + if self.model.shear_rates().stress().is_some() { STRESS_CONTROL_NUMBERS } else { 0 };
        let velocities = velocities + self.random_numbers() + self.forces().map_or(0, |f| f.numbers(self.expected));
        if self.is_rigid() { velocities + FRAME[1].1 + FRAME[2].1 + self.warm_start().numbers() } else { velocities }
    }

    fn warm_start(&self) -> WarmStart {
        WarmStart::new(self.model.is_coupled())
    }

    /// Numbers of a particle for orientations, given those for velocities, each of which but the present one has an
    /// angular velocity beside it: the orientation and the rotation in the step as well, and where motions are random,
    /// the rotation by them.
    fn orientation_numbers(&self, velocities: usize) -> usize {
        match self.model.integrator {
            _ if !self.model.has_orientations() => 0,
            Integrator::Brownian(_) => ORIENTATION_NUMBERS + velocities - 3 + 3 + 3,
            _ => ORIENTATION_NUMBERS + velocities - 3 + 3,
        }
    }

    /// Numbers of a particle for rigid bodies, given those for velocities, each of which has one of the centre beside
    /// it: the number of its body, its arm, its part of the stress and, if motions are given, loads as well.
    fn body_numbers(&self, velocities: usize) -> usize {
        if self.model.bodies.is_empty() {
            return 0;
        }
        let is_given = self.model.kinds_with_given_motion().next().is_some();
        let loads = if is_given { CONSTRAINT_LOAD_NUMBERS } else { 0 };
        1 + 3 + CONSTRAINT_MOMENT_NUMBERS + loads + velocities
    }

    fn forces(&self) -> Option<Forces> {
        Forces::of(self.model).ok()
    }

    fn is_rigid(&self) -> bool {
        self.model.hydrodynamics.multipoles == MultipoleOrder::Dipole
    }

    /// Memory of near pairs within a distance.
    fn near(&self, distance: f64) -> Bytes {
        PairsWithHalo::bytes(distance, self.expected)
    }

    fn gap_search(&self) -> f64 {
        2.2 * self.expected.largest_radius()
    }

    /// Memory of a step. It includes the state before the step, to restore after an interrupt: positions, and all
    /// columns but for past solutions, which are only renamed; and a copy before a substep that may be repeated.
    fn step(&self) -> Bytes {
        let owned = self.expected.owned();
        let past = if self.is_rigid() { self.warm_start().past_numbers() } else { 0 };
        let saved = Particles::bytes(owned, self.numbers() - past);
        let copy = saved.then(Particles::bytes(owned, self.numbers()));
        let copies = if self.is_implicit() { saved.then(copy) } else { saved };
        copies.then(self.evaluation()).freed()
    }

    /// Numbers of a particle's random motions.
    fn random_numbers(&self) -> usize {
        match self.model.integrator {
            Integrator::Brownian(BrownianScheme::Midpoint) => AMBIENT_NUMBERS,
            Integrator::Brownian(BrownianScheme::TwoEvaluations) => AMBIENT_NUMBERS + RANDOM_NUMBERS,
            _ => 0,
        }
    }

    fn is_brownian(&self) -> bool {
        self.model.thermal_energy.is_some()
    }

    /// Lanczos vectors of a draw.
    fn random_vectors(&self) -> f64 {
        if self.is_brownian() { VECTORS } else { 0.0 }
    }

    /// Memory of a card that steps take.
    fn steps_on_card(&self) -> CardSteps {
        let slots = Contacts::of(self.model).map_or(0, |contacts| contacts.slots_of(self.expected.total() as usize));
        let has_substeps = matches!(self.model.integrator, Integrator::Implicit(_) | Integrator::Adaptive(_));
        let has_differences = matches!(self.model.integrator, Integrator::Brownian(BrownianScheme::TwoEvaluations));
        CardSteps { random_vectors: self.random_vectors(), has_substeps, has_differences, slots }
    }

    fn is_implicit(&self) -> bool {
        matches!(self.model.integrator, Integrator::Implicit(_))
    }

    fn evaluation(&self) -> Bytes {
        let owned = self.expected.owned();
        let forces = self.forces().map_or_else(Bytes::default, |forces| forces.bytes(self.expected));
        // A coupled solve uses the memory of its guess.
        let guess = Bytes::list::<Traceless>(if self.model.is_coupled() { 0.0 } else { owned });
        // Slip modes and what the solve makes of them.
        let slip = Bytes::list::<[f64; 16]>(if self.model.has_slip() { owned } else { 0.0 });
        let loads = forces.then(Bytes::list::<[Vector; 2]>(owned)).then(slip);
        let solve = match self.near_field() {
            Some(range) => solve_bytes(&self.far, self.expected, range).or(self.far.solve()),
            None => self.far.solve(),
        };
        let random = Bytes::list::<[f64; AMBIENT_NUMBERS]>(self.random_vectors() * owned);
        let solve = solve.or(random.freed());
        let evaluation = Particles::migration_bytes(owned).freed().or(loads.then(guess).then(solve).freed());
        let [lists, approach] = self.approach();
        lists.then(evaluation.or(approach))
    }

    /// Variable steps examine pairs with gaps up to a radius: memory of their neighbour lists, which persist, and of
    /// the pairs' relative motion.
    fn approach(&self) -> [Bytes; 2] {
        if matches!(self.model.integrator, Integrator::AdamsBashforth { .. }) {
            return [Bytes::default(); 2];
        }
        let distance = WATCHED * self.expected.largest_radius();
        let pairs = 0.5 * self.expected.owned() * self.expected.neighbours(distance);
        [
            NeighbourLists::bytes(distance, self.expected),
            self.near(distance).then(Bytes::list::<[[Vector; 4]; 2]>(pairs)).freed(),
        ]
    }

    fn report(&self) -> Bytes {
        self.near(self.gap_search()).freed()
    }

    fn is_first(&self) -> bool {
        self.rank_of.0 == 0
    }
}
