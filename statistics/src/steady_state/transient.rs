//! Transient of a series, by the marginal standard error rule.

use super::{TimeSeries, error_of, is_constant};

/// Number of values that are averaged before the rule is applied, and the smallest number of averages for that; see
/// [`Transient::of`].
const BATCH: usize = 5;
const FEWEST_BATCHES: usize = 10;

/// Number of errors by which the part left out has to differ from the rest, if the rest has many effective samples;
/// with `FEW` of them twice as many.
const DIFFERENCE: f64 = 3.0;
const FEW: f64 = 5.0;

/// Initial part of a series that does not belong to its steady state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transient {
    /// Time at which it ends; before all values if there is no transient.
    pub end: f64,
    /// Whether it seems to last for more than half of the series, so that there is no steady state in it.
    pub is_too_long: bool,
}

impl Transient {
    /// No transient: all values belong to the steady state, or those from a known time on.
    pub fn until(end: f64) -> Self {
        Self { end, is_too_long: false }
    }

    /// The later of two transients, for quantities that reach their steady state together.
    #[must_use]
    pub fn later(self, other: Self) -> Self {
        Self { end: self.end.max(other.end), is_too_long: self.is_too_long || other.is_too_long }
    }

    /// Transient that leaves the mean of the rest with the smallest marginal standard error (White, Simulation 69,
    /// 323, 1997),
    ///
    /// ```text
    /// MSER(d) = 1 / (n - d)^2 sum_{i > d} (x_i - mean_d)^2,
    /// ```
    ///
    /// where `x_i` are means of 5 values (MSER-5; the values themselves if there are fewer than 50), weighted by the
    /// time that they represent, and `mean_d` is the mean of those after `d`. In a short series of correlated values
    /// the position of the minimum is random: the rule is followed only if the part that it leaves out differs from
    /// the rest by more than `3 (1 + 5 / N)` errors of the difference, with `N` effective samples in the rest.
    pub fn of(series: &TimeSeries) -> Self {
        let none = Self::until(f64::NEG_INFINITY);
        if is_constant(series) {
            return none;
        }
        let size = if series.len() >= BATCH * FEWEST_BATCHES { BATCH } else { 1 };
        let batches = Batches::of(series, size);
        let count = batches.0.len();
        let last = count.saturating_sub(FEWEST_BATCHES / 2);
        let Some(best) = batches.smallest_marginal_error(last).filter(|&best| best > 0) else { return none };
        if !differs(series, series.time(best * size)) {
            return none;
        }
        let half = count / 2;
        Self { end: series.time(best.min(half) * size), is_too_long: best > half }
    }
}

/// Means of consecutive values, with the times that they represent.
struct Batches(Vec<(f64, f64)>);

impl Batches {
    fn of(series: &TimeSeries, size: usize) -> Self {
        let all: Vec<(f64, f64)> = series.weighted().collect();
        let mean = |batch: &[(f64, f64)]| {
            let weight: f64 = batch.iter().map(|part| part.0).sum();
            (weight, batch.iter().map(|part| part.0 * part.1).sum::<f64>() / weight)
        };
        Self(all.chunks_exact(size).map(mean).collect())
    }

    /// Number of batches to leave out, at most `last`, for the smallest marginal standard error; the first of equal
    /// ones.
    fn smallest_marginal_error(&self, last: usize) -> Option<usize> {
        let (mut total, mut mean, mut squares) = (0.0, 0.0, 0.0);
        let mut best: Option<(f64, usize)> = None;
        for (index, &(weight, value)) in self.0.iter().enumerate().rev() {
            total += weight;
            let from_mean = value - mean;
            mean += from_mean * weight / total;
            squares += weight * from_mean * (value - mean);
            let marginal = squares / (total * total);
            if index <= last && best.is_none_or(|(least, _)| marginal <= least) {
                best = Some((marginal, index));
            }
        }
        best.map(|(_, index)| index)
    }
}

/// Whether the mean up to a time differs from that after it by more than its error. The part before it is assumed to
/// have the correlations of the rest; its mean over a shorter time varies more accordingly, at most as much as the
/// values themselves.
fn differs(series: &TimeSeries, end: f64) -> bool {
    let (before, after) = (series.before(end), series.since(end));
    let error = error_of(&after);
    let of_part = (error * error * after.duration() / before.duration()).min(after.variance());
    let samples = after.variance() / (error * error) + 1.0;
    let errors = DIFFERENCE * (1.0 + FEW / samples);
    (before.mean() - after.mean()).abs() > errors * (error * error + of_part).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::Random;

    fn of(values: impl Fn(f64) -> f64, count: u32) -> Transient {
        let times: Vec<f64> = (0..count).map(f64::from).collect();
        Transient::of(&TimeSeries::new(&times, times.iter().map(|&time| values(time))))
    }

    #[test]
    fn an_exponential_approach_is_left_out() {
        let mut random = Random::new(3, 0);
        let noise: Vec<f64> = (0..1000).map(|_| random.normal()[0]).collect();
        let found = of(|time| 20.0 * (-time / 50.0).exp() + noise[time as usize], 1000);
        // The approach is within the noise, 1, after 150, and within its marginal error of 0.03 after 320.
        assert!((100.0..350.0).contains(&found.end) && !found.is_too_long, "{found:?}");
    }

    #[test]
    fn noise_has_no_transient() {
        for seed in 0..50 {
            let mut random = Random::new(seed, 1);
            let noise: Vec<f64> = (0..200).map(|_| random.normal()[0]).collect();
            let found = of(|time| noise[time as usize], 200);
            assert!(found.end < 100.0 && !found.is_too_long, "{found:?}");
        }
    }

    #[test]
    fn a_transient_of_more_than_half_the_series_is_too_long() {
        let mut random = Random::new(4, 0);
        let noise: Vec<f64> = (0..500).map(|_| random.normal()[0]).collect();
        let jump = |at: f64| of(|time| if time < at { -20.0 } else { noise[time as usize] }, 500);
        assert_eq!((jump(150.0).end, jump(150.0).is_too_long), (150.0, false));
        assert_eq!((jump(350.0).end, jump(350.0).is_too_long), (250.0, true));
    }

    #[test]
    fn what_does_not_vary_has_none() {
        for count in [0, 1, 3, 100] {
            assert_eq!(of(|time| 2.0 + 1e-16 * time, count), Transient::until(f64::NEG_INFINITY));
        }
    }
}
