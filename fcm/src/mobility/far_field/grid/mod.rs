//! Far field by a grid, alone or split between grid and pairs.

mod flow;
mod fluctuations;
mod moments;
pub(super) mod operator;
mod potential_grid;
mod quadrupoles;
mod spectral_grid;

use crate::envelope::{Common, Envelope};
use crate::lanczos::DrawDiagnostics;
use crate::mobility::far_field::{FarField, FlowAtPoints};
use crate::mobility::loads::{Loads, Motion, Output, angular_velocity, dipole};
use crate::mobility::noise::NoiseRequest;
use crate::mobility::work::{Stopwatch, Work};
use crate::pairs::pair_correction::{DynPairCorrection, LoadedParticles, PairCorrection};
use crate::pairs::radial_functions::Envelopes;
use crate::pairs::table::PairFunctions;
use crate::plan::Plan;
use crate::plan::problem::Precision;
use crate::walls::wall_images::WallImages;
use domain::parallel::{FusedLoops, all_rows, greatest, stage};
use domain::{Halo, LocalAndGhosts, Particles, Partition, PeriodicBox, Tensor, Traceless, Units, Vector, VerletList};
pub(crate) use moments::MomentFarField;
use solver::Real;
use spectral_grid::{FlowGrid, GridLoads, GridPart, SpectralGrid};

/// Far field of a plan with a grid: of the flow, or of moments.
///
/// Internally, units of length and viscosity make those of the plan about 1, and in each evaluation a unit of force
/// makes the loads about 1. The units are powers of two, so results have the same digits in any units, and the same
/// bits if the units differ by powers of two.
pub(crate) struct GridFarField<G: GridPart + ?Sized = dyn FlowGrid> {
    plan: Plan,
    /// Units of length and viscosity, and of force in the last evaluation.
    units: Units,
    partition: Partition,
    grid: Box<G>,
    near: Option<Box<dyn DynPairCorrection>>,
    /// Pair correction of degenerate quadrupoles, made when first needed.
    near_quadrupoles: Option<Box<dyn DynPairCorrection>>,
    wall_images: Option<WallImages>,
    arrangement: ArrangedParticles,
    has_arranged: bool,
    verlet_list: VerletList,
    work: Work,
}

/// Quantities that depend on the positions alone, in internal units.
struct ArrangedParticles {
    cell: PeriodicBox,
    halo: Halo,
    positions: Vec<Vector>,
    classes: Vec<u32>,
}

impl GridFarField {
    /// Sets up the mobility of a plan, on ranks that share the grid by `partition`.
    pub fn new(plan: &Plan, partition: &Partition) -> Self {
        let own = plan.in_units(&plan.units());
        let (grid, near) = match plan.precision {
            Precision::Single => parts::<f32>(&own, partition),
            Precision::Double => parts::<f64>(&own, partition),
        };
        Self::of_parts(plan, partition, grid, near)
    }
}

impl<G: GridPart + ?Sized> GridFarField<G> {
    /// Sets up a grid with the near field that belongs to it.
    fn of_parts(plan: &Plan, partition: &Partition, grid: Box<G>, near: Option<Box<dyn DynPairCorrection>>) -> Self {
        let units = plan.units();
        let own = plan.in_units(&units);
        let cell = own.cell();
        let arrangement = ArrangedParticles {
            cell,
            halo: Halo::plan(partition, &cell, &[], [0.0; 2]),
            positions: Vec::new(),
            classes: Vec::new(),
        };
        let verlet_list = VerletList::new(own.cutoff(), partition);
        Self {
            plan: plan.clone(),
            units,
            partition: partition.clone(),
            grid,
            near,
            near_quadrupoles: None,
            wall_images: WallImages::new(&own),
            arrangement,
            has_arranged: false,
            verlet_list,
            work: Work::default(),
        }
    }

    /// Whether there are forces, torques and stresslets on any rank; sets the unit of force by the largest of them
    /// and of degenerate quadrupoles. Collective.
    fn kinds_of(&mut self, loads: &Loads, quadrupoles: &[Vector]) -> [bool; 3] {
        let of_quadrupoles = greatest(quadrupoles, |h| h.abs().max_element()) / self.units.length.powi(2);
        let own = loads.largest(self.units.length).max(of_quadrupoles);
        let (kinds, largest) = loads.kinds_on_ranks(own, self.partition.comm());
        self.units = self.units.with_force(largest);
        kinds
    }

    /// Forces and dipoles of all particles present, in internal units.
    fn present(&self, loads: &Loads, [forced, twisted, strained]: [bool; 3]) -> (Vec<Vector>, Vec<Tensor>) {
        let [of_force, of_dipole] = [self.units.force, self.units.torque()].map(|unit| 1.0 / unit);
        let torque = |i: usize| loads.torques.get(i).copied().unwrap_or_default();
        let stresslet = |i: usize| loads.stresslets.get(i).copied().unwrap_or_default();
        let dipole = |i: usize| dipole(stresslet(i), torque(i)) * of_dipole;
        let (mut forces, mut dipoles, halo) = (Vec::new(), Vec::new(), &self.arrangement.halo);
        let (owned, has_dipoles) = (halo.owned(), twisted || strained);
        let mut loops = FusedLoops::default();
        loops.mapped(&mut forces, &loads.forces, move |&force| force * of_force);
        loops.of_rows(&mut dipoles, if has_dipoles { owned } else { 0 }, dipole);
        loops.run();
        if forced {
            halo.extend(&mut forces);
        }
        if has_dipoles {
            halo.extend(&mut dipoles);
        }
        (forces, dipoles)
    }

