//! Mean of a quantity over the seeds, and its error from their spread.

use std::f64::consts::FRAC_PI_2;

/// Probability that a normal deviate is within one standard deviation.
const WITHIN: f64 = 0.682_689_492_137_085_9;

/// Number of seeds whose spread alone determines the error.
const ENOUGH: usize = 4;

/// Mean of one quantity over the seeds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SeedMean {
    /// The mean.
    pub(super) mean: f64,
    /// Half-width of the 68.3% confidence interval of the mean: the standard error of the mean times the factor of
    /// Student's distribution. For a single seed, the error that the run reports; for two or three at least that of
    /// the mean by the errors that they report, since their spread may be small by chance.
    pub(super) error: f64,
    /// Number of seeds.
    pub(super) seeds: usize,
    /// Standard deviation over the seeds; NaN for a single one.
    pub(super) deviation: f64,
    /// Root mean square of the errors that the runs report; NaN if none reports any.
    pub(super) claimed: f64,
}

impl SeedMean {
    /// From at least one value, each with its reported error.
    pub(super) fn of(values: &[(f64, f64)]) -> Self {
        let count = values.len() as f64;
        let mean = values.iter().map(|(value, _)| value).sum::<f64>() / count;
        let squares: f64 = values.iter().map(|(value, _)| (value - mean).powi(2)).sum();
        let deviation = (squares / (count - 1.0)).sqrt();
        let errors: Vec<f64> = values.iter().map(|(_, error)| *error).filter(|error| error.is_finite()).collect();
        let claimed = (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt();
        let reported = claimed / count.sqrt();
        let error = match values.len() {
            1 => reported,
            seeds => {
                let of_spread = student(seeds - 1) * deviation / count.sqrt();
                if seeds < ENOUGH { of_spread.max(reported) } else { of_spread }
            }
        };
        Self { mean, error, seeds: values.len(), deviation, claimed }
    }

    /// Observed spread over reported error: 1 if the runs report correct errors, above 1 if these are too small.
    pub(super) fn calibration(&self) -> f64 {
        self.deviation / self.claimed
    }
}

/// Factor of Student's distribution with `degrees` degrees of freedom: the number of standard errors of the mean that
/// contain 68.3% of cases. Exact for one and two degrees, within 1e-3 for three and more, by the expansion of Fisher
/// (Abramowitz & Stegun 26.7.5) at one standard deviation.
fn student(degrees: usize) -> f64 {
    let n = degrees as f64;
    match degrees {
        1 => (FRAC_PI_2 * WITHIN).tan(),
        2 => WITHIN * (2.0 / (1.0 - WITHIN * WITHIN)).sqrt(),
        _ => 1.0 + 0.5 / n + 0.25 / (n * n) + 0.0625 / (n * n * n),
    }
}

/// Number of errors of a mean over seeds that contain the true mean in 95% of cases, by Student's distribution over the
/// factor that the errors already have. Exact for two and three seeds, within 1% for more.
pub(super) fn errors_of_95_percent(seeds: usize) -> f64 {
    let (n, x) = (seeds.saturating_sub(1) as f64, 1.959_964_f64);
    let quantile = match seeds {
        0 | 1 => return f64::INFINITY,
        2 => 12.706_2,
        3 => 4.302_65,
        _ => {
            x + (x.powi(3) + x) / (4.0 * n)
                + (5.0 * x.powi(5) + 16.0 * x.powi(3) + 3.0 * x) / (96.0 * n * n)
                + (3.0 * x.powi(7) + 19.0 * x.powi(5) + 17.0 * x.powi(3) - 15.0 * x) / (384.0 * n.powi(3))
        }
    };
    quantile / student(seeds - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_those_of_tables() {
        // scipy.stats.t.ppf(0.8413447460685429, n)
        for (degrees, factor) in
            [(1, 1.837_337), (2, 1.321_278), (3, 1.196_888), (4, 1.141_643), (9, 1.058_5), (99, 1.005_1)]
        {
            assert!((student(degrees) - factor).abs() < 1e-3, "{degrees}: {}", student(degrees));
        }
    }

    #[test]
    fn errors_of_few_seeds_reach_farther() {
        // scipy.stats.t.ppf(0.975, n) over t.ppf(0.8413447460685429, n)
        for (seeds, errors) in [(2, 6.916), (3, 3.256), (4, 2.659), (5, 2.432), (10, 2.137), (100, 1.974)] {
            let found = errors_of_95_percent(seeds);
            assert!((found / errors - 1.0).abs() < 0.01, "{seeds}: {found}");
        }
        assert!(errors_of_95_percent(1).is_infinite());
    }

    #[test]
    fn errors_come_from_the_spread_of_seeds() {
        let found = SeedMean::of(&[(1.0, 0.5), (2.0, 0.5), (3.0, f64::NAN)]);
        assert_eq!((found.mean, found.deviation, found.claimed, found.seeds), (2.0, 1.0, 0.5, 3));
        assert!((found.error - student(2) / 3.0_f64.sqrt()).abs() < 1e-15);
        assert!((found.calibration() - 2.0).abs() < 1e-15);
        let one = SeedMean::of(&[(4.0, 0.25)]);
        assert!((one.error - 0.25).abs() < 1e-15 && one.deviation.is_nan() && one.calibration().is_nan());
        assert!(SeedMean::of(&[(4.0, f64::NAN)]).error.is_nan());
        // Two that agree by chance, and four that agree.
        assert!((SeedMean::of(&[(4.0, 0.5); 2]).error - 0.5 / 2.0_f64.sqrt()).abs() < 1e-15);
        assert_eq!(SeedMean::of(&[(4.0, 0.5); 4]).error.to_bits(), 0);
        assert!(SeedMean::of(&[(4.0, f64::NAN); 2]).error.abs() < 1e-15);
    }
}
