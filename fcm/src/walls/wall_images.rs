//! Images of spheres in walls, of themselves and of each other, with the wavenumbers of the walls' flow that are not
//! on the grid.

use crate::envelope::Envelope;
use crate::pairs::pair_correction::LoadedParticles;
use crate::plan::Plan;
use crate::plan::bounded::NEAREST_WALL;
use crate::walls::wall_kernel::{SourceAtWall, WallKernel, WallLoad, WallMobilityBlock};
use domain::parallel::MeasuredLoop;
use domain::{Neighbours, PeriodicBox, Tensor, Vector};
use gpu::ImageLists;
use rayon::prelude::*;
use simd::vectorised;
use std::f64::consts::PI;

/// A particle that applies loads, or a periodic image of one.
pub(crate) struct SourceSphere {
    pub position: Vector,
    pub class: u32,
    pub force: Vector,
    pub dipole: Tensor,
    /// Degenerate quadrupole, if particles have any.
    pub quadrupole: Option<Vector>,
}

impl Plan {
    /// Approximate number of images of a sphere in a homogeneous suspension of `particles` spheres.
    pub(crate) fn images(&self, particles: f64) -> f64 {
        match self.boundaries.walls() {
            0 => 0.0,
            _ => self.images_within(self.wavenumber_split().reach(self.image_cutoff), particles),
        }
    }

    /// The same for images that end at a distance `reach` from a wall: for pairs, whose distances add up to less than
    /// twice that.
    fn images_within(&self, reach: f64, particles: f64) -> f64 {
        let (smallest, largest) = self.extremes();
        let (beyond, between) = ((reach - smallest).max(0.0), (self.edges.z - 2.0 * smallest).max(largest));
        let density = particles / (self.edges.x * self.edges.y * between);
        let pairs =
            if self.wavenumber_split().is_sharp() { 0.0 } else { density * PI * self.cutoff().powi(2) * 2.0 * beyond };
        self.boundaries.walls() as f64 * beyond / between * (1.0 + pairs)
    }
}

impl WallImages {
    /// Bytes of the images in a homogeneous suspension of `particles` spheres over all ranks, of which this rank owns
    /// `owned`.
    pub fn bytes(plan: &Plan, owned: f64, particles: f64) -> f64 {
        let images = Self::new(plan).map_or(0.0, |images| plan.images_within(images.classes[0].reach, particles));
        // Each block serves two spheres.
        owned * images * (size_of::<ImagePair>() as f64 + 0.5 * size_of::<WallMobilityBlock>() as f64)
    }
}

/// Images of spheres in one wall or two. Between two walls the flow between spheres is the sum of those of each wall
/// alone, up to reflections between the walls.
pub(crate) struct WallImages {
    walls: usize,
    waves: WallKernel,
    /// Whether spheres have images in each other.
    of_pairs: bool,
    inverse_viscosity: f64,
    classes: Vec<SphereClass>,
    point: SphereClass,
    /// For each sphere, the spheres whose images act on it.
    lists: Vec<Vec<ImagePair>>,
    blocks: Vec<WallMobilityBlock>,
}

/// A sphere that acts on another one by its image: its row, the index of their block, whether the block is for these
/// two in this order, and `x` from it to the other.
#[derive(Clone, Copy)]
struct ImagePair {
    row: u32,
    block: usize,
    is_forward: bool,
    x: Vector,
}

/// A class of spheres or the points of the fluid: contact distance, squared widths, and the distance from a wall
/// within which it has an image in one of the same class. A sphere that overlaps the wall has the image of one that
/// touches it: a stronger image would make the mobility negative.
struct SphereClass {
    contact: f64,
    squares: [f64; 2],
    reach: f64,
}

impl WallImages {
    /// Images of the spheres of a plan; `None` without walls.
    pub fn new(plan: &Plan) -> Option<Self> {
        let (walls, cutoff) = (plan.boundaries.walls(), plan.cutoff());
        if walls == 0 {
            return None;
        }
        let (smallest, _) = plan.extremes();
        // A point of the fluid may be on the wall.
        let closest = if plan.fluid_margin.is_some() { smallest } else { 2.0 * smallest };
        let cut = plan.wavenumber_split();
        let waves = WallKernel::new(&cut, cutoff, closest, plan.image_cutoff);
        let of_class = |&radius: &f64| {
            let Envelope { monopole, dipole } = Envelope::of_sphere(radius);
            let squares = [monopole * monopole, dipole * dipole];
            let is_small = |&distance: &f64| {
                waves.block(Vector::ZERO, [SourceAtWall { distance, squares }; 2]).share(radius) < plan.image_cutoff
            };
            let mut distances = (0..).map(|step| radius * (NEAREST_WALL + 0.05 * f64::from(step)));
            let reach = distances.find(is_small).expect("an image that decays gets small");
            SphereClass { contact: radius, squares, reach }
        };
        let classes: Vec<SphereClass> = plan.radii.iter().map(of_class).collect();
        let point = SphereClass { contact: 0.0, squares: [0.0; 2], reach: classes[0].reach };
        Some(Self {
            walls,
            inverse_viscosity: 1.0 / plan.viscosity,
            point,
            classes,
            lists: Vec::new(),
            blocks: Vec::new(),
            of_pairs: !cut.is_sharp(),
            waves,
        })
    }

