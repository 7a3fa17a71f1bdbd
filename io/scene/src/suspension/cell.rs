//! The box of a scene.

use super::raw::{self, SuspensionSections};
use super::{KeyError, flow};
use crate::CaseBoundary;
use crate::case::boundaries_of;
use crate::checks::positive;
use crate::document::NumberOr;
use domain::{AxisRotation, Boundaries, Number, PeriodicBox, Vector};

/// Room around spheres whose positions the scene does not determine, in radii of the largest sphere.
const SOMEWHERE: f64 = 10.0;

/// The box, with its non-periodic axis last, and the rotation of axes to it. For an extension it is another periodic
/// box with the same volume; in unbounded fluid it is a box around the initial positions.
pub fn cell(raw: &SuspensionSections) -> Result<(PeriodicBox, AxisRotation), KeyError> {
    let (boundaries, turn) = boundaries(raw.cell.boundaries.unwrap_or([raw::Boundary::Periodic; 3]))?;
    let edges = Vector::from_array(turn.list(edges(raw, boundaries)?));
    let extension = raw.flow.as_ref().and_then(|flow| flow::extension(flow.kind));
    match (extension, boundaries) {
        (None, _) | (Some(_), Boundaries::Open) => {}
        (Some(extension), Boundaries::Periodic) => {
            if raw.cell.strain.is_some() {
                let message = "is set, but the box of an extension starts as that flow needs it; leave it out";
                return Err(KeyError::new("box.strain", message));
            }
            return Ok((extension.cell(edges)?, turn));
        }
        (Some(_), _) => {
            let message = "has walls or an open axis, but an extension needs a box that repeats along all axes, or \
                fluid that is open along all; leave it out";
            return Err(KeyError::new("box.boundaries", message));
        }
    }
    let strain = strain(raw, boundaries)?;
    let cell = PeriodicBox::sheared(edges, strain).map_err(|e| KeyError::new("box.edges", e.to_string()))?;
    let cell = cell.with_boundaries(boundaries).map_err(|e| KeyError::new("box.boundaries", e.to_string()))?;
    Ok((cell, turn))
}

/// Largest initial strain of a box, equal to the largest strain of a run.
const MAX_STRAIN: f64 = 1e9;

/// Strain of the box at the start.
fn strain(raw: &SuspensionSections, boundaries: Boundaries) -> Result<f64, KeyError> {
    let Some(strain) = raw.cell.strain else { return Ok(0.0) };
    let refused = |message: &str| Err(KeyError::new("box.strain", message));
    if !matches!(raw.particles.initial, raw::Initial::File | raw::Initial::Positions) {
        return refused("goes with particles.initial = \"file\" or \"positions\" only; leave it out or change that");
    }
    if boundaries != Boundaries::Periodic {
        return refused("is set, but only a box that repeats along all axes is sheared; leave it out");
    }
    let is_possible = strain.abs() <= MAX_STRAIN;
    if !is_possible {
        return refused(&format!("is {}; it needs to be a number from -{MAX_STRAIN} to {MAX_STRAIN}", Number(strain)));
    }
    Ok(strain)
}

fn edges(raw: &SuspensionSections, boundaries: Boundaries) -> Result<[f64; 3], KeyError> {
    let is_placed = raw.species.is_empty() && raw.bodies.iter().all(|one| one.positions.is_some());
    let starts_in_box = matches!(raw.particles.initial, raw::Initial::Random | raw::Initial::Lattice) && !is_placed;
    match raw.cell.edges {
        Some(_) if boundaries == Boundaries::Open && !starts_in_box => {
            let message = "are given, but in unbounded fluid only particles.initial = \"random\" and \"lattice\" \
                start in a box; leave them out";
            Err(KeyError::new("box.edges", message))
        }
        Some(edges) => {
            for (axis, length) in edges.iter().enumerate() {
                positive(&format!("box.edges[{axis}]"), *length)?;
            }
            Ok(edges)
        }
        None if boundaries == Boundaries::Open && !starts_in_box => Ok(around(raw)),
        None => {
            let message = "are missing; only spheres in unbounded fluid that start as a cloud, at positions or from a \
                file need none, and spheres from a file that has a box";
            Err(KeyError::new("box.edges", message))
        }
    }
}

/// Approximate edges of a box around spheres in unbounded fluid.
fn around(raw: &SuspensionSections) -> [f64; 3] {
    let sizes = raw.species.iter().map(largest).chain(raw.bodies.iter().map(largest_of_body));
    let room = SOMEWHERE * sizes.fold(0.0, f64::max);
    if let Some(radius) = raw.particles.radius {
        return [2.0 * radius.abs() + room; 3];
    }
    let of_bodies = || raw.bodies.iter().filter_map(|one| one.positions.as_deref());
    let places = || raw.particles.positions.as_deref().into_iter().chain(of_bodies()).flatten();
    std::array::from_fn(|axis| {
        let coordinates = || places().map(|place| place[axis]).filter(|x| x.is_finite());
        let extent = coordinates().fold(f64::NEG_INFINITY, f64::max) - coordinates().fold(f64::INFINITY, f64::min);
        extent.max(0.0) + room
    })
}

/// Approximate largest radius of a species.
fn largest(species: &raw::SpeciesSection) -> f64 {
    let of_list = |raw: &raw::DistributionSection| {
        let table = raw.table.iter().flatten().map(|row| row[0]).fold(0.0, f64::max);
        let spread = raw.mean.unwrap_or(0.0) + SOMEWHERE * raw.standard_deviation.unwrap_or(0.0);
        table.max(spread).max(raw.largest.unwrap_or(0.0))
    };
    species.radius.or(species.distribution.as_ref().map(of_list)).unwrap_or(0.0)
}

/// Approximate largest radius of a kind of bodies, or that of its shell.
fn largest_of_body(body: &raw::BodiesSection) -> f64 {
    let of_list = match &body.spheres {
        Some(NumberOr::Other(list)) => list.iter().map(|one| one.radius).fold(0.0, f64::max),
        _ => 0.0,
    };
    [body.radius, body.shell_radius].into_iter().flatten().fold(of_list, f64::max)
}

fn boundaries(axes: [raw::Boundary; 3]) -> Result<(Boundaries, AxisRotation), KeyError> {
    boundaries_of(axes.map(CaseBoundary::from)).map_err(|_| {
        let message = "is none that is possible: \"periodic\" along all axes; \"open\" along all axes; or along one \
            axis \"walls\", one at 0 and one at the edge, \"wall\", one at 0 with unbounded fluid above, or \"open\", \
            and \"periodic\" along the other two";
        KeyError::new("box.boundaries", message)
    })
}
