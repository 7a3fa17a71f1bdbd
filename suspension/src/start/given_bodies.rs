//! Rigid bodies and filaments that start from a file.

use super::bodies::Object;
use super::placement;
use crate::error::PlacingError;
use crate::model::Model;
use domain::{GivenPositions, Number, Quaternion, Vector};

/// Largest distance of a sphere of the file from its place in its body, over its radius. Positions may be rounded.
const MISPLACED: f64 = 1e-3;

/// All spheres and bodies of a model in the order of their ids. A kind of bodies takes the spheres of its species in
/// the order of the file, body by body. The first sphere of a body and the orientation in its row determine the place
/// of the body, from which the others may differ by [`MISPLACED`]. Spheres of filaments are where the file has them.
pub(super) fn objects(model: &Model, placed: GivenPositions) -> Result<Vec<Object<'_>>, PlacingError> {
    let name = placed.name.clone();
    let spheres = GivenSpheres::new(model, placement::given(model, placed)?);
    spheres.objects().map_err(|message| PlacingError::Given { name, message })
}

struct GivenSpheres<'a> {
    model: &'a Model,
    positions: Vec<Vector>,
    species: Vec<u32>,
    /// Zero for spheres without; empty if no sphere has one.
    orientations: Vec<Quaternion>,
    /// Rows of each species that belong to no object yet, the next one last.
    rows: Vec<Vec<usize>>,
}

impl<'a> GivenSpheres<'a> {
    fn new(model: &'a Model, given: GivenPositions) -> Self {
        let species = given.species.expect("told by the file or by counts");
        let mut rows = vec![Vec::new(); model.species.len()];
        for (row, &kind) in species.iter().enumerate().rev() {
            rows[kind as usize].push(row);
        }
        Self { model, positions: given.positions, species, orientations: given.orientations.unwrap_or_default(), rows }
    }

