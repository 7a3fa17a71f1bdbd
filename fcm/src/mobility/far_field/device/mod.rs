//! Far field by the split method on a device.
//!
//! Loads and motions pass through the host in each evaluation, except in solves of a single rank. On several ranks each
//! has a device with a slab of the grid and the particles that reach into it; ranks exchange modes and sums through the
//! host.
//! The flow of degenerate quadrupoles, which a solve needs once, and that at points of the fluid are evaluated on the
//! host, by the same plan.

mod arrangement;
mod contacts;
mod coupled;
mod fluctuating;
mod images;
mod kept_lists;
mod present;
mod random_motions;
mod rigid;
mod steps;
mod tables;
#[cfg(test)]
mod tests;
mod vectors;

use crate::lanczos::DrawDiagnostics;
use crate::mobility::contacts::ContactFarField;
use crate::mobility::coupled::{
    ChangeLimits, ChangedSolution, CoupledFarField, CoupledProblem, CoupledResidual, CoupledSolution, HeldSprings,
    KnownSolution,
};
use crate::mobility::far_field::grid::GridFarField;
use crate::mobility::far_field::{FarField, FlowAtPoints, RigidFarField, RigidProblem, RigidSolution, SurfaceFarField};
use crate::mobility::fluctuating::FluctuatingFarField;
use crate::mobility::loads::{Loads, Motion, Output};
use crate::mobility::noise::NoiseRequest;
use crate::mobility::stepping::HeldSteps;
use crate::mobility::work::Work;
use crate::plan::Plan;
use crate::plan::device::number_of_card;
use domain::parallel::mapped;
use domain::{Halo, Particles, Partition, PeriodicBox, RemoteHolder, Tensor, Traceless, Units, Vector, sphere};
use gpu::{
    Cuda, Device, DeviceError, DeviceMotion, NearInput, NearTables, PairDraw, PeriodicPlaces, SplitFarField,
    SurfaceLaws,
};
use images::HostImages;
use kept_lists::KeptLists;
use present::{PresentLoads, grid_share};
use rigid::{ResidentProblem, ResidentSolution};
use std::cell::RefCell;
use std::rc::Rc;
use tables::PlanTables;
use vectors::SharedField;

/// Far field of a plan on a device, in internal units as those of [`GridFarField`].
pub(crate) struct DeviceFarField {
    plan: Plan,
    partition: Partition,
    units: Units,
    tables: PlanTables,
    split: SharedField,
    /// Columns of solutions.
    kept: Rc<KeptLists>,
    /// Place of each particle in the order of ids.
    places: Vec<u32>,
    /// Images in walls, if there are any.
    images: Option<HostImages>,
    particles: Particles,
    /// Copies of other ranks' particles.
    halo: Rc<Halo>,
    cell: PeriodicBox,
    /// The lattice of the grid on the device, in internal units.
    arranged: Option<PeriodicBox>,
    /// The same far field on the host, made when first needed, and whether its particles are those of the device.
    host: Option<(GridFarField, bool)>,
    work: Work,
    /// Largest resistance of a single sphere in a solve with near pairs.
    largest_resistance: f64,
    /// Force between surfaces in contact that is added to the loads of such a solve.
    largest_surface_force: f64,
}

/// Result of a device, whose failures end the run.
///
/// # Panics
/// If the device fails, as when its memory is full.
fn succeeded<T>(result: Result<T, DeviceError>) -> T {
    result.unwrap_or_else(|error| panic!("hydrodynamics.device \"gpu\" fails: {error}"))
}

/// A matrix row by row.
fn by_rows(matrix: &Tensor) -> [f64; 9] {
    matrix.transpose().to_cols_array()
}

/// Columns as a list of numbers in other units.
fn scaled<const N: usize>(columns: impl Iterator<Item = [f64; N]>, factor: f64) -> Vec<f64> {
    columns.flatten().map(|value| value * factor).collect()
}

impl DeviceFarField {
    /// Opens the card of this rank.
    pub fn new(plan: &Plan, partition: &Partition) -> Self {
        let number = succeeded(number_of_card(partition.comm()));
        Self::on(Box::new(succeeded(Cuda::open(number))), plan, partition)
    }

    /// On any device, of which each rank has one.
    pub fn on(device: Box<dyn Device>, plan: &Plan, partition: &Partition) -> Self {
        let units = plan.units();
        let own = plan.in_units(&units);
        let tables = PlanTables::new(&own);
        let split = succeeded(SplitFarField::new(device, tables.split(&own, grid_share(&own, partition))));
        let split = Rc::new(RefCell::new(split));
        Self {
            plan: plan.clone(),
            partition: partition.clone(),
            units,
            tables,
            kept: Rc::new(KeptLists::new(&split, &plan.radii, units.length)),
            places: Vec::new(),
            split,
            images: HostImages::new(&own, partition),
            particles: Particles::default(),
            halo: Rc::new(present::halo(plan, &units, partition, &own.cell(), &[])),
            cell: plan.cell(),
            arranged: None,
            host: None,
            work: Work::default(),
            largest_resistance: 0.0,
            largest_surface_force: 0.0,
        }
    }

