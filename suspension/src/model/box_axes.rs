//! Axes of the user, which differ from those of the box if walls are across x or y.

use crate::columns::{ANGULAR_VELOCITY, BODY, ORIENTATION, PAIR_MOMENT, STRESSLET, VELOCITY};
use crate::model::Parameters;
use domain::{AxisRotation, Particles, PeriodicBox, Quaternion, Tensor, Traceless, Vector};
use simulation::{ContactForces, VelocityField};

/// Rotation from the axes of the box to the user's axes and back; the identity without a [`Parameters::turn`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UserAxes {
    /// Rotation from the user's axes to those of the box.
    turn: AxisRotation,
    /// Edges of the box in its own axes and in the user's. They change only along axes with the same direction in both.
    edges: [Vector; 2],
}

impl UserAxes {
    /// The user's axes of a model.
    pub fn of(parameters: &Parameters) -> Self {
        let (turn, edges) = (parameters.turn, parameters.cell.edges());
        Self { turn, edges: [edges, Vector::from_array(turn.inverse().list(edges.to_array()))] }
    }

    /// Rotation from the user's axes to those of the box.
    pub fn turn(&self) -> AxisRotation {
        self.turn
    }

    /// The user's axis (0, 1 or 2 for x, y and z) that corresponds to an axis of the box.
    pub fn axis(&self, of_box: usize) -> usize {
        self.turn.list([0, 1, 2])[of_box]
    }

    /// The user's name of an axis of the box.
    pub fn name(&self, of_box: usize) -> char {
        self.turn.list(['x', 'y', 'z'])[of_box]
    }

    /// A list with an entry per axis, in the user's order.
    pub fn list<T: Copy>(&self, of_box: [T; 3]) -> [T; 3] {
        self.turn.inverse().list(of_box)
    }

    /// A vector in the user's axes.
    pub fn vector(&self, of_box: Vector) -> Vector {
        self.turn.inverse().vector(of_box)
    }

    /// A vector in the axes of the box.
    pub fn vector_in(&self, of_user: Vector) -> Vector {
        self.turn.vector(of_user)
    }

    /// An orientation in the user's axes.
    pub fn orientation(&self, of_box: Quaternion) -> Quaternion {
        self.turn.inverse().quaternion(of_box)
    }

    /// An orientation in the axes of the box.
    pub fn orientation_in(&self, of_user: Quaternion) -> Quaternion {
        self.turn.quaternion(of_user)
    }

    /// A tensor in the user's axes.
    pub fn tensor(&self, of_box: &Tensor) -> Tensor {
        self.turn.inverse().tensor(of_box)
    }

    /// A tensor of the user's in the axes of the box.
    pub fn tensor_in(&self, of_user: &Tensor) -> Tensor {
        self.turn.tensor(of_user)
    }

    /// A position in the user's axes.
    pub fn place(&self, in_box: Vector) -> Vector {
        self.turn.inverse().place(in_box, self.edges[1])
    }

    /// A position in the axes of the box.
    pub fn place_in(&self, of_user: Vector) -> Vector {
        self.turn.place(of_user, self.edges[0])
    }

    /// The box in the user's axes. With rotated axes it has no information about its boundaries, which a
    /// [`simulation::Frame`] gives in addition.
    pub fn cell(&self, cell: &PeriodicBox) -> PeriodicBox {
        if self.turn.is_none() {
            return *cell;
        }
        let [origin, edges] = [cell.origin(), cell.edges()].map(|v| Vector::from_array(self.list(v.to_array())));
        PeriodicBox::new(edges).and_then(|plain| plain.with_extent(origin, edges)).expect("edges of a box")
    }

