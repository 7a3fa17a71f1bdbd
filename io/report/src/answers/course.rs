//! The course of a quantity in a run, and its mean.

use super::{AnswerRange, RunAnswer};
use statistics::{RequestedPrecision, SteadyMean, TimeSeries, Transient};

/// A quantity that a run was made for, at the times of its series.
pub(super) struct Course {
    quantity: &'static str,
    species: String,
    unit: &'static str,
    values: Vec<f64>,
    precision: RequestedPrecision,
    /// Whether it is of the stress, whose quantities share one transient.
    is_of_stress: bool,
    result: Result,
    /// Its name in units of a scale, and that scale.
    reduced: Option<(&'static str, f64)>,
}

/// The quantity, in terms of the mean `x` of the values.
enum Result {
    /// `x`.
    Mean,
    /// `sqrt(x)`.
    Root,
    /// A number over `x`.
    Inverse(f64),
}

/// The plain mean of a quantity in a run.
#[derive(Debug, Clone, PartialEq)]
pub struct PlainMean {
    /// The quantity, as answers name it.
    pub quantity: String,
    /// Of which species.
    pub species: String,
    /// The mean.
    pub value: f64,
}

/// All particles, as a species.
pub(super) const ALL: &str = "all";

impl Course {
    /// The mean of values.
    pub(super) fn new(quantity: &'static str, unit: &'static str, values: Vec<f64>) -> Self {
        let (species, precision) = (ALL.to_owned(), RequestedPrecision::USUAL);
        Self { quantity, species, unit, values, precision, is_of_stress: false, result: Result::Mean, reduced: None }
    }

    /// The same course, of one species.
    pub(super) fn of_species(self, species: &str) -> Self {
        Self { species: species.to_owned(), ..self }
    }

    /// The same course, marked as a stress.
    pub(super) fn of_stress(self) -> Self {
        Self { is_of_stress: true, ..self }
    }

    /// The same course, whose mean may vanish: errors are compared with `scale` if that is larger than the mean.
    pub(super) fn beside(self, scale: f64) -> Self {
        Self { precision: RequestedPrecision { scale, ..self.precision }, ..self }
    }

    /// One that is positive by its nature.
    pub(super) fn positive(self) -> Self {
        Self { precision: RequestedPrecision { is_positive: true, ..self.precision }, ..self }
    }

    /// One whose values are means themselves, so that few of them will do.
    pub(super) fn of_means(self) -> Self {
        Self { precision: RequestedPrecision { fewest: 4, ..self.precision }, ..self }
    }

    /// The square root of the mean.
    pub(super) fn root(self) -> Self {
        Self { result: Result::Root, ..self.positive() }
    }

    /// A number over the mean.
    pub(super) fn inverse(self, of: f64) -> Self {
        Self { result: Result::Inverse(of), ..self }
    }

    /// Also over a scale, under a name of its own, without unit.
    pub(super) fn also_over(self, name: &'static str, scale: f64) -> Self {
        Self { reduced: (scale.is_finite() && scale > 0.0).then_some((name, 1.0 / scale)), ..self }
    }

    /// Names and values by the plain mean from a time on, whatever is known of its error.
    pub(super) fn plain_means(&self, times: &[f64], from: f64) -> Vec<PlainMean> {
        let late = || times.iter().zip(&self.values).filter(|(time, value)| **time >= from && value.is_finite());
        let mean = late().map(|(_, value)| value).sum::<f64>() / late().count() as f64;
        let value = match self.result {
            Result::Mean => mean,
            Result::Root => mean.sqrt(),
            Result::Inverse(of) => of / mean,
        };
        let named = |quantity: &str, value: f64| PlainMean {
            quantity: quantity.to_owned(),
            species: self.species.clone(),
            value,
        };
        let reduced = self.reduced.map(|(name, factor)| named(name, value * factor));
        std::iter::once(named(self.quantity, value)).chain(reduced).collect()
    }

    fn answers(self, mean: SteadyMean) -> impl Iterator<Item = RunAnswer> {
        let mean = match self.result {
            Result::Mean => mean,
            Result::Root => mean.mapped(f64::sqrt, 0.5 / mean.value.sqrt()),
            Result::Inverse(of) => mean.mapped(|value| of / value, of / (mean.value * mean.value)),
        };
        let answer = |quantity: &str, mean, unit: &str| RunAnswer {
            quantity: quantity.to_owned(),
            species: self.species.clone(),
            mean,
            unit: unit.to_owned(),
        };
        let own = answer(self.quantity, mean, self.unit);
        let reduced = self.reduced.map(|(name, factor)| answer(name, mean.times(factor), ""));
        std::iter::once(own).chain(reduced)
    }
}

/// The means of quantities in a range of times, with the transient left out, which ends no earlier than some time.
pub(super) fn means(courses: Vec<Course>, times: &[f64], range: &AnswerRange, earliest: f64) -> Vec<RunAnswer> {
    let begins = range.from.unwrap_or(earliest);
    let series = |course: &Course| TimeSeries::new(times, course.values.iter().copied()).within(begins, range.until);
    let transient = |series: &TimeSeries| match range.from {
        Some(_) => Transient::until(f64::NEG_INFINITY),
        None => Transient::of(series),
    };
    let all: Vec<_> = courses.into_iter().map(|course| (series(&course), course)).collect();
    let transients: Vec<Transient> = all.iter().map(|(series, _)| transient(series)).collect();
    let of_stress =
        all.iter().zip(&transients).filter(|((_, course), _)| course.is_of_stress).map(|(_, transient)| *transient);
    let shared = of_stress.reduce(Transient::later);
    let mean = |((series, course), own): ((TimeSeries, Course), Transient)| {
        let transient = shared.filter(|_| course.is_of_stress).unwrap_or(own);
        let mean = SteadyMean::of(&series, transient, course.precision);
        course.answers(mean)
    };
    all.into_iter().zip(transients).flat_map(mean).collect()
}
