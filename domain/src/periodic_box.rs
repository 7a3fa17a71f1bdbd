//! Periodic, possibly sheared box, which may have walls or be open.

use crate::{Boundaries, Number, Tensor, Vector};

/// Reason why a box is refused.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum BoxError {
    /// An edge is not a positive length.
    #[error("box edge {axis} is {}; an edge needs to be positive and finite", Number(*length))]
    Edge {
        /// Axis: x, y or z.
        axis: char,
        /// Length given.
        length: f64,
    },
    /// The strain is not a finite number.
    #[error("the box's strain is {}; it needs to be a finite number", Number(*.0))]
    Strain(f64),
    /// The lattice vectors span no volume, or are in left-handed order.
    #[error(
        "the box's lattice vectors span a volume of {}; they need to be finite and in right-handed order, so that it \
         is positive",
        Number(*.0)
    )]
    Lattice(f64),
    /// Walls or open faces of a box that is sheared or not along x, y and z.
    #[error("a box with {0:?} boundaries has edges along x, y and z; it can be neither sheared nor any other lattice")]
    Bounded(Boundaries),
}

/// A periodic box. With Lees-Edwards boundary conditions its lattice vectors are `(Lx, 0, 0)`, `(s Ly, Ly, 0)` and
/// `(0, 0, Lz)`: flow along x, gradient along y, vorticity along z, strain `s`. The lattices of `s` and of
/// `s + Lx/Ly` are the same, and `s` is kept in `[-Lx/(2 Ly), Lx/(2 Ly))`.
///
/// Positions in the box have lattice coordinates `(xi, eta, zeta) = (x - s y, y, z)`, each in `[0, L)` of its axis,
/// which are periodic one by one.
///
/// Any other lattice, as extensional flows need, is such a box in axes of its own: the first axis is along the first
/// lattice vector and the second in the plane of the first two. In these axes the lattice vectors are `(Lx, 0, 0)`,
/// `Ly (s, 1, 0)` and `Lz (t, r, 1)`, and `y = eta + r zeta`, `x = xi + s eta + t zeta`.
///
/// A box with other [`Boundaries`] is not periodic along some axes: along them positions are never wrapped, may lie
/// outside of the box if the fluid is open, and have no images. If the fluid is open the box may be anywhere: it
/// begins at an origin, which is zero along periodic axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeriodicBox {
    edges: Vector,
    strain: f64,
    /// `t` and `r`.
    tilts: [f64; 2],
    /// Axes as columns, if they are not x, y and z.
    axes: Option<Tensor>,
    boundaries: Boundaries,
    origin: Vector,
}

impl PeriodicBox {
    /// A box that is not sheared.
    pub fn new(edges: Vector) -> Result<Self, BoxError> {
        Self::sheared(edges, 0.0)
    }

    /// A box at a Lees-Edwards strain, which is reduced to its range.
    pub fn sheared(edges: Vector, strain: f64) -> Result<Self, BoxError> {
        for (axis, length) in "xyz".chars().zip(edges.to_array()) {
            if !(length.is_finite() && length > 0.0) {
                return Err(BoxError::Edge { axis, length });
            }
        }
        if !strain.is_finite() {
            return Err(BoxError::Strain(strain));
        }
        let (period, boundaries) = (edges.x / edges.y, Boundaries::Periodic);
        let turns = (strain / period + 0.5).floor();
        Ok(Self {
            edges,
            strain: strain - turns * period,
            tilts: [0.0; 2],
            axes: None,
            boundaries,
            origin: Vector::ZERO,
        })
    }

