//! Mean of a correlated time series in its steady state, with an error that is reliable for short series, and a
//! verdict.

#[cfg(test)]
mod coverage_tests;
mod series;
mod standard_error;
mod student;
mod transient;

pub use series::TimeSeries;
use standard_error::LowFrequencies;
pub use transient::Transient;

/// Mean of a series in its steady state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteadyMean {
    /// Mean after the transient; NaN if it would be meaningless.
    pub value: f64,
    /// Standard error: the true mean is within it with a probability of 68%.
    pub error: f64,
    /// Effective number of samples: of independent values whose mean had this error.
    pub samples: f64,
    /// End of the transient, which is left out; time of the first value if there is no transient.
    pub transient: f64,
    /// Whether the requested precision is reached.
    pub verdict: Verdict,
}

/// Whether the requested precision of a mean is reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Verdict {
    /// It is reached.
    Converged,
    /// The series would need to be longer.
    TooShort {
        /// Factor by which it would need to be longer.
        longer: f64,
    },
    /// The series has no steady state yet: it has a trend, or a transient longer than half of it.
    Drifting,
    /// There is no value: too few samples, or a quantity that can't be negative is not significantly above zero.
    Meaningless,
}

/// Requested precision of a mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RequestedPrecision {
    /// Largest error over the value, or over [`Self::scale`] if that is larger.
    pub relative_error: f64,
    /// Scale of the quantity with which errors are compared if its mean may vanish; 0 for the mean alone.
    pub scale: f64,
    /// Whether the quantity is positive by definition.
    pub is_positive: bool,
    /// Smallest number of values for a mean with an error.
    pub fewest: usize,
}

impl RequestedPrecision {
    /// 5% of the mean.
    pub const USUAL: Self = Self { relative_error: 0.05, scale: 0.0, is_positive: false, fewest: 8 };
}

/// Effective number of samples below which a mean is meaningless, and below which a run is too short. A larger first
/// number would select those short series whose error is too small.
const MEANINGFUL: f64 = 1.5;
const ENOUGH: f64 = 10.0;
/// The squared error is multiplied by `1 + UNSEEN / samples`: means of short series vary more than their cosines
/// show, because of slower fluctuations.
const UNSEEN: f64 = 5.5;
/// Probability of a trend by chance above which it is not significant.
const CHANCE: f64 = 0.01;
/// Relative variations up to this are round-off.
const ROUND_OFF: f64 = 1e-12;

impl SteadyMean {
    /// Mean of the values after a transient.
    pub fn of(series: &TimeSeries, transient: Transient, precision: RequestedPrecision) -> Self {
        let steady = series.since(transient.end);
        if steady.len() < precision.fewest.max(4) {
            return Self::meaningless(&steady);
        }
        let (value, error, variance) = (steady.mean(), error_of(&steady), steady.variance());
        let count = steady.len() as f64;
        let samples = if error > 0.0 { (variance / (error * error) + 1.0).min(count) } else { count };
        let error = error * (1.0 + UNSEEN / samples).sqrt();
        let is_unknown = precision.is_positive && value <= error && error > 0.0;
        if samples < MEANINGFUL || is_unknown || !value.is_finite() || !error.is_finite() {
            return Self::meaningless(&steady);
        }
        let scale = value.abs().max(precision.scale);
        let longer = (error / (precision.relative_error * scale)).powi(2).max(ENOUGH / samples);
        let longer = if error == 0.0 { 1.0 } else { longer };
        let has_trend = error > 0.0 && LowFrequencies::of(&steady).probability_of_trend() < CHANCE;
        let verdict = match longer {
            _ if transient.is_too_long || has_trend => Verdict::Drifting,
            longer if longer <= 1.0 => Verdict::Converged,
            longer => Verdict::TooShort { longer: of_whole(longer, series.duration(), steady.duration()) },
        };
        Self { value, error, samples, transient: steady.time(0), verdict }
    }

    fn meaningless(steady: &TimeSeries) -> Self {
        let transient = if steady.is_empty() { f64::NAN } else { steady.time(0) };
        Self { value: f64::NAN, error: f64::NAN, samples: f64::NAN, transient, verdict: Verdict::Meaningless }
    }

    /// The same in another unit.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        self.mapped(|value| value * factor, factor)
    }

    /// A function of the mean, with its derivative there.
    #[must_use]
    pub fn mapped(self, function: impl Fn(f64) -> f64, derivative: f64) -> Self {
        Self { value: function(self.value), error: self.error * derivative.abs(), ..self }
    }
}

