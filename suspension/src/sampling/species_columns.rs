//! Columns across the box in which species are counted, for their segregation.

use super::{axis, in_lattice};
use crate::model::Model;
use domain::{Boundaries, Bytes, Particles, PeriodicBox, Vector};
use statistics::SpeciesColumns;

/// Width of the columns for segregation, over the largest radius.
pub const COLUMN_WIDTH: f64 = 4.0;

/// Whether segregation is defined: with several species, in a box that does not move.
pub fn has_columns(model: &Model) -> bool {
    let stays = !matches!(model.cell.boundaries(), Boundaries::Open | Boundaries::OpenAlongZ);
    model.species.len() > 1 && stays
}

/// Columns for the segregation of a model's species, along the axis of its statistics.
pub fn columns(model: &Model) -> SpeciesColumns {
    let (axis, width) = axis_and_width(model);
    SpeciesColumns::new(&model.cell, axis, width, model.species.len())
}

/// These columns in the user's axes.
pub fn columns_of_user(model: &Model) -> SpeciesColumns {
    let ((axis, width), axes) = (axis_and_width(model), model.user_axes());
    SpeciesColumns::new(&axes.cell(&model.cell), axes.axis(axis), width, model.species.len())
}

/// Memory of such columns, and of a copy for counting.
pub fn column_bytes(model: &Model) -> Bytes {
    let (axis, width) = axis_and_width(model);
    let columns = SpeciesColumns::bytes(&model.cell, axis, width, model.species.len());
    columns.then(columns.freed())
}

/// Axis of the columns, by default that of the forces or the gradient, and their width.
pub fn axis_and_width(model: &Model) -> (usize, f64) {
    let axis = axis(model, model.statistics.and_then(|wanted| wanted.axis));
    (axis, COLUMN_WIDTH * model.species.iter().map(|s| s.radius).fold(0.0, f64::max))
}

/// Counts this rank's particles in a copy of empty columns, which were made for a box with the given edges.
pub fn counted(empty: &SpeciesColumns, edges: Vector, cell: &PeriodicBox, particles: &Particles) -> SpeciesColumns {
    let mut columns = empty.clone();
    for (&position, &species) in in_lattice(cell, edges, particles).iter().zip(&particles.species) {
        columns.add(position, species);
    }
    columns
}