    /// Box of any three lattice vectors in right-handed order, which are kept as they are.
    pub fn of_lattice(vectors: [Vector; 3]) -> Result<Self, BoxError> {
        let [a, b, c] = vectors;
        let volume = a.cross(b).dot(c);
        if !(volume.is_finite() && volume > 0.0) {
            return Err(BoxError::Lattice(volume));
        }
        let z = a.cross(b).normalize();
        let x = a.normalize();
        let y = z.cross(x);
        let edges = Vector::new(a.length(), b.dot(y), c.dot(z));
        let tilts = [c.dot(x) / edges.z, c.dot(y) / edges.z];
        let (axes, boundaries) = (Some(Tensor::from_cols(x, y, z)), Boundaries::Periodic);
        Ok(Self { edges, strain: b.dot(x) / edges.y, tilts, axes, boundaries, origin: Vector::ZERO })
    }

    /// The same box with other boundaries; only a box that is not sheared and along x, y and z can have them.
    pub fn with_boundaries(&self, boundaries: Boundaries) -> Result<Self, BoxError> {
        let is_plain = self.strain == 0.0 && self.axes.is_none();
        if boundaries != Boundaries::Periodic && !is_plain {
            return Err(BoxError::Bounded(boundaries));
        }
        Ok(Self { boundaries, ..*self })
    }

    /// A box of the same boundaries with other edges and another origin along axes that are not periodic.
    pub fn with_extent(&self, origin: Vector, edges: Vector) -> Result<Self, BoxError> {
        let plain = Self::new(edges)?.with_boundaries(self.boundaries)?;
        Ok(Self { origin, ..plain })
    }

    /// Origin of the box along axes that are not periodic.
    pub fn origin(&self) -> Vector {
        self.origin
    }

    /// Position in the box as fractions of its edges.
    #[inline]
    pub fn fractional_coordinates(&self, position: Vector) -> Vector {
        (self.lattice_coordinates(position) - self.origin) / self.edges
    }

    /// Boundary conditions at the faces.
    pub fn boundaries(&self) -> Boundaries {
        self.boundaries
    }

    /// Whether the box is periodic along an axis: 0, 1 and 2 for x, y and z.
    #[inline]
    pub fn is_periodic(&self, axis: usize) -> bool {
        self.boundaries.is_periodic(axis)
    }

