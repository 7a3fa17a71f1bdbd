//! Part of the flow on the grid: spreading, Stokes solve, interpolation.

use super::operator::{interpolated_volume, lattice, operator, unit_volume};
use crate::envelope::{Envelope, Source};
use crate::grid::gaussian::{self, Gaussians, Sources, Terms};
use crate::grid::interpolate::{GridMotions, Interpolation};
use crate::grid::kernel::{Kernel, Load};
use crate::grid::spread::Spread;
use crate::grid::stencil::{Stencil, sorted_stencils};
use crate::grid::window::{self, Windowed};
use crate::mobility::loads::Output;
use crate::mobility::noise::Stream;
use crate::mobility::work::{Stopwatch, Work};
use crate::plan::Plan;
use domain::parallel::{MeasuredLoop, change, of_rows, stage};
use domain::{Boundaries, Partition, PeriodicBox, Tensor, Vector};
use rayon::prelude::*;
use solver::{Field, Grid, Physical, Real, Stokes, Transform};
use std::borrow::Cow;
use std::marker::PhantomData;

/// Loads of the particles present: one force, one dipole and one degenerate quadrupole per particle, or an empty list
/// of either.
#[derive(Clone, Copy)]
pub(crate) struct GridLoads<'a> {
    pub classes: &'a [u32],
    pub forces: &'a [Vector],
    pub dipoles: &'a [Tensor],
    /// Degenerate quadrupoles, on all ranks or none.
    pub quadrupoles: Option<&'a [Vector]>,
}

/// Part on the grid, in the precision that the plan chose.
pub(crate) trait GridPart {
    /// Sets the box and the positions of the particles present.
    fn arrange(&mut self, cell: &PeriodicBox, positions: &[Vector]);

    /// Velocities and velocity gradients of the particles present: the contributions of this rank's share of the
    /// grid.
    fn motions(&mut self, loads: &GridLoads, output: Output, work: &mut Work) -> GridMotions;

    /// Takes the memory of motions that are no longer needed, for the next ones.
    fn reuse(&mut self, motions: GridMotions);
}

/// Grid with a flow.
pub(crate) trait FlowGrid: GridPart {
    /// Velocity field of the loads on the grid, without interpolation.
    fn solve(&mut self, loads: &GridLoads, work: &mut Work);

    /// Velocities of the last field at points of the fluid, in a box that is not periodic along all axes: the
    /// contributions of this rank's share of the grid. The envelope of a point has the transform 1; the grid carries
    /// the part that is common to all envelopes.
    fn velocities_at(&mut self, cell: &PeriodicBox, points: &[Vector]) -> Vec<Vector>;

    /// Random velocities and velocity gradients, or velocities alone, whose covariance is the mobility on the
    /// grid: the contributions of this rank's share of the grid.
    fn noise(&mut self, classes: &[u32], output: Output, stream: Stream) -> GridMotions;

    /// Velocity field of the last evaluation on this rank, `[component][z][y][x]`, x fastest.
    fn velocity_field(&self) -> Vec<f64>;

    /// Largest `|k . u| / (|k| |u|)` of the last velocity field, which it overwrites; see [`solver::divergence`].
    fn divergence(&mut self) -> f64;
}

/// Grid of one precision. Vectors and tensors on the grid have components along the box's axes, see
/// [`PeriodicBox`]; loads and motions have Cartesian components in space.
pub(crate) struct SpectralGrid<T: Real> {
    pub(super) plan: Plan,
    partition: Partition,
    pub(super) grid: Grid,
    pub(super) transform: Transform<T>,
    operator: Stokes<T>,
    pub(super) field: Field<T, Physical>,
    /// Divergence of the last velocity field, which computing it overwrites.
    divergence: Option<f64>,
    kernels: SpreadingKernels<T>,
    /// Spreading kernels of points of the fluid, made when first needed.
    point_kernels: Option<SpreadingKernels<T>>,
    stencils: Vec<Stencil>,
    /// Memory of the next motions.
    spare: GridMotions,
}

/// Functions on the grid: the envelopes themselves, or a window.
enum SpreadingKernels<T> {
    Gaussian(gaussian::GaussianLattice),
    Window(window::WindowLattice<T>),
}

impl<T: Real> SpectralGrid<T> {
    pub fn new(plan: &Plan, partition: &Partition, cell: &PeriodicBox) -> Self {
        let grid = Grid::new(plan.grid, lattice(plan, cell)).expect("a plan has a grid that can be transformed");
        let grid = if plan.is_reduced() { grid.reduced() } else { grid };
        let transform = Transform::new(grid.points(), partition, plan.support.lanes);
        let field = transform.field();
        Self {
            plan: plan.clone(),
            partition: partition.clone(),
            operator: operator(plan, &grid, partition),
            kernels: SpreadingKernels::new(plan, &grid),
            grid,
            transform,
            field,
            divergence: None,
            point_kernels: None,
            stencils: Vec::new(),
            spare: GridMotions::default(),
        }
    }

