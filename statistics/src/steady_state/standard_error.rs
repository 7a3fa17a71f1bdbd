//! The standard error of the mean of a correlated series, from its spectrum at the lowest frequencies.

use super::TimeSeries;
use super::student::probability_within;
use std::f64::consts::{PI, SQRT_2};

/// Cosines that are looked at, fewer where there are fewer than twice as many samples.
const COSINES: usize = 10;

/// Correlation times over the duration of the series that are thought possible, between the least that the cosines can
/// tell from none and the duration itself.
const TIMES: usize = 12;

/// The share of the spectrum without correlation that is thought possible beside that with a correlation time, and its
/// probability.
const FLOORS: [(f64, f64); 3] = [(0.0, 0.6), (0.1, 0.2), (0.3, 0.2)];

/// The probability, before the series is seen, that it has no correlation that the cosines can tell.
const UNCORRELATED: f64 = 0.5;

/// The probability within one standard error.
const WITHIN: f64 = 0.682_689_492;

/// Power of the series in cosines of `1, 2, 3, ...` half waves: `P_k = [sqrt(2) / T integral x(t) cos(pi k t / T)
/// dt]^2`, whose expectation is the spectral density at the angular frequency `pi k / T`, over `T`. They are all but
/// independent of each other and of the mean, which has the expectation of frequency zero.
pub(super) struct LowFrequencies(Vec<f64>);

/// A spectrum `S(w) / S(0) = (1 - f) / (1 + (w tau)^2) + f` of what is thought possible.
#[derive(Clone, Copy)]
struct Spectrum {
    /// The correlation time over the duration.
    time: f64,
    floor: f64,
    /// Its probability before the series is seen.
    prior: f64,
}

/// Student's t distributions of one number of degrees of freedom about zero, with their scales and weights.
struct Mixture {
    freedom: usize,
    parts: Vec<(f64, f64)>,
}

impl LowFrequencies {
    /// Those of a series.
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

    /// The standard error of the mean: half of the span in which the true mean lies with 68%, given the cosines.
    ///
    /// Each cosine has a normal distribution whose variance is that of one of the possible spectra, of an unknown
    /// scale. With the scale integrated out, with `1 / scale` as prior density, the mean has Student's t distribution
    /// for each spectrum; their mixture is weighted by the likelihood of the cosines. So short series, whose
    /// correlation time is not known well, have larger errors, by as much as it is not known.
    pub(super) fn standard_error(&self) -> f64 {
        let scaled = |spectrum: &Spectrum| spectrum.of_mean();
        self.mixture(0, scaled).half_width(WITHIN)
    }

    /// The probability of a slowest cosine, which is nearly a straight line, as large as this or larger, given the
    /// other ones.
    pub(super) fn probability_of_trend(&self) -> f64 {
        let mixture = self.mixture(1, |spectrum| spectrum.at(1));
        1.0 - mixture.probability_within(self.0[0].sqrt())
    }

    /// The distribution of a number whose variance over `S(0)` is given, from all cosines but the first few.
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

/// All that are thought possible: no correlation, and correlation times in geometric steps, with probabilities that are
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
    /// Its value at the cosine of `k` half waves.
    fn at(&self, k: usize) -> f64 {
        (1.0 - self.floor) / (1.0 + (PI * k as f64 * self.time).powi(2)) + self.floor
    }

    /// The variance of the mean of a series of this correlation time, over that of a long one, `S(0) / T`.
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

    /// The distance within which a number lies with a probability, by bisection.
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
