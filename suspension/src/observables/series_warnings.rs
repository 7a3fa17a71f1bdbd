//! Warnings at the end of a run, from its time series.

use super::observable::ObservedState;
use super::rheology::Rheology;
use crate::error::gap::Gap;
use crate::evaluation::overlap_monitor::{OverlappedSteps, Remedies};
use crate::model::Model;
use crate::suspension::Suspension;
use domain::Number;

/// Overlaps of contacts over the target above which a warning is given: the largest for a given stiffness, and the mean
/// of the largest for an automatic one.
const SOFT: f64 = 2.5;
const SOFT_IN_THE_MEAN: f64 = 1.5;

/// Relative deviation of the mean stress from the given stress that needs no warning.
const OFF: f64 = 0.05;

/// Observations of all rows that lead to warnings.
pub struct SeriesWarnings {
    overlaps: OverlapRows,
    repels: bool,
    crowded: OverlappedSteps,
    remedies: Remedies,
    /// With contacts, the target of the largest overlap over the roughness, and whether the stiffness is automatic; and
    /// the overlaps seen since the stiffness is constant.
    target_overlap: Option<(f64, bool)>,
    contact_overlaps: ContactOverlaps,
    /// Stiffness at the last row, if it was still adapting.
    adapting: Option<f64>,
    /// Sums for the comparison with a given stress, if there is one.
    given: Option<GivenStress>,
    rheology: Option<Rheology>,
    smallest_radius: f64,
}

/// Statistics of the largest overlap of contacts, over the roughness, in several rows.
#[derive(Default)]
struct ContactOverlaps {
    rows: f64,
    sum: f64,
    deepest: f64,
}

/// A given stress, and the sum of the measured stresses.
#[derive(Debug, Clone, Copy)]
struct GivenStress {
    stress: f64,
    rows: f64,
    sum: f64,
}

/// Counts of rows with overlapping spheres.
#[derive(Debug, Clone, Copy, Default)]
struct OverlapRows {
    rows: u64,
    with_overlap: u64,
    largest: f64,
}

impl SeriesWarnings {
    /// Nothing seen yet of a model.
    pub fn of(model: &Model, rheology: Option<&Rheology>, smallest_radius: f64) -> Self {
        Self {
            overlaps: OverlapRows::default(),
            repels: model.repulsion.is_some(),
            crowded: OverlappedSteps::default(),
            remedies: Remedies::of(model),
            target_overlap: model.contacts.map(|contacts| (contacts.overlap, contacts.stiffness.is_none())),
            contact_overlaps: ContactOverlaps::default(),
            adapting: None,
            given: model.shear_rates().stress().map(|stress| GivenStress { stress, rows: 0.0, sum: 0.0 }),
            rheology: rheology.cloned(),
            smallest_radius,
        }
    }

    /// All warnings.
    pub fn all(&self) -> Vec<String> {
        let crowded = self.crowded.warning(self.remedies, self.smallest_radius);
        let off = self.given.and_then(GivenStress::warning);
        [self.overlapped(), crowded, self.soft(), self.settling(), off].into_iter().flatten().collect()
    }

    /// Changes to the scene that would keep the spheres apart.
    pub fn remedies(&self) -> Remedies {
        self.remedies
    }

    /// Counts a step that was taken.
    pub fn see_step(&mut self, suspension: &Suspension) {
        suspension.overlap_counts().into_iter().for_each(|crowded| self.crowded.see(crowded));
    }

    /// Takes note of a row. Collective.
    pub fn see_row(&mut self, present: &mut ObservedState) {
        self.overlaps.see(present.report().smallest_gap);
        if let Some((given, rheology)) = self.given.as_mut().zip(self.rheology.as_ref()) {
            given.see(rheology.driving_stress(present));
        }
        if let Some([_, _, _, largest_overlap, _]) = present.contact_numbers() {
            let (stiffness, stays) = present.suspension().contact_stiffness().expect("spheres may touch");
            self.adapting = (!stays).then_some(stiffness);
            if stays {
                self.contact_overlaps.see(largest_overlap);
            }
        }
    }

    /// A warning about contacts with much larger overlaps than the target.
    fn soft(&self) -> Option<String> {
        let (target_overlap, is_chosen) = self.target_overlap?;
        let ContactOverlaps { rows, sum, deepest } = self.contact_overlaps;
        let (overlap, most, words) =
            if is_chosen { (sum / rows, SOFT_IN_THE_MEAN, "in the mean") } else { (deepest, SOFT, "at most") };
        (overlap > most * target_overlap).then(|| {
            format!(
                "the largest overlap of contacts is {:.2} of the roughness {words}, where {:.2} was aimed at; near \
                 jamming that is what the stress depends on: look whether a larger contacts.stiffness changes it",
                Number(overlap),
                Number(target_overlap)
            )
        })
    }

    /// A warning about a stiffness that is still adapting.
    fn settling(&self) -> Option<String> {
        let stiffness = Number(self.adapting?);
        Some(format!(
            "the stiffness of contacts, {stiffness:.4} at the end, had not settled yet: take a longer run, a smaller \
             contacts.adaptation_strain, or a number as contacts.stiffness"
        ))
    }

    /// A warning about overlaps, if there were any.
    fn overlapped(&self) -> Option<String> {
        let OverlapRows { rows, with_overlap, largest } = self.overlaps;
        let remedy = if self.repels { "a larger repulsion.strength or a shorter time.step" } else { "a [repulsion]" };
        (with_overlap > 0).then(|| {
            format!(
                "spheres overlap in {with_overlap} of {rows} rows of the time series, by {} at most; try {remedy}",
                Gap { length: largest, radius: self.smallest_radius }
            )
        })
    }
}

impl ContactOverlaps {
    fn see(&mut self, overlap: f64) {
        let Self { rows, sum, deepest } = self;
        (*rows, *sum, *deepest) = (*rows + 1.0, *sum + overlap, deepest.max(overlap));
    }
}

impl GivenStress {
    fn see(&mut self, found: f64) {
        (self.rows, self.sum) = (self.rows + 1.0, self.sum + found);
    }

    /// A warning if the mean stress deviates from the given one.
    fn warning(self) -> Option<String> {
        let found = self.sum / self.rows / self.stress;
        ((found - 1.0).abs() > OFF).then(|| {
            format!(
                "the stress was {:.3} times flow.stress in the mean: contacts bounce where steps are too long for \
                 their stiffness; try a shorter time.step, a smaller contacts.stiffness, or \
                 contacts.adaptation_strain = 0.0",
                Number(found)
            )
        })
    }
}

impl OverlapRows {
    fn see(&mut self, smallest_gap: f64) {
        self.rows += 1;
        self.with_overlap += u64::from(smallest_gap < 0.0);
        self.largest = self.largest.max(-smallest_gap);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_stress_than_that_given_is_worth_a_word() {
        let of = |found: [f64; 2]| {
            let mut given = GivenStress { stress: 2.0, rows: 0.0, sum: 0.0 };
            for stress in found {
                given.see(stress);
            }
            given.warning()
        };
        assert_eq!(of([1.9, 2.15]), None);
        let said = of([4.0, 5.0]).unwrap();
        assert!(said.starts_with("the stress was 2.25 times flow.stress in the mean"), "{said}");
        assert!(of([1.8, 1.8]).is_some());
    }
}
