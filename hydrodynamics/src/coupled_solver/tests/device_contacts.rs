//! Contacts and implicit repulsion of spheres that move on a card, which an emulator stands for, against the host's
//! solve with springs.

use super::on_device::{Suspension, columns, emulator, relative};
use super::*;
use crate::coupled_solver::{HeldContacts, TooManyContacts};
use crate::pairs::surface_laws::TakenForce;
use crate::solution::{HeldForces, HeldPrediction};
use crate::springs::{ContactSprings, TetherResistance};
use domain::parallel::RowLists;
use domain::{Random, RemoteList};
use fcm::{HeldLoads, Method, Mobility, MovingFlow, StressletSolver};
use gpu::{Counted, Device, contact_bytes};
use lubrication::{Barrier, Contact, Elasticity, PairKind, SurfaceForce};
use solver::BackgroundFlow;

/// Times of predictions along the line of centres and across, in the units of a case.
const TIMES: [f64; 2] = [0.02, 0.03];

/// Slots of a particle.
const SLOTS: usize = 12;

/// Spheres in contact in a sheared box, with forces between their surfaces.
struct Touching {
    suspension: Suspension,
    range: Option<LubricationRange>,
    law: Contact,
    forces: Vec<TakenForce>,
    /// The flow in which spheres move, and the part of it that expected velocities contain.
    moving: MovingFlow,
    /// Units of length and viscosity; the unit of force is 1.
    units: Units,
}

/// An image of another sphere as seen by a sphere: its row, and the vector to it.
struct Image {
    other: usize,
    separation: Vector,
}

fn random(count: usize, seed: u64) -> Vec<Vector> {
    (0..count as u64).map(|row| Random::new(seed, row).point() - Vector::splat(0.5)).collect()
}

impl Suspension {
    /// The same in other units of length and viscosity.
    fn in_units(self, units: &Units) -> Self {
        let Self { cell, mut particles, plan } = self;
        let cell = cell.scaled(units.length);
        particles.positions.iter_mut().for_each(|x| *x *= units.length);
        particles.radii.iter_mut().for_each(|a| *a *= units.length);
        particles.wrap(&cell);
        let radii: Vec<f64> = plan.radii.iter().map(|a| a * units.length).collect();
        let fixed = Fixed {
            precision: Some(plan.precision),
            method: Some(Method::Split),
            iteration_tolerance: Some(plan.iteration_tolerance),
            ..Fixed::default()
        };
        let of_cell = Problem {
            edges: cell.edges(),
            volume: cell.volume(),
            shortest_vector: Problem::shortest_vector_of(&cell),
            largest_strain: cell.strain(),
            viscosity: units.viscosity,
            fixed,
            ..problem(cell.edges().x, &radii, 1e-3, 1e-6)
        };
        Self { cell, particles, plan: Plan::choose(&of_cell).unwrap() }
    }
}

impl Touching {
    fn new(precision: Precision, iteration: f64, is_lubricated: bool, elasticity: Elasticity) -> Self {
        let full = |edge: f64| PeriodicBox::sheared(Vector::splat(0.894 * edge), 0.3).unwrap();
        // No sphere is near two images of another: the host's contacts have the ids of the others.
        Self::of(Suspension::of(28, full, precision, iteration), is_lubricated, elasticity, Units::ONE)
    }

    /// Spheres that are given in units of 1, in others.
    fn of(mut suspension: Suspension, is_lubricated: bool, elasticity: Elasticity, units: Units) -> Self {
        if units != Units::ONE {
            suspension = suspension.in_units(&units);
        }
        let count = suspension.particles.len() as u64;
        suspension.particles.ids = (0..count).map(|row| 3 * row + 5).collect();
        let barrier = SurfaceForce::Barrier(Barrier::new(30.0, 0.5).unwrap());
        let screened = SurfaceForce::Screened { strength: 20.0, radius_power: 0, length: 0.05 * units.length };
        let explicit = SurfaceForce::Screened { strength: 9.0, radius_power: 0, length: 0.04 * units.length };
        let forces = [(barrier, true), (screened, true), (explicit, false)];
        let law = Contact {
            friction: 0.5,
            roughness: 0.3,
            stiffness: 150.0 / units.length.powi(2),
            tangential_ratio: 0.4,
            rolling_friction: 0.3,
            critical_load: 0.0,
            elasticity,
        };
        let flow = BackgroundFlow::shear(0.8 * units.rate());
        Self {
            suspension,
            // It ends at smaller gaps than springs.
            range: is_lubricated.then(|| LubricationRange::new(0.3, 1e-5).unwrap()),
            law,
            forces: forces.map(|(force, is_implicit)| TakenForce { force, is_implicit }).to_vec(),
            moving: MovingFlow::carrying(flow),
            units,
        }
    }

