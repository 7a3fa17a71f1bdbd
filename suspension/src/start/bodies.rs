//! Rigid bodies and filaments at the start of a run.

use crate::bodies;
use crate::columns::{ARM, BODY};
use crate::error::PlacingError;
use crate::model::{Bodies, BodyOrientation, Model, Start};
use crate::rotation::orientations;
use crate::start::given_bodies;
use domain::{BodySphere, GivenPositions, Number, Occupied, Particles, Quaternion, Random, Vector, sphere};
use std::cmp::Reverse;

/// Added to the seed for the random numbers of scenes with bodies.
const STREAM: u64 = 0x626f_6469_6573_0000;

/// Random positions, and orientations if they are random, that are tried for a body or a sphere.
const TRIES: u64 = 20_000;

/// All particles of a model with bodies or filaments, in the order of their ids: the spheres that belong to none, and
/// then the bodies, kind by kind. Spheres of a filament have the orientation of the rod as which it starts, or that of
/// the file.
pub fn particles(model: &Model, placed: Option<GivenPositions>) -> Result<Particles, PlacingError> {
    let objects = match model.start {
        Start::Given => given_bodies::objects(model, placed.unwrap_or_default())?,
        _ => BodyPlacement::new(model).placed()?,
    };
    let mut particles = Particles::default();
    let (mut owners, mut arms, mut turns) = (Vec::new(), Vec::new(), Vec::new());
    let mut next_body = 0.0;
    for object in objects {
        let body = if object.is_body { next_body } else { -1.0 };
        next_body += f64::from(u8::from(object.is_body));
        for (member, &species) in object.members.iter().zip(&object.species) {
            particles.push(owners.len() as u64, object.place(member), member.radius, species);
            owners.push(body);
            arms.push(member.position);
            turns.push(object.orientation);
        }
    }
    if !model.bodies.is_empty() {
        particles.column(BODY, 1).values = owners.into();
        particles.vectors(ARM).copy_from_slice(&arms);
    }
    if model.has_orientations() {
        orientations(&mut particles).copy_from_slice(&turns);
    }
    Ok(particles)
}

/// Refuses particles of a saved state whose bodies are not those of the model.
pub fn check(particles: &Particles, model: &Model) -> Result<(), String> {
    let (bodies, arms) = (bodies::members(particles), particles.rows::<3>(ARM).unwrap_or_default());
    let is_same = |row: usize| match model.member(particles.ids[row]) {
        Some(member) => {
            let arm = model.bodies[member.kind].spheres[member.sphere].position;
            bodies[row] == Some(member.body as u32) && Vector::from_array(arms[row]) == arm
        }
        None => bodies.get(row).copied().flatten().is_none(),
    };
    if bodies::exist(particles) != model.bodies.is_empty() && (0..particles.len()).all(is_same) {
        return Ok(());
    }
    Err("the state has other bodies than the scene; start a new run to change [[bodies]]".to_owned())
}

/// A body, or a sphere that belongs to none.
pub(super) struct Object<'a> {
    pub is_body: bool,
    pub members: Vec<BodySphere>,
    /// Species of the members.
    pub species: Vec<u32>,
    pub centre: Vector,
    /// [`Quaternion::NONE`] for spheres that belong to no body, unless a file gives them one.
    pub orientation: Quaternion,
    /// Whether a random place comes with a random orientation.
    turns: bool,
    /// Name of the kind, if the position is random.
    at_random: Option<&'a str>,
}

impl Object<'_> {
    /// A sphere that belongs to no body.
    pub(super) fn sphere(species: u32, radius: f64, centre: Vector, orientation: Quaternion) -> Self {
        let members = vec![BodySphere { position: Vector::ZERO, radius }];
        Self { is_body: false, members, species: vec![species], centre, orientation, turns: false, at_random: None }
    }

    /// A body of a kind.
    pub(super) fn body(model: &Model, kind: usize, centre: Vector, orientation: Quaternion) -> Self {
        let (members, species) = (model.placed_together()[kind].spheres.clone(), model.species_of_body(kind));
        Self { is_body: true, members, species, centre, orientation, turns: false, at_random: None }
    }

    /// Position of a member.
    pub(super) fn place(&self, member: &BodySphere) -> Vector {
        self.centre + self.orientation.rotate(member.position)
    }

    fn extent(&self) -> f64 {
        BodySphere::extent(&self.members)
    }

    fn volume(&self) -> f64 {
        self.members.iter().map(|member| sphere::volume(member.radius)).sum()
    }
}

