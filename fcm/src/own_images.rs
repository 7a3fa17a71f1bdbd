//! Each sphere's own image in the walls, by the wavenumbers that the grid's flow of walls does not have.

use crate::bounded::NEAREST_WALL;
use crate::envelope::Envelope;
use crate::image::Image;
use crate::near::Loaded;
use crate::plan::Plan;
use domain::{Tensor, Vector};
use rayon::prelude::*;

/// The part of the tolerance below which an image is left out.
const NEGLIGIBLE: f64 = 0.01;

/// Images of spheres in one wall or two. In the flow of two walls what is beyond the grid's wavenumbers is the sum of those of
/// each alone, but for `exp(-2 k H)`.
pub(crate) struct OwnImages {
    walls: usize,
    highest: f64,
    inverse_viscosity: f64,
    classes: Vec<OfClass>,
}

/// Squares of a sphere's widths, and how far from a wall it has an image. One that has sunk in has that of one that touches: more
/// would take more mobility away than there is left where spheres are near each other, without their images in each other.
struct OfClass {
    contact: f64,
    squares: [f64; 2],
    reach: f64,
}

impl OwnImages {
    /// Those of the spheres of a plan; none without walls.
    pub fn new(plan: &Plan) -> Option<Self> {
        let (walls, highest) = (plan.boundaries.walls(), plan.highest_at_walls());
        let of_class = |&radius: &f64| {
            let Envelope { monopole, dipole } = Envelope::of_sphere(radius);
            let squares = [monopole * monopole, dipole * dipole];
            let is_small = |z: &f64| Image::from(highest, *z, squares).share(radius) < NEGLIGIBLE * plan.tolerance;
            let mut distances = (0..).map(|step| radius * (NEAREST_WALL + 0.05 * f64::from(step)));
            OfClass {
                contact: radius,
                squares,
                reach: distances.find(is_small).expect("an image that decays gets small"),
            }
        };
        let classes = plan.radii.iter().map(of_class).collect();
        (walls > 0).then(|| Self { walls, highest, inverse_viscosity: 1.0 / plan.viscosity, classes })
    }

    /// Adds the images' flows to the velocities and, if they are asked for, the gradients of the spheres that come first.
    pub fn add(&self, present: &Loaded, gradients: bool, motions: &mut [(Vector, Tensor)]) {
        motions.par_iter_mut().enumerate().for_each(|(row, (velocity, gradient))| {
            let Some(image) = self.of(present, row) else { return };
            let force = present.forces.get(row).copied().unwrap_or_default();
            let dipole = present.dipoles.get(row).copied().unwrap_or(Tensor::ZERO);
            let (u, d) = image.motion(force, &dipole);
            *velocity += u * self.inverse_viscosity;
            if gradients {
                *gradient += d * self.inverse_viscosity;
            }
        });
    }

    /// A sphere's image in the walls that are near.
    fn of(&self, present: &Loaded, row: usize) -> Option<Image> {
        let OfClass { contact, squares, reach } = self.classes[present.classes[row] as usize];
        let below = present.positions[row].z - present.cell.origin().z;
        let image = |z: f64| (z < reach).then(|| Image::from(self.highest, z.max(contact), squares));
        let above = if self.walls == 2 { image(present.cell.edges().z - below) } else { None };
        match (image(below), above.map(Image::reflected)) {
            (Some(below), Some(above)) => Some(below + above),
            (below, above) => below.or(above),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::{Fixed, Multipoles, Problem};
    use domain::{Boundaries, PeriodicBox};

    fn plan(boundaries: Boundaries, tolerance: f64) -> Plan {
        let problem = Problem {
            edges: Vector::new(12.0, 14.0, 9.0),
            boundaries,
            contraction: 1.0,
            largest_strain: 0.0,
            largest_tilts: [0.0; 2],
            radii: vec![(1.0, 1), (1.5, 1)],
            viscosity: 2.0,
            multipoles: Multipoles::Dipole,
            rigid: true,
            tolerance,
            threads: 1,
            ranks: 1,
            costs: crate::Costs::default(),
            fixed: Fixed::default(),
        };
        Plan::choose(&problem).unwrap()
    }

    /// What a sphere of the second radius at a height has of its images.
    fn motion(images: &OwnImages, cell: &PeriodicBox, z: f64, force: Vector, dipole: Tensor) -> (Vector, Tensor) {
        let present = Loaded {
            cell,
            positions: &[Vector::new(1.0, 2.0, z)],
            classes: &[1],
            forces: &[force],
            dipoles: &[dipole],
        };
        let mut motions = [(Vector::ZERO, Tensor::ZERO)];
        images.add(&present, true, &mut motions);
        motions[0]
    }

    #[test]
    fn only_walls_have_images() {
        assert!(OwnImages::new(&plan(Boundaries::Periodic, 1e-3)).is_none());
        assert!(OwnImages::new(&plan(Boundaries::OpenAlongZ, 1e-3)).is_none());
        let plan = plan(Boundaries::Wall, 1e-3);
        let (images, cell) = (OwnImages::new(&plan).unwrap(), plan.cell());
        let force = Vector::new(0.3, -0.2, 0.9);
        let at = |z: f64| motion(&images, &cell, z, force, Tensor::ZERO);
        assert!(at(1.53).0.dot(force) < 0.0 && at(8.0) == (Vector::ZERO, Tensor::ZERO));
        assert_eq!(at(9.0 - 1.53), (Vector::ZERO, Tensor::ZERO), "there is no wall above");
    }

    /// Where an image ends it is a hundredth of the tolerance, in units of what the sphere has alone.
    #[test]
    fn what_is_left_out_is_small() {
        for tolerance in [1e-2, 1e-5] {
            let plan = plan(Boundaries::Walls, tolerance);
            let images = OwnImages::new(&plan).unwrap();
            for (OfClass { squares, reach, .. }, radius) in images.classes.iter().zip([1.0, 1.5]) {
                assert!(*reach > 1.02 * radius && *reach < 4.0 * radius, "{reach} at {tolerance:e}");
                let left = Image::from(images.highest, *reach, *squares).share(radius);
                assert!(left < 0.01 * tolerance && left > 1e-4 * tolerance, "{left:e} at {tolerance:e}");
            }
        }
    }

    #[test]
    fn the_wall_above_is_the_one_below_upside_down() {
        let plan = plan(Boundaries::Walls, 1e-3);
        let (images, cell) = (OwnImages::new(&plan).unwrap(), plan.cell());
        let force = Vector::new(0.3, -0.2, 0.9);
        let dipole = Tensor::from_cols_array(&[0.1, 0.4, -0.7, 1.1, 0.5, 0.2, 0.9, -1.3, -0.6]);
        let mirror = Tensor::from_diagonal(Vector::new(1.0, 1.0, -1.0));
        let below = motion(&images, &cell, 1.6, force, dipole);
        let above = motion(&images, &cell, 9.0 - 1.6, mirror * force, mirror * dipole * mirror);
        let [velocity, gradient] = [below.0.length(), below.1.z_axis.length()];
        assert!(velocity > 1e-8 && gradient > 1e-8, "{below:?}");
        // Of the distance from the wall above, times twice the wavenumber.
        let round_off = 1e-12;
        assert!((mirror * above.0 - below.0).length() < round_off * velocity);
        let difference = mirror * above.1 * mirror - below.1;
        assert!(difference.to_cols_array().iter().all(|entry| entry.abs() < round_off * gradient), "{difference:?}");
    }
}
