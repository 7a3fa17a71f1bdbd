//! Standard error of the mean of a correlated series, from its spectrum at the lowest frequencies.

use super::TimeSeries;
use super::student::probability_within;
use std::f64::consts::{PI, SQRT_2};

/// Largest number of cosines; half the number of samples if that is less.
const COSINES: usize = 10;

/// Number of correlation times, over the duration of the series, that are considered: between the least that the
/// cosines can distinguish from none and the duration itself.
const TIMES: usize = 12;

/// Uncorrelated fractions of the spectrum that are considered in addition to a part with a correlation time, and
/// their probabilities.
const FLOORS: [(f64, f64); 3] = [(0.0, 0.6), (0.1, 0.2), (0.3, 0.2)];

/// Prior probability that the series has no correlation that the cosines can detect.
const UNCORRELATED: f64 = 0.5;

/// Probability within one standard error.
const WITHIN: f64 = 0.682_689_492;

/// Power of the series in cosines of `1, 2, 3, ...` half waves:
/// `P_k = [sqrt(2) / T integral x(t) cos(pi k t / T) dt]^2`, whose expectation is the spectral density at the angular
/// frequency `pi k / T`, over `T`. They are nearly independent of each other and of the mean, whose variance has the
/// expectation at frequency zero.
pub(super) struct LowFrequencies(Vec<f64>);

/// A model spectrum `S(w) / S(0) = (1 - f) / (1 + (w tau)^2) + f`.
#[derive(Clone, Copy)]
struct Spectrum {
    /// Correlation time over the duration.
    time: f64,
    floor: f64,
    /// Prior probability.
    prior: f64,
}

/// Mixture of Student's t distributions about zero with the same number of degrees of freedom: their scales and
/// weights.
struct Mixture {
    freedom: usize,
    parts: Vec<(f64, f64)>,
}

impl LowFrequencies {
    /// Powers of a series.
    pub(super) fn of(series: &TimeSeries) -> Self {
        let (mean, duration) = (series.mean(), series.duration());
        let count = COSINES.min(series.len() / 2);
        let mut amplitudes = vec![0.0; count];
        let mut before = 0.0;
        for (weight, value) in series.weighted() {
            let middle = (before + 0.5 * weight) / duration;
            for (k, amplitude) in amplitudes.iter_mut().enumerate() {
                *amplitude += weight * (value - mean) * (PI * (k + 1) as f64 * middle).cos();
            }
            before += weight;
        }
        Self(amplitudes.into_iter().map(|amplitude| (SQRT_2 * amplitude / duration).powi(2)).collect())
    }

    /// Standard error of the mean: half of the interval in which the true mean lies with a probability of 68%, given
    /// the cosines.
    ///
    /// Each cosine has a normal distribution whose variance is that of one of the model spectra, of an unknown scale.
    /// With the scale integrated out, with `1 / scale` as prior density, the mean has Student's t distribution for
    /// each spectrum; their mixture is weighted by the likelihood of the cosines. So short series, whose correlation
    /// time is poorly known, have correspondingly larger errors.
    pub(super) fn standard_error(&self) -> f64 {
        let scaled = |spectrum: &Spectrum| spectrum.of_mean();
        self.mixture(0, scaled).half_width(WITHIN)
    }

    /// Probability that the slowest cosine, which is nearly a straight line, is as large as this or larger, given the
    /// other ones.
    pub(super) fn probability_of_trend(&self) -> f64 {
        let mixture = self.mixture(1, |spectrum| spectrum.at(1));
        1.0 - mixture.probability_within(self.0[0].sqrt())
    }

    /// Distribution of a number whose variance over `S(0)` is given, from all cosines but the first few.
    fn mixture(&self, skipped: usize, variance: impl Fn(&Spectrum) -> f64) -> Mixture {
        let freedom = self.0.len() - skipped;
        let part = |spectrum: &Spectrum| {
            let shape = |k: usize| spectrum.at(k);
            let ks = skipped + 1..=self.0.len();
            let scale = ks.clone().map(|k| self.0[k - 1] / shape(k)).sum::<f64>() / freedom as f64;
            let shapes: f64 = ks.map(|k| shape(k).ln()).sum();
            let likelihood = -0.5 * (shapes + freedom as f64 * scale.ln());
            ((scale * variance(spectrum)).sqrt(), likelihood + spectrum.prior.ln())
        };
        let parts: Vec<(f64, f64)> = spectra(self.0.len()).iter().map(part).collect();
        let most = parts.iter().map(|part| part.1).fold(f64::NEG_INFINITY, f64::max);
        let total: f64 = parts.iter().map(|part| (part.1 - most).exp()).sum();
        let parts = parts.into_iter().map(|(scale, weight)| (scale, (weight - most).exp() / total)).collect();
        Mixture { freedom, parts }
    }
}

/// All model spectra: without correlation, and with correlation times in geometric steps, whose probabilities are
/// proportional to them.
fn spectra(cosines: usize) -> Vec<Spectrum> {
    let least = 0.3 / (PI * cosines as f64);
    let time = |step: usize| least.powf(1.0 - step as f64 / (TIMES - 1) as f64);
    let total: f64 = (0..TIMES).map(time).sum();
    let mut spectra = vec![Spectrum { time: 0.0, floor: 0.0, prior: UNCORRELATED }];
    for time in (0..TIMES).map(time) {
        let with_floor = |(floor, share)| {
            let prior = (1.0 - UNCORRELATED) * share * time / total;
            Spectrum { time, floor, prior }
        };
        spectra.extend(FLOORS.map(with_floor));
    }
    spectra
}

impl Spectrum {
    /// Value at the cosine of `k` half waves.
    fn at(&self, k: usize) -> f64 {
        (1.0 - self.floor) / (1.0 + (PI * k as f64 * self.time).powi(2)) + self.floor
    }

    /// Variance of the mean of a series of this correlation time, over that of a long one, `S(0) / T`.
    fn of_mean(&self) -> f64 {
        let correlated = 1.0 - self.time * (1.0 - (-1.0 / self.time).exp());
        (1.0 - self.floor) * correlated + self.floor
    }
}

impl Mixture {
    fn probability_within(&self, distance: f64) -> f64 {
        let part = |&(scale, weight): &(f64, f64)| weight * probability_within(distance / scale, self.freedom);
        self.parts.iter().map(part).sum()
    }

    /// Distance within which a number lies with the given probability, by bisection.
    fn half_width(&self, probability: f64) -> f64 {
        let largest = self.parts.iter().map(|part| part.0).fold(0.0, f64::max);
        let (mut low, mut high) = (0.0, 10.0 * largest);
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            let is_less = self.probability_within(middle) < probability;
            (low, high) = if is_less { (middle, high) } else { (low, middle) };
        }
        high
    }
}
