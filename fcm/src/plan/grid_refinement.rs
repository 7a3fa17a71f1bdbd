//! Refinement of the grids of lattices that are not orthogonal.

use crate::plan::method::Method;
use crate::plan::problem::Problem;
use crate::plan::{LONG, Plan};
use domain::{Boundaries, Vector};
use solver::Grid;

impl Plan {
    /// Whether the grid is that of the least sheared lattice with the same points: see [`Grid::reduced`].
    pub(crate) fn is_reduced(&self) -> bool {
        self.split.is_some() && !self.is_tilted && is_long(self.boundaries, self.smallest_edge_ratio, self.edges)
    }
}

/// Whether a box of constant edges is so long along the flow that the strain of its lattice may be large.
fn is_long(boundaries: Boundaries, smallest_edge_ratio: f64, edges: Vector) -> bool {
    boundaries == Boundaries::Periodic && smallest_edge_ratio >= 1.0 && edges.x >= LONG * edges.y
}

/// `sqrt(1 + s^2)`
fn of_strain(strain: f64) -> f64 {
    (1.0 + strain * strain).sqrt()
}

impl Problem {
    /// Whether the third lattice vector is tilted.
    pub(crate) fn is_tilted(&self) -> bool {
        self.largest_tilts.iter().any(|&tilt| tilt != 0.0)
    }

    /// Whether grids of the split method are reduced: [`Plan::is_reduced`].
    pub(crate) fn is_reduced(&self) -> bool {
        !self.is_tilted() && is_long(self.boundaries, self.smallest_edge_ratio, self.edges)
    }

    /// Lengths of the lattice vectors over the box's edges: a grid sheared by `s` resolves `sqrt(1 + s^2)` less along
    /// y.
    pub(crate) fn lengthened(&self) -> Vector {
        let (s, [t, r]) = (self.largest_strain, self.largest_tilts);
        Vector::new(1.0, of_strain(s), (1.0 + t * t + r * r).sqrt())
    }

    /// Largest of these, and of the factor by which a sphere extends farther along a lattice coordinate:
    /// [`domain::PeriodicBox::coordinate_stretch`].
    pub(crate) fn stretch(&self) -> f64 {
        let (s, [t, r]) = (self.largest_strain, self.largest_tilts);
        let (first, Vector { y, z, .. }) = (t + s * r, self.lengthened());
        (1.0 + s * s + first * first).sqrt().max(y).max(z)
    }

    /// Refinement of a method's grid along each axis. A reduced one is sheared by at most half of `hx/hy`. If `hx` is
    /// at most the spacing `h` that an orthogonal grid needs, then `hy = h sqrt(3)/2` is enough for
    /// `hy^2 + (hx/2)^2 <= h^2`.
    pub(crate) fn lengthened_for(&self, method: Method) -> Vector {
        if method == Method::Direct || !self.is_reduced() {
            return self.lengthened();
        }
        Vector::new(1.0, of_strain(self.largest_strain.min(3f64.sqrt().recip())), 1.0)
    }

    /// Lengths of the lattice vectors of a method's grid over its given spacings.
    pub(crate) fn lengthened_on(&self, is_split: bool, spacing: Vector) -> Vector {
        if !is_split || !self.is_reduced() {
            return self.lengthened();
        }
        Vector::new(1.0, of_strain(self.largest_strain.min(0.5 * spacing.x / spacing.y)), 1.0)
    }

    /// [`Self::stretch`] for the grid of the split method that replaces an orthogonal one of this spacing.
    pub(crate) fn stretch_at(&self, spacing: f64) -> f64 {
        if !self.is_reduced() {
            return self.stretch();
        }
        let needed = self.edges.y / spacing * self.lengthened_for(Method::Split).y;
        let points = Grid::good_size((needed - 1e-9).ceil() as usize);
        let strain = 0.5 * spacing * points as f64 / self.edges.y;
        of_strain(self.largest_strain.min(strain))
    }

    /// Factor by which a given grid of the split method is coarser than an orthogonal one with its largest spacing.
    pub(crate) fn coarsening(&self, spacing: Vector) -> f64 {
        if !self.is_reduced() {
            return self.stretch();
        }
        let strain = self.largest_strain.min(0.5 * spacing.x / spacing.y);
        (spacing * Vector::new(1.0, of_strain(strain), 1.0)).max_element() / spacing.max_element()
    }
}