    /// Sets the positions of the particles present; those with neighbour lists receive the images' flows.
    ///
    /// The block of two spheres is computed once, for the one whose position is lexicographically larger.
    pub fn arrange(&mut self, present: &LoadedParticles, neighbours: &Neighbours, owned: usize) {
        let mut blocks = std::mem::take(&mut self.blocks);
        let images = &*self;
        let of = |row: usize| (images.class(present.classes[row]), present.positions[row].z);
        let near = |row: usize| {
            let mut near = Vec::new();
            let (class, z) = of(row);
            if images.of_pairs && images.is_near_wall(present.cell, class, z) {
                for neighbour in neighbours.of(row).iter() {
                    let j = neighbour.row as usize;
                    let x = present.positions[row] - present.positions[j];
                    let x = x - present.cell.lattice(neighbour.steps.map(i32::from));
                    if images.reach_each_other(present.cell, [of(row), of(j)]) {
                        near.push(ImagePair { row: j as u32, block: 0, is_forward: x.to_array() > [0.0; 3], x });
                    }
                }
            }
            if images.reach_each_other(present.cell, [of(row); 2]) {
                near.push(ImagePair { row: row as u32, block: 0, is_forward: true, x: Vector::ZERO });
            }
            near
        };
        let mut lists: Vec<Vec<ImagePair>> = (0..owned).into_par_iter().map(near).measured().collect();
        // A pair has its block at the sphere that is ahead, or at the one that this rank owns.
        let is_first = |pair: &ImagePair| pair.is_forward || pair.row as usize >= owned;
        let mut first = Vec::new();
        for (row, list) in lists.iter_mut().enumerate() {
            for pair in list.iter_mut().filter(|pair| is_first(pair)) {
                pair.block = first.len();
                first.push((row, *pair));
            }
        }
        let behind = |row: usize| {
            let with_block = |pair: &ImagePair| {
                if is_first(pair) {
                    return Some(*pair);
                }
                let is_same = |other: &&ImagePair| is_first(other) && other.row as usize == row && other.x == -pair.x;
                let other = lists[pair.row as usize].iter().find(is_same)?;
                Some(ImagePair { block: other.block, ..*pair })
            };
            lists[row].iter().filter_map(with_block).collect()
        };
        let lists = (0..owned).into_par_iter().map(behind).measured().collect();
        let block = |&(row, ImagePair { row: j, x, is_forward, .. }): &(usize, ImagePair)| {
            let pair = [of(row), of(j as usize)];
            let block = if is_forward {
                images.between(WallLoad::ForceAndDipole, present.cell, x, pair)
            } else {
                images.between(WallLoad::ForceAndDipole, present.cell, -x, [pair[1], pair[0]])
            };
            block.expect("these reach each other")
        };
        first.par_iter().map(block).measured().collect_into_vec(&mut blocks);
        (self.lists, self.blocks) = (lists, blocks);
    }

    /// The images of the arranged particles, for a device.
    pub fn lists(&self) -> ImageLists {
        let mut lists = ImageLists { starts: vec![0], ..ImageLists::default() };
        for list in &self.lists {
            let packed = |image: &ImagePair| (2 * image.block + usize::from(image.is_forward)) as i32;
            lists.images.extend(list.iter().map(|image| [image.row as i32, packed(image)]));
            lists.starts.push(lists.images.len() as i32);
        }
        lists.blocks = self.blocks.iter().map(WallMobilityBlock::entries).collect();
        lists
    }

    fn class(&self, class: u32) -> &SphereClass {
        &self.classes[class as usize]
    }

