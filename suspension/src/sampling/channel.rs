//! Profiles between walls, above a wall, or through a layer in unbounded fluid.

use super::column;
use super::vectors::{BlockRows, map_blocks};
use crate::columns::{ANGULAR_VELOCITY, PAIR_MOMENT, STRESSLET, VELOCITY};
use crate::model::{Model, StatisticsParameters};
use domain::{Boundaries, Particles, Tensor, Traceless, Vector};
use statistics::{ChannelProfile, ChannelSample};
use std::ops::Range;

/// Columns that a sample needs in addition to [`super::COLUMNS`]; the last one only with forces between spheres.
pub const MORE_COLUMNS: [&str; 2] = [STRESSLET, PAIR_MOMENT];

/// Profile along the axis that is not periodic, from the wall at 0, or around the centre of a layer.
pub struct ChannelSampling {
    pub profile: ChannelProfile,
    /// Whether heights are relative to the mean height of all centres.
    is_layer: bool,
    /// The user's axis along which heights are measured.
    pub axis: usize,
}

impl ChannelSampling {
    /// A profile without samples; `None` in a fully periodic box and in unbounded fluid.
    pub fn of(model: &Model, wanted: StatisticsParameters) -> Option<Self> {
        let count = bins(model, wanted)?;
        let is_layer = model.cell.boundaries() == Boundaries::OpenAlongZ;
        let edges = model.cell.edges();
        let bottom = if is_layer { -0.5 * edges.z } else { 0.0 };
        let heights = [bottom, bottom + edges.z];
        let profile = ChannelProfile::new(heights, edges.x * edges.y, model.species.len(), count);
        Some(Self { profile, is_layer, axis: model.user_axes().axis(2) })
    }

    /// Adds all spheres at one time; `slips` are velocities relative to the flow, and each rank adds the spheres of its
    /// blocks. Collective.
    pub fn add(&mut self, BlockRows { blocks, rows }: BlockRows, particles: &Particles, slips: &[Vector]) {
        let mut heights: Vec<f64> = particles.positions.iter().map(|x| x[self.axis]).collect();
        if self.is_layer {
            let sum = |rows: Range<usize>| vec![heights[rows.clone()].iter().sum::<f64>(), rows.len() as f64];
            let [sum, count] = blocks.total(&map_blocks(rows, sum)).try_into().expect("two sums");
            for height in &mut heights {
                *height -= sum / count;
            }
        }
        let of_name =
            |name: &str| particles.columns.iter().find(|column| column.name == name).map(|column| &column.values);
        let stresslets: &[Traceless] = of_name(STRESSLET).map_or(&[], |values| bytemuck::cast_slice(values));
        let stresslets: Vec<Tensor> = stresslets.iter().map(|s| s.tensor()).collect();
        let pair_moments: &[Tensor] = of_name(PAIR_MOMENT).map_or(&[], |values| bytemuck::cast_slice(values));
        let sample = |rows: Range<usize>| ChannelSample {
            heights: &heights[rows.clone()],
            radii: &particles.radii[rows.clone()],
            species: &particles.species[rows.clone()],
            velocities: &column(particles, VELOCITY)[rows.clone()],
            slips: &slips[rows.clone()],
            angular_velocities: column(particles, ANGULAR_VELOCITY).get(rows.clone()).unwrap_or_default(),
            stresslets: stresslets.get(rows.clone()).unwrap_or_default(),
            pair_moments: pair_moments.get(rows).unwrap_or_default(),
        };
        let profile = &self.profile;
        let sums = blocks.total(&map_blocks(rows, |rows| profile.sums(&sample(rows))));
        let spreads = blocks.total(&map_blocks(rows, |rows| profile.second_moments(&sample(rows), &sums)));
        if blocks.comm().is_first() {
            self.profile.add_sums(&sums, &spreads, MORE_COLUMNS.map(|name| of_name(name).is_some()));
        }
    }
}

/// Default number of bins per smallest radius.
const PER_RADIUS: f64 = 4.0;

/// Range of the default number of bins.
const USUAL: [f64; 2] = [8.0, 256.0];

/// Number of bins of a model's profiles; `None` without profiles.
pub fn bins(model: &Model, wanted: StatisticsParameters) -> Option<usize> {
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