    /// The far field on the host, of the same particles.
    fn host(&mut self) -> &mut GridFarField {
        let (plan, partition) = (&self.plan, &self.partition);
        let (host, is_arranged) = self.host.get_or_insert_with(|| (GridFarField::new(plan, partition), false));
        if !*is_arranged {
            host.arrange(&self.cell, &self.particles);
            *is_arranged = true;
        }
        host
    }

    /// Loads of the particles present in internal units. Collective.
    fn present(&self, loads: &Loads, kinds: [bool; 3]) -> PresentLoads {
        PresentLoads::new(loads, [self.units.force, self.units.torque()], kinds, &self.halo)
    }

    /// The back end itself, if one rank solves and adds up forces on its device: ranks with a device each do so
    /// together on the host.
    fn alone(&mut self) -> Option<&mut Self> {
        self.halo.is_alone().then_some(self)
    }

    /// Copies the tables of near pairs to the device, unless they are there.
    fn copy_near_tables(&mut self, tables: &dyn Fn() -> NearTables) {
        let mut split = self.split.borrow_mut();
        if !split.has_near_tables() {
            let tables = tables();
            succeeded(split.set_near_tables(&tables));
            self.largest_resistance = tables.resistances.iter().flatten().copied().fold(0.0, f64::max);
        }
    }

    /// Viscosity in internal units.
    fn viscosity(&self) -> f64 {
        self.plan.viscosity / self.units.viscosity
    }

    /// Largest load of a problem as a force, with those by which spheres resist the rates of strain.
    fn largest_of(&self, problem: &RigidProblem) -> f64 {
        let fastest = problem.strain_rates.iter().flat_map(|e| e.0).map(f64::abs).fold(0.0, f64::max);
        let radius = self.plan.radii.iter().copied().fold(0.0, f64::max);
        let resisted = sphere::strain_resistance(self.plan.viscosity, radius) * fastest;
        problem.loads.largest(self.units.length).max(resisted / self.units.length)
    }

    /// Adds evaluations to the work, if there are dipoles in the loads and gradients of the motions.
    fn note_evaluations(&mut self, count: u64, [has_dipoles, has_gradients]: [bool; 2]) {
        self.work.evaluations += count;
        self.work.transforms += count;
        self.work.particles_spread += count * self.particles.len() as u64;
        self.work.dipole_spreads += count * u64::from(has_dipoles);
        self.work.dipole_interpolations += count * u64::from(has_gradients);
        self.work.neighbours += count * self.split.borrow().neighbours() as u64;
        self.note_seconds();
    }

    fn note_seconds(&mut self) {
        let seconds = self.split.borrow().seconds();
        let own = &mut self.work.seconds;
        (own.spread, own.fft, own.interpolate) = (seconds.spread, seconds.transform, seconds.interpolate);
        (own.near, own.exchange) = (seconds.near, seconds.copies);
    }

    /// The motions that were requested, in the plan's units.
    fn motion(&self, of_device: &DeviceMotion) -> Motion {
        let (velocity, rate) = (self.units.velocity(), self.units.rate());
        let vectors = |values: &[f64], unit: f64| mapped(values.as_chunks().0, |&v| Vector::from_array(v) * unit);
        Motion {
            velocities: vectors(&of_device.velocities, velocity),
            angular_velocities: vectors(&of_device.angular_velocities, rate),
            strain_rates: mapped(of_device.strain_rates.as_chunks().0, |&e| Traceless(e) * rate),
        }
    }
}

impl FarField for DeviceFarField {
    fn arrange(&mut self, cell: &PeriodicBox, particles: &Particles) {
        self.arrange_in(cell, particles);
    }

    fn is_arranged(&self, cell: &PeriodicBox, particles: &Particles) -> bool {
        self.arranged.is_some() && self.cell == *cell && self.are_arranged(particles)
    }

    fn apply(&mut self, loads: &Loads, output: Output) -> Motion {
        let (kinds, largest) = loads.kinds_on_ranks(loads.largest(self.units.length), self.partition.comm());
        self.units = self.units.with_force(largest);
        let [forced, twisted, strained] = kinds;
        let dipoles = twisted || strained;
        let wanted = [output != Output::Gradients, output != Output::Velocities];
        let orders = self.tables.orders([forced, dipoles], wanted);
        let present = self.present(loads, kinds);
        let motion = succeeded(self.split.borrow_mut().apply(&present.lists(), &orders));
        self.note_evaluations(1, [dipoles, wanted[1]]);
        self.motion(&motion)
    }

    fn rigid(&mut self) -> Option<&mut dyn RigidFarField> {
        self.alone().map(|own| own as &mut dyn RigidFarField)
    }

    fn surface(&mut self) -> Option<&mut dyn SurfaceFarField> {
        self.alone().map(|own| own as &mut dyn SurfaceFarField)
    }

    fn coupled(&mut self) -> Option<&mut dyn CoupledFarField> {
        self.alone().map(|own| own as &mut dyn CoupledFarField)
    }