    fn objects(mut self) -> Result<Vec<Object<'a>>, String> {
        let free = self.model.free_species();
        let is_free = |&row: &usize| (self.species[row] as usize) < free;
        let mut objects: Vec<Object> = (0..self.positions.len()).filter(is_free).map(|row| self.sphere(row)).collect();
        for kind in 0..self.model.placed_together().len() {
            for number in 0..self.model.placed_together()[kind].count {
                let next = |species: u32| self.rows[species as usize].pop().expect("as many as the model counts");
                let rows: Vec<usize> = self.model.species_of_body(kind).into_iter().map(next).collect();
                if kind < self.model.bodies.len() {
                    objects.push(self.body(kind, number, &rows)?);
                } else {
                    objects.extend(rows.into_iter().map(|row| self.sphere(row)));
                }
            }
        }
        Ok(objects)
    }

    fn orientation(&self, row: usize) -> Quaternion {
        self.orientations.get(row).copied().unwrap_or(Quaternion::NONE)
    }

    fn sphere(&self, row: usize) -> Object<'a> {
        let species = self.species[row];
        let radius = self.model.species[species as usize].radius;
        Object::sphere(species, radius, self.positions[row], self.orientation(row))
    }

    fn body(&self, kind: usize, number: u64, rows: &[usize]) -> Result<Object<'a>, String> {
        let mut body = Object::body(self.model, kind, Vector::ZERO, self.orientation(rows[0]));
        body.centre = self.positions[rows[0]] - body.place(&body.members[0]);
        for (member, &row) in body.members.iter().zip(rows) {
            let apart = self.model.cell.nearest_image(self.positions[row] - body.place(member)).length();
            if apart > MISPLACED * member.radius {
                let (name, apart) = (&self.model.bodies[kind].name, Number(apart));
                return Err(format!(
                    "has a sphere in row {row} that is {apart:.3} away from its place in body {number} of \"{name}\"; \
                     the spheres of a body need to be in the order of [[bodies]], each with the orientation of the body"
                ));
            }
        }
        Ok(body)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::ARM;
    use crate::model::{Bodies, Filaments, Parameters, Species, Start};
    use crate::rotation::orientations;
    use crate::start::bodies;
    use domain::{BodyShape, BodySphere, EqualSpheres, Particles, PeriodicBox, Vector};

    fn parameters(start: Start) -> Parameters {
        let cell = PeriodicBox::sheared(Vector::new(14.0, 11.0, 12.0), 0.3).unwrap();
        Parameters { seed: 3, start, ..Parameters::new(cell, 1.0, vec![Species::new("free", 1.0, 7)], 0.1, 1) }
    }

    fn with_bodies(start: Start) -> Model {
        let at = |x: f64, radius: f64| BodySphere { position: Vector::X * x, radius };
        let mixed = Bodies::new("mixed", vec![at(0.0, 0.6), at(1.1, 0.4), at(2.2, 0.6)], 6);
        let rods = BodyShape::Rod(EqualSpheres { number: 4, radius: 0.5, gap: 0.0 }).spheres();
        Model::new(parameters(start).with_bodies(vec![mixed, Bodies::new("rods", rods, 5)])).unwrap()
    }

    fn random() -> Start {
        Start::Random { minimum_gap: 0.02 }
    }

    /// Particles as in a trajectory: positions are inside of the box, and rounded here.
    fn written(particles: &mut Particles, model: &Model) -> GivenPositions {
        let rounded = |x: f64| (x * 1e4).round() * 1e-4;
        GivenPositions {
            name: "a file".to_owned(),
            positions: particles.positions.iter().map(|&place| model.cell.wrap(place).0.map(rounded)).collect(),
            radii: None,
            species: Some(particles.species.clone()),
            orientations: Some(orientations(particles).to_vec()),
        }
    }

    #[test]
    fn bodies_of_a_file_are_rigid_and_at_their_places() {
        let (model, restarted) = (with_bodies(random()), with_bodies(Start::Given));
        let mut before = bodies::particles(&model, None).unwrap();
        let file = written(&mut before, &model);
        let mut after = bodies::particles(&restarted, Some(file)).unwrap();
        assert_eq!((&after.ids, &after.species, &after.radii), (&before.ids, &before.species, &before.radii));
        assert_eq!(after.vectors(ARM), before.vectors(ARM));
        assert_eq!(bodies::check(&after, &restarted), Ok(()));
        for (row, turned) in orientations(&mut before).to_vec().into_iter().enumerate() {
            let change = model.cell.nearest_image(after.positions[row] - before.positions[row]).length();
            assert!(change < 3e-4, "{row}: {change}");
            assert!(!turned.is_some() || (orientations(&mut after)[row] * turned.inverse()).v.length() < 1e-15);
        }
        // Rigid to round-off, although the file is not.
        let apart = |particles: &Particles, row: usize| particles.positions[row].distance(particles.positions[row + 1]);
        assert!((7..9).all(|row| (apart(&after, row) - 1.1).abs() < 1e-14));
    }

    #[test]
    fn rows_in_another_order_are_refused_unless_species_tell_them_apart() {
        let (model, restarted) = (with_bodies(random()), with_bodies(Start::Given));
        let mut particles = bodies::particles(&model, None).unwrap();
        let file = written(&mut particles, &model);
        let swapped = |a: usize, b: usize| {
            let mut file = file.clone();
            file.positions.swap(a, b);
            file.species.as_mut().unwrap().swap(a, b);
            file.orientations.as_mut().unwrap().swap(a, b);
            bodies::particles(&restarted, Some(file)).map_err(|error| error.to_string())
        };
        // Spheres 7, 8 and 9 are the first body, whose second sphere is of another species; 25 is the first of a rod.
        assert!(swapped(7, 8).is_ok() && swapped(0, 7).is_ok());
        let message = swapped(26, 27).unwrap_err();
        assert!(message.starts_with("a file: has a sphere in row 26 that is "), "{message}");
        assert!(message.contains("away from its place in body 0 of \"rods\""), "{message}");
        let none = GivenPositions { orientations: None, ..file.clone() };
        let message = bodies::particles(&restarted, Some(none)).unwrap_err().to_string();
        assert_eq!(message, "a file: has no orientations, which bodies and filaments need");
    }

    #[test]
    fn filaments_of_a_file_may_be_bent() {
        let spheres = EqualSpheres { number: 3, radius: 0.5, gap: 0.1 };
        let model = |start| {
            let filaments = vec![Filaments::new("threads", spheres, 2, [9.0, 4.0])];
            Model::new(parameters(start).with_filaments(filaments)).unwrap()
        };
        let mut particles = bodies::particles(&model(random()), None).unwrap();
        let mut file = written(&mut particles, &model(random()));
        file.positions[8] += Vector::new(0.2, -0.3, 0.1);
        let bent = bodies::particles(&model(Start::Given), Some(file.clone())).unwrap();
        assert_eq!(*bent.positions, file.positions);
    }
}
