//! Velocity of the fluid between the particles, in boxes that are not periodic along all axes.
//!
//! A point of the fluid is a sphere of radius zero, whose envelope has the transform 1. The grid carries the common
//! Gaussian and a bracket in its place, and the pair correction between a sphere and a point makes up the difference,
//! as between two spheres.

use super::GridFarField;
use super::spectral_grid::GridLoads;
use crate::envelope::{Common, Envelope};
use crate::mobility::far_field::FlowAtPoints;
use crate::mobility::loads::Loads;
use crate::pairs::table::{PairFunctions, PairTable, PairValues};
use crate::plan::Plan;
use crate::plan::sample_points::SamplePoints;
use crate::walls::wall_images::SourceSphere;
use domain::parallel::MeasuredLoop;
use domain::{Tensor, Vector};
use rayon::prelude::*;

/// Flow of given loads, at points of a box.
pub(super) struct GridFlow<'a> {
    far: &'a mut GridFarField,
    forces: Vec<Vector>,
    dipoles: Vec<Tensor>,
    /// Degenerate quadrupoles; empty if there are none on any rank.
    quadrupoles: Vec<Vector>,
    near: NearPoints,
}

impl GridFarField {
    /// Flow of loads and degenerate quadrupoles, if there are any on any rank, at points of the fluid, in a box that is
    /// not periodic along all axes.
    pub(super) fn flow_of(&mut self, loads: &Loads, quadrupoles: Option<&[Vector]>) -> GridFlow<'_> {
        self.work.evaluations += 1;
        let kinds = self.kinds_of(loads, quadrupoles.unwrap_or_default());
        let (mut forces, mut dipoles) = self.present(loads, kinds);
        let quadrupoles = quadrupoles.map(|all| self.present_quadrupoles(all));
        let of_grid = self.arrangement.grid_loads(&forces, &dipoles);
        self.grid.solve(&GridLoads { quadrupoles: quadrupoles.as_deref(), ..of_grid }, &mut self.work);
        let owned = self.arrangement.halo.owned();
        let mut near = NearPoints::new(&self.plan.in_units(&self.units));
        if quadrupoles.is_some() {
            near = near.with_quadrupoles(&self.plan.in_units(&self.units));
        }
        let mut quadrupoles = quadrupoles.unwrap_or_default();
        for list in [&mut forces, &mut quadrupoles] {
            list.truncate(owned);
            list.shrink_to_fit();
        }
        dipoles.truncate(owned);
        dipoles.shrink_to_fit();
        GridFlow { far: self, forces, dipoles, quadrupoles, near }
    }
}

impl FlowAtPoints for GridFlow<'_> {
    fn plane(&mut self, raster: &SamplePoints, k: usize) -> Vec<Vector> {
        let inverse = 1.0 / self.far.units.length;
        let raster =
            SamplePoints { first: raster.first * inverse, spacing: raster.spacing * inverse, points: raster.points };
        let points: Vec<Vector> = raster.plane(k).collect();
        let mut velocities = self.far.grid.velocities_at(&self.far.arrangement.cell, &points);
        self.add_near(&raster, k, &mut velocities);
        self.far.partition.comm().sum(bytemuck::cast_slice_mut(&mut velocities));
        let unit = self.far.units.velocity();
        for velocity in &mut velocities {
            *velocity *= unit;
        }
        velocities
    }
}

