//! Changes of a quantity from the first point of a family to each of the others.

use super::folder::FamilyFolder;
use super::spread::{SeedMean, errors_of_95_percent};
use crate::RunError;
use files::FileError;
use report::{PlainMean, second_half};
use scene::{Family, Member};
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

/// Significance of a change of an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChangeVerdict {
    /// There are too few seeds to tell, or they differ too much: it may be more than half of the quantity.
    Unknown,
    /// It may be by chance.
    NotSeen,
    /// It is hardly by chance, but below the error of the quantity itself.
    Small,
    /// It is beyond both.
    Matters,
}

/// The part of a quantity up to which something is known of a change that is not seen.
const KNOWN: f64 = 0.5;

impl AnswerChange {
    /// Significance of the change.
    pub fn verdict(&self) -> ChangeVerdict {
        let (change, scale) = (self.change.abs(), (self.mean - self.change).abs().max(self.error));
        match self.chance() {
            chance if !chance.is_finite() => ChangeVerdict::Unknown,
            chance if change > chance && change > self.error => ChangeVerdict::Matters,
            chance if change > chance => ChangeVerdict::Small,
            _ if self.at_most() > KNOWN * scale => ChangeVerdict::Unknown,
            _ => ChangeVerdict::NotSeen,
        }
    }

    /// The change that 95% of pairs of equal runs stay below.
    fn chance(&self) -> f64 {
        errors_of_95_percent(self.seeds) * self.change_error
    }

    /// The change that is excluded in 95% of cases.
    pub fn at_most(&self) -> f64 {
        self.change.abs() + self.chance()
    }

    /// The change, its error, and the change that is excluded over the quantity at the first point.
    pub fn relative(&self) -> [f64; 3] {
        let first = self.mean - self.change;
        [self.change, self.change_error, self.at_most()].map(|number| number / first.abs())
    }
}

impl ChangeVerdict {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Unknown => "unknown",
            Self::NotSeen => "not seen",
            Self::Small => "small",
            Self::Matters => "matters",
        }
    }
}

impl FamilyFolder {
    /// The quantities that some member has, with their species.
    pub fn quantities(&self, family: &Family) -> Result<BTreeSet<(String, String)>, RunError> {
        let mut all = BTreeSet::new();
        for member in family.members() {
            all.extend(self.means(family, member)?.into_iter().map(|mean| (mean.quantity, mean.species)));
        }
        Ok(all)
    }

    /// The verdicts of the runs of the first point on a quantity: `2 converged, 1 too short`.
    pub fn first_verdicts(&self, family: &Family, of: (&str, &str)) -> Result<String, RunError> {
        let table = self.table(family)?;
        let is_it = |words: &[String]| words[0] == family.members()[0].point_name() && (&*words[2], &*words[3]) == of;
        Ok(table.rows.iter().find(|(words, _)| is_it(words)).map(|(words, _)| words[4].clone()).unwrap_or_default())
    }

    /// A quantity at each point, as the mean over the second half of each run; nothing where no seed has a value.
    pub fn changes(&self, family: &Family, of: (&str, &str)) -> Result<Vec<Option<AnswerChange>>, RunError> {
        let mut points = Vec::new();
        for members in family.points() {
            let mut values = Vec::new();
            for member in members {
                let means = self.means(family, member)?.into_iter();
                let found = means.filter(|m| (m.quantity.as_str(), m.species.as_str()) == of && m.value.is_finite());
                values.extend(found.map(|mean| (member.seed, mean.value)));
            }
            points.push(values);
        }
        Ok(points.iter().map(|values| changed(&points[0], values)).collect())
    }

    fn means(&self, family: &Family, member: &Member) -> Result<Vec<PlainMean>, RunError> {
        let scene = family.scene(member).map_err(|e| FileError::read(self.path(), &e))?;
        Ok(second_half(&self.member(member), &scene)?)
    }
}

type SeedValues = [(Option<u64>, f64)];

fn changed(first: &SeedValues, values: &SeedValues) -> Option<AnswerChange> {
    let at_first = |seed: Option<u64>| first.iter().find(|(other, _)| *other == seed).map(|(_, value)| *value);
    let pairs: Vec<[f64; 2]> = values.iter().filter_map(|&(seed, value)| Some([value, at_first(seed)?])).collect();
    if pairs.is_empty() {
        return None;
    }
    let spread = |of: &dyn Fn(&[f64; 2]) -> f64| {
        SeedMean::of(&pairs.iter().map(|pair| (of(pair), f64::NAN)).collect::<Vec<_>>())
    };
    let (found, difference) = (spread(&|[here, _]| *here), spread(&|[here, there]| here - there));
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
        let first = [(Some(1), 10.0), (Some(2), 20.0), (Some(3), 30.0)];
        let same = [(Some(1), 10.1), (Some(2), 20.0), (Some(3), 29.9)];
        let found = changed(&first, &same).unwrap();
        assert!(found.seeds == 3 && found.change.abs() < 1e-12 && found.change_error < 0.1);
        assert!(
            found.verdict() == ChangeVerdict::NotSeen && (found.at_most() / found.change_error - 3.256).abs() < 0.01
        );
        let wild = [(Some(1), 50.0), (Some(2), 20.0), (Some(3), 29.0)];
        assert_eq!(changed(&first, &wild).unwrap().verdict(), ChangeVerdict::Unknown);
        // Seeds are 8 from their mean, by which a change of 2 is small, however well it is known.
        let other = [(Some(1), 12.1), (Some(2), 22.0), (Some(4), 1.0)];
        let found = changed(&first, &other).unwrap();
        assert!(found.seeds == 2 && (found.change - 2.05).abs() < 1e-12 && (found.mean - 17.05).abs() < 1e-12);
        assert_eq!(found.verdict(), ChangeVerdict::Small);
        let far = [(Some(1), 50.0), (Some(2), 60.1), (Some(3), 70.0)];
        let found = changed(&first, &far).unwrap();
        assert_eq!(found.verdict(), ChangeVerdict::Matters);
        assert!((found.relative()[0] - 40.03 / 20.0).abs() < 2e-3, "{:?}", found.relative());
        assert!(changed(&first, &[(Some(9), 1.0)]).is_none());
        assert_eq!(changed(&first[..1], &[(Some(1), 11.0)]).unwrap().verdict(), ChangeVerdict::Unknown);
    }
}
