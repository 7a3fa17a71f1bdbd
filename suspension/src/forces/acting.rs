//! Input and output of forces.

use crate::flow::periodic_cell::PeriodicCell;
use crate::neighbourhood::{NeighbourLists, PairsWithHalo};
use domain::parallel::RowLists;
use domain::{DomainView, Particles, Traceless, Vector};
use fcm::{Loads, Motion};
use hydrodynamics::{BondSprings, ContactSprings, HeldFluctuations, HeldForces, TetherResistance};
use lubrication::PairKind;

/// Particles of a rank at one time.
#[derive(Clone, Copy)]
pub struct Configuration<'a> {
    /// The particles.
    pub particles: &'a Particles,
    /// Box and partition.
    pub domain: DomainView<'a>,
    /// Pairs within the longest range of all forces; `None` if no force asks for pairs.
    pub near: Option<&'a PairsWithHalo>,
    /// Time.
    pub time: f64,
    /// Neighbour lists.
    pub(crate) lists: &'a NeighbourLists,
}

/// Particles at the time of an evaluation, for which a solve needs loads.
pub struct Instant<'a> {
    /// The particles, in whose columns a force may keep its history.
    pub particles: &'a mut Particles,
    /// Box and partition.
    pub domain: DomainView<'a>,
    /// Pairs within the longest range of all forces; `None` if no force asks for pairs.
    pub near: Option<&'a PairsWithHalo>,
    /// Time.
    pub time: f64,
    /// Predicted motion, if forces are taken implicitly.
    pub prediction: Option<&'a Prediction<'a>>,
    /// Time since the last stored solution.
    pub since_last_solution: f64,
    /// Motions of the previous solution relative to the background flow, if a force follows them.
    pub previous: &'a Motion,
    /// Background flow.
    pub(crate) flow: &'a PeriodicCell,
    /// Neighbour lists.
    pub(crate) lists: &'a NeighbourLists,
}

impl Instant<'_> {
    /// The particles as they are.
    pub fn configuration(&self) -> Configuration<'_> {
        let Self { particles, domain, near, time, lists, .. } = self;
        Configuration { particles, domain: *domain, near: *near, time: *time, lists }
    }
}

/// Predicted motion of the particles over a time, for forces at its end.
pub struct Prediction<'a> {
    /// Length of time.
    pub time: f64,
    /// Predicted velocities relative to the background flow.
    pub velocities: &'a [Vector],
    /// Predicted angular velocities relative to the background flow; empty without bonds that resist bending.
    pub angular_velocities: &'a [Vector],
    /// Strain rate of a linear flow that these velocities include.
    pub strain_rate: Traceless,
}

/// Motions of a solution.
pub struct SolvedMotion<'a> {
    /// Motions of this rank's particles relative to the background flow.
    pub motion: &'a Motion,
    /// Box and partition.
    pub domain: DomainView<'a>,
    /// Whether forces were taken implicitly.
    pub is_implicit: bool,
    /// Whether the rate of the flow follows from a stress.
    pub is_stress_controlled: bool,
}

/// Everything by which forces enter a solve.
#[derive(Default)]
pub struct Acting {
    /// Forces and torques on this rank's particles.
    pub loads: Loads,
    /// Implicit resistances.
    pub resistances: Resistances,
    /// Motions of the ambient fluid at the particles, such as slip; empty lists stand for none. Lubrication takes no
    /// account of them: it resists motions relative to the background flow.
    pub ambient: Motion,
    /// Random motions and loads, in place of these, of particles that move where the far field is evaluated.
    pub fluctuations: Option<HeldFluctuations>,
    /// Implicit forces and contacts, in place of all others, of such particles.
    pub held_forces: Option<HeldForces>,
}

/// Resistance, force over velocity, of two particles or of a particle and a wall, as a function of the distance.
pub type ResistanceFunction = Box<dyn Fn(f64, PairKind) -> f64 + Send + Sync>;

/// Implicit resistances of all forces.
#[derive(Default)]
pub struct Resistances {
    pairs: Vec<ResistanceFunction>,
    /// Resistances of contacts, particle by particle.
    pub contacts: RowLists<ContactSprings>,
    /// Resistances of bonds and traps.
    pub tethers: TetherResistance,
}

impl Resistances {
    /// Adds a resistance to the separation of any two particles, and of particles and walls.
    pub fn add_pairs(&mut self, resistance: ResistanceFunction) {
        self.pairs.push(resistance);
    }

    /// Adds resistances of bonds, particle by particle.
    pub fn add_bonds(&mut self, bonds: RowLists<BondSprings>) {
        let all = &mut self.tethers.bonds;
        if all.rows() == 0 {
            *all = bonds;
            return;
        }
        let joined = |row: usize, list: &mut Vec<_>| list.extend([&*all, &bonds].into_iter().flat_map(|of| of.of(row)));
        *all = RowLists::of_rows(bonds.rows().max(all.rows()), joined);
    }

    /// The sum of the functions of pairs at a distance.
    pub fn of_pair(&self, distance: f64, between: PairKind) -> f64 {
        self.pairs.iter().map(|resistance| resistance(distance, between)).reduce(|sum, more| sum + more).unwrap_or(0.0)
    }

    /// Adds resistances of traps.
    pub fn add_traps(&mut self, traps: Vec<f64>) {
        let all = &mut self.tethers.traps;
        all.resize(traps.len().max(all.len()), 0.0);
        all.iter_mut().zip(traps).for_each(|(all, trap)| *all += trap);
    }
}
