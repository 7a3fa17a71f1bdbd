//! Means of correlated series, with error bars.

use crate::{State, Store};

/// A mean with its standard error.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Estimate {
    /// The mean.
    pub mean: f64,
    /// Standard error of the mean.
    pub error: f64,
    /// Whether the series is long enough, compared to its correlation time, for the error to be reliable; if not, it
    /// is a lower bound.
    pub converged: bool,
}

/// Mean of a series of correlated numbers, and its error by blocking: neighbours are averaged in pairs, pairs of
/// these again and so on, until blocks are independent (Flyvbjerg & Petersen, J. Chem. Phys. 91, 461, 1989). The
/// length of the blocks is the shortest `B` with `B^3 > 2 n (error_B / error_1)^4`, for `n` numbers (Lee et al.,
/// Phys. Rev. E 83, 066706, 2011).
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Blocks {
    levels: Vec<BlockLevel>,
}

/// Blocks of one length: Welford's mean and sum of squares, and a block that is not yet paired.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct BlockLevel {
    count: u64,
    mean: f64,
    squares: f64,
    waiting: f64,
}

impl BlockLevel {
    /// Adds a block; returns the mean of a completed pair.
    fn add(&mut self, value: f64) -> Option<f64> {
        self.count += 1;
        let from_mean = value - self.mean;
        self.mean += from_mean / self.count as f64;
        self.squares += from_mean * (value - self.mean);
        let pair = self.count.is_multiple_of(2).then_some(0.5 * (self.waiting + value));
        self.waiting = value;
        pair
    }

    /// Square of the error of the mean, as if blocks were independent.
    fn variance_of_mean(&self) -> f64 {
        let n = self.count as f64;
        self.squares / (n * (n - 1.0))
    }
}

impl Blocks {
    /// Memory of the longest series.
    pub const MOST_BYTES: usize = 32 * size_of::<BlockLevel>();

    /// Adds the next number of the series.
    pub fn add(&mut self, value: f64) {
        let mut value = Some(value);
        for level in 0.. {
            let Some(block) = value else { return };
            if level == self.levels.len() {
                self.levels.push(BlockLevel::default());
            }
            value = self.levels[level].add(block);
        }
    }

    /// Number of values added.
    pub fn count(&self) -> u64 {
        self.levels.first().map_or(0, |level| level.count)
    }

    /// Standard deviation of the values; NaN if there are none.
    pub fn deviation(&self) -> f64 {
        self.levels.first().map_or(f64::NAN, |level| (level.squares / level.count as f64).sqrt())
    }

    /// Mean and its error; the mean of no values is NaN, the error of one is infinite.
    pub fn estimate(&self) -> Estimate {
        let Some(single) = self.levels.first() else {
            return Estimate { mean: f64::NAN, error: f64::INFINITY, converged: false };
        };
        if single.count < 2 {
            return Estimate { mean: single.mean, error: f64::INFINITY, converged: false };
        }
        let alone = single.variance_of_mean();
        let is_long_enough = |(level, blocks): &(usize, &BlockLevel)| {
            let ratio = if alone > 0.0 { blocks.variance_of_mean() / alone } else { 0.0 };
            8_f64.powi(*level as i32) > 2.0 * single.count as f64 * ratio * ratio
        };
        let mut usable = self.levels.iter().enumerate().take_while(|(_, level)| level.count >= 4);
        let (square, converged) = match usable.find(is_long_enough) {
            Some((_, level)) => (level.variance_of_mean(), true),
            None => (
                self.levels.iter().filter(|l| l.count >= 4).map(BlockLevel::variance_of_mean).fold(alone, f64::max),
                false,
            ),
        };
        Estimate { mean: single.mean, error: square.sqrt(), converged }
    }
}

impl State for Blocks {
    fn visit(&mut self, store: &mut dyn Store) {
        let mut count = self.levels.len() as u64;
        store.count(&mut count);
        self.levels.resize(count.min(64) as usize, BlockLevel::default());
        for level in &mut self.levels {
            store.count(&mut level.count);
            for number in [&mut level.mean, &mut level.squares, &mut level.waiting] {
                store.number(number);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::Random;

    /// A Gaussian number from two uniform ones (Box & Muller).
    fn gaussian(random: &mut Random) -> f64 {
        (-2.0 * (1.0 - random.uniform()).ln()).sqrt() * (std::f64::consts::TAU * random.uniform()).cos()
    }

    /// `x' = c x + sqrt(1 - c^2) g`: variance 1, the variance of the mean of `n` is `(1 + c) / (1 - c) / n`.
    #[test]
    fn errors_of_correlated_numbers_are_those_known() {
        for correlation in [0.0, 0.5, 0.9] {
            let count = 1 << 15;
            let expected = ((1.0 + correlation) / (1.0 - correlation) / f64::from(count)).sqrt();
            let (mut squares, runs) = (0.0, 20);
            for seed in 0..runs {
                let mut random = Random::new(seed, 1);
                let mut blocks = Blocks::default();
                let mut x = gaussian(&mut random);
                for _ in 0..count {
                    blocks.add(x);
                    x = correlation * x + (1.0 - correlation * correlation).sqrt() * gaussian(&mut random);
                }
                let Estimate { mean, error, converged } = blocks.estimate();
                assert!(converged && mean.abs() < 5.0 * error);
                squares += error * error / runs as f64;
            }
            // Each error is known to a few per cent; blocks that are too short reduce it by another few.
            assert!((squares.sqrt() / expected - 1.0).abs() < 0.08, "{} for {expected}", squares.sqrt());
        }
    }

    #[test]
    fn the_error_of_a_short_series_is_not_trusted() {
        let mut blocks = Blocks::default();
        assert!(blocks.estimate().mean.is_nan());
        for i in 0..64 {
            blocks.add((f64::from(i) / 40.0).sin());
        }
        assert!(!blocks.estimate().converged);
        let mut constant = Blocks::default();
        for _ in 0..9 {
            constant.add(2.0);
        }
        assert_eq!(constant.estimate(), Estimate { mean: 2.0, error: 0.0, converged: true });
        assert!(constant.deviation().abs() < 1e-15);
        constant.add(12.0);
        assert!((constant.deviation() - 3.0).abs() < 1e-15 && Blocks::default().deviation().is_nan());
    }

    /// A ramp of 16: means of four have the variance 80/3, and four of them are the longest blocks that count.
    #[test]
    fn without_blocks_long_enough_the_error_is_the_largest() {
        let mut ramp = Blocks::default();
        (0..16).for_each(|i| ramp.add(f64::from(i)));
        let Estimate { mean, error, converged } = ramp.estimate();
        assert!((mean - 7.5).abs() < 1e-15 && (error - (20.0_f64 / 3.0).sqrt()).abs() < 1e-14 && !converged, "{error}");
    }

    #[test]
    fn the_mean_is_that_of_all_at_once_and_the_state_lasts() {
        let values: Vec<f64> = (0..1000).map(|i| (f64::from(i) * 0.7).sin() + 1e3).collect();
        let mut blocks = Blocks::default();
        for &v in &values[..400] {
            blocks.add(v);
        }
        let mut resumed = Blocks::default();
        assert!(resumed.load(&blocks.save()));
        for &v in &values[400..] {
            resumed.add(v);
        }
        let mean = values.iter().sum::<f64>() / 1000.0;
        assert!((resumed.estimate().mean - mean).abs() < 1e-12 * mean);
        for &v in &values[400..] {
            blocks.add(v);
        }
        assert_eq!(blocks, resumed);
    }
}
