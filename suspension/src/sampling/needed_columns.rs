//! Columns of the particles that samples of a model need.

use super::{COLUMNS, channel};
use crate::columns::{ORIENTATION, ORIENTATION_NUMBERS, PAIR_MOMENT_NUMBERS, STRESSLET};
use crate::forces::Forces;
use crate::model::Model;

/// Indices and names of the species with orientations.
pub(super) fn oriented(model: &Model) -> Vec<(usize, String)> {
    let all = model.species.iter().enumerate();
    all.filter(|(_, one)| one.orientation.is_some()).map(|(index, one)| (index, one.name.clone())).collect()
}

/// Columns that a sample of a model needs.
pub fn needed_columns(model: &Model) -> Vec<&'static str> {
    let orientations = model.has_orientations().then_some(ORIENTATION);
    COLUMNS.into_iter().chain(channel_bins(model).map(|_| STRESSLET)).chain(orientations).collect()
}

/// Whether a sample of a model also needs the column [`PAIR_MOMENT`](crate::columns::PAIR_MOMENT).
pub fn needs_pair_moments(model: &Model) -> bool {
    let has_stress = || Forces::of(model).is_ok_and(|forces| !forces.stresses_of_model().is_empty());
    has_profile(model) && has_stress()
}

/// Whether samples of a model include profiles of stresses.
pub fn has_profile(model: &Model) -> bool {
    channel_bins(model).is_some()
}

/// Numbers per particle in all of these columns.
pub fn numbers(model: &Model) -> usize {
    let pair_moments = if needs_pair_moments(model) { PAIR_MOMENT_NUMBERS } else { 0 };
    let orientations = if model.has_orientations() { ORIENTATION_NUMBERS } else { 0 };
    6 + channel_bins(model).map_or(0, |_| 5) + pair_moments + orientations
}

/// Number of bins of profiles, for a model with statistics and a wall or an open axis.
pub(super) fn channel_bins(model: &Model) -> Option<usize> {
    model.statistics.and_then(|wanted| channel::bins(model, wanted))
}