    fn count(&self) -> usize {
        self.suspension.particles.len()
    }

    fn solver(&self, device: Option<Box<dyn Device>>) -> CoupledSolver {
        let Suspension { plan, .. } = &self.suspension;
        let partition = self.suspension.partition();
        let short_range = ShortRange { lubrication: self.range, springs: Some(3.2 * 1.25 * self.units.length) };
        match device {
            Some(device) => {
                let far = StressletSolver::of(Mobility::on(device, plan, &partition), partition.comm());
                CoupledSolver::of(far, &partition, short_range).unwrap()
            }
            None => CoupledSolver::new(plan, &partition, short_range).unwrap(),
        }
    }

    /// Images of other spheres within reach of a sphere.
    fn images(&self, row: usize) -> Vec<Image> {
        let Suspension { cell, particles, .. } = &self.suspension;
        let steps = (0..27).map(|k| [k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1]);
        let at = |steps: [i32; 3]| {
            (0..self.count()).map(move |other| {
                let separation = particles.positions[other] + cell.lattice(steps) - particles.positions[row];
                Image { other, separation }
            })
        };
        steps.flat_map(at).filter(|image| image.separation.length() > 0.0).collect()
    }

    fn between(&self, row: usize, image: &Image) -> [f64; 2] {
        [row, image.other].map(|row| self.suspension.particles.radii[row])
    }

    fn times(&self) -> [f64; 2] {
        TIMES.map(|time| time / self.units.rate())
    }

    /// Expected velocities relative to the flow.
    fn expected(&self) -> Vec<Vector> {
        random(self.count(), 4).into_iter().map(|v| v * self.units.velocity()).collect()
    }

    /// Loads besides those of contacts and surfaces.
    fn given(&self) -> Loads {
        let [forces, torques] = [8, 9].map(|seed| random(self.count(), seed));
        let torques = torques.into_iter().map(|torque| torque * self.units.torque()).collect();
        Loads { forces, torques, stresslets: Vec::new() }
    }

    /// Resistance of implicit forces between surfaces.
    fn surface_resistance(&self, distance: f64, between: [f64; 2]) -> f64 {
        let implicit = self.forces.iter().filter(|taken| taken.is_implicit);
        let gap = distance - between[0] - between[1];
        implicit.map(|taken| self.times()[0] * taken.force.stiffness(gap, between)).sum()
    }

    fn contact(&self, row: usize, image: &Image) -> Option<ContactSprings> {
        let (between, distance) = (self.between(row, image), image.separation.length());
        let overlap = self.law.overlap(distance, between);
        let [normal, tangential] = [
            self.times()[0] * self.law.normal_stiffness(overlap, between),
            self.times()[1] * self.law.tangential_stiffness(overlap, between),
        ];
        let other = self.suspension.particles.ids[image.other];
        let within = (1.0 + 1e-9) * distance;
        (overlap > 0.0).then_some(ContactSprings { other, within, normal, tangential, rolling: tangential })
    }

    /// All loads on the spheres at known velocities: those given, and forces of surfaces and contacts without friction
    /// at the start.
    fn known_loads(&self) -> Loads {
        let (mut loads, expected, strain) = (self.given(), self.expected(), self.moving.flow.strain_rate().tensor());
        for row in 0..self.count() {
            for image in self.images(row) {
                let (between, distance) = (self.between(row, &image), image.separation.length());
                let (axis, radii) = (image.separation / distance, between[0] + between[1]);
                let opening = axis.dot(expected[image.other] - expected[row]);
                for TakenForce { force, .. } in &self.forces {
                    loads.forces[row] += force.force(image.separation, between);
                }
                loads.forces[row] -= axis * (self.surface_resistance(distance, between) * opening);
                let Some(springs) = self.contact(row, &image) else { continue };
                let strained = strain * image.separation;
                let sheared = springs.tangential * (strained - axis * axis.dot(strained));
                let normal = self.law.force(self.law.overlap(distance, between), between) + springs.normal * opening;
                loads.forces[row] += sheared - normal * axis;
                loads.torques[row] += axis.cross(sheared) * (distance * between[0] / radii);
            }
        }
        loads
    }

    /// The solution of the host.
    fn exact(&self) -> Solution {
        let Suspension { cell, particles, .. } = &self.suspension;
        let resistance = |distance: f64, between: PairKind| match between {
            PairKind::Spheres(radii) => self.surface_resistance(distance, radii),
            PairKind::Wall(_) => 0.0,
        };
        let contacts = RowLists::of_rows(self.count(), |row, list| {
            list.extend(self.images(row).iter().filter_map(|image| self.contact(row, image)));
        });
        assert!(contacts.items().len() > self.count());
        let springs = Springs { resistance: &resistance, contacts: &contacts, tethers: &TetherResistance::default() };
        let loads = self.known_loads();
        let input = SolveInput { springs: Some(&springs), ..acting(&loads, self.moving.flow.strain_rate()) };
        self.solver(None).solve(cell, particles, &input, Guess::default()).unwrap()
    }
}