    /// Whether a sphere may have an image in another one.
    fn is_near_wall(&self, cell: &PeriodicBox, of: &SphereClass, z: f64) -> bool {
        let farthest = |of: &SphereClass| of.reach - of.contact;
        let reach = of.reach + self.classes.iter().map(farthest).fold(0.0, f64::max);
        let below = z - cell.origin().z;
        below < reach || (self.walls == 2 && cell.edges().z - below < reach)
    }

    /// Two spheres, each of a class and at a height, as seen from the lower wall or from the upper one; `None` if
    /// that is too far away.
    fn seen_by(&self, cell: &PeriodicBox, above: bool, spheres: [(&SphereClass, f64); 2]) -> Option<[SourceAtWall; 2]> {
        let seen = spheres.map(|(&SphereClass { contact, squares, .. }, z)| {
            let below = z - cell.origin().z;
            let distance = if above { cell.edges().z - below } else { below };
            SourceAtWall { distance: distance.max(contact), squares }
        });
        let is_there = !above || self.walls == 2;
        let is_near = seen[0].distance + seen[1].distance < spheres[0].0.reach + spheres[1].0.reach;
        (is_there && is_near).then_some(seen)
    }

    fn reach_each_other(&self, cell: &PeriodicBox, spheres: [(&SphereClass, f64); 2]) -> bool {
        [false, true].into_iter().any(|above| self.seen_by(cell, above, spheres).is_some())
    }

    /// Flow from one sphere to another at `x` from it, by the walls near which both are.
    fn between(
        &self,
        load: WallLoad,
        cell: &PeriodicBox,
        x: Vector,
        spheres: [(&SphereClass, f64); 2],
    ) -> Option<WallMobilityBlock> {
        let of_wall = |above: bool| self.seen_by(cell, above, spheres).map(|seen| self.waves.block_of(load, x, seen));
        match (of_wall(false), of_wall(true).map(WallMobilityBlock::reflected)) {
            (Some(mut below), Some(above)) => {
                below += above;
                Some(below)
            }
            (below, above) => below.or(above),
        }
    }

    /// Velocity at a point by the images of a sphere's force, dipole and degenerate quadrupole.
    pub fn velocity_at(&self, cell: &PeriodicBox, point: Vector, sphere: &SourceSphere) -> Vector {
        let x = point - sphere.position;
        let spheres = [(&self.point, point.z), (self.class(sphere.class), point.z - x.z)];
        let of = |load: WallLoad, force: Vector, dipole: &Tensor| {
            let block = self.between(load, cell, x, spheres);
            block.map_or(Vector::ZERO, |block| block.motion(force, dipole).0 * self.inverse_viscosity)
        };
        let velocity = of(WallLoad::ForceAndDipole, sphere.force, &sphere.dipole);
        sphere.quadrupole.map_or(velocity, |h| velocity + of(WallLoad::Quadrupole, h, &Tensor::ZERO))
    }

    /// Adds the images' flows to the velocities and, if requested, the gradients of the particles in `motions`.
    pub fn add(&self, present: &LoadedParticles, gradients: bool, motions: &mut [(Vector, Tensor)]) {
        motions.par_iter_mut().zip(&self.lists).measured().for_each(|(motion, list)| {
            vectorised(
                #[inline(always)]
                || self.add_list(present, gradients, list, motion),
            );
        });
    }

    /// Adds the flows of the images of the particles' degenerate quadrupoles, in place of their forces, to the
    /// velocities and gradients in `motions`. Blocks of quadrupoles are not symmetric, and are not kept.
    pub fn add_of_quadrupoles(&self, present: &LoadedParticles, motions: &mut [(Vector, Tensor)]) {
        let of = |row: usize| (self.class(present.classes[row]), present.positions[row].z);
        let add = |(row, (motion, list)): (usize, (&mut (Vector, Tensor), &Vec<ImagePair>))| {
            for &ImagePair { row: j, x, .. } in list {
                let (spheres, quadrupole) = ([of(row), of(j as usize)], present.forces[j as usize]);
                let Some(block) = self.between(WallLoad::Quadrupole, present.cell, x, spheres) else { continue };
                let (u, d) = block.motion(quadrupole, &Tensor::ZERO);
                motion.0 += u * self.inverse_viscosity;
                motion.1 += d * self.inverse_viscosity;
            }
        };
        motions.par_iter_mut().zip(&self.lists).enumerate().measured().for_each(add);
    }

