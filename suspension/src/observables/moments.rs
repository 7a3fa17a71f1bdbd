//! Mean moments of spheres, and the torque of the applied field.

use super::observable::{Observable, ObservedState, measure};
use crate::forces::dipoles::{induced, permanent};
use crate::model::{Model, MomentKind, SphereMoment};
use domain::{Boundaries, Vector};
use simulation::Quantity;

/// For each kind of moments in a model, the mean moment of the spheres of each species, and the torque of the applied
/// field on all spheres, over the volume of the box: `c sum m x H_0 / V`, with the constant `c` of the field. Unbounded
/// fluid has no volume to average over, and no such torque.
pub fn moments(model: &Model) -> Vec<Box<dyn Observable>> {
    MomentKind::ALL.into_iter().flat_map(|kind| of_kind(kind, model)).collect()
}

fn of_kind(kind: MomentKind, model: &Model) -> Vec<Box<dyn Observable>> {
    let Some(applied) = kind.field(model) else { return Vec::new() };
    let (axes, name) = (model.user_axes(), kind.name());
    let moments: Vec<SphereMoment> = model.species.iter().map(|species| kind.of(species)).collect();
    let names = model.species.iter().map(|species| species.name.clone()).collect();
    let components = || ["x", "y", "z"].map(String::from).to_vec();
    // Moments are those of the field over the constant; an electric one is a charge times a length.
    let (scale, unit) = match kind {
        MomentKind::Magnetic => (1.0, "field*length^3"),
        MomentKind::Electric => (applied.constant, "charge*length"),
    };
    let quantity = Quantity { name: format!("{name}_moment").into(), unit, table: Some((names, components())) };
    let of_species = moments.clone();
    let mean = measure(quantity, move |present| {
        let sums = sums(present, kind, &of_species);
        sums.iter().flat_map(|&(sum, count)| axes.vector(sum * (scale / count)).to_array()).collect()
    });
    let quantity = Quantity {
        name: format!("{name}_torque").into(),
        unit: "force/length^2",
        table: Some((vec!["all".to_owned()], components())),
    };
    let torque = measure(quantity, move |present| {
        let total: Vector = sums(present, kind, &moments).iter().map(|(sum, _)| *sum).sum();
        let (time, volume) = (present.suspension().clock().time(), present.suspension().cell().volume());
        axes.vector(total.cross(applied.at(time)) * (applied.constant / volume)).to_array().to_vec()
    });
    if model.cell.boundaries() == Boundaries::Open { vec![mean] } else { vec![mean, torque] }
}

/// Sum of the moments of each species, and the number of its spheres. Collective.
fn sums(present: &ObservedState, kind: MomentKind, species: &[SphereMoment]) -> Vec<(Vector, f64)> {
    let particles = present.suspension().particles();
    let (permanent, induced) = (permanent(particles, species), induced(particles, kind));
    let mut sums = vec![[0.0; 4]; species.len()];
    for (row, &index) in particles.species.iter().enumerate() {
        let moment = permanent[row] + induced[row];
        let terms = [moment.x, moment.y, moment.z, 1.0];
        sums[index as usize].iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
    }
    present.suspension().comm().sum(sums.as_flattened_mut());
    sums.into_iter().map(|[x, y, z, count]| (Vector::new(x, y, z), count)).collect()
}
