//! Shapes of rigid bodies that are made of spheres.

use crate::{Quaternion, Random, Vector, sphere};
use std::f64::consts::{PI, TAU};

/// A sphere of a rigid body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodySphere {
    /// Position in the axes of the body, from its centre.
    pub position: Vector,
    /// Radius.
    pub radius: f64,
}

/// A body of equal spheres. Its axis of symmetry, if it has one, is z in its own axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BodyShape {
    /// Spheres in a line along the axis.
    Rod(EqualSpheres),
    /// Spheres on a circle across the axis.
    Ring(EqualSpheres),
    /// A square lattice across the axis, with this number of spheres along an edge.
    Plate(EqualSpheres),
    /// A tetrahedron of closely packed spheres, with this number along an edge; one of its faces is across the axis.
    Tetrahedron(EqualSpheres),
    /// A cube of a simple cubic lattice, with this number of spheres along an edge.
    Cube(EqualSpheres),
    /// Each sphere is attached to one of the former ones, at random.
    Aggregate {
        /// The spheres.
        spheres: EqualSpheres,
        /// Seed of the random numbers.
        seed: u64,
    },
    /// Centres on the surface of a sphere, nearly evenly.
    Shell {
        /// Number of spheres: 12, 42, 162, 642 and so on are the vertices of an icosahedron whose faces are divided;
        /// others are on a spiral.
        number: usize,
        /// Radius of the surface.
        shell_radius: f64,
        /// Radius of the spheres; by default, the nearest two touch.
        radius: Option<f64>,
    },
}

/// Equal spheres at equal gaps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EqualSpheres {
    /// Number of spheres, in all or along an edge.
    pub number: usize,
    /// Radius.
    pub radius: f64,
    /// Gap between the surfaces of neighbours; negative for spheres that overlap.
    pub gap: f64,
}

/// Directions that are tried for a sphere of an aggregate.
const TRIES: usize = 100_000;

impl EqualSpheres {
    /// Distance between the centres of neighbours.
    fn spacing(self) -> f64 {
        2.0 * self.radius + self.gap
    }

    fn at(self, positions: impl Iterator<Item = Vector>) -> Vec<BodySphere> {
        let spacing = self.spacing();
        positions.map(|position| BodySphere { position: position * spacing, radius: self.radius }).collect()
    }
}

impl BodyShape {
    /// The spheres, with the centre of their volumes at zero.
    pub fn spheres(&self) -> Vec<BodySphere> {
        BodySphere::centred(match *self {
            Self::Rod(line) => line.at((0..line.number).map(|k| Vector::Z * k as f64)),
            Self::Ring(ring) => ring.at(circle(ring.number)),
            Self::Plate(plate) => plate.at(lattice([plate.number, plate.number, 1])),
            Self::Cube(cube) => cube.at(lattice([cube.number; 3])),
            Self::Tetrahedron(pile) => pile.at(tetrahedron(pile.number)),
            Self::Aggregate { spheres, seed } => aggregate(spheres, seed),
            Self::Shell { number, shell_radius, radius } => shell(number, shell_radius, radius),
        })
    }
}

impl BodySphere {
    /// Spheres moved together such that the centre of their volumes is at zero.
    pub fn centred(mut spheres: Vec<Self>) -> Vec<Self> {
        let volume: f64 = spheres.iter().map(|one| sphere::volume(one.radius)).sum();
        let centre = spheres.iter().map(|one| one.position * sphere::volume(one.radius)).sum::<Vector>() / volume;
        for one in &mut spheres {
            one.position -= centre;
        }
        spheres
    }

    /// Radius of the sphere around the centre that holds all of them.
    pub fn extent(spheres: &[Self]) -> f64 {
        spheres.iter().map(|one| one.position.length() + one.radius).fold(0.0, f64::max)
    }
}

/// Points on a circle at a distance of 1 between neighbours.
fn circle(number: usize) -> impl Iterator<Item = Vector> {
    let radius = if number > 1 { 0.5 / (PI / number as f64).sin() } else { 0.0 };
    (0..number).map(move |k| {
        let (sine, cosine) = (TAU * k as f64 / number as f64).sin_cos();
        Vector::new(cosine, sine, 0.0) * radius
    })
}

fn lattice([nx, ny, nz]: [usize; 3]) -> impl Iterator<Item = Vector> {
    (0..nz)
        .flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])))
        .map(|place| Vector::from_array(place.map(|c| c as f64)))
}

/// Sites of a tetrahedron of a face-centred cubic lattice at a distance of 1 between neighbours.
fn tetrahedron(edge: usize) -> impl Iterator<Item = Vector> {
    let first = Vector::X;
    let second = Vector::new(0.5, 0.75_f64.sqrt(), 0.0);
    let third = Vector::new(0.5, 0.75_f64.sqrt() / 3.0, (2.0_f64 / 3.0).sqrt());
    lattice([edge; 3])
        .filter(move |place| place.element_sum() < edge as f64 - 0.5)
        .map(move |Vector { x, y, z }| first * x + second * y + third * z)
}