    #[inline(always)]
    fn add_list(&self, present: &LoadedParticles, gradients: bool, list: &[ImagePair], motion: &mut (Vector, Tensor)) {
        for ImagePair { row, block, is_forward, .. } in list {
            let force = present.forces.get(*row as usize).copied().unwrap_or_default();
            let dipole = present.dipoles.get(*row as usize).copied().unwrap_or(Tensor::ZERO);
            let block = &self.blocks[*block];
            let (u, d) =
                if *is_forward { block.motion(force, &dipole) } else { block.motion_of_second(force, &dipole) };
            motion.0 += u * self.inverse_viscosity;
            if gradients {
                motion.1 += d * self.inverse_viscosity;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::problem::Problem;
    use domain::{Boundaries, PeriodicBox};

    fn plan(boundaries: Boundaries, tolerance: f64) -> Plan {
        let problem = Problem {
            edges: Vector::new(12.0, 14.0, 9.0),
            boundaries,
            volume: 12.0 * 14.0 * 9.0,
            shortest_vector: 9.0,
            radii: vec![(1.0, 1), (1.5, 1)],
            viscosity: 2.0,
            tolerance,
            ..Problem::of_five_spheres()
        };
        Plan::choose(&problem).unwrap()
    }

    /// Motion of a sphere of the second radius at a height by its own images.
    fn motion(images: &mut WallImages, cell: &PeriodicBox, z: f64, force: Vector, dipole: Tensor) -> (Vector, Tensor) {
        let present = LoadedParticles {
            cell,
            positions: &[Vector::new(1.0, 2.0, z)],
            classes: &[1],
            forces: &[force],
            dipoles: &[dipole],
        };
        let mut motions = [(Vector::ZERO, Tensor::ZERO)];
        images.arrange(&present, &Neighbours::find(cell, present.positions, 1, 1.0), 1);
        images.add(&present, true, &mut motions);
        motions[0]
    }

    #[test]
    fn only_walls_have_images() {
        assert!(WallImages::new(&plan(Boundaries::Periodic, 1e-3)).is_none());
        assert!(WallImages::new(&plan(Boundaries::OpenAlongZ, 1e-3)).is_none());
        let plan = plan(Boundaries::Wall, 1e-3);
        let (mut images, cell) = (WallImages::new(&plan).unwrap(), plan.cell());
        let force = Vector::new(0.3, -0.2, 0.9);
        let mut at = |z: f64| motion(&mut images, &cell, z, force, Tensor::ZERO);
        assert!(at(1.53).0.dot(force) < 0.0 && at(8.0) == (Vector::ZERO, Tensor::ZERO));
        assert_eq!(at(9.0 - 1.53), (Vector::ZERO, Tensor::ZERO), "there is no wall above");
    }

    /// At the distance where images end they are below a third of the tolerance, in units of the sphere's mobility,
    /// but not far below.
    #[test]
    fn what_is_left_out_is_small() {
        for tolerance in [1e-2, 1e-5] {
            let plan = plan(Boundaries::Walls, tolerance);
            let images = WallImages::new(&plan).unwrap();
            for (&SphereClass { squares, reach, .. }, radius) in images.classes.iter().zip([1.0, 1.5]) {
                let share = |distance: f64| {
                    images.waves.block(Vector::ZERO, [SourceAtWall { distance, squares }; 2]).share(radius)
                };
                assert!(
                    share(reach) < 0.3 * tolerance && share(0.9 * reach) > 0.3 * tolerance,
                    "{reach} at {tolerance:e}"
                );
            }
        }
    }

    #[test]
    fn the_wall_above_is_the_one_below_upside_down() {
        let plan = plan(Boundaries::Walls, 1e-3);
        let (mut images, cell) = (WallImages::new(&plan).unwrap(), plan.cell());
        let force = Vector::new(0.3, -0.2, 0.9);
        let dipole = Tensor::from_cols_array(&[0.1, 0.4, -0.7, 1.1, 0.5, 0.2, 0.9, -1.3, -0.6]);
        let mirror = Tensor::from_diagonal(Vector::new(1.0, 1.0, -1.0));
        let below = motion(&mut images, &cell, 1.6, force, dipole);
        let above = motion(&mut images, &cell, 9.0 - 1.6, mirror * force, mirror * dipole * mirror);
        let [velocity, gradient] = [below.0.length(), below.1.z_axis.length()];
        assert!(velocity > 1e-8 && gradient > 1e-8, "{below:?}");
        // Round-off of the distance from the upper wall, times twice the wavenumber.
        let round_off = 1e-12;
        assert!((mirror * above.0 - below.0).length() < round_off * velocity);
        let difference = mirror * above.1 * mirror - below.1;
        assert!(difference.to_cols_array().iter().all(|entry| entry.abs() < round_off * gradient), "{difference:?}");
    }
}
