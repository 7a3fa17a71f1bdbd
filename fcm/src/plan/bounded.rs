//! Grids for boxes that are not periodic along all axes.

use crate::envelope::{Common, Envelope};
use crate::grid::window::KaiserBessel;
use crate::plan::Plan;
use crate::plan::method::Split;
use crate::plan::problem::{Multipoles, Problem};
use crate::plan::wavenumber_split::{SplitInput, WavenumberSplit};
use domain::{Boundaries, Number, PeriodicBox, Units, Vector};

/// Least distance of a sphere's centre from a wall, in radii: below about 0.8 the mobility is not positive definite.
pub const NEAREST_WALL: f64 = 0.85;

/// Error for a sphere that is too near a wall, or outside of the box.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "sphere {id} of radius {} is at {axis} = {}; the box is {} long there with {what}, and its centre needs to be \
     from {} to {}",
    Number(*radius), Number(*place), Number(*edge), Number(allowed[0]), Number(allowed[1])
)]
pub struct OutsideError {
    /// Id of the sphere.
    pub id: u64,
    /// Radius of the sphere.
    pub radius: f64,
    /// Axis along which it is outside: x, y or z.
    pub axis: char,
    /// Coordinate of its centre along that axis.
    pub place: f64,
    /// Edge of the box along the axis.
    pub edge: f64,
    /// Description of the boundaries across the axis.
    pub what: &'static str,
    /// Interval in which the centre has to be.
    pub allowed: [f64; 2],
}

/// Refuses a sphere that is nearer to a wall than [`NEAREST_WALL`] of its radius, or outside of the box along an axis
/// that is not periodic.
pub fn check_inside(cell: &PeriodicBox, id: u64, position: Vector, radius: f64) -> Result<(), OutsideError> {
    for (axis, name) in "xyz".chars().enumerate().filter(|(axis, _)| !cell.is_periodic(*axis)) {
        let (place, edge) = (position[axis], cell.edges()[axis]);
        let allowed = allowed(cell.boundaries(), edge, radius);
        // Positions computed from those of spheres at the limits are not refused for round-off.
        let round_off = 1e-9 * edge;
        if !(allowed[0] - round_off..=allowed[1] + round_off).contains(&place) {
            let what = match cell.boundaries() {
                Boundaries::Walls => "walls at both ends",
                Boundaries::Wall => "a wall at 0 and unbounded fluid above",
                _ => "open ends",
            };
            return Err(OutsideError { id, radius, axis: name, place, edge, what, allowed });
        }
    }
    Ok(())
}

/// Interval in which centres have to be along an axis that is not periodic.
fn allowed(boundaries: Boundaries, edge: f64, radius: f64) -> [f64; 2] {
    let [below, above] = [1, 2].map(|walls| if boundaries.walls() >= walls { NEAREST_WALL * radius } else { 0.0 });
    [below, edge - above]
}

/// Quantities of a plan on which the wavenumber split at walls depends.
pub(crate) struct WallGrid {
    pub boundaries: Boundaries,
    /// Smallest and largest radius.
    pub radii: [f64; 2],
    pub multipoles: Multipoles,
    /// Relative error allowed for the split of wavenumbers.
    pub allowed: f64,
    pub width: f64,
    pub cutoff: f64,
    pub spacing: f64,
    pub points: usize,
    /// Edge of the box across the walls.
    pub height: f64,
}

impl WallGrid {
    /// Wavenumber split between the grid and pairs of spheres, and the error of the walls' flow; no split and no
    /// error without walls.
    pub fn cut(&self) -> (WavenumberSplit, f64) {
        let [smallest, _] = self.radii;
        if self.boundaries.walls() == 0 {
            return (WavenumberSplit::none(self.spacing), 0.0);
        }
        let envelopes = self.radii.map(Envelope::of_sphere);
        let narrowest = envelopes.map(|envelope| self.multipoles.narrowest(envelope));
        let common = Common::new(self.width, narrowest.into_iter());
        let widths = narrowest.into_iter().chain(envelopes.map(|envelope| envelope.monopole));
        let rests = widths.map(|sigma| common.rest(sigma).abs());
        let (cut, error) = WavenumberSplit::choose(&SplitInput {
            spacing: self.spacing / smallest,
            window: KaiserBessel::new(self.points, self.width / self.spacing),
            own: 0.5 * rests.fold(0.0, f64::max) / self.spacing.powi(2),
            cutoff: self.cutoff / smallest,
            height: if self.boundaries.walls() == 2 { self.height / smallest } else { f64::INFINITY },
            allowed: self.allowed,
        });
        (cut.scaled(smallest), error)
    }
}

