//! Contacts of spheres that move on a card, which an emulator stands for, against those of the host, number by number.

use super::super::forcing::ContactForcing;
use super::super::history::{CONTACTS, FOUND};
use super::super::*;
use super::motion;
use crate::flow::periodic_cell::PeriodicCell;
use crate::model::{Protocol, ShearRates};
use crate::neighbourhood::NeighbourLists;
use domain::{Boundaries, Column, Comm, Partition, PeriodicBox, Random, RemoteList, Traceless, Units, Vector};
use fcm::{
    Costs, Fixed, Loading, Method, Mobility, Motion, MovingFlow, Multipoles, Plan, Precision, Problem, StressletSolver,
};
use gpu::Emulator;
use hydrodynamics::{CoupledSolver, HeldContacts, ShortRange};
use lubrication::Elasticity;
use simulation::Clock;
use std::ops::Range;

/// Number of spheres.
const COUNT: usize = 90;

/// Radii, in a unit of length that is not that of solves, and viscosity.
const RADII: [f64; 2] = [5.0, 6.5];
const VISCOSITY: f64 = 3.0;

/// Time to which normal forces are predicted, and that since the last solution.
const TIMES: [f64; 2] = [0.07, 0.1];

/// Spheres in a sheared box, of which many overlap.
struct Crowd {
    cell: PeriodicBox,
    flow: PeriodicCell,
    law: Contact,
    slots: usize,
}

/// Loads and states of contacts after two substeps: forces, torques, and ten numbers a slot.
struct States {
    loads: Vec<f64>,
    found: Vec<f64>,
}

impl Crowd {
    fn new(law: Contact) -> Self {
        let cell = PeriodicBox::sheared(Vector::new(48.0, 45.0, 42.0), 0.3).unwrap();
        let rates = ShearRates::new(0.4, Protocol::STEADY, TIMES[1]);
        let flow = PeriodicCell::at(&Clock::at(0, TIMES[1]), cell, rates, false);
        Self { cell, flow, law, slots: 30 }
    }

    /// Spheres at the start of a substep.
    fn spheres(&self, substep: u64) -> Particles {
        let mut particles = Particles::default();
        for k in 0..COUNT as u64 {
            let moved = (Random::new(8 + substep, k).point() - Vector::splat(0.5)) * (0.3 * substep as f64);
            let position = self.cell.wrap(Random::new(3, k).point() * self.cell.edges() + moved).0;
            let class = u32::from(k.is_multiple_of(3));
            particles.push(3 * k + 5, position, RADII[class as usize], class);
        }
        particles
    }

    /// By the host; substeps may have predictions.
    fn on_host(&self, are_predicted: [bool; 2]) -> States {
        let (partition, lists) = (Partition::new(&Comm::alone(), [8, 8]), NeighbourLists::default());
        let domain = DomainView { cell: &self.cell, partition: &partition };
        let (mut loads, mut history) = (Loads::default(), None);
        for (substep, is_predicted) in (0..).zip(are_predicted) {
            let (mut particles, velocities) = (self.spheres(substep), motion(10 + substep, COUNT).velocities);
            particles.columns.extend(history.take());
            let prediction = Prediction {
                time: TIMES[0],
                velocities: &velocities,
                angular_velocities: &[],
                strain_rate: Traceless::default(),
            };
            let at = Instant {
                particles: &mut particles,
                domain,
                near: None,
                time: 0.0,
                prediction: Some(&prediction).filter(|_| is_predicted),
                since_last_solution: TIMES[1],
                previous: &motion(20 + substep, COUNT),
                flow: &self.flow,
                lists: &lists,
            };
            let near = lists.near(at.particles, domain, self.law.reach([RADII[1]; 2]));
            let touching = AllTouching::of(&self.law, at.particles, &self.cell, near);
            let forcing = ContactForcing::new(&self.law, touching, &at);
            loads = Loads::default();
            forcing.add_to(&mut loads);
            forcing.note(&mut particles, self.slots, &forcing.ends(&motion(30 + substep, COUNT))).unwrap();
            history = particles.columns.into_iter().find(|column| column.name == FOUND);
            history = history.map(|column| Column { name: CONTACTS.to_owned(), ..column });
        }
        let rows = loads.forces.iter().zip(&loads.torques);
        let loads = rows.flat_map(|(force, torque)| [force.to_array(), torque.to_array()]).flatten().collect();
        States { loads, found: history.unwrap().values.to_vec() }
    }

    fn solver(&self, seed: u64) -> CoupledSolver {
        let plan = Plan::choose(&Problem {
            edges: self.cell.edges(),
            boundaries: Boundaries::Periodic,
            volume: self.cell.volume(),
            shortest_vector: Problem::shortest_vector_of(&self.cell),
            smallest_edge_ratio: 1.0,
            largest_strain: self.cell.strain(),
            largest_tilts: [0.0; 2],
            radii: RADII.map(|radius| (radius, COUNT)).to_vec(),
            viscosity: VISCOSITY,
            multipoles: Multipoles::Dipole,
            rigid: true,
            lubricated: false,
            loading: Loading::Varied,
            tolerance: 1e-2,
            threads: 1,
            ranks: 1,
            costs: Costs::default(),
            network: None,
            fixed: Fixed { precision: Some(Precision::Single), method: Some(Method::Split), ..Fixed::default() },
        });
        let plan = plan.unwrap();
        let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
        let device = Box::new(Emulator::beside_program(&[], seed).unwrap());
        let far = StressletSolver::of(Mobility::on(device, &plan, &partition), partition.comm());
        CoupledSolver::of(far, &partition, ShortRange::default()).unwrap()
    }

