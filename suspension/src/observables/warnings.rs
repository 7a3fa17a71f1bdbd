//! Warnings at the end of a run, from its time series.

use super::{Observer, Overlaps, Pressed};
use crate::error::gap::Gap;
use domain::Number;

/// Overlaps of contacts over the target above which a warning is given: the largest for a given stiffness, and the mean
/// of the largest for an automatic one.
const SOFT: f64 = 2.5;
const SOFT_IN_THE_MEAN: f64 = 1.5;

impl Observer {
    /// A warning about contacts with much larger overlaps than the target.
    pub(super) fn soft(&self) -> Option<String> {
        let (aim, is_chosen) = self.aim?;
        let Pressed { rows, sum, deepest } = self.pressed;
        let (overlap, most, words) =
            if is_chosen { (sum / rows, SOFT_IN_THE_MEAN, "in the mean") } else { (deepest, SOFT, "at most") };
        (overlap > most * aim).then(|| {
            format!(
                "the largest overlap of contacts is {:.2} of the roughness {words}, where {:.2} was aimed at; near \
                 jamming that is what the stress depends on: look whether a larger contacts.stiffness changes it",
                Number(overlap),
                Number(aim)
            )
        })
    }

    /// A warning about a stiffness that is still adapting.
    pub(super) fn settling(&self) -> Option<String> {
        let stiffness = Number(self.unsettled?);
        Some(format!(
            "the stiffness of contacts, {stiffness:.4} at the end, had not settled yet: take a longer run, a smaller \
             contacts.settling, or a number as contacts.stiffness"
        ))
    }

    /// A warning about overlaps, if there were any.
    pub(super) fn overlapped(&self) -> Option<String> {
        let Overlaps { rows, with_overlap, largest } = self.overlaps;
        let remedy = if self.repels { "a larger repulsion.strength or a shorter time.step" } else { "a [repulsion]" };
        (with_overlap > 0).then(|| {
            format!(
                "spheres overlap in {with_overlap} of {rows} rows of the time series, by {} at most; try {remedy}",
                Gap { length: largest, radius: self.smallest_radius }
            )
        })
    }
}
