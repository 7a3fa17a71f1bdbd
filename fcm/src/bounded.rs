//! Grids of boxes that do not repeat along all axes.

use crate::envelope::Envelope;
use crate::plan::Plan;
use crate::problem::Problem;
use crate::window::Window;
use domain::{Boundaries, Number, PeriodicBox, Vector};
use std::f64::consts::PI;

/// The least distance of a sphere's centre from a wall, in radii: below about 0.8 the mobility is not positive definite.
pub const NEAREST_WALL: f64 = 0.85;

/// Wavenumbers that the flow of walls can have on a grid, in units of the highest: windows err beyond.
const HIGHEST: f64 = 0.85;

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

/// The weight of a wavenumber, times the radius, in the flow that a wall sends back to the gradients of spheres on it:
/// `((1 - x)^2 + x^2) k^2 exp(-2 k)` for one, `x = k - s^2 k^2` with the dipole's width `s` (see [`crate::image`]), of which the
/// highest wavenumbers have a small part in spheres at different places.
fn weight(wavenumber: f64) -> f64 {
    let x = wavenumber - Envelope::of_sphere(1.0).dipole.powi(2) * wavenumber * wavenumber;
    (1.0 + 0.12 * x * (x - 1.0)) * wavenumber * wavenumber * (-2.0 * wavenumber).exp()
}

/// Error of leaving out the images of spheres in each other from a wavenumber, times the smallest radius, on, of eight spheres of
/// which two are at walls. Where all are it is about twice as large. Each sphere's own image is whole.
fn beyond(wavenumber: f64) -> f64 {
    0.125 * weight(wavenumber)
}

/// The wavenumber, times the smallest radius, from which on images in each other are so small an error.
fn needed(error: f64) -> f64 {
    (20..400).map(|twentieths| 0.05 * f64::from(twentieths)).find(|&k| beyond(k) <= error).unwrap_or(20.0)
}

/// Shares of the tolerance that walls may have with rigid spheres, whose stresslets come out worse than gradients, and with given
/// loads.
const RIGID_SHARE: f64 = 0.25;
const GIVEN_SHARE: f64 = 0.4;

/// The wavenumber up to which the flow of walls is on a grid: as the tolerance needs, for the fewer the less windows err, but none
/// that the grid does not have.
pub(crate) fn highest_at_walls(tolerance: f64, smallest_radius: f64, spacing: f64) -> f64 {
    (HIGHEST * PI / spacing).min(needed(RIGID_SHARE * tolerance) / smallest_radius)
}

/// Error of walls up to a highest wavenumber on a grid of some spacing, both in units of the smallest radius: by images beyond that,
/// and by what folds onto the wavenumbers through a window, times what derivatives make of it in units of the spacing: one of a
/// dipole, and `1 - own lap`, where the Laplacian of the wall's flow is none but that of what folds onto it is. Nothing damps
/// that, as a Gaussian does in the fluid. Both factors are fits to the errors of eight spheres between walls and of twelve most of
/// which are at walls, with windows of 7 to 12 points on grids that have 0.55 to 0.85 of their wavenumbers at walls: nine errors
/// of ten are below twice this.
pub(crate) fn wall_error(highest: f64, spacing: f64, (window, own): (Window, f64)) -> f64 {
    let part = highest / f64::from(PARTS);
    let folded = |number: i32| {
        let wavenumber = part * (f64::from(number) + 0.5);
        let k = wavenumber * spacing;
        let other = 2.0 * PI - k;
        let derivatives = other / k * (1.0 + own * (other * other - k * k));
        (window.transform(other) / window.transform(k)).abs() * derivatives * weight(wavenumber) * part
    };
    beyond(highest).hypot(2.5 * (0..PARTS).map(folded).sum::<f64>())
}

/// Wavenumbers that are looked at.
const PARTS: i32 = 16;

impl Problem {
    /// The share of the tolerance that walls may have.
    pub(crate) fn allowed_at_walls(&self) -> f64 {
        self.tolerance * if self.rigid { RIGID_SHARE } else { GIVEN_SHARE }
    }

    /// The coarsest grid on which the flow of walls has its tolerance.
    pub(crate) fn coarsest_at_walls(&self) -> f64 {
        if self.boundaries.walls() == 0 {
            return f64::INFINITY;
        }
        self.smallest_radius() * HIGHEST * PI / needed(self.allowed_at_walls())
    }

    /// Lengths that a grid has to have: the edges where the box repeats. Between walls there is room for whole windows of
    /// `window` along an axis, and the copies of a sphere are beyond the cutoff of any other; in open space the grid is as long
    /// again as what is on it.
    pub(crate) fn lengths(&self, window: f64, cutoff: f64) -> Vector {
        let length = |axis: usize| {
            let edge = self.edges[axis];
            let [lowest, highest] = allowed(self.boundaries, edge, self.smallest_radius());
            match self.boundaries {
                _ if self.boundaries.is_periodic(axis) => edge,
                Boundaries::Open => 2.0 * (highest - lowest + window),
                _ => highest - lowest + window.max(cutoff),
            }
        };
        Vector::from_array(std::array::from_fn(length))
    }
}

impl Plan {
    /// The wavenumber up to which the grid has the flow of walls.
    pub(crate) fn highest_at_walls(&self) -> f64 {
        highest_at_walls(self.tolerance, self.extremes().0, self.spacing().max_element())
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
