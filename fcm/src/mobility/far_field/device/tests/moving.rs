//! Particles with velocities in a flow, and their near pairs from all images.

use super::*;
use crate::mobility::stepping::{DisplacementWeights, HeldSteps, HeldVelocities};
use domain::{ParticleValues, Random, RemoteHolder, RemoteList, Tensor, remote_columns};
use solver::BackgroundFlow;

/// Unit of length of the cases, which differs from that of the far field.
const UNIT: f64 = 0.2;

/// Particles with columns of velocities by rows.
pub(super) struct Moving {
    pub case: Case,
    pub columns: Vec<Vec<Vector>>,
    pub flow: BackgroundFlow,
    /// Deformation of separations by a flow that advects the particles.
    pub deformation: Tensor,
}

/// A pair: rows of a sphere and of another, of which this is an image, the vector from the image, and the relative
/// velocities.
pub(super) struct MovingPair {
    pub rows: [usize; 2],
    pub separation: Vector,
    pub velocities: Vec<Vector>,
    pub radii: [f64; 2],
    deformation: Tensor,
}

/// The same on a device.
pub(super) struct Held {
    _far: DeviceFarField,
    pub holder: Rc<dyn RemoteHolder>,
    pub steps: Rc<dyn HeldSteps>,
    pub positions: RemoteList,
    pub columns: Vec<RemoteList>,
    places: Vec<u32>,
    flow: BackgroundFlow,
    deformation: Tensor,
}

impl MovingPair {
    pub fn mean(&self) -> f64 {
        0.5 * (self.radii[0] + self.radii[1])
    }

    pub fn after(&self, weights: &DisplacementWeights) -> Vector {
        self.deformation * (self.separation + self.velocities.iter().zip(weights).map(|(&v, &w)| v * w).sum::<Vector>())
    }

    pub fn gap_after(&self, weights: &DisplacementWeights) -> f64 {
        self.after(weights).length() - 2.0 * self.mean()
    }
}

impl Moving {
    /// Spheres of sizes 1 to 3, every third of which nearly touches the one before, with some columns of velocities.
    /// Rows are not in the order of ids, and some of the sheared boxes have half a period of strain.
    pub fn random(seed: u64, shape: Shape, columns: usize) -> Self {
        let mut case = Case::random(seed, shape, 1.0 + 2.0 * (seed % 2) as f64);
        if shape == Shape::Sheared && seed.is_multiple_of(5) {
            let edges = case.cell.edges();
            case.cell = PeriodicBox::sheared(edges, -0.5 * edges.x / edges.y).unwrap();
            let cell = case.cell;
            case.particles.positions.iter_mut().for_each(|x| *x = cell.wrap(*x).0);
        }
        let (mut random, count) = (Random::new(seed, 1), case.particles.len());
        let mut vector = || Vector::from_array(std::array::from_fn(|_| 2.0 * random.uniform() - 1.0));
        for row in (1..count).step_by(3) {
            let contact = case.particles.radii[row - 1] + case.particles.radii[row];
            let place = case.particles.positions[row - 1] + vector().normalize() * (contact + 1e-3 * vector().x);
            case.particles.positions[row] = case.cell.wrap(place).0;
        }
        case.cell = case.cell.scaled(UNIT);
        case.particles.positions.iter_mut().for_each(|x| *x *= UNIT);
        case.particles.radii.iter_mut().for_each(|a| *a *= UNIT);
        let gradient =
            Tensor::from_cols(Vector::new(0.0, 0.1, 0.0), Vector::new(0.7, 0.0, -0.3), Vector::new(0.2, 0.4, 0.0));
        let (flow, deformation) = match shape {
            Shape::Tilted => (BackgroundFlow::NONE, Tensor::IDENTITY + gradient * 0.01),
            _ => (BackgroundFlow::with_gradient(gradient).unwrap(), Tensor::IDENTITY),
        };
        let columns = (0..columns)
            .map(|_| case.particles.positions.iter().map(|&x| flow.velocity(x) + 0.3 * UNIT * vector()).collect());
        Self { columns: columns.collect(), flow, deformation, case }.with_other_ids()
    }