/// Placement of bodies and spheres, one after another.
struct BodyPlacement<'a> {
    model: &'a Model,
    objects: Vec<Object<'a>>,
}

impl<'a> BodyPlacement<'a> {
    fn new(model: &'a Model) -> Self {
        let mut placing = Self { model, objects: Vec::new() };
        placing.add_free_spheres();
        model.placed_together().into_iter().enumerate().for_each(|(kind, bodies)| placing.add_bodies(kind, bodies));
        placing
    }

    fn gap(&self) -> f64 {
        if let Start::Random { minimum_gap } = self.model.start { minimum_gap } else { 0.0 }
    }

    fn add_free_spheres(&mut self) {
        let places = if let Start::Positions(places) = &self.model.start { places.as_slice() } else { &[] };
        for (number, kind) in self.model.species[..self.model.free_species()].iter().enumerate() {
            for _ in 0..kind.count.unwrap_or(0) {
                let given = places.get(self.objects.len());
                self.objects.push(Object {
                    at_random: given.is_none().then_some(kind.name.as_str()),
                    ..Object::sphere(number as u32, kind.radius, given.copied().unwrap_or_default(), Quaternion::NONE)
                });
            }
        }
    }

    fn add_bodies(&mut self, kind: usize, bodies: &'a Bodies) {
        let axes = self.model.user_axes();
        for number in 0..bodies.count as usize {
            let given = bodies.positions.as_ref().map(|places| places[number]);
            let orientation = match &bodies.orientation {
                BodyOrientation::Random => self.random(u64::MAX - self.objects.len() as u64).1,
                BodyOrientation::Aligned(along) => Quaternion::between(Vector::Z, axes.vector(*along)),
                BodyOrientation::Each(list) => list[number].normalized(),
            };
            self.objects.push(Object {
                turns: bodies.orientation == BodyOrientation::Random,
                at_random: given.is_none().then_some(bodies.name.as_str()),
                ..Object::body(self.model, kind, given.unwrap_or_default(), axes.orientation_in(orientation))
            });
        }
    }

    /// A random position and orientation.
    fn random(&self, name: u64) -> (Vector, Quaternion) {
        let mut random = Random::new(self.model.seed.wrapping_add(STREAM), name);
        let cell = &self.model.cell;
        let place = cell.origin() + cell.position(random.point() * cell.edges());
        (place, Quaternion::random(&mut random))
    }

