//! Grids of boxes that do not repeat along all axes.

use crate::envelope::{Common, Envelope};
use crate::plan::Plan;
use crate::problem::{Method, Multipoles, Problem};
use crate::wall_cut::{AtWalls, WallCut};
use crate::window::Window;
use domain::{Boundaries, Number, PeriodicBox, Vector};

/// The least distance of a sphere's centre from a wall, in radii: below about 0.8 the mobility is not positive definite.
pub const NEAREST_WALL: f64 = 0.85;

/// A sphere that is too near a wall, or not in the box at all.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "sphere {id} of radius {} is at {axis} = {}; the box is {} long there with {what}, and its centre needs to be from {} to \
     {}",
    Number(*radius), Number(*place), Number(*edge), Number(allowed[0]), Number(allowed[1])
)]
pub struct OutsideError {
    /// Its id.
    pub id: u64,
    /// Its radius.
    pub radius: f64,
    /// x, y or z.
    pub axis: char,
    /// The coordinate of its centre.
    pub place: f64,
    /// The box's edge along the axis.
    pub edge: f64,
    /// What lies at the faces.
    pub what: &'static str,
    /// Where centres may be.
    pub allowed: [f64; 2],
}

/// Refuses a sphere that is nearer a wall than [`NEAREST_WALL`] of its radius, or outside of the box where that does not
/// repeat.
pub fn check_inside(cell: &PeriodicBox, id: u64, position: Vector, radius: f64) -> Result<(), OutsideError> {
    for (axis, name) in "xyz".chars().enumerate().filter(|(axis, _)| !cell.is_periodic(*axis)) {
        let (place, edge) = (position[axis], cell.edges()[axis]);
        let allowed = allowed(cell.boundaries(), edge, radius);
        // Places computed from those of spheres at the ends are not refused for round-off.
        let round_off = 1e-9 * edge;
        if !(allowed[0] - round_off..=allowed[1] + round_off).contains(&place) {
            let what = match cell.boundaries() {
                Boundaries::Walls => "walls at both ends",
                Boundaries::Wall => "a wall at 0 and open fluid above",
                _ => "open ends",
            };
            return Err(OutsideError { id, radius, axis: name, place, edge, what, allowed });
        }
    }
    Ok(())
}

/// Where centres may be along an axis that does not repeat.
fn allowed(boundaries: Boundaries, edge: f64, radius: f64) -> [f64; 2] {
    let [below, above] = [1, 2].map(|walls| if boundaries.walls() >= walls { NEAREST_WALL * radius } else { 0.0 });
    [below, edge - above]
}

/// What a plan has at walls.
pub(crate) struct GridAtWalls {
    pub boundaries: Boundaries,
    /// The smallest radius and the largest.
    pub radii: [f64; 2],
    pub multipoles: Multipoles,
    /// The relative error that the cut may have.
    pub allowed: f64,
    pub width: f64,
    pub cutoff: f64,
    pub spacing: f64,
    pub points: usize,
    /// The edge across the walls.
    pub height: f64,
}

impl GridAtWalls {
    /// The cut between wavenumbers of walls on the grid and between spheres, and the error of walls; neither without walls.
    pub fn cut(&self) -> (WallCut, f64) {
        let [smallest, _] = self.radii;
        if self.boundaries.walls() == 0 {
            return (WallCut::none(self.spacing), 0.0);
        }
        let envelopes = self.radii.map(Envelope::of_sphere);
        let narrowest = envelopes.map(|envelope| self.multipoles.narrowest(envelope));
        let common = Common::new(self.width, narrowest.into_iter());
        let widths = narrowest.into_iter().chain(envelopes.map(|envelope| envelope.monopole));
        let rests = widths.map(|sigma| common.rest(sigma).abs());
        let (cut, error) = WallCut::choose(&AtWalls {
            spacing: self.spacing / smallest,
            window: Window::new(self.points, self.width / self.spacing),
            own: 0.5 * rests.fold(0.0, f64::max) / self.spacing.powi(2),
            cutoff: self.cutoff / smallest,
            height: if self.boundaries.walls() == 2 { self.height / smallest } else { f64::INFINITY },
            allowed: self.allowed,
        });
        (cut.scaled(smallest), error)
    }
}

impl Problem {
    /// Lengths that a grid has to have: the edges where the box repeats. Between walls there is room for whole windows of
    /// `window` along an axis, and the copies of a sphere do not overlap any other; in open space the grid is as long
    /// again as what is on it.
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
    /// Which wavenumbers of the flow of walls the grid has.
    pub(crate) fn wall_cut(&self) -> WallCut {
        let Method::Split { width, cutoff } = self.method else { return WallCut::none(self.spacing().max_element()) };
        let (smallest, largest) = self.extremes();
        let at_walls = GridAtWalls {
            boundaries: self.boundaries,
            radii: [smallest, largest],
            multipoles: self.multipoles,
            allowed: self.allowed_of_wall_cut,
            width,
            cutoff,
            spacing: self.spacing().max_element(),
            points: self.support.support,
            height: self.edges.z,
        };
        at_walls.cut().0
    }

    /// Where the grid's first point is: where the lowest sphere's window begins, along axes that do not repeat.
    pub(crate) fn first_point(&self) -> Vector {
        let half = 0.5 * self.support.support as f64;
        let first = |axis: usize| {
            if self.boundaries.is_periodic(axis) { 0.0 } else { self.span(axis)[0] - half * self.spacing()[axis] }
        };
        Vector::from_array(std::array::from_fn(first))
    }

    /// From where to where centres of spheres may be along an axis that does not repeat, or points of the fluid if velocities
    /// are asked for there.
    pub(crate) fn span(&self, axis: usize) -> [f64; 2] {
        let (edge, walls) = (self.edges[axis], self.boundaries.walls());
        match self.beyond {
            None => allowed(self.boundaries, edge, self.extremes().0),
            Some(beyond) => [if walls > 0 { 0.0 } else { -beyond }, edge + if walls > 1 { 0.0 } else { beyond }],
        }
    }

    /// How far a rank's share of the grid and its share of the box may be apart along y and z.
    pub(crate) fn mismatch(&self) -> [f64; 2] {
        let (first, end) = (self.first_point(), self.first_point() + self.period - self.edges);
        [1, 2].map(|axis| first[axis].abs().max(end[axis].abs()))
    }
}
