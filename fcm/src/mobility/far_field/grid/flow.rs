//! Velocity of the fluid between the particles, in boxes that are not periodic along all axes.
//!
//! A point of the fluid is a sphere of radius zero, whose envelope has the transform 1. The grid carries the common
//! Gaussian and a bracket in its place, and the pair correction between a sphere and a point makes up the difference,
//! as between two spheres.

use super::GridFarField;
use crate::envelope::Envelope;
use crate::mobility::far_field::FlowAtPoints;
use crate::mobility::loads::Loads;
use crate::pairs::table::{PairFunctions, PairTable};
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
    near: NearPoints,
}

impl GridFarField {
    /// Flow of loads at points of the fluid, in a box that is not periodic along all axes.
    pub(super) fn flow_of(&mut self, loads: &Loads) -> GridFlow<'_> {
        self.work.evaluations += 1;
        let kinds = self.kinds_of(loads, &[]);
        let (mut forces, mut dipoles) = self.present(loads, kinds);
        self.grid.solve(&self.arrangement.grid_loads(&forces, &dipoles), &mut self.work);
        let owned = self.arrangement.halo.owned();
        forces.truncate(owned);
        forces.shrink_to_fit();
        dipoles.truncate(owned);
        dipoles.shrink_to_fit();
        let near = NearPoints::new(&self.plan.in_units(&self.units));
        GridFlow { far: self, forces, dipoles, near }
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
    functions: Vec<(PairFunctions, Option<PairTable<f64>>)>,
}

impl NearPoints {
    fn new(plan: &Plan) -> Self {
        let cutoff = plan.cutoff();
        let common = plan.common().expect("the split method has a common Gaussian");
        let of_radius = |&radius: &f64| {
            let functions = PairFunctions::new(Envelope::POINT, Envelope::of_sphere(radius), common);
            (functions, PairTable::new(&functions, cutoff, plan.table_tolerance()))
        };
        Self { cutoff, inverse_viscosity: 1.0 / plan.viscosity, functions: plan.radii.iter().map(of_radius).collect() }
    }

    /// Near-field velocity at `x` from a particle, as in [`crate::pairs::pair_correction`].
    fn velocity(&self, from: &SourceSphere, x: Vector) -> Vector {
        let (square, (exact, table)) = (x.length_squared(), &self.functions[from.class as usize]);
        let f = table.as_ref().map_or_else(|| exact.exact(square), |table| table.evaluate(square));
        let along = from.dipole * x;
        let of_force = x * (f[1] * x.dot(from.force)) - from.force * (2.0 * f[0] + square * f[1]);
        let of_dipole =
            x * (f[3] * x.dot(along)) + from.dipole.transpose() * x * f[2] - along * (4.0 * f[2] + square * f[3]);
        (of_force + of_dipole) * self.inverse_viscosity
    }
}