    /// By a card whose threads have a seed.
    fn on_card(&self, are_predicted: [bool; 2], seed: u64) -> States {
        let (mut solver, flow, mut history) = (self.solver(seed), *self.flow.flow(), None);
        let mut loads = Vec::new();
        for (substep, is_predicted) in (0..).zip(are_predicted) {
            let mut particles = self.spheres(substep);
            let positions = particles.positions.to_vec();
            particles.move_to(solver.holder().unwrap());
            let relative = motion(10 + substep, COUNT).velocities;
            let expected: Vec<Vector> = relative.iter().zip(positions).map(|(&v, x)| v + flow.velocity(x)).collect();
            let hold = |vectors: &[Vector]| solver.holder().unwrap().hold(bytemuck::cast_slice(vectors));
            let lists = |motion: Motion| [hold(&motion.velocities), hold(&motion.angular_velocities)];
            let (expected, previous, moved) =
                (hold(&expected), lists(motion(20 + substep, COUNT)), lists(motion(30 + substep, COUNT)));
            let contacts = HeldContacts {
                law: &self.law,
                slots: self.slots,
                times: if is_predicted { TIMES } else { [0.0; 2] },
                expected: Some(&expected).filter(|_| is_predicted),
                history: history.as_ref(),
                previous: Some(previous.each_ref()),
                flow: MovingFlow::carrying(flow),
            };
            solver.hold_loads(&Loads::default(), &particles);
            let held = solver.contact_loads(&self.cell, &particles, &contacts).unwrap();
            loads = copied(&solver, held.list().unwrap());
            let ends = solver.contact_ends(moved.each_ref(), &contacts);
            history = ends.remote_list().cloned();
        }
        // Of torques.
        let unit = Units::of(VISCOSITY, RADII).torque();
        loads.as_chunks_mut::<6>().0.iter_mut().for_each(|load| load[3..].iter_mut().for_each(|t| *t *= unit));
        States { loads, found: copied(&solver, &history.unwrap()) }
    }
}

impl States {
    fn slots(&self) -> &[[f64; CONTACT_NUMBERS]] {
        self.found.as_chunks().0
    }

    /// Some numbers of all slots.
    fn numbers(&self, numbers: &Range<usize>) -> Vec<f64> {
        self.slots().iter().flat_map(|slot| slot[numbers.clone()].to_vec()).collect()
    }
}

fn copied(solver: &CoupledSolver, list: &RemoteList) -> Vec<f64> {
    solver.holder().unwrap().copies(&[list]).remove(0)
}

/// Without rolling resistance, and with it and a critical load.
fn laws() -> [Contact; 2] {
    let law = Contact {
        friction: 0.02,
        roughness: 0.05,
        stiffness: 7.0,
        tangential_ratio: 0.4,
        rolling_friction: 0.0,
        critical_load: 0.0,
        elasticity: Elasticity::Linear,
    };
    [law, Contact { rolling_friction: 0.02, critical_load: 30.0, elasticity: Elasticity::Hertz, ..law }]
}

/// Some numbers differ from others by less than a part of the largest.
fn are_close(found: &[f64], exact: &[f64]) {
    let largest = exact.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    assert!(found.len() == exact.len() && largest > 0.1, "{} and {} numbers", found.len(), exact.len());
    for (k, (found, exact)) in found.iter().zip(exact).enumerate() {
        assert!((found - exact).abs() < 1e-11 * largest, "number {k}: {found} and {exact}");
    }
}

/// After two substeps, in which contacts begin and end, stick, slide and roll, the last one with a prediction or
/// without.
#[test]
fn loads_and_states_are_those_of_the_host() {
    for (law, is_predicted) in [(laws()[0], true), (laws()[1], true), (laws()[1], false)] {
        let (crowd, are_predicted) = (Crowd::new(law), [true, is_predicted]);
        let (exact, found) = (crowd.on_host(are_predicted), crowd.on_card(are_predicted, 3));
        are_close(&found.loads, &exact.loads);
        let slots = exact.slots();
        let limited = |k: usize| slots.iter().filter(|slot| slot[k] < 1.0).count();
        let contacts = slots.iter().filter(|slot| slot[0] > 0.0).count();
        let slots = slots.len();
        for share in if law.rolling_friction > 0.0 { 8..10 } else { 8..9 } {
            let limited = limited(share) + contacts - slots;
            assert!(limited > 20 && limited + 20 < contacts, "{limited} of {contacts}");
        }
        for numbers in
            [0..1, 1..4, 4..7, 7..8, 8..10].into_iter().filter(|of| law.rolling_friction > 0.0 || of.start != 4)
        {
            are_close(&found.numbers(&numbers), &exact.numbers(&numbers));
        }
    }
}

/// Both spheres of a contact note the same bits with opposite forces, in any order of threads.
#[test]
fn both_spheres_note_the_same() {
    let crowd = Crowd::new(laws()[1]);
    let [one, other] = [1, 2].map(|seed| crowd.on_card([true; 2], seed));
    assert_eq!((&one.loads, &one.found), (&other.loads, &other.found));
    let mut contacts = 0;
    let of_row = |row: usize| &one.slots()[crowd.slots * row..][..crowd.slots];
    for row in 0..COUNT {
        for slot in of_row(row).iter().take_while(|slot| slot[0] > 0.0) {
            let (id, other) = (3 * row + 5, (slot[0] as usize - 6) / 3);
            let seen = of_row(other).iter().find(|seen| seen[0] as usize == id + 1).unwrap();
            assert_eq!((seen[1..4].to_vec(), &seen[4..]), (slot[1..4].iter().map(|f| -f).collect(), &slot[4..]));
            contacts += 1;
        }
    }
    assert!(contacts > COUNT);
}