/// Spheres on a card, and lists that it holds.
struct OnCard<'a> {
    case: &'a Touching,
    solver: CoupledSolver,
    particles: Particles,
    expected: RemoteList,
}

impl<'a> OnCard<'a> {
    fn new(case: &'a Touching, device: Box<dyn Device>) -> Self {
        let (mut solver, mut particles) = (case.solver(Some(device)), case.suspension.particles.clone());
        assert!(solver.take_surface_forces(&case.forces));
        particles.move_to(solver.holder().unwrap());
        solver.hold_loads(&case.given(), &particles);
        let relative = case.expected().into_iter().zip(&case.suspension.particles.positions);
        let expected: Vec<Vector> = relative.map(|(v, &x)| v + case.moving.carried.velocity(x)).collect();
        let expected = solver.holder().unwrap().hold(bytemuck::cast_slice(&expected));
        Self { case, solver, particles, expected }
    }

    fn loads(&mut self, slots: usize) -> Result<HeldLoads, TooManyContacts> {
        let Self { case, solver, particles, expected } = self;
        let contacts = HeldContacts {
            law: &case.law,
            slots,
            times: case.times(),
            expected: Some(expected),
            history: None,
            previous: None,
            flow: case.moving,
        };
        solver.contact_loads(&case.suspension.cell, particles, &contacts)
    }

    /// A solution with all lists.
    fn solution(&mut self, forces: Option<&HeldForces>) -> Solution {
        let (none, Self { case, solver, particles, .. }) = (Loads::default(), self);
        let input = SolveInput {
            keeps_columns: true,
            moving_in: Some(case.moving),
            surface_forces: true,
            held_forces: forces,
            ..acting(&none, case.moving.flow.strain_rate())
        };
        let solution = solver.solve(&case.suspension.cell, particles, &input, Guess::default()).unwrap();
        let kept = solution.kept.clone().unwrap();
        let [.., velocities, rotations] = &kept.columns.guessed;
        let lists = [velocities, rotations].map(|values| values.remote_list().unwrap());
        let motions = solver.holder().unwrap().copies(&lists);
        let [velocities, angular_velocities] =
            [0, 1].map(|k| motions[k].as_chunks().0.iter().map(|&v| Vector::from_array(v)).collect());
        let solution = solver.with_lists(solution, particles);
        Solution { motion: Motion { velocities, angular_velocities, ..solution.motion }, ..solution }
    }

    /// The implicit solution, and the loads from which it follows.
    fn implicit(&mut self) -> (Solution, Vec<f64>) {
        let (loads, velocities) = (self.loads(SLOTS).unwrap(), self.expected.clone());
        let known = self.solver.holder().unwrap().copies(&[loads.list().unwrap()]).remove(0);
        let prediction = Some(HeldPrediction { time: self.case.times()[0], velocities });
        (self.solution(Some(&HeldForces { prediction, contacts: Some(loads) })), known)
    }
}

fn agree(case: &Touching, allowed: f64) {
    let exact = Touching { suspension: case.suspension.with_tolerance(1e-9), forces: case.forces.clone(), ..*case };
    let (exact, (found, _)) = (exact.exact(), OnCard::new(case, emulator(3)).implicit());
    for (kind, (found, exact)) in columns(&found).iter().zip(&columns(&exact)).enumerate() {
        let error = relative(found, exact);
        assert!(error < allowed, "numbers of kind {kind}: {error:e}");
    }
}

/// Also by expected velocities without those of a flow that advects positions.
#[test]
fn implicit_solutions_are_those_of_the_host() {
    for (is_lubricated, elasticity) in [(true, Elasticity::Linear), (false, Elasticity::Hertz)] {
        let case = Touching::new(Precision::Double, 1e-9, is_lubricated, elasticity);
        let carried = if is_lubricated { BackgroundFlow::NONE } else { case.moving.flow };
        agree(&Touching { moving: MovingFlow { carried, ..case.moving }, ..case }, 1e-7);
    }
}

/// In units of length and viscosity that are not those of solves.
#[test]
fn implicit_solutions_in_other_units_are_those_of_the_host() {
    let units = Units { length: 12.0, viscosity: 0.3, force: 1.0 };
    for elasticity in [Elasticity::Linear, Elasticity::Hertz] {
        let full = |edge: f64| PeriodicBox::sheared(Vector::splat(0.894 * edge), 0.3).unwrap();
        let suspension = Suspension::of(28, full, Precision::Double, 1e-9);
        agree(&Touching::of(suspension, true, elasticity, units), 1e-7);
    }
}