    /// All bodies and spheres at their places: those whose places are given, and then the others, the largest first.
    fn placed(mut self) -> Result<Vec<Object<'a>>, PlacingError> {
        let kinds: Vec<(f64, usize)> = self
            .model
            .species
            .iter()
            .map(|kind| (kind.radius + 0.5 * self.gap(), kind.count.unwrap_or(0) as usize))
            .collect();
        let cell = self.model.cell;
        let mut occupied = Occupied::new(&cell, &kinds, None);
        let mut order: Vec<usize> = (0..self.objects.len()).collect();
        order.sort_by(|&a, &b| self.objects[b].extent().total_cmp(&self.objects[a].extent()));
        order.sort_by_key(|&index| Reverse(self.objects[index].at_random.is_none()));
        let (mut filled, half_gap) = (0.0, 0.5 * self.gap());
        for (placed, index) in order.into_iter().enumerate() {
            let object = &self.objects[index];
            if let Some(name) = object.at_random {
                let found = self.free(index, &occupied);
                let (centre, orientation) = found.ok_or_else(|| self.no_room(name, placed, filled / cell.volume()))?;
                (self.objects[index].centre, self.objects[index].orientation) = (centre, orientation);
            }
            let object = &self.objects[index];
            filled += object.volume();
            for member in &object.members {
                occupied.insert(member.radius + half_gap, cell.wrap(object.place(member)).0);
            }
        }
        Ok(self.objects)
    }

    /// The first random place at which an object is free of those before it.
    fn free(&self, index: usize, occupied: &Occupied) -> Option<(Vector, Quaternion)> {
        let (object, half_gap) = (&self.objects[index], 0.5 * self.gap());
        (0..TRIES).find_map(|attempt| {
            let (centre, turn) = self.random(index as u64 * TRIES + attempt);
            let orientation =
                if object.turns { self.model.user_axes().orientation_in(turn) } else { object.orientation };
            let is_free = object.members.iter().all(|member| {
                let place = centre + orientation.rotate(member.position);
                let mut walls = self.model.cell.to_walls(place);
                walls.all(|to| to.distance >= member.radius + half_gap)
                    && occupied.is_free(member.radius + half_gap, self.model.cell.wrap(place).0, None)
            });
            is_free.then_some((centre, orientation))
        })
    }

    fn no_room(&self, name: &str, placed: usize, fraction: f64) -> PlacingError {
        let (all, fraction) = (self.objects.len(), Number(fraction));
        PlacingError::NoRoom(format!(
            "found no room for \"{name}\" in {TRIES} random places: {placed} of {all} bodies, filaments and spheres \
             are placed, which fill {fraction:.3} of the box; take fewer of them, a larger box, or give positions"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Parameters, Species};
    use domain::{BodyShape, Boundaries, EqualSpheres, PeriodicBox};

    fn rods(count: u64) -> Bodies {
        Bodies::new("rods", BodyShape::Rod(EqualSpheres { number: 4, radius: 0.5, gap: 0.0 }).spheres(), count)
    }

    fn model(cell: PeriodicBox, count: u64) -> Model {
        let free = vec![Species::new("free", 1.0, 12)];
        let usual = Parameters { seed: 3, ..Parameters::new(cell, 1.0, free, 0.1, 1) };
        Model::new(Parameters { start: Start::Random { minimum_gap: 0.02 }, ..usual }.with_bodies(vec![rods(count)]))
            .unwrap()
    }

    #[test]
    fn bodies_and_spheres_at_random_keep_their_gaps() {
        let sheared = PeriodicBox::sheared(Vector::new(14.0, 11.0, 12.0), 0.3).unwrap();
        let walled = PeriodicBox::new(Vector::splat(12.0)).unwrap().with_boundaries(Boundaries::Walls).unwrap();
        for cell in [sheared, walled] {
            let model = model(cell, 30);
            let particles = particles(&model, None).unwrap();
            assert_eq!(particles.len(), 132);
            let bodies = bodies::members(&particles);
            for i in 0..132 {
                assert!(cell.to_walls(particles.positions[i]).all(|to| to.distance >= particles.radii[i]));
                for j in 0..i {
                    let distance = cell.nearest_image(particles.positions[i] - particles.positions[j]).length();
                    let least = particles.radii[i] + particles.radii[j];
                    let is_one = bodies[i].is_some() && bodies[i] == bodies[j];
                    assert!(distance >= least + if is_one { -1e-12 } else { 0.02 }, "{i} {j}: {distance}");
                }
            }
            assert_eq!(check(&particles, &model), Ok(()));
            let mut other = particles.clone();
            other.vectors(ARM)[40].x += 0.1;
            assert!(
                check(&other, &model).is_err()
                    && check(&Particles::numbered(vec![Vector::X], vec![1.0], vec![0]), &model).is_err()
            );
        }
    }

    #[test]
    fn a_box_that_is_too_full_is_refused_with_the_fraction_reached() {
        let cell = PeriodicBox::new(Vector::splat(10.0)).unwrap();
        let error = particles(&model(cell, 200), None).unwrap_err().to_string();
        assert!(error.contains("\"rods\"") || error.contains("\"free\""), "{error}");
        assert!(error.contains("of 212 bodies, filaments and spheres are placed"), "{error}");
    }
}