    /// Particles in the user's axes, with velocities, angular velocities, stresslets, orientations and pair moments,
    /// as far as they have these columns.
    pub fn particles(&self, mut particles: Particles) -> Particles {
        if self.turn.is_none() {
            return particles;
        }
        for (position, steps) in particles.positions.iter_mut().zip(&mut particles.steps) {
            (*position, *steps) = self.inside(self.place(*position), self.turn.inverse().steps(*steps));
        }
        for column in &mut particles.columns {
            match column.name.as_str() {
                VELOCITY | ANGULAR_VELOCITY => {
                    let vectors: &mut [Vector] = bytemuck::cast_slice_mut(&mut column.values);
                    for vector in vectors {
                        *vector = self.vector(*vector);
                    }
                }
                STRESSLET => {
                    let stresslets: &mut [Traceless] = bytemuck::cast_slice_mut(&mut column.values);
                    for stresslet in stresslets {
                        *stresslet = self.turn.inverse().traceless(*stresslet);
                    }
                }
                ORIENTATION => {
                    let orientations: &mut [Quaternion] = bytemuck::cast_slice_mut(&mut column.values);
                    for orientation in orientations {
                        *orientation = self.orientation(*orientation);
                    }
                }
                PAIR_MOMENT => {
                    let moments: &mut [Tensor] = bytemuck::cast_slice_mut(&mut column.values);
                    for moment in moments {
                        *moment = self.tensor(moment);
                    }
                }
                BODY => {}
                other => unreachable!("\"{other}\" is for nobody outside"),
            }
        }
        particles
    }

    /// Along a reversed axis a position on the near face of the box is mapped to the far face: wraps it, with one step
    /// more.
    fn inside(&self, mut place: Vector, mut steps: [i32; 3]) -> (Vector, [i32; 3]) {
        for (axis, against) in self.turn.inverse().against().into_iter().enumerate() {
            if against && place[axis] >= self.edges[1][axis] {
                (place[axis], steps[axis]) = (0.0, steps[axis].wrapping_add(1));
            }
        }
        (place, steps)
    }

    /// A velocity field in the user's axes.
    pub fn field(&self, field: VelocityField) -> VelocityField {
        if self.turn.is_none() {
            return field;
        }
        let (back, of_box) = (self.turn.inverse(), self.list([0, 1, 2]));
        let (points, periodic) = (self.list(field.points), self.list(field.periodic));
        let [mut first, spacing] = [field.origin, field.spacing].map(|v| Vector::from_array(self.list(v.to_array())));
        for axis in (0..3).filter(|&axis| back.against()[axis]) {
            // Along a reversed axis the point at the near face is mapped to the far face, and a periodic box starts
            // again there.
            let last = first[axis] + (points[axis] - 1) as f64 * spacing[axis];
            first[axis] = if periodic[axis] { 0.0 } else { self.edges[1][axis] - last };
        }
        let point = |axis: usize, number: usize| match (back.against()[axis], periodic[axis]) {
            (false, _) => number,
            (true, true) => (points[axis] - number) % points[axis],
            (true, false) => points[axis] - 1 - number,
        };
        let [nx, ny, _] = field.points;
        let value = |at: [usize; 3]| {
            let mut inside = [0; 3];
            (0..3).for_each(|axis| inside[of_box[axis]] = point(axis, at[axis]));
            self.vector(field.values[(inside[2] * ny + inside[1]) * nx + inside[0]])
        };
        let [all_x, all_y, all_z] = if field.values.is_empty() { [0; 3] } else { points };
        let places = (0..all_z).flat_map(|z| (0..all_y).flat_map(move |y| (0..all_x).map(move |x| [x, y, z])));
        let values = places.map(value).collect();
        VelocityField { cell: self.cell(&field.cell), origin: first, spacing, points, periodic, values, ..field }
    }

    /// Contact forces in the user's axes.
    pub fn contacts(&self, mut contacts: ContactForces) -> ContactForces {
        if self.turn.is_none() {
            return contacts;
        }
        let edges = self.list(contacts.lattice.map(Vector::length));
        contacts.lattice = [Vector::X * edges[0], Vector::Y * edges[1], Vector::Z * edges[2]];
        for contact in &mut contacts.list {
            contact.position = self.inside(self.place(contact.position), [0; 3]).0;
            contact.separation = self.vector(contact.separation);
            contact.tangential = self.vector(contact.tangential);
        }
        contacts
    }
}