#[test]
fn implicit_solutions_in_single_precision_are_those_of_the_host() {
    agree(&Touching::new(Precision::Single, 1e-5, true, Elasticity::Hertz), 1e-4);
}

/// Two spheres that touch across a box as well, where the contacts differ. Their motions are those under the forces and
/// torques that the springs exert in these motions.
#[test]
fn images_have_their_own_springs() {
    let mut suspension = Suspension::of(2, |_| cube(4.4), Precision::Double, 1e-10);
    suspension.particles.positions[0] = Vector::new(0.3, 1.0, 2.0);
    suspension.particles.positions[1] = Vector::new(2.45, 1.1, 1.8);
    let case = Touching { forces: Vec::new(), ..Touching::of(suspension, false, Elasticity::Hertz, Units::ONE) };
    let (sprung, known) = OnCard::new(&case, emulator(5)).implicit();
    let (v, w) = (&sprung.motion.velocities, &sprung.motion.angular_velocities);
    let mut loads = Loads::default();
    for (row, known) in known.as_chunks::<6>().0.iter().enumerate() {
        let (mut force, mut torque) = (Vector::from_slice(known), Vector::from_slice(&known[3..]));
        let images = case.images(row);
        let touching = images.iter().filter_map(|image| Some((image, case.contact(row, image)?)));
        assert_eq!(touching.clone().count(), 2);
        for (image, springs) in touching {
            let (axis, other, arm) = (image.separation.normalize(), image.other, 0.5 * image.separation.length());
            let moved = v[other] - v[row];
            let opening = axis.dot(moved);
            let slip = springs.tangential * (moved - axis * opening - arm * (w[row] + w[other]).cross(axis));
            let rolling = springs.rolling * (w[other] - w[row]).cross(axis);
            force += springs.normal * opening * axis + slip;
            torque += axis.cross(arm * slip + rolling);
        }
        loads.forces.push(force);
        loads.torques.push(torque);
    }
    let mut free = OnCard::new(&case, emulator(5));
    let at_rest = free.solution(None);
    free.solver.hold_loads(&loads, &free.particles);
    let pushed = free.solution(None);
    for ((found, exact), at_rest) in columns(&sprung).iter().zip(&columns(&pushed)).zip(&columns(&at_rest)).take(2) {
        assert!(relative(found, exact) < 1e-8 && relative(at_rest, exact) > 0.1, "{found:?}, {exact:?}");
    }
}

/// Contacts take what the forecast has for them, which is without arguments, radii and sums.
#[test]
fn contacts_take_what_is_predicted() {
    let case = Touching::new(Precision::Single, 1e-2, false, Elasticity::Linear);
    let (device, counts) = Counted::new(emulator(1));
    let mut card = OnCard::new(&case, Box::new(device));
    card.solver.mobility().follow(&case.suspension.cell, &card.particles);
    let before = counts.borrow().memory[1];
    card.loads(SLOTS).unwrap();
    let (found, expected) = (counts.borrow().memory[1] - before, (case.count() * contact_bytes(SLOTS)) as u64);
    assert!((expected..expected + 500).contains(&found), "{found} bytes, {expected} expected");
}

/// Springs act in solves with a prediction alone, and solutions have the same bits in any order of threads.
#[test]
fn springs_end_with_the_prediction() {
    let case = Touching::new(Precision::Single, 1e-4, true, Elasticity::Linear);
    let [(first, loads), (second, others)] = [1, 2].map(|seed| {
        let mut card = OnCard::new(&case, emulator(seed));
        let before = card.solution(None);
        let implicit = card.implicit();
        assert_eq!(columns(&card.solution(None)), columns(&before));
        assert!(relative(&columns(&implicit.0)[0], &columns(&before)[0]) > 0.1);
        implicit
    });
    assert_eq!((columns(&first), loads), (columns(&second), others));
}

/// The one with the lowest id, as on the host.
#[test]
fn a_particle_with_too_many_contacts_is_named() {
    let case = Touching::new(Precision::Single, 1e-2, false, Elasticity::Linear);
    let contacts = |row| case.images(row).iter().filter(|image| case.contact(row, image).is_some()).count();
    let counts: Vec<usize> = (0..case.count()).map(contacts).collect();
    let most = *counts.iter().max().unwrap();
    for slots in [1, most / 2, most - 1] {
        let row = counts.iter().position(|&count| count > slots).unwrap();
        let found = OnCard::new(&case, emulator(1)).loads(slots).map(drop);
        assert_eq!(found, Err(TooManyContacts { id: case.suspension.particles.ids[row] }));
    }
    OnCard::new(&case, emulator(2)).loads(most).unwrap();
}