impl Problem {
    /// Lengths that the grid needs at least: the edges along periodic axes. Between walls there is room for whole
    /// windows of length `window`, and periodic copies of a sphere do not overlap (`overlap`); in open space the grid
    /// is twice as long as that.
    pub(crate) fn lengths(&self, window: f64, overlap: f64) -> Vector {
        let length = |axis: usize| {
            let edge = self.edges[axis];
            let [lowest, highest] = allowed(self.boundaries, edge, self.smallest_radius());
            match self.boundaries {
                _ if self.boundaries.is_periodic(axis) => edge,
                Boundaries::Open => 2.0 * (highest - lowest + window),
                _ => highest - lowest + window.max(overlap),
            }
        };
        Vector::from_array(std::array::from_fn(length))
    }
}

impl Plan {
    /// Wavenumbers of the walls' flow that the grid resolves.
    pub(crate) fn wavenumber_split(&self) -> WavenumberSplit {
        let Some(Split { width, cutoff }) = self.split else {
            return WavenumberSplit::none(self.spacing().max_element());
        };
        let (smallest, largest) = self.extremes();
        let at_walls = WallGrid {
            boundaries: self.boundaries,
            radii: [smallest, largest],
            multipoles: self.multipoles,
            allowed: self.wavenumber_split_tolerance,
            width,
            cutoff,
            spacing: self.spacing().max_element(),
            points: self.support.support,
            height: self.edges.z,
        };
        at_walls.cut().0
    }

    /// Position of the first grid point. Along axes that are not periodic the window of the lowest sphere begins
    /// there.
    pub(crate) fn first_point(&self) -> Vector {
        let half = 0.5 * self.support.support as f64;
        let first = |axis: usize| {
            if self.boundaries.is_periodic(axis) { 0.0 } else { self.span(axis)[0] - half * self.spacing()[axis] }
        };
        Vector::from_array(std::array::from_fn(first))
    }

    /// Interval of the centres of spheres along an axis that is not periodic, or of points of the fluid if velocities
    /// are evaluated there.
    pub(crate) fn span(&self, axis: usize) -> [f64; 2] {
        let (edge, walls) = (self.edges[axis], self.boundaries.walls());
        match self.fluid_margin {
            None => allowed(self.boundaries, edge, self.extremes().0),
            Some(beyond) => [if walls > 0 { 0.0 } else { -beyond }, edge + if walls > 1 { 0.0 } else { beyond }],
        }
    }

    /// Largest distance along y and z between the boundary of a rank's share of the grid and that of its share of the
    /// box.
    pub(crate) fn mismatch(&self) -> [f64; 2] {
        let (first, end) = (self.first_point(), self.first_point() + self.period - self.edges);
        [1, 2].map(|axis| first[axis].abs().max(end[axis].abs()))
    }

    /// Distance along y and z by which stencils extend beyond a rank's share of a box, both in some units.
    pub(crate) fn stencil_reach(&self, cell: &PeriodicBox, units: &Units) -> [f64; 2] {
        let half = 0.5 * self.support.support as f64;
        if cell.boundaries() == Boundaries::Periodic {
            let edges = cell.edges();
            return [edges.y / self.grid[1] as f64, edges.z / self.grid[2] as f64].map(|h| half * h);
        }
        let own = self.in_units(units);
        let (spacing, mismatch) = (own.spacing(), own.mismatch());
        [half * spacing.y + mismatch[0], half * spacing.z + mismatch[1]]
    }
}