    /// Velocities and gradients that loads cause, and degenerate quadrupoles if there are any on any rank, in internal
    /// units. Collective.
    fn motions(&mut self, loads: &Loads, quadrupoles: Option<&[Vector]>, output: Output) -> Vec<(Vector, Tensor)> {
        self.work.evaluations += 1;
        let (mut clock, mut stage) = (Stopwatch::start(), stage("exchange"));
        let kinds = self.kinds_of(loads, quadrupoles.unwrap_or_default());
        let (forces, dipoles) = self.present(loads, kinds);
        let quadrupoles = quadrupoles.map(|all| self.present_quadrupoles(all));
        clock.stop(&mut self.work.seconds.exchange);
        let arrangement = &self.arrangement;
        let grid_loads = GridLoads { quadrupoles: quadrupoles.as_deref(), ..arrangement.grid_loads(&forces, &dipoles) };
        let mut motions = self.grid.motions(&grid_loads, output, &mut self.work);
        clock.restart();
        arrangement.collect(&mut motions);
        clock.stop(&mut self.work.seconds.exchange);
        if let Some(near) = &self.near {
            let gradients = output != Output::Velocities || !dipoles.is_empty();
            let loaded = arrangement.loaded(&forces, &dipoles);
            let neighbours = self.verlet_list.neighbours();
            stage.next("pair corrections");
            near.add(&loaded, neighbours, gradients, &mut motions);
            let of_quadrupoles = quadrupoles.as_deref().map(|quadrupoles| arrangement.loaded(quadrupoles, &[]));
            if let Some((near, loaded)) = self.near_quadrupoles.as_ref().zip(of_quadrupoles.as_ref()) {
                near.add(loaded, neighbours, gradients, &mut motions);
            }
            if let Some(images) = &self.wall_images {
                stage.next("images in walls");
                images.add(&loaded, gradients, &mut motions);
                if let Some(loaded) = &of_quadrupoles {
                    images.add_of_quadrupoles(loaded, &mut motions);
                }
            }
            self.work.neighbours += neighbours.count() as u64;
            clock.stop(&mut self.work.seconds.near);
        }
        motions
    }

    /// [`FarField::arrange`].
    pub fn arrange_particles(&mut self, cell: &PeriodicBox, particles: &Particles) {
        let (mut clock, mut stage) = (Stopwatch::start(), stage("arrangement"));
        let inverse = 1.0 / self.units.length;
        let (cell, plan) = (&cell.scaled(inverse), &self.plan);
        let (mut present, mut classes) = (Vec::new(), Vec::new());
        let mut loops = FusedLoops::default();
        loops.mapped(&mut present, &particles.positions, move |&position| position * inverse);
        loops.mapped(&mut classes, &particles.radii, |&radius| plan.class_of(radius));
        loops.run();
        let owned = present.len();
        let cutoff = self.near.as_ref().map_or(0.0, |near| near.cutoff());
        let reach = plan.stencil_reach(cell, &self.units).map(|stencil| stencil.max(cutoff));
        let halo = Halo::plan(&self.partition, cell, &present, reach);
        halo.extend(&mut present);
        halo.extend(&mut classes);
        clock.stop(&mut self.work.seconds.exchange);
        stage.next("stencils");
        self.grid.arrange(cell, &present);
        clock.stop(&mut self.work.seconds.spread);
        stage.next("neighbour lists");
        if self.near.is_some() {
            let ids = halo.extended(&particles.ids);
            self.verlet_list.update(cell, &LocalAndGhosts { owned, ids: &ids, positions: &present });
            self.work.searches = self.verlet_list.searches();
        }
        self.arrangement = ArrangedParticles { cell: *cell, halo, positions: present, classes };
        self.has_arranged = true;
        if let Some(images) = &mut self.wall_images {
            stage.next("lists of images in walls");
            images.arrange(&self.arrangement.loaded(&[], &[]), self.verlet_list.neighbours(), owned);
        }
        clock.stop(&mut self.work.seconds.near);
    }

    /// [`FarField::is_arranged`].
    pub fn has_arranged(&self, cell: &PeriodicBox, particles: &Particles) -> bool {
        let (inverse, known) = (1.0 / self.units.length, &self.arrangement);
        let (plan, positions, classes) = (&self.plan, &known.positions, &known.classes);
        let is_same = |row: usize| {
            particles.positions[row] * inverse == positions[row] && plan.class_of(particles.radii[row]) == classes[row]
        };
        let is_like = self.has_arranged && known.halo.owned() == particles.len() && known.cell == cell.scaled(inverse);
        is_like && all_rows(particles.len(), is_same)
    }