impl GridFlow<'_> {
    /// Adds the near field of this rank's own particles, in the order of the particles.
    fn add_near(&self, raster: &SamplePoints, k: usize, velocities: &mut [Vector]) {
        let (near, images) = (&self.near, self.images(raster, k));
        velocities.par_chunks_mut(raster.points[0]).enumerate().measured().for_each(|(j, row)| {
            for image in &images {
                let across = raster.point([0, j, k]) - image.position;
                let square = near.cutoff * near.cutoff - across.y * across.y - across.z * across.z;
                if square <= 0.0 {
                    continue;
                }
                // Points of the row within the cutoff.
                let half = square.sqrt();
                let [from, to] = [-half, half].map(|x| (x - across.x) / raster.spacing.x);
                for i in from.ceil().max(0.0) as usize..((to.floor() + 1.0).max(0.0) as usize).min(row.len()) {
                    let point = raster.point([i, j, k]);
                    let x = point - image.position;
                    row[i] += near.velocity(image, x);
                    if let Some(images) = &self.far.wall_images {
                        row[i] += images.velocity_at(&self.far.arrangement.cell, point, image);
                    }
                }
            }
        });
    }

    /// Particles, and their images along periodic axes, whose near field reaches a plane.
    fn images(&self, raster: &SamplePoints, k: usize) -> Vec<SourceSphere> {
        let arrangement = &self.far.arrangement;
        let (cell, reach) = (&arrangement.cell, Vector::splat(self.near.cutoff));
        let [nx, ny, _] = raster.points;
        let (low, high) = (raster.point([0, 0, k]) - reach, raster.point([nx - 1, ny - 1, k]) + reach);
        let mut images = Vec::new();
        for (row, &place) in arrangement.positions[..arrangement.halo.owned()].iter().enumerate() {
            let steps = |axis: usize| {
                let [from, to] = [low, high].map(|end| (end[axis] - place[axis]) / cell.edges()[axis]);
                if cell.is_periodic(axis) { from.ceil() as i32..=to.floor() as i32 } else { 0..=0 }
            };
            for (x, y) in steps(0).flat_map(|x| steps(1).map(move |y| (x, y))) {
                let place = place + cell.edges() * Vector::new(f64::from(x), f64::from(y), 0.0);
                if place.cmpge(low).all() && place.cmple(high).all() {
                    images.push(SourceSphere {
                        position: place,
                        class: arrangement.classes[row],
                        force: self.forces.get(row).copied().unwrap_or_default(),
                        dipole: self.dipoles.get(row).copied().unwrap_or(Tensor::ZERO),
                        quadrupole: self.quadrupoles.get(row).copied(),
                    });
                }
            }
        }
        images
    }
}

/// Pair corrections between spheres of each radius and points.
struct NearPoints {
    cutoff: f64,
    inverse_viscosity: f64,
    functions: Vec<PointFunctions>,
    /// Functions of degenerate quadrupoles; empty if there are none.
    of_quadrupoles: Vec<PointFunctions>,
}

/// Functions between a sphere and a point, with their table if there is one.
type PointFunctions = (PairFunctions, Option<PairTable<f64>>);

impl NearPoints {
    fn new(plan: &Plan) -> Self {
        Self {
            cutoff: plan.cutoff(),
            inverse_viscosity: 1.0 / plan.viscosity,
            functions: point_functions(plan, PairFunctions::new),
            of_quadrupoles: Vec::new(),
        }
    }

    fn with_quadrupoles(self, plan: &Plan) -> Self {
        Self { of_quadrupoles: point_functions(plan, PairFunctions::of_quadrupole), ..self }
    }

    /// Near-field velocity at `x` from a particle, as in [`crate::pairs::pair_correction`].
    fn velocity(&self, from: &SourceSphere, x: Vector) -> Vector {
        let square = x.length_squared();
        let at = |(exact, table): &PointFunctions| {
            table.as_ref().map_or_else(|| exact.exact(square), |table| table.evaluate(square))
        };
        let f = at(&self.functions[from.class as usize]);
        let along = from.dipole * x;
        let stokeslet =
            |f: &PairValues, force: Vector| x * (f[1] * x.dot(force)) - force * (2.0 * f[0] + square * f[1]);
        let of_dipole =
            x * (f[3] * x.dot(along)) + from.dipole.transpose() * x * f[2] - along * (4.0 * f[2] + square * f[3]);
        let of_quadrupole = from
            .quadrupole
            .map_or(Vector::ZERO, |quadrupole| stokeslet(&at(&self.of_quadrupoles[from.class as usize]), quadrupole));
        (stokeslet(&f, from.force) + of_dipole + of_quadrupole) * self.inverse_viscosity
    }
}

/// Functions between the spheres of each radius of a plan and points.
fn point_functions(plan: &Plan, functions: fn(Envelope, Envelope, Common) -> PairFunctions) -> Vec<PointFunctions> {
    let common = plan.common().expect("the split method has a common Gaussian");
    let of_radius = |&radius: &f64| {
        let functions = functions(Envelope::POINT, Envelope::of_sphere(radius), common);
        (functions, PairTable::new(&functions, plan.cutoff(), plan.table_tolerance()))
    };
    plan.radii.iter().map(of_radius).collect()
}