/// Factor by which the whole run would be longer if its steady part were longer by `longer`.
fn of_whole(longer: f64, all: f64, steady: f64) -> f64 {
    1.0 + (longer - 1.0) * steady / all
}

/// Standard error of the mean of a series; zero for one that is constant up to round-off.
fn error_of(series: &TimeSeries) -> f64 {
    match series.len() {
        0..2 => f64::INFINITY,
        _ if is_constant(series) => 0.0,
        _ => LowFrequencies::of(series).standard_error(),
    }
}

/// Whether a series does not vary by more than round-off.
fn is_constant(series: &TimeSeries) -> bool {
    series.variance().sqrt() <= ROUND_OFF * series.mean().abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::Random;

    fn series(count: u32, value: impl FnMut(f64) -> f64) -> TimeSeries {
        let times: Vec<f64> = (0..count).map(f64::from).collect();
        TimeSeries::new(&times, times.iter().copied().map(value).collect::<Vec<f64>>())
    }

    fn mean(series: &TimeSeries, precision: RequestedPrecision) -> SteadyMean {
        SteadyMean::of(series, Transient::of(series), precision)
    }

    #[test]
    fn independent_values_have_the_error_of_their_number() {
        let mut random = Random::new(1, 2);
        let noise = series(4000, |_| 10.0 + random.normal()[0]);
        let found = mean(&noise, RequestedPrecision::USUAL);
        assert!((found.error * 4000.0_f64.sqrt() - 1.0).abs() < 0.35, "{found:?}");
        assert!((found.value - 10.0).abs() < 3.0 * found.error && found.verdict == Verdict::Converged, "{found:?}");
        assert!(found.samples > 2000.0 && found.samples <= 4000.0 && found.transient == 0.0, "{found:?}");
    }

    #[test]
    fn what_does_not_vary_is_known() {
        let found = mean(&series(20, |time| 3.0 + 1e-15 * time), RequestedPrecision::USUAL);
        assert_eq!((found.error, found.samples, found.verdict), (0.0, 20.0, Verdict::Converged));
        assert_eq!(mean(&series(20, |_| 0.0), RequestedPrecision::USUAL).verdict, Verdict::Converged);
    }

    #[test]
    fn a_trend_is_drift() {
        let mut random = Random::new(1, 3);
        let ramp = series(400, |time| 5.0 + 0.01 * time + random.normal()[0]);
        assert_eq!(mean(&ramp, RequestedPrecision::USUAL).verdict, Verdict::Drifting);
        assert_eq!(mean(&series(50, |time| time), RequestedPrecision::USUAL).verdict, Verdict::Drifting);
    }

    #[test]
    fn a_short_run_is_told_how_long_it_should_be() {
        let noise = |seed| {
            let mut random = Random::new(seed, 4);
            series(400, |_| 1.0 + 4.0 * random.normal()[0])
        };
        let longer = |seed| match mean(&noise(seed), RequestedPrecision::USUAL).verdict {
            Verdict::TooShort { longer } => longer,
            other => panic!("{other:?}, with an error of 20%"),
        };
        let mut factors: Vec<f64> = (0..9).map(longer).collect();
        factors.sort_by(f64::total_cmp);
        // An error of 0.2 where 0.05 is requested.
        assert!((10.0..32.0).contains(&factors[4]), "{factors:?}");
        let beside_ten = RequestedPrecision { scale: 10.0, ..RequestedPrecision::USUAL };
        assert_eq!(mean(&noise(0), beside_ten).verdict, Verdict::Converged);
        assert!((of_whole(3.0, 10.0, 5.0) - 2.0).abs() < 1e-15);
    }

    #[test]
    fn values_that_mean_nothing_are_not_given() {
        let few = mean(&series(7, |time| time), RequestedPrecision::USUAL);
        assert!(few.value.is_nan() && few.error.is_nan() && few.verdict == Verdict::Meaningless);
        assert!(mean(&series(0, |time| time), RequestedPrecision::USUAL).transient.is_nan());
        let mut random = Random::new(1, 5);
        let noise = series(100, |_| random.normal()[0] - 0.1);
        let positive = RequestedPrecision { is_positive: true, ..RequestedPrecision::USUAL };
        assert_eq!(mean(&noise, positive).verdict, Verdict::Meaningless);
        assert!(mean(&noise, RequestedPrecision::USUAL).value.is_finite());
    }

    #[test]
    fn units_change_value_and_error() {
        let found = mean(&series(20, |time| 2.0 + (time * 0.7).sin()), RequestedPrecision::USUAL);
        let other = found.times(-2.0);
        assert_eq!((other.value, other.error, other.samples), (-2.0 * found.value, 2.0 * found.error, found.samples));
    }
}
