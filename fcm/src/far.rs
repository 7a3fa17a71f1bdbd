//! The far field: through the grid.

use crate::envelope::{Envelope, Source};
use crate::interpolate::Interpolation;
use crate::kernel::Lattice;
use crate::passes::passes;
use crate::plan::Plan;
use crate::problem::Method;
use crate::shape::{Load, Own, Sources, Wide};
use crate::spread::Spread;
use crate::stencil::{Place, Support, places};
use crate::work::{Clock, Work};
use domain::{Partition, PeriodicBox, Tensor, Vector};
use rayon::prelude::*;
use solver::{Field, Grid, Physical, Real, Stokes, Transform};
use std::borrow::Cow;

/// What particles apply: the forces and dipoles of all present, or none at all of a kind.
pub(crate) struct FarLoads<'a> {
    pub classes: &'a [u32],
    pub forces: &'a [Vector],
    pub dipoles: &'a [Tensor],
}

/// What is asked for of every particle present.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Wanted {
    Velocities,
    Gradients,
    Both,
}

/// The far field in whichever precision the plan chose.
pub(crate) trait FarField {
    /// Fixes the box and the positions of the particles present.
    fn arrange(&mut self, cell: &PeriodicBox, positions: &[Vector]);

    /// The velocities and velocity gradients, by what this rank's share of the grid adds to them.
    fn motions(&mut self, loads: &FarLoads, wanted: Wanted, work: &mut Work) -> Vec<(Vector, Tensor)>;

    /// The velocity field of the last evaluation on this rank, `[component][z][y][x]`, x fastest.
    fn velocity_field(&self) -> Vec<f64>;

    /// The largest `|k . u| / (|k| |u|)` of the last velocity field, see [`solver::divergence`].
    fn divergence(&mut self) -> f64;
}

/// A grid of values of one precision.
pub(crate) struct Far<T: Real> {
    plan: Plan,
    partition: Partition,
    grid: Grid,
    transform: Transform<T>,
    operator: Stokes<T>,
    field: Field<T, Physical>,
    lattice: Lattice,
    sources: Vec<Sources>,
    places: Vec<Place>,
}

impl<T: Real> Far<T> {
    pub fn new(plan: &Plan, partition: &Partition, cell: &PeriodicBox) -> Self {
        let grid = Grid::new(plan.grid, *cell).expect("a plan has a grid that can be transformed");
        let transform = Transform::new(grid.points(), partition, plan.support.lanes);
        let field = transform.field();
        let mut far = Self {
            plan: plan.clone(),
            partition: partition.clone(),
            operator: Stokes::new(&grid, plan.viscosity),
            lattice: lattice::<T>(&grid, plan.support),
            grid,
            transform,
            field,
            sources: Vec::new(),
            places: Vec::new(),
        };
        far.shear(cell);
        far
    }

    fn shear(&mut self, cell: &PeriodicBox) {
        self.grid = self.grid.in_cell(*cell);
        self.lattice = lattice::<T>(&self.grid, self.plan.support);
        self.operator = Stokes::new(&self.grid, self.plan.viscosity);
        let strain = cell.strain();
        let sources = |&radius: &f64| {
            let envelope = Envelope::of_sphere(radius);
            let [monopole, dipole] = match self.plan.method {
                Method::Direct => [envelope.monopole, envelope.dipole],
                Method::Split { width, .. } => [width; 2],
            };
            let monopole = Source::monopole(envelope.monopole, monopole);
            Sources { monopole, dipole: Source::dipole(envelope.dipole, dipole), strain }
        };
        self.sources = self.plan.radii.iter().map(sources).collect();
    }

