//! Changes of an answer from the first point of a family to each of the others.

use super::answers;
use super::folder::FamilyFolder;
use super::spread::Spread;
use crate::run::RunError;
use crate::{Family, FileError, Member};
use std::collections::BTreeSet;

/// A quantity at a point of a family, and its change from the first point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnswerChange {
    /// Mean over the seeds.
    pub mean: f64,
    /// Error of the mean, from the spread over the seeds.
    pub error: f64,
    /// Number of seeds with a value here and at the first point.
    pub seeds: usize,
    /// Mean over these seeds of the difference from the first point.
    pub change: f64,
    /// Error of that mean, from the spread of the differences.
    pub change_error: f64,
}

/// Number of errors beyond which a change is significant.
const ERRORS: f64 = 2.0;

impl AnswerChange {
    /// Whether the change is larger than two errors.
    pub fn matters(&self) -> bool {
        self.change.abs() > ERRORS * self.change_error
    }
}

impl FamilyFolder {
    /// The quantities for which some member has an answer, with their species.
    pub fn quantities(&self, family: &Family) -> Result<BTreeSet<(String, String)>, RunError> {
        let mut all = BTreeSet::new();
        for member in family.members() {
            all.extend(self.answers(family, member)?.into_iter().map(|answer| (answer.quantity, answer.species)));
        }
        Ok(all)
    }

    /// A quantity at each point; `None` where no seed has a value.
    pub fn changes(&self, family: &Family, of: (&str, &str)) -> Result<Vec<Option<AnswerChange>>, RunError> {
        let mut points = Vec::new();
        for members in family.points() {
            let mut values = Vec::new();
            for member in members {
                let answers = self.answers(family, member)?.into_iter();
                let found = answers.filter(|a| (a.quantity.as_str(), a.species.as_str()) == of && a.value.is_finite());
                values.extend(found.map(|answer| (member.seed, answer.value, answer.error)));
            }
            points.push(values);
        }
        Ok(points.iter().map(|values| changed(&points[0], values)).collect())
    }

    fn answers(&self, family: &Family, member: &Member) -> Result<Vec<answers::Answer>, RunError> {
        let scene = family.scene(member).map_err(|e| FileError::read(self.path(), &e))?;
        Ok(answers::of(&self.member(member), &scene)?)
    }
}

type Values = [(Option<u64>, f64, f64)];

fn changed(first: &Values, values: &Values) -> Option<AnswerChange> {
    let here: Vec<(f64, f64)> = values.iter().map(|&(_, value, error)| (value, error)).collect();
    let at_first = |seed: Option<u64>| first.iter().find(|(other, ..)| *other == seed).map(|(_, value, _)| value);
    let differences: Vec<(f64, f64)> =
        values.iter().filter_map(|&(seed, value, _)| Some((value - at_first(seed)?, f64::NAN))).collect();
    if differences.is_empty() {
        return None;
    }
    let (found, difference) = (Spread::of(&here), Spread::of(&differences));
    Some(AnswerChange {
        mean: found.mean,
        error: found.error,
        seeds: difference.seeds,
        change: difference.mean,
        change_error: difference.error,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_that_of_each_seed() {
        let first = [(Some(1), 10.0, 1.0), (Some(2), 20.0, 1.0), (Some(3), 30.0, 1.0)];
        let same = [(Some(1), 10.1, 1.0), (Some(2), 20.0, 1.0), (Some(3), 29.9, 1.0)];
        let found = changed(&first, &same).unwrap();
        assert!(found.seeds == 3 && found.change.abs() < 1e-12 && found.change_error < 0.1 && !found.matters());
        let other = [(Some(1), 12.1, 1.0), (Some(2), 22.0, 1.0), (Some(4), 1.0, 1.0)];
        let found = changed(&first, &other).unwrap();
        assert!(found.seeds == 2 && (found.change - 2.05).abs() < 1e-12 && found.matters(), "{found:?}");
        assert!(changed(&first, &[(Some(9), 1.0, 1.0)]).is_none());
        assert!(!changed(&first[..1], &[(Some(1), 11.0, 1.0)]).unwrap().matters(), "one seed has no spread");
    }
}
