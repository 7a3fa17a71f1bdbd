//! The contacts of many spheres, on any number of threads.

mod on_device;

use super::history::FOUND;
use super::*;
use crate::flow::periodic_cell::PeriodicCell;
use crate::model::{Flow, Parameters, Protocol, ShearRates, Species};
use domain::{Boundaries, Comm, Partition, PeriodicBox, Random, Traceless, Vector};
use fcm::Motion;
use simulation::Clock;

/// Number of spheres: several batches of each loop.
const COUNT: usize = 1500;

/// Time of a substep.
const STEP: f64 = 0.1;

/// Everything that follows from the contacts of a rank.
#[derive(Debug, PartialEq)]
struct Found {
    loads: [Vec<Vector>; 2],
    springs: RowLists<hydrodynamics::ContactSprings>,
    states: Vec<f64>,
    shear_moment: f64,
    statistics: ContactStatistics,
    forces: Vec<[f64; FORCE_NUMBERS]>,
}

/// Spheres at random positions, many of which overlap.
fn spheres(edges: Vector) -> Particles {
    let mut particles = Particles::default();
    for id in 0..COUNT as u64 {
        let radius = if id.is_multiple_of(3) { 1.3 } else { 1.0 };
        particles.push(id, Random::new(3, id).point() * edges, radius, usize::from(id.is_multiple_of(3)) as u32);
    }
    particles
}

fn random(seed: u64, count: usize) -> Vec<Vector> {
    (0..count as u64).map(|id| Random::new(seed, id).point() - Vector::splat(0.5)).collect()
}

fn motion(seed: u64, count: usize) -> Motion {
    let [velocities, angular_velocities] = [seed, seed + 1].map(|seed| random(seed, count));
    Motion { velocities, angular_velocities, strain_rates: Vec::new() }
}

fn contacts(cell: PeriodicBox, particles: &Particles) -> Contacts {
    let species = [("small", 1.0, COUNT - COUNT / 3), ("large", 1.3, COUNT / 3)];
    let species = species.map(|(name, radius, count)| Species::new(name, radius, count as u64));
    let usual = Parameters::new(cell, 1.0, species.to_vec(), STEP, 1);
    let law =
        crate::model::Contacts { rolling_friction: 0.2, stiffness: Some(50.0), ..crate::model::Contacts::new(0.5) };
    let hydrodynamics = crate::model::Hydrodynamics { lubrication: true, ..crate::model::Hydrodynamics::default() };
    let integrator = crate::model::Integrator::Implicit(crate::model::Adaptive::UNLIMITED);
    let flow = Flow::Shear { rate: 0.4, lees_edwards: true };
    let model = Model::new(Parameters { contacts: Some(law), hydrodynamics, integrator, flow, ..usual }).unwrap();
    assert_eq!(particles.len(), COUNT);
    Contacts::of(&model).unwrap().between(&Radii::of_model(&model).unwrap())
}

/// The contacts of a second substep, with the friction of a first one, in a box with the given boundaries.
fn found(boundaries: Boundaries) -> Found {
    let edges = Vector::new(30.0, 28.0, 26.0);
    let (periodic, comm) = (PeriodicBox::new(edges).unwrap(), Comm::alone());
    let cell = periodic.with_boundaries(boundaries).unwrap();
    let flow = PeriodicCell::at(&Clock::at(0, STEP), cell, ShearRates::new(0.4, Protocol::STEADY, STEP), false);
    let partition = Partition::new(&comm, [8, 8]);
    let (domain, lists) = (DomainView { cell: &cell, partition: &partition }, NeighbourLists::default());
    let mut particles = spheres(edges);
    let mut contacts = contacts(periodic, &particles);
    let mut acting = Acting::default();
    let mut states = Vec::new();
    for substep in 0..2 {
        let (velocities, previous) = (random(10 + substep, COUNT), motion(20 + substep, COUNT));
        let prediction = Prediction {
            time: STEP,
            velocities: &velocities,
            angular_velocities: &[],
            strain_rate: Traceless::default(),
        };
        let mut at = Instant {
            particles: &mut particles,
            domain,
            near: None,
            time: 0.0,
            prediction: Some(&prediction),
            since_last_solution: STEP,
            previous: &previous,
            flow: &flow,
            lists: &lists,
        };
        contacts.add_loads(&mut at, &mut acting).unwrap();
        let motion = &motion(30 + substep, COUNT);
        let solved = SolvedMotion { motion, domain, is_implicit: true, is_stress_controlled: true };
        contacts.solved(&mut particles, &solved).unwrap();
        states = particles.column(FOUND, 0).values.to_vec();
        keep(&mut particles);
    }
    Found {
        loads: [acting.loads.forces, acting.loads.torques],
        springs: acting.resistances.contacts,
        states,
        shear_moment: contacts.shear_moment,
        statistics: contacts.measured(&particles, domain, &lists),
        forces: contacts.forces(&particles, domain, &lists),
    }
}

/// Also the contacts of spheres and walls, and those across the faces of the box.
#[test]
fn contacts_have_the_same_bits_on_any_threads() {
    for boundaries in [Boundaries::Periodic, Boundaries::Walls] {
        let [alone, others @ ..] = [1, 2, 5].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| found(boundaries))
        });
        let [each, frictional, sliding, ..] = alone.statistics.numbers(&Comm::alone());
        assert!(each > 1.0 && frictional > 0.5 && sliding > 0.1, "{each} {frictional} {sliding}");
        assert!(others.iter().all(|other| *other == alone), "{boundaries:?}");
    }
}