    /// The same box in other units of length: all lengths times `factor`, a power of two, so nothing is rounded.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self { edges: self.edges * factor, origin: self.origin * factor, ..*self }
    }

    /// Edge lengths: the periods of the lattice coordinates.
    pub fn edges(&self) -> Vector {
        self.edges
    }

    /// Strain `s` of the lattice.
    pub fn strain(&self) -> f64 {
        self.strain
    }

    /// Volume, which a shear does not change.
    pub fn volume(&self) -> f64 {
        self.edges.x * self.edges.y * self.edges.z
    }

    /// `t` and `r`, by which the third lattice vector is tilted along the box's first and second axis; zero in a
    /// sheared box.
    pub fn tilts(&self) -> [f64; 2] {
        self.tilts
    }

    /// Whether the third lattice vector is orthogonal to the others up to round-off.
    pub fn is_orthogonal(&self) -> bool {
        self.tilts.iter().all(|tilt| tilt.abs() < 1e-12)
    }

    /// Axes of the box as columns, unless they are x, y and z.
    pub fn axes(&self) -> Option<&Tensor> {
        self.axes.as_ref()
    }

    /// The three lattice vectors.
    pub fn lattice_vectors(&self) -> [Vector; 3] {
        [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(|steps| self.lattice(steps))
    }

    /// Lattice vector for an integer number of steps along each edge.
    pub fn lattice(&self, steps: [i32; 3]) -> Vector {
        self.position(Vector::from_array(steps.map(f64::from)) * self.edges)
    }

    /// Lattice coordinates of a position as lengths along each axis, not wrapped.
    pub fn lattice_coordinates(&self, position: Vector) -> Vector {
        let Some(axes) = &self.axes else {
            return Vector::new(position.x - self.strain * position.y, position.y, position.z);
        };
        let [t, r] = self.tilts;
        let Vector { x, y, z } = axes.transpose() * position;
        let y = y - r * z;
        Vector::new(x - self.strain * y - t * z, y, z)
    }

    /// Position with these lattice coordinates.
    pub fn position(&self, coordinates: Vector) -> Vector {
        let Vector { x, y, z } = coordinates;
        let Some(axes) = &self.axes else {
            return Vector::new(x + self.strain * y, y, z);
        };
        let [t, r] = self.tilts;
        *axes * Vector::new(x + self.strain * y + t * z, y + r * z, z)
    }

    /// Largest difference of each lattice coordinate between positions a unit of length apart.
    pub fn coordinate_stretch(&self) -> Vector {
        let [t, r] = self.tilts;
        let first = t - self.strain * r;
        Vector::new((1.0 + self.strain.powi(2) + first * first).sqrt(), (1.0 + r * r).sqrt(), 1.0)
    }

    /// Image of a position inside the box, and the lattice steps that were taken out of the position:
    /// `position = wrapped + lattice(steps)`. Along axes that are not periodic nothing is taken out.
    pub fn wrap(&self, position: Vector) -> (Vector, [i32; 3]) {
        let (coordinates, repeats) = (self.lattice_coordinates(position), self.boundaries.repeats());
        let mut steps = (coordinates / self.edges).floor() * repeats;
        let mut wrapped = position - self.lattice(whole(steps));
        // Round-off can leave an image on the far face, or just below the near one.
        let again = (self.lattice_coordinates(wrapped) / self.edges).floor() * repeats;
        if again != Vector::ZERO {
            steps += again;
            wrapped = position - self.lattice(whole(steps));
            let coordinates = self.lattice_coordinates(wrapped);
            let inside = coordinates.clamp(Vector::ZERO, self.edges * (1.0 - f64::EPSILON));
            wrapped = self.position(Vector::select(repeats.cmpgt(Vector::ZERO), inside, coordinates));
        }
        (wrapped, whole(steps))
    }

    /// Shortest of the images of a separation, in a box whose strain is in its range.
    pub fn nearest_image(&self, separation: Vector) -> Vector {
        if self.axes.is_some() {
            return self.nearest_of_any(separation);
        }
        if !self.is_periodic(2) {
            return separation - self.lattice(whole(self.whole_steps(separation)));
        }
        let mut d = separation;
        d.z -= (d.z / self.edges.z).round() * self.edges.z;
        let steps = (d.y / self.edges.y).round();
        d.y -= steps * self.edges.y;
        d.x -= steps * self.strain * self.edges.y;
        d.x -= (d.x / self.edges.x).round() * self.edges.x;
        if self.strain == 0.0 {
            return d;
        }
        // The rounding above is exact for an orthogonal box only: an image one row up or down may be nearer.
        let mut nearest = d;
        for row in [-1.0, 1.0] {
            let mut e = d;
            e.y += row * self.edges.y;
            e.x += row * self.strain * self.edges.y;
            e.x -= (e.x / self.edges.x).round() * self.edges.x;
            if e.length_squared() < nearest.length_squared() {
                nearest = e;
            }
        }
        nearest
    }

    /// Number of edges that a separation, in lattice coordinates, spans, rounded: 0 along axes that are not periodic.
    pub(crate) fn whole_steps(&self, coordinates: Vector) -> Vector {
        (coordinates / self.edges).round() * self.boundaries.repeats()
    }

    /// Shortest of the images of a separation, in a lattice with a reduced basis: no vector is much shorter after
    /// adding a multiple of another.
    fn nearest_of_any(&self, separation: Vector) -> Vector {
        let steps = whole((self.lattice_coordinates(separation) / self.edges).round());
        let around = || (-1..=1).flat_map(|z| (-1..=1).flat_map(move |y| (-1..=1).map(move |x| [x, y, z])));
        let images = around().map(|by| separation - self.lattice(std::array::from_fn(|d| steps[d] + by[d])));
        images.min_by(|a, b| a.length_squared().total_cmp(&b.length_squared())).expect("there are 27")
    }
}

fn whole(steps: Vector) -> [i32; 3] {
    steps.to_array().map(|s| s as i32)
}

#[cfg(test)]
mod tests;