    fn fluctuating(&mut self) -> Option<&mut dyn FluctuatingFarField> {
        self.alone().map(|own| own as &mut dyn FluctuatingFarField)
    }

    fn contacts(&mut self) -> Option<&mut dyn ContactFarField> {
        self.alone().map(|own| own as &mut dyn ContactFarField)
    }

    fn apply_with_quadrupoles(&mut self, loads: &Loads, quadrupoles: &[Vector]) -> Motion {
        self.host().apply_with_quadrupoles(loads, quadrupoles)
    }

    fn noise(&mut self, draw: &NoiseRequest) -> (Motion, DrawDiagnostics) {
        self.random_motion(draw)
    }

    fn flow(&mut self, loads: &Loads, quadrupoles: Option<&[Vector]>) -> Option<Box<dyn FlowAtPoints + '_>> {
        self.host().flow(loads, quadrupoles)
    }

    fn work(&self) -> Work {
        self.work
    }
}

impl RigidFarField for DeviceFarField {
    fn solve(&mut self, problem: &RigidProblem) -> RigidSolution {
        let RigidProblem { loads, strain_rates, comm, limits } = problem;
        let own_radii = self.plan.radii.iter().map(|radius| radius / self.units.length);
        let resistances: Vec<f64> = own_radii.map(|a| sphere::strain_resistance(self.viscosity(), a)).collect();
        self.units = self.units.with_force(self.largest_of(problem));
        let kinds = [!loads.forces.is_empty(), !loads.torques.is_empty(), !loads.stresslets.is_empty()];
        let present = self.present(loads, kinds);
        let own_rates = scaled(strain_rates.iter().map(|e| e.0), 1.0 / self.units.rate());
        let orders = [kinds[0], false].map(|has_forces| self.tables.orders([has_forces, true], [true, true]));
        let resident = ResidentProblem {
            loads: present.lists(),
            strain_rates: &own_rates,
            resistances: &resistances,
            orders,
            comm,
            limits: *limits,
        };
        let ResidentSolution { motion, stresslets, outcome } = rigid::solve(&self.split, &resident);
        self.note_evaluations(1 + outcome.iterations as u64, [true; 2]);
        let stresslets = stresslets.as_chunks().0.iter().map(|&s| Traceless(s) * self.units.torque()).collect();
        RigidSolution { motion: self.motion(&motion), stresslets, outcome }
    }
}

impl SurfaceFarField for DeviceFarField {
    fn forces(&mut self, laws: &SurfaceLaws) -> Vec<Vector> {
        let forces = succeeded(self.split.borrow_mut().surface_forces(laws));
        mapped(forces.as_chunks().0, |&force| Vector::from_array(force))
    }
}

impl CoupledFarField for DeviceFarField {
    fn assemble(&mut self, tables: &dyn Fn() -> NearTables, input: &NearInput, springs: &HeldSprings) -> [usize; 2] {
        self.copy_near_tables(tables);
        self.largest_surface_force = input.surface.map_or(0.0, SurfaceLaws::largest);
        let predicted = springs.predicted.as_ref().map(|predicted| self.predicted(predicted));
        let input = NearInput { are_touching: springs.are_touching, predicted, ..*input };
        succeeded(self.split.borrow_mut().assemble_near(&input))
    }

    fn random_loads(&mut self, tables: &dyn Fn() -> NearTables, particles: &Particles, seed: u64) -> Vec<f64> {
        self.copy_near_tables(tables);
        let inverse = 1.0 / self.units.length;
        let frame = self.tables.frame(&self.cell.scaled(inverse));
        let fractions = frame.all_fractions(&mapped(&particles.positions, |&x| x * inverse));
        let (ids, fractions, steps) = (&particles.ids[..], fractions.as_flattened(), &particles.steps[..]);
        let places = Some(PeriodicPlaces { fractions, steps });
        let draw = PairDraw { ids, places, seed, factor: 1.0, given: None };
        let mut split = self.split.borrow_mut();
        let list = succeeded(split.random_pair_loads(&draw));
        let loads = succeeded(split.values_of(&list));
        split.release(&list);
        loads
    }

    fn in_flow(&mut self) -> Vec<[f64; 11]> {
        succeeded(self.split.borrow_mut().near_in_flow()).as_chunks().0.to_vec()
    }

    fn solve(&mut self, problem: &CoupledProblem) -> CoupledSolution {
        self.solve_coupled(problem)
    }

    fn residual(&mut self, known: &KnownSolution) -> CoupledResidual {
        self.coupled_residual(known)
    }

    fn changed(&mut self, known: &KnownSolution, change: &ChangeLimits) -> ChangedSolution {
        self.change_coupled(known, change)
    }

    fn holder(&self) -> Rc<dyn RemoteHolder> {
        Rc::clone(&self.kept) as Rc<dyn RemoteHolder>
    }

    fn steps(&self) -> Rc<dyn HeldSteps> {
        Rc::clone(&self.kept) as Rc<dyn HeldSteps>
    }
}