    fn spread(&mut self, loads: &GridLoads, work: &mut Work) {
        let (force, dipole) = (|r: usize| loads.forces.get(r), |r: usize| loads.dipoles.get(r));
        let quadrupole = |r: usize| loads.quadrupoles.and_then(|all| all.get(r)).copied().unwrap_or_default();
        let (no_force, no_dipole) = (Vector::ZERO, Tensor::ZERO);
        let axes = self.grid.cell().axes();
        let load = |r: usize| {
            let (force, dipole) = (*force(r).unwrap_or(&no_force), dipole(r).unwrap_or(&no_dipole));
            let vectors = [force, quadrupole(r)];
            axes.map_or_else(
                || Load::new(vectors, dipole),
                |axes| Load::new(vectors.map(|v| axes.transpose() * v), &(axes.transpose() * *dipole * *axes)),
            )
        };
        let all: Vec<Load<T>> = (0..loads.classes.len()).into_par_iter().map(load).measured().collect();
        let is_loaded = |stencil: &Stencil| {
            let row = stencil.row as usize;
            force(row).is_some_and(|f| *f != no_force)
                || dipole(row).is_some_and(|g| *g != no_dipole)
                || quadrupole(row) != no_force
        };
        let loaded = if self.stencils.par_iter().measured().all(is_loaded) {
            Cow::Borrowed(&self.stencils)
        } else {
            Cow::Owned(self.stencils.iter().filter(|place| is_loaded(place)).copied().collect())
        };
        work.particles_spread += loaded.len() as u64;
        work.dipole_spreads += u64::from(!loads.dipoles.is_empty());
        let spread = Spread { stencils: &loaded, classes: loads.classes, loads: &all, period: self.plan.grid[2] };
        let terms = [!loads.forces.is_empty(), !loads.dipoles.is_empty(), loads.quadrupoles.is_some()];
        self.kernels.with(terms, SpreadTask { spread, field: &mut self.field });
    }

    fn interpolate(&mut self, classes: &[u32], output: Output) -> GridMotions {
        let mut motions = std::mem::take(&mut self.spare);
        let to = Interpolation { stencils: &self.stencils, classes, volume: self.interpolated_volume() };
        let terms = [output != Output::Gradients, output != Output::Velocities, false];
        self.kernels.with(terms, InterpolationTask { to, field: &self.field, motions: &mut motions });
        if let Some(axes) = self.grid.cell().axes() {
            let out = |(velocity, gradient): &mut (Vector, Tensor)| {
                *velocity = *axes * *velocity;
                *gradient = *axes * *gradient * axes.transpose();
            };
            motions.par_iter_mut().measured().for_each(out);
        }
        motions
    }

    /// Spreads degenerate quadrupoles without windows: each by two forces with envelopes of their own.
    fn spread_quadrupoles(&mut self, classes: &[u32], quadrupoles: &[Vector]) {
        let spheres = self.plan.grid_envelopes();
        let sources: Vec<Envelope> = spheres.iter().flat_map(|sphere| sphere.quadrupole().envelopes()).collect();
        let kernels = self.kernels.with_envelopes(&self.plan, &self.grid, &sources);
        let axes = self.grid.cell().axes();
        let load = |row: usize| {
            let force = quadrupoles[row / 2] * spheres[classes[row / 2] as usize].quadrupole().weight;
            let force = axes.map_or(force, |axes| axes.transpose() * force);
            Load::new([if row.is_multiple_of(2) { force } else { -force }, Vector::ZERO], &Tensor::ZERO)
        };
        let loads: Vec<Load<T>> = of_rows(2 * classes.len(), load);
        let classes = of_rows(loads.len(), |row| 2 * classes[row / 2] + (row % 2) as u32);
        let placed = &self.stencils;
        let stencil = |k: usize| Stencil { row: 2 * placed[k / 2].row + (k % 2) as u32, ..placed[k / 2] };
        let stencils = of_rows(2 * placed.len(), stencil);
        let spread = Spread { stencils: &stencils, classes: &classes, loads: &loads, period: self.plan.grid[2] };
        kernels.with([true, false, false], SpreadTask { spread, field: &mut self.field });
    }

    /// Velocity field of what is spread.
    fn transform(&mut self) {
        self.transform.apply(&mut self.field, &self.operator);
        self.divergence = None;
    }

    /// Volume of a grid point by which interpolation multiplies.
    fn interpolated_volume(&self) -> f64 {
        interpolated_volume(&self.plan, &self.grid)
    }

