//! Profiles between walls, above one, or through a layer in unbounded fluid.

use super::column;
use crate::columns::{ANGULAR_VELOCITY, STRESSLET, VELOCITY};
use crate::model::{Model, Statistics as Wanted};
use domain::{Boundaries, Particles, Tensor, Traceless, Vector};
use statistics::{ChannelProfile, ChannelSample};

/// The columns that a sample needs besides [`super::COLUMNS`].
pub const MORE_COLUMNS: [&str; 1] = [STRESSLET];

/// A profile along the axis that does not repeat, from the wall at 0 on, or around the middle of a layer, wherever that is.
pub struct Channel {
    pub profile: ChannelProfile,
    /// Whether heights are those above the mean height of all centres.
    is_layer: bool,
    /// The user's axis along which heights are.
    pub axis: usize,
}

impl Channel {
    /// Nothing so far; `None` in a box that repeats along all axes, and in open fluid.
    pub fn of(model: &Model, wanted: Wanted) -> Option<Self> {
        let count = bins(model, wanted)?;
        let is_layer = model.cell.boundaries() == Boundaries::OpenAlongZ;
        let edges = model.cell.edges();
        let bottom = if is_layer { -0.5 * edges.z } else { 0.0 };
        let (area, of) = (edges.x * edges.y, (model.species.len(), count));
        let profile = ChannelProfile::new([bottom, bottom + edges.z], area, of);
        Some(Self { profile, is_layer, axis: model.user_axes().axis(2) })
    }

    /// Adds all spheres at one time, in the order of their ids, which move so relative to the flow.
    pub fn add(&mut self, particles: &Particles, slips: &[Vector]) {
        let mut heights: Vec<f64> = particles.positions.iter().map(|x| x[self.axis]).collect();
        if self.is_layer {
            let middle = heights.iter().sum::<f64>() / heights.len() as f64;
            for height in &mut heights {
                *height -= middle;
            }
        }
        let of_name = |name: &str| particles.columns.iter().find(|column| column.name == name);
        let stresslets: &[Traceless] = of_name(STRESSLET).map_or(&[], |column| bytemuck::cast_slice(&column.values));
        let stresslets: Vec<Tensor> = stresslets.iter().map(|s| s.tensor()).collect();
        self.profile.add(&ChannelSample {
            heights: &heights,
            radii: &particles.radii,
            species: &particles.species,
            velocities: column(particles, VELOCITY),
            slips,
            angular_velocities: column(particles, ANGULAR_VELOCITY),
            stresslets: &stresslets,
        });
    }
}

/// Bins of a radius of the smallest spheres, unless the scene says how many there are.
const PER_RADIUS: f64 = 4.0;

/// How many bins there are unless the scene says it.
const USUAL: [f64; 2] = [8.0, 256.0];

/// The bins of a scene's profiles; `None` where there are none.
pub fn bins(model: &Model, wanted: Wanted) -> Option<usize> {
    if matches!(model.cell.boundaries(), Boundaries::Periodic | Boundaries::Open) {
        return None;
    }
    let smallest = model.species.iter().map(|species| species.radius).fold(f64::INFINITY, f64::min);
    let [least, most] = USUAL;
    let usual = (PER_RADIUS * model.cell.edges().z / smallest).round().clamp(least, most);
    Some(wanted.bins.unwrap_or(usual as usize))
}

#[cfg(test)]
mod tests;