    /// The given spheres in a cube, with one column of velocities.
    pub fn in_cube(edge: f64, spheres: &[(Vector, f64, Vector)]) -> Self {
        let mut case = Case::random(2, Shape::Upright, 1.0);
        case.cell = PeriodicBox::new(Vector::splat(edge)).unwrap();
        case.particles = Particles::default();
        for (id, &(position, radius, _)) in spheres.iter().enumerate() {
            case.particles.push(id as u64, position, radius, 0);
        }
        let columns = vec![spheres.iter().map(|&(.., velocity)| velocity).collect()];
        Self { case, columns, flow: BackgroundFlow::NONE, deformation: Tensor::IDENTITY }.with_other_ids()
    }

    fn with_other_ids(mut self) -> Self {
        let count = self.case.particles.len() as u64;
        self.case.particles.ids = (0..count).map(|row| 10 * (count - row)).collect();
        self
    }

    /// Pairs whose centres are within a distance, each once for all images.
    pub fn near(&self, reach: f64) -> Vec<MovingPair> {
        let (Particles { positions, radii, .. }, cell) = (&self.case.particles, &self.case.cell);
        let mut near = Vec::new();
        for (i, j) in (0..positions.len()).flat_map(|i| (0..=i).map(move |j| (i, j))) {
            for image in 0..7_i32.pow(3) {
                let steps = [image % 7 - 3, image / 7 % 7 - 3, image / 49 - 3];
                let lattice = cell.lattice(steps);
                let separation = positions[i] - (positions[j] + lattice);
                if separation.length() < reach && (i, [0; 3]) != (j, steps) {
                    let of_image = self.flow.velocity(lattice);
                    let velocities = self.columns.iter().map(|of| of[i] - (of[j] + of_image)).collect();
                    let (radii, deformation) = ([radii[i], radii[j]], self.deformation);
                    near.push(MovingPair { rows: [i, j], separation, velocities, radii, deformation });
                }
            }
        }
        near
    }

    /// On an emulator with an order of threads, at positions that are here or on the device.
    pub fn on(&self, precision: Precision, device: Box<dyn Device>, are_here: bool) -> Held {
        let Case { cell, particles, .. } = &self.case;
        let mut far = self.case.on_device(&self.case.plan(precision), device);
        let coupled = far.coupled().unwrap();
        let (holder, steps) = (coupled.holder(), coupled.steps());
        let places = remote_columns::places_by_id(&particles.ids);
        let hold = |values: &[Vector]| {
            let mut by_place = vec![[0.0; 3]; values.len()];
            values.iter().zip(&places).for_each(|(x, &place)| by_place[place as usize] = x.to_array());
            holder.hold(by_place.as_flattened())
        };
        let positions = hold(&particles.positions);
        if !are_here {
            let mut moved = particles.clone();
            moved.positions = ParticleValues::remote(positions.clone());
            moved.steps = ParticleValues::remote(hold(&vec![Vector::ZERO; particles.len()]));
            far.arrange(cell, &moved);
        }
        let columns = self.columns.iter().map(|column| hold(column)).collect();
        let &Self { flow, deformation, .. } = self;
        Held { _far: far, holder, steps, positions, columns, places, flow, deformation }
    }
}

impl Held {
    pub fn velocities(&self) -> HeldVelocities<'_> {
        let deformation = self.deformation;
        HeldVelocities { positions: &self.positions, columns: &self.columns, flow: &self.flow, deformation }
    }

    /// Vectors of a list by rows.
    pub fn vectors(&self, list: &RemoteList) -> Vec<Vector> {
        let values = self.holder.copies(&[list]).remove(0);
        self.places.iter().map(|&place| Vector::from_slice(&values[3 * place as usize..][..3])).collect()
    }
}