    fn evaluate(&mut self, loads: &GridLoads, output: Output, work: &mut Work) -> GridMotions {
        self.solve(loads, work);
        let (mut clock, _stage) = (Stopwatch::start(), stage("interpolation"));
        let motions = self.interpolate(loads.classes, output);
        clock.stop(&mut work.seconds.interpolate);
        work.dipole_interpolations += u64::from(output != Output::Velocities);
        motions
    }
}

/// Places of kernels of some extent in a box that is not periodic along all axes.
///
/// # Panics
/// If a window wraps around the grid along such an axis: the result would not have a small error but be nonsense.
pub(super) fn bounded_stencils(
    plan: &Plan,
    grid: &Grid,
    extent: [usize; 3],
    cell: &PeriodicBox,
    positions: &[Vector],
) -> Vec<Stencil> {
    let first = cell.origin() + plan.first_point();
    let positions: Vec<Vector> = positions.iter().map(|&position| position - first).collect();
    let found = sorted_stencils(grid, extent, &positions);
    for axis in (0..3).filter(|&axis| !plan.boundaries.is_periodic(axis)) {
        let is_open = plan.boundaries == Boundaries::Open;
        let last = plan.grid[axis] / if is_open { 2 } else { 1 } - extent[axis];
        let is_whole = found.iter().all(|place| place.first[axis] as usize <= last);
        assert!(is_whole, "a sphere is outside of a box that does not repeat along its axis {axis}");
    }
    found
}

/// Operation that is generic over the kernel.
trait WithKernel<T: Real> {
    fn run<K: Kernel<T>>(self, kernel: &K);
}

struct SpreadTask<'a, T: Real> {
    spread: Spread<'a, T>,
    field: &'a mut Field<T, Physical>,
}

impl<T: Real> WithKernel<T> for SpreadTask<'_, T> {
    fn run<K: Kernel<T>>(self, kernel: &K) {
        self.spread.run(kernel, self.field);
    }
}

struct InterpolationTask<'a, T: Real> {
    to: Interpolation<'a>,
    field: &'a Field<T, Physical>,
    motions: &'a mut GridMotions,
}

impl<T: Real> WithKernel<T> for InterpolationTask<'_, T> {
    fn run<K: Kernel<T>>(self, kernel: &K) {
        self.to.run(kernel, self.field, self.motions);
    }
}

impl<T: Real> SpreadingKernels<T> {
    fn new(plan: &Plan, grid: &Grid) -> Self {
        Self::for_envelopes(plan, grid, &plan.grid_envelopes())
    }

    /// Spreading kernels of the plan's spheres, or of other envelopes that share its common Gaussian.
    fn for_envelopes(plan: &Plan, grid: &Grid, envelopes: &[Envelope]) -> Self {
        match (plan.window(), plan.common()) {
            (Some(window), Some(common)) => Self::Window(window::WindowLattice::new(grid, window, common, envelopes)),
            _ => Self::gaussian(plan, grid, envelopes),
        }
    }

    fn gaussian(plan: &Plan, grid: &Grid, envelopes: &[Envelope]) -> Self {
        assert!(grid.cell().is_orthogonal(), "a plan for a tilted lattice has windows");
        let strain = grid.cell().strain();
        let sources =
            |e: &Envelope| Sources { monopole: Source::monopole(e.monopole), dipole: Source::dipole(e.dipole), strain };
        let sources = envelopes.iter().map(sources).collect();
        Self::Gaussian(gaussian::GaussianLattice::new::<T>(grid, plan.support, sources))
    }

    /// The same kernels for other envelopes, or on a grid that has been sheared.
    fn with_envelopes(&self, plan: &Plan, grid: &Grid, envelopes: &[Envelope]) -> Self {
        match (self, plan.common()) {
            (Self::Window(lattice), Some(common)) => Self::Window(lattice.with_envelopes(grid, common, envelopes)),
            _ => Self::gaussian(plan, grid, envelopes),
        }
    }

    /// Points of a stencil along each axis.
    fn extent(&self, plan: &Plan) -> [usize; 3] {
        let [y, z] = [plan.support.support; 2];
        match self {
            Self::Gaussian(_) => [plan.support.lanes, y, z],
            Self::Window(_) => [y, y, z],
        }
    }

    /// Runs an operation with the kernel for the terms that are present: forces, dipoles, and with windows degenerate
    /// quadrupoles.
    fn with<W: WithKernel<T>>(&self, [forces, dipoles, quadrupoles]: [bool; 3], what: W) {
        match self {
            Self::Gaussian(lattice) => match (forces, dipoles) {
                (true, true) => what.run(&Gaussians { lattice, shape: PhantomData::<Terms<true, true>> }),
                (false, true) => what.run(&Gaussians { lattice, shape: PhantomData::<Terms<false, true>> }),
                (_, false) => what.run(&Gaussians { lattice, shape: PhantomData::<Terms<true, false>> }),
            },
            Self::Window(lattice) => match lattice.order(forces, dipoles).max(if quadrupoles { 2 } else { 0 }) {
                0 => what.run(&Windowed::<T, 0>(lattice)),
                1 => what.run(&Windowed::<T, 1>(lattice)),
                2 => what.run(&Windowed::<T, 2>(lattice)),
                _ => what.run(&Windowed::<T, 3>(lattice)),
            },
        }
    }
}