    fn spread(&mut self, loads: &FarLoads, work: &mut Work) {
        let (force, dipole) = (|r: usize| loads.forces.get(r), |r: usize| loads.dipoles.get(r));
        let (no_force, no_dipole) = (Vector::ZERO, Tensor::ZERO);
        let load = |r: usize| Load::new(*force(r).unwrap_or(&no_force), dipole(r).unwrap_or(&no_dipole));
        let all: Vec<Load<T>> = (0..loads.classes.len()).into_par_iter().map(load).collect();
        let is_loaded = |place: &Place| {
            let row = place.row as usize;
            force(row).is_some_and(|f| *f != no_force) || dipole(row).is_some_and(|g| *g != no_dipole)
        };
        let loaded = if self.places.par_iter().all(is_loaded) {
            Cow::Borrowed(&self.places)
        } else {
            Cow::Owned(self.places.iter().filter(|place| is_loaded(place)).copied().collect())
        };
        work.particles_spread += loaded.len() as u64;
        let spread = Spread {
            places: &loaded,
            classes: loads.classes,
            sources: &self.sources,
            loads: &all,
            lattice: &self.lattice,
        };
        match (self.plan.method, loads.forces.is_empty(), loads.dipoles.is_empty()) {
            (Method::Split { .. }, _, true) => spread.run::<Wide<true, false>>(&mut self.field),
            (Method::Split { .. }, true, false) => spread.run::<Wide<false, true>>(&mut self.field),
            (Method::Split { .. }, false, false) => spread.run::<Wide<true, true>>(&mut self.field),
            (Method::Direct, _, true) => spread.run::<Own<true, false>>(&mut self.field),
            (Method::Direct, true, false) => spread.run::<Own<false, true>>(&mut self.field),
            (Method::Direct, false, false) => spread.run::<Own<true, true>>(&mut self.field),
        }
        work.dipole_spreads += u64::from(!loads.dipoles.is_empty());
    }

    fn interpolate(&self, classes: &[u32], wanted: Wanted) -> Vec<(Vector, Tensor)> {
        let to = Interpolation { places: &self.places, classes, sources: &self.sources, lattice: &self.lattice };
        match (self.plan.method, wanted) {
            (Method::Split { .. }, Wanted::Velocities) => to.run::<T, Wide<true, false>>(&self.field),
            (Method::Split { .. }, Wanted::Gradients) => to.run::<T, Wide<false, true>>(&self.field),
            (Method::Split { .. }, Wanted::Both) => to.run::<T, Wide<true, true>>(&self.field),
            (Method::Direct, Wanted::Velocities) => to.run::<T, Own<true, false>>(&self.field),
            (Method::Direct, Wanted::Gradients) => to.run::<T, Own<false, true>>(&self.field),
            (Method::Direct, Wanted::Both) => to.run::<T, Own<true, true>>(&self.field),
        }
    }

    fn evaluate(&mut self, loads: &FarLoads, wanted: Wanted, work: &mut Work) -> Vec<(Vector, Tensor)> {
        let mut clock = Clock::start();
        self.spread(loads, work);
        clock.stop(&mut work.seconds.spread);
        self.transform.apply(&mut self.field, &self.operator);
        clock.stop(&mut work.seconds.fft);
        let motions = self.interpolate(loads.classes, wanted);
        clock.stop(&mut work.seconds.interpolate);
        work.transforms += 1;
        work.dipole_interpolations += u64::from(wanted != Wanted::Velocities);
        motions
    }
}

fn lattice<T: Real>(grid: &Grid, support: Support) -> Lattice {
    let (points, spacing) = (grid.points(), grid.spacing());
    Lattice { points, spacing, support, passes: passes(&support, spacing, grid.cell().strain(), T::LANES) }
}

impl<T: Real> FarField for Far<T> {
    fn arrange(&mut self, cell: &PeriodicBox, positions: &[Vector]) {
        if cell != self.grid.cell() {
            self.shear(cell);
        }
        self.places = places(&self.grid, self.plan.support, positions);
    }

    fn motions(&mut self, loads: &FarLoads, wanted: Wanted, work: &mut Work) -> Vec<(Vector, Tensor)> {
        self.evaluate(loads, wanted, work)
    }

    fn velocity_field(&self) -> Vec<f64> {
        self.field.to_vec().into_iter().map(Real::to_f64).collect()
    }

    fn divergence(&mut self) -> f64 {
        let mut field = self.field.clone();
        field.clear_halo();
        let spectrum = self.transform.forward(field);
        solver::divergence(&self.grid, &spectrum, self.partition.comm())
    }
}
