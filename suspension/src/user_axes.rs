//! The axes of the user, which a box with walls across x or y does not share with its own.

use crate::columns::{ANGULAR_VELOCITY, PAIR_MOMENT, STRESSLET, VELOCITY};
use crate::model::Parameters;
use domain::{Particles, PeriodicBox, Tensor, Traceless, Turn, Vector};
use simulation::{ContactForces, VelocityField};

/// From the axes of a box to those of whoever gave it, and back; the same where [`Parameters::turn`] is none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UserAxes {
    /// From the user's to the box's.
    turn: Turn,
    /// Edges of the box, and as the user has them. They change along axes alone that point the same way in both.
    edges: [Vector; 2],
}

impl UserAxes {
    /// Those of a model.
    pub fn of(parameters: &Parameters) -> Self {
        let (turn, edges) = (parameters.turn, parameters.cell.edges());
        Self { turn, edges: [edges, Vector::from_array(turn.inverse().list(edges.to_array()))] }
    }

    /// From the user's axes to those of the box.
    pub fn turn(&self) -> Turn {
        self.turn
    }

    /// Which of the user's axes one of the box's is: 0, 1 or 2 for x, y and z.
    pub fn axis(&self, of_box: usize) -> usize {
        self.turn.list([0, 1, 2])[of_box]
    }

    /// What the user calls an axis of the box.
    pub fn name(&self, of_box: usize) -> char {
        self.turn.list(['x', 'y', 'z'])[of_box]
    }

    /// A list of an entry for each axis.
    pub fn list<T: Copy>(&self, of_box: [T; 3]) -> [T; 3] {
        self.turn.inverse().list(of_box)
    }

    /// A vector.
    pub fn vector(&self, of_box: Vector) -> Vector {
        self.turn.inverse().vector(of_box)
    }

    /// A vector of the user's in the axes of the box.
    pub fn vector_in(&self, of_user: Vector) -> Vector {
        self.turn.vector(of_user)
    }

    /// A tensor.
    pub fn tensor(&self, of_box: &Tensor) -> Tensor {
        self.turn.inverse().tensor(of_box)
    }

    /// A tensor of the user's in the axes of the box.
    pub fn tensor_in(&self, of_user: &Tensor) -> Tensor {
        self.turn.tensor(of_user)
    }

    /// A place.
    pub fn place(&self, in_box: Vector) -> Vector {
        self.turn.inverse().place(in_box, self.edges[1])
    }

    /// A place of the user's in the box.
    pub fn place_in(&self, of_user: Vector) -> Vector {
        self.turn.place(of_user, self.edges[0])
    }

    /// A box, at whose faces is nothing but what a [`simulation::Frame`] says besides where axes are others.
    pub fn cell(&self, cell: &PeriodicBox) -> PeriodicBox {
        if self.turn.is_none() {
            return *cell;
        }
        let [origin, edges] = [cell.origin(), cell.edges()].map(|v| Vector::from_array(self.list(v.to_array())));
        PeriodicBox::new(edges).and_then(|plain| plain.spanning(origin, edges)).expect("edges of a box")
    }

    /// Particles with velocities, angular velocities, stresslets and moments of pairs, as far as they have them.
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
                PAIR_MOMENT => {
                    let moments: &mut [Tensor] = bytemuck::cast_slice_mut(&mut column.values);
                    for moment in moments {
                        *moment = self.tensor(moment);
                    }
                }
                other => unreachable!("\"{other}\" is for nobody outside"),
            }
        }
        particles
    }

    /// A place on the near face of the box is on the far one along axes that point the other way: one step further.
    fn inside(&self, mut place: Vector, mut steps: [i32; 3]) -> (Vector, [i32; 3]) {
        for (axis, against) in self.turn.inverse().against().into_iter().enumerate() {
            if against && place[axis] >= self.edges[1][axis] {
                (place[axis], steps[axis]) = (0.0, steps[axis].wrapping_add(1));
            }
        }
        (place, steps)
    }

    /// A velocity field.
    pub fn field(&self, field: VelocityField) -> VelocityField {
        if self.turn.is_none() {
            return field;
        }
        let (back, of_box) = (self.turn.inverse(), self.list([0, 1, 2]));
        let (points, periodic) = (self.list(field.points), self.list(field.periodic));
        let [mut first, spacing] = [field.first, field.spacing].map(|v| Vector::from_array(self.list(v.to_array())));
        for axis in (0..3).filter(|&axis| back.against()[axis]) {
            // The point at the near face is at the far one, from where a box that repeats begins anew.
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
        VelocityField { cell: self.cell(&field.cell), first, spacing, points, periodic, values, ..field }
    }

    /// Forces of contacts.
    pub fn contacts(&self, mut contacts: ContactForces) -> ContactForces {
        if self.turn.is_none() {
            return contacts;
        }
        let edges = self.list(contacts.lattice.map(Vector::length));
        contacts.lattice = [Vector::X * edges[0], Vector::Y * edges[1], Vector::Z * edges[2]];
        for contact in &mut contacts.list {
            contact.place = self.inside(self.place(contact.place), [0; 3]).0;
            contact.separation = self.vector(contact.separation);
            contact.tangential = self.vector(contact.tangential);
        }
        contacts
    }
}