impl<T: Real> GridPart for SpectralGrid<T> {
    fn arrange(&mut self, cell: &PeriodicBox, positions: &[Vector]) {
        if cell.boundaries() != Boundaries::Periodic {
            let extent = self.kernels.extent(&self.plan);
            self.stencils = bounded_stencils(&self.plan, &self.grid, extent, cell, positions);
            return;
        }
        if cell != self.grid.cell() {
            self.grid = self.grid.in_cell(*cell);
            self.operator = operator(&self.plan, &self.grid, &self.partition);
            self.kernels = self.kernels.with_envelopes(&self.plan, &self.grid, &self.plan.grid_envelopes());
        }
        self.stencils = sorted_stencils(&self.grid, self.kernels.extent(&self.plan), positions);
    }

    fn motions(&mut self, loads: &GridLoads, output: Output, work: &mut Work) -> GridMotions {
        let Some(quadrupoles) = loads.quadrupoles.filter(|_| !matches!(self.kernels, SpreadingKernels::Window(_)))
        else {
            return self.evaluate(loads, output, work);
        };
        let mut motions = self.evaluate(&GridLoads { quadrupoles: None, ..*loads }, output, work);
        let mut clock = Stopwatch::start();
        self.spread_quadrupoles(loads.classes, quadrupoles);
        clock.stop(&mut work.seconds.spread);
        self.transform();
        clock.stop(&mut work.seconds.fft);
        work.transforms += 1;
        let others = self.interpolate(loads.classes, output);
        change(&mut motions, &others, |sum, other| *sum = (sum.0 + other.0, sum.1 + other.1));
        clock.stop(&mut work.seconds.interpolate);
        motions
    }

    fn reuse(&mut self, motions: GridMotions) {
        self.spare = motions;
    }
}

impl<T: Real> FlowGrid for SpectralGrid<T> {
    fn solve(&mut self, loads: &GridLoads, work: &mut Work) {
        let (mut clock, mut stage) = (Stopwatch::start(), stage("spreading"));
        self.spread(loads, work);
        clock.stop(&mut work.seconds.spread);
        stage.next("transforms");
        self.transform();
        clock.stop(&mut work.seconds.fft);
        work.transforms += 1;
    }

    fn velocities_at(&mut self, cell: &PeriodicBox, points: &[Vector]) -> Vec<Vector> {
        let (plan, grid, volume) = (&self.plan, &self.grid, self.interpolated_volume());
        let stencils = bounded_stencils(plan, grid, self.kernels.extent(plan), cell, points);
        let kernels =
            self.point_kernels.get_or_insert_with(|| SpreadingKernels::for_envelopes(plan, grid, &[Envelope::POINT]));
        let to = Interpolation { stencils: &stencils, classes: &vec![0; points.len()], volume };
        let mut motions = GridMotions::default();
        kernels.with([true, false, false], InterpolationTask { to, field: &self.field, motions: &mut motions });
        motions.into_iter().map(|motion| motion.0).collect()
    }

    fn noise(&mut self, classes: &[u32], output: Output, stream: Stream) -> GridMotions {
        let volume = self.interpolated_volume();
        self.field = self.transform.noise(&self.operator, volume, &stream);
        self.divergence = None;
        self.interpolate(classes, output)
    }

    fn velocity_field(&self) -> Vec<f64> {
        assert!(self.divergence.is_none(), "the velocity field was used up by its divergence");
        let over = 1.0 / unit_volume(&self.plan, &self.grid).powi(2);
        let mut values: Vec<f64> = self.field.to_vec().into_iter().map(|value| value.to_f64() * over).collect();
        if let Some(axes) = self.grid.cell().axes() {
            let points = values.len() / 3;
            for point in 0..points {
                let place = [0, 1, 2].map(|component| component * points + point);
                let out = *axes * Vector::from_array(place.map(|at| values[at]));
                place.into_iter().zip(out.to_array()).for_each(|(at, value)| values[at] = value);
            }
        }
        values
    }

    fn divergence(&mut self) -> f64 {
        *self.divergence.get_or_insert_with(|| {
            self.field.clear_halo();
            solver::divergence(&self.grid, &mut self.transform, &mut self.field, self.partition.comm())
        })
    }
}