fn aggregate(spheres: EqualSpheres, seed: u64) -> Vec<BodySphere> {
    let mut random = Random::new(seed, spheres.number as u64);
    let mut sites = vec![Vector::ZERO];
    let closest = 1.0 - 1e-12;
    for _ in 1..spheres.number {
        let attached = (0..TRIES).find_map(|_| {
            let to = ((random.uniform() * sites.len() as f64) as usize).min(sites.len() - 1);
            let site = sites[to] + Quaternion::random(&mut random).axis();
            sites.iter().all(|other| other.distance(site) >= closest).then_some(site)
        });
        // Beyond its farthest sphere an aggregate has room.
        sites.push(attached.unwrap_or_else(|| {
            let farthest = sites.iter().copied().fold(Vector::ZERO, |a, b| if b.x > a.x { b } else { a });
            farthest + Vector::X
        }));
    }
    spheres.at(sites.into_iter())
}

fn shell(number: usize, shell_radius: f64, radius: Option<f64>) -> Vec<BodySphere> {
    let directions = icosahedral(number).unwrap_or_else(|| spiral(number));
    let nearest = |k: usize| {
        let others = directions.iter().enumerate().filter(|(other, _)| *other != k);
        others.map(|(_, other)| other.distance(directions[k])).fold(2.0, f64::min)
    };
    let radius = radius.unwrap_or_else(|| 0.5 * shell_radius * (0..number).map(nearest).fold(2.0, f64::min));
    directions.iter().map(|&direction| BodySphere { position: direction * shell_radius, radius }).collect()
}

/// Directions on a spiral, each of which stands for the same solid angle.
fn spiral(number: usize) -> Vec<Vector> {
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    let direction = |k: usize| {
        let z = 1.0 - (2.0 * k as f64 + 1.0) / number as f64;
        let (sine, cosine) = (golden * k as f64).sin_cos();
        Vector::new(cosine, sine, 0.0) * (1.0 - z * z).sqrt() + Vector::Z * z
    };
    (0..number).map(direction).collect()
}

/// Vertices of an icosahedron each of whose faces is divided into four, repeatedly; `None` if none has this number.
fn icosahedral(number: usize) -> Option<Vec<Vector>> {
    let divisions = (0..8).find(|&k| 10 * 4_usize.pow(k) + 2 == number)?;
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let signs = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
    let of_signs = |[a, b]: [f64; 2]| {
        [Vector::new(0.0, a, b * golden), Vector::new(a, b * golden, 0.0), Vector::new(b * golden, 0.0, a)]
    };
    let mut vertices: Vec<Vector> = signs.into_iter().flat_map(of_signs).map(Vector::normalize).collect();
    for _ in 0..divisions {
        let edges = edges(&vertices);
        vertices.extend(edges.into_iter().map(|[i, j]| (vertices[i] + vertices[j]).normalize()).collect::<Vec<_>>());
    }
    Some(vertices)
}

/// Pairs of neighbouring vertices: those that are nearer than 1.4 times the nearest.
fn edges(vertices: &[Vector]) -> Vec<[usize; 2]> {
    let distance = |[i, j]: [usize; 2]| vertices[i].distance(vertices[j]);
    let pairs = || (0..vertices.len()).flat_map(|i| (0..i).map(move |j| [i, j]));
    let shortest = pairs().map(distance).fold(f64::INFINITY, f64::min);
    pairs().filter(|&pair| distance(pair) < 1.4 * shortest).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const THREE: EqualSpheres = EqualSpheres { number: 3, radius: 0.5, gap: 0.1 };

    fn nearest(spheres: &[BodySphere]) -> f64 {
        let pairs = (0..spheres.len()).flat_map(|i| (0..i).map(move |j| [i, j]));
        pairs.map(|[i, j]| spheres[i].position.distance(spheres[j].position)).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn shapes_have_their_numbers_and_gaps_about_their_centres() {
        for (shape, number) in [
            (BodyShape::Rod(THREE), 3),
            (BodyShape::Ring(THREE), 3),
            (BodyShape::Plate(THREE), 9),
            (BodyShape::Cube(THREE), 27),
            (BodyShape::Tetrahedron(THREE), 10),
            (BodyShape::Aggregate { spheres: EqualSpheres { number: 40, ..THREE }, seed: 5 }, 40),
        ] {
            let spheres = shape.spheres();
            assert_eq!(spheres.len(), number, "{shape:?}");
            assert!((nearest(&spheres) - 1.1).abs() < 1e-9, "{shape:?}: {}", nearest(&spheres));
            assert!(spheres.iter().map(|one| one.position).sum::<Vector>().length() < 1e-12, "{shape:?}");
        }
    }

    #[test]
    fn shells_are_even() {
        for (number, least) in [(12, 1.05), (42, 0.54), (162, 0.27), (642, 0.13), (100, 0.3)] {
            let spheres = BodyShape::Shell { number, shell_radius: 1.0, radius: None }.spheres();
            assert_eq!(spheres.len(), number);
            let distance = nearest(&spheres);
            assert!(distance > least && (2.0 * spheres[0].radius - distance).abs() < 1e-12, "{number}: {distance}");
        }
    }

    #[test]
    fn the_centre_is_that_of_the_volumes() {
        let pair = [(0.0, 1.0), (4.0, 2.0)].map(|(x, radius)| BodySphere { position: Vector::X * x, radius });
        let spheres = BodySphere::centred(pair.to_vec());
        assert!((spheres[0].position.x + 32.0 / 9.0).abs() < 1e-14);
        assert!((BodySphere::extent(&spheres) - (32.0 / 9.0 + 1.0)).abs() < 1e-14);
    }
}