    /// Work done so far.
    pub fn work(&self) -> Work {
        self.work
    }
}

impl FarField for GridFarField {
    fn arrange(&mut self, cell: &PeriodicBox, particles: &Particles) {
        self.arrange_particles(cell, particles);
    }

    fn is_arranged(&self, cell: &PeriodicBox, particles: &Particles) -> bool {
        self.has_arranged(cell, particles)
    }

    fn apply(&mut self, loads: &Loads, output: Output) -> Motion {
        let motions = self.motions(loads, None, output);
        let _stage = stage("exchange");
        let found = motion(&motions, output, &self.units);
        self.grid.reuse(motions);
        found
    }

    fn apply_with_quadrupoles(&mut self, loads: &Loads, quadrupoles: &[Vector]) -> Motion {
        let motions = self.motions(loads, Some(quadrupoles), Output::All);
        let found = motion(&motions, Output::All, &self.units);
        self.grid.reuse(motions);
        found
    }

    fn noise(&mut self, draw: &NoiseRequest) -> (Motion, DrawDiagnostics) {
        self.random_motion(draw)
    }

    fn flow(&mut self, loads: &Loads, quadrupoles: Option<&[Vector]>) -> Option<Box<dyn FlowAtPoints + '_>> {
        self.near.is_some().then(|| Box::new(self.flow_of(loads, quadrupoles)) as Box<dyn FlowAtPoints>)
    }

    fn velocity_field(&self) -> Option<Vec<f64>> {
        let unit = self.units.velocity();
        Some(self.grid.velocity_field().into_iter().map(|value| value * unit).collect())
    }

    fn divergence(&mut self) -> Option<f64> {
        Some(self.grid.divergence())
    }

    fn work(&self) -> Work {
        self.work
    }
}

/// Grid of a plan, and near field if it has one, in one precision.
fn parts<T: Real>(plan: &Plan, partition: &Partition) -> (Box<dyn FlowGrid>, Option<Box<dyn DynPairCorrection>>) {
    let grid = Box::new(SpectralGrid::<T>::new(plan, partition, &plan.cell()));
    (grid, near::<T>(plan, PairFunctions::new))
}

/// Near field of a plan, if it has one, by the functions of two envelopes.
fn near<T: Real>(
    plan: &Plan,
    functions: fn(Envelope, Envelope, Common) -> PairFunctions,
) -> Option<Box<dyn DynPairCorrection>> {
    let common = plan.common()?;
    let all = plan.radii.iter().map(|&radius| Envelope::of_sphere(radius)).collect();
    let (envelopes, tolerance) = (Envelopes { all, common, functions }, plan.table_tolerance());
    Some(Box::new(PairCorrection::<T>::new(envelopes, plan.cutoff(), plan.viscosity, tolerance)))
}

impl ArrangedParticles {
    /// Loads of the particles present, for the grid.
    fn grid_loads<'a>(&'a self, forces: &'a [Vector], dipoles: &'a [Tensor]) -> GridLoads<'a> {
        GridLoads { classes: &self.classes, forces, dipoles, quadrupoles: None }
    }

    /// The particles present with their loads, for the near field.
    fn loaded<'a>(&'a self, forces: &'a [Vector], dipoles: &'a [Tensor]) -> LoadedParticles<'a> {
        LoadedParticles { cell: &self.cell, positions: &self.positions, classes: &self.classes, forces, dipoles }
    }

    /// Returns the sums that ranks made for each other's particles to the owners.
    fn collect(&self, motions: &mut Vec<(Vector, Tensor)>) {
        if self.halo.is_alone() {
            return;
        }
        let mut velocities: Vec<Vector> = motions.iter().map(|m| m.0).collect();
        self.halo.collect(&mut velocities);
        motions.iter_mut().zip(velocities).for_each(|(motion, velocity)| motion.0 = velocity);
        let mut gradients: Vec<Tensor> = motions.iter().map(|m| m.1).collect();
        self.halo.collect(&mut gradients);
        motions.iter_mut().zip(gradients).for_each(|(motion, gradient)| motion.1 = gradient);
        motions.truncate(self.halo.owned());
    }
}

/// The motions that were requested, in the plan's units.
fn motion(motions: &[(Vector, Tensor)], output: Output, units: &Units) -> Motion {
    let (velocity, rate) = (units.velocity(), units.rate());
    let (mut motion, mut loops) = (Motion::default(), FusedLoops::default());
    if output != Output::Gradients {
        loops.mapped(&mut motion.velocities, motions, move |m| m.0 * velocity);
    }
    if output != Output::Velocities {
        loops.mapped(&mut motion.angular_velocities, motions, move |m| angular_velocity(&m.1) * rate);
        loops.mapped(&mut motion.strain_rates, motions, move |m| Traceless::part_of(&m.1) * rate);
    }
    loops.run();
    motion
}
