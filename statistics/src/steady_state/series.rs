//! A time series with equal or unequal intervals.

use std::ops::Range;

/// Values at increasing times, each of which represents the time around it: half of the interval on either side, at
/// the ends the same length outwards as inwards. At equal intervals all have the same weight.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeSeries {
    times: Vec<f64>,
    values: Vec<f64>,
    /// Time that each value represents.
    weights: Vec<f64>,
}

impl TimeSeries {
    /// The finite values at increasing times; the others are left out.
    pub fn new(times: &[f64], values: impl IntoIterator<Item = f64>) -> Self {
        let (mut kept, mut finite) = (Vec::new(), Vec::new());
        for (&time, value) in times.iter().zip(values) {
            let is_later = kept.last().is_none_or(|&last| time > last);
            if time.is_finite() && value.is_finite() && is_later {
                kept.push(time);
                finite.push(value);
            }
        }
        let weights = weights(&kept);
        Self { times: kept, values: finite, weights }
    }

    /// Part from a time on.
    #[must_use]
    pub fn since(&self, from: f64) -> Self {
        self.within(from, f64::INFINITY)
    }

    /// Part from one time to another, both included.
    #[must_use]
    pub fn within(&self, from: f64, until: f64) -> Self {
        let first = self.times.partition_point(|&time| time < from);
        let end = self.times.partition_point(|&time| time <= until).max(first);
        self.part(first..end)
    }

    /// Part before a time.
    pub(super) fn before(&self, end: f64) -> Self {
        self.part(0..self.times.partition_point(|&time| time < end))
    }

    fn part(&self, range: Range<usize>) -> Self {
        let times = self.times[range.clone()].to_vec();
        Self { weights: weights(&times), times, values: self.values[range].to_vec() }
    }

    /// Number of values.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Whether there are no values.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Time of a value.
    pub(super) fn time(&self, index: usize) -> f64 {
        self.times[index]
    }

    /// Time that all values together represent.
    pub fn duration(&self) -> f64 {
        self.weights.iter().sum()
    }

    /// Mean over time; NaN without values.
    pub fn mean(&self) -> f64 {
        self.weighted().map(|(weight, value)| weight * value).sum::<f64>() / self.duration()
    }

    /// Variance over time about the mean.
    pub fn variance(&self) -> f64 {
        let mean = self.mean();
        self.weighted().map(|(weight, value)| weight * (value - mean).powi(2)).sum::<f64>() / self.duration()
    }

    /// Weights and values.
    pub(super) fn weighted(&self) -> impl DoubleEndedIterator<Item = (f64, f64)> + ExactSizeIterator {
        self.weights.iter().copied().zip(self.values.iter().copied())
    }
}

fn weights(times: &[f64]) -> Vec<f64> {
    let gap = |index: usize| times[index + 1] - times[index];
    let last = times.len().saturating_sub(1);
    let weight = |index: usize| match (index, last) {
        (_, 0) => 1.0,
        (0, _) => gap(0),
        (index, last) if index == last => gap(last - 1),
        _ => 0.5 * (gap(index - 1) + gap(index)),
    };
    (0..times.len()).map(weight).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_count_for_the_time_around_them() {
        let series = TimeSeries::new(&[0.0, 1.0, 2.0, 4.0], [1.0, 2.0, 3.0, 5.0]);
        assert_eq!(series.weights, [1.0, 1.0, 1.5, 2.0]);
        assert!((series.mean() - (1.0 + 2.0 + 4.5 + 10.0) / 5.5).abs() < 1e-15);
        assert_eq!(series.since(1.5).weights, [2.0, 2.0]);
        assert_eq!(series.within(1.0, 2.0).values, [2.0, 3.0]);
        assert_eq!(series.before(1.0).values, [1.0]);
        assert!(series.within(2.5, 1.0).is_empty());
        assert!((TimeSeries::new(&[3.0], [7.0]).mean() - 7.0).abs() < 1e-15);
        assert!(TimeSeries::new(&[], []).mean().is_nan());
    }

    #[test]
    fn values_that_are_not_finite_and_times_that_do_not_grow_are_left_out() {
        let times = [0.0, 1.0, 1.0, 0.5, f64::NAN, 2.0, 3.0];
        let series = TimeSeries::new(&times, [f64::NAN, 1.0, 9.0, 9.0, 9.0, f64::INFINITY, 2.0]);
        assert_eq!((series.times, series.values), (vec![1.0, 3.0], vec![1.0, 2.0]));
    }
}
