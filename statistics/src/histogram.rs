//! Histograms of numbers whose range is not known in advance.

use crate::{State, Store};

/// Number of bins on either side of zero.
const HALF: usize = 256;

/// Histogram with bins of equal width around zero. The width is the smallest power of two for which all numbers fit:
/// when one does not, neighbouring bins are merged in pairs, so counts do not depend on the order of the numbers.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Histogram {
    counts: Vec<f64>,
    /// Exponent of two of the width, offset by 2^11 to be positive.
    exponent: u64,
}

const OFFSET: i32 = 2048;

impl Histogram {
    /// Adds a number; numbers that are not finite are ignored.
    pub fn add(&mut self, value: f64) {
        if !value.is_finite() {
            return;
        }
        let needed = exponent(value);
        if self.counts.is_empty() {
            self.counts = vec![0.0; 2 * HALF];
            self.exponent = needed;
        }
        while self.exponent < needed {
            self.widen();
        }
        let bin = (value / self.width()).floor() as i64 + HALF as i64;
        self.counts[bin.clamp(0, 2 * HALF as i64 - 1) as usize] += 1.0;
    }

    /// Merges bins in pairs.
    fn widen(&mut self) {
        let mut merged = vec![0.0; 2 * HALF];
        for (bin, count) in self.counts.iter().enumerate() {
            merged[HALF / 2 + bin / 2] += count;
        }
        self.counts = merged;
        self.exponent += 1;
    }

    /// Adds the numbers of another histogram.
    pub(crate) fn merge(&mut self, other: &Self) {
        if self.counts.is_empty() || other.counts.is_empty() {
            if self.counts.is_empty() {
                self.clone_from(other);
            }
            return;
        }
        let mut other = other.clone();
        while self.exponent < other.exponent {
            self.widen();
        }
        while other.exponent < self.exponent {
            other.widen();
        }
        self.counts.iter_mut().zip(&other.counts).for_each(|(count, more)| *count += more);
    }

    fn width(&self) -> f64 {
        libm::exp2(f64::from(self.exponent as i32 - OFFSET))
    }

    /// Number of values added.
    pub fn count(&self) -> f64 {
        self.counts.iter().sum()
    }

    /// Centres of the bins from the first to the last that is not empty, and the count in each.
    pub fn counts(&self) -> Vec<(f64, f64)> {
        let first = self.counts.iter().position(|&count| count > 0.0).unwrap_or(0);
        let last = self.counts.iter().rposition(|&count| count > 0.0).map_or(0, |last| last + 1);
        let centre = |bin: usize| (bin as f64 - HALF as f64 + 0.5) * self.width();
        (first..last).map(|bin| (centre(bin), self.counts[bin])).collect()
    }

    /// Standard deviation, from the centres of the bins.
    pub fn standard_deviation(&self) -> f64 {
        let counts = self.counts();
        let moment = |power: i32| counts.iter().map(|(x, n)| x.powi(power) * n).sum::<f64>() / self.count();
        (moment(2) - moment(1).powi(2)).max(0.0).sqrt()
    }

    /// Density of `x / s`, with `s` the standard deviation, in bins about `s / 10` wide: the bins' centres and the
    /// density there.
    pub fn normalised(&self) -> Vec<(f64, f64)> {
        let (count, deviation) = (self.count(), self.standard_deviation());
        let merged = (0.1 * deviation / self.width()).round().max(1.0) as usize;
        let width = merged as f64 * self.width();
        // Groups of bins start at zero on either side.
        let groups = HALF.div_ceil(merged) as i64;
        let sum = |group: i64| {
            let bins = (group * merged as i64..(group + 1) * merged as i64).map(|bin| bin + HALF as i64);
            bins.filter_map(|bin| self.counts.get(usize::try_from(bin).ok()?)).sum::<f64>()
        };
        let all = (-groups..groups).map(|g| ((g as f64 + 0.5) * width / deviation, sum(g)));
        all.filter(|(_, n)| *n > 0.0).map(|(x, n)| (x, n / count / width * deviation)).collect()
    }
}

/// Least exponent of two, with the offset, of a width at which a number fits.
fn exponent(value: f64) -> u64 {
    let least = libm::log2((value.abs() / HALF as f64).max(f64::MIN_POSITIVE)).floor() as i32 + 1;
    (least + OFFSET) as u64
}

impl State for Histogram {
    fn visit(&mut self, store: &mut dyn Store) {
        store.numbers(&mut self.counts);
        store.count(&mut self.exponent);
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "counts are whole")]
mod tests {
    use super::*;
    use crate::Counts;
    use domain::Random;

    fn numbers() -> Vec<f64> {
        // The sum of twelve uniform numbers is nearly Gaussian with a standard deviation of 1.
        let number = |seed| {
            let mut random = Random::new(seed, 3);
            (0..12).map(|_| random.uniform()).sum::<f64>() - 6.0
        };
        (0..20_000).map(number).collect()
    }

    #[test]
    fn counts_do_not_depend_on_the_order_and_the_state_lasts() {
        let mut numbers = numbers();
        numbers.push(40.0);
        let mut forwards = Histogram::default();
        for &x in &numbers {
            forwards.add(x);
        }
        let mut backwards = Histogram::default();
        numbers.iter().rev().for_each(|&x| backwards.add(x));
        assert_eq!(forwards, backwards);
        assert_eq!(forwards.count(), numbers.len() as f64);
        let mut again = Histogram::default();
        assert!(again.load(&forwards.save()));
        assert_eq!(again, forwards);
    }

    /// Whichever part has the wider bins, or none.
    #[test]
    fn counts_of_parts_are_those_of_all() {
        let mut numbers = numbers();
        numbers.truncate(500);
        numbers[77] = 1e3;
        let of = |numbers: &[f64]| {
            let mut histogram = Histogram::default();
            for &x in numbers {
                histogram.add(x);
            }
            histogram
        };
        for middle in [0, 50, 200, 500] {
            let mut first = of(&numbers[..middle]);
            first.merge(&of(&numbers[middle..]));
            assert_eq!(first, of(&numbers), "{middle}");
            first.clear();
            assert_eq!(first, Histogram::default());
        }
    }

    #[test]
    fn gaussian_numbers_have_a_gaussian_density() {
        let mut histogram = Histogram::default();
        for x in numbers() {
            histogram.add(x);
        }
        assert!((histogram.standard_deviation() - 1.0).abs() < 0.02);
        let density = histogram.normalised();
        assert!(density.iter().all(|(_, p)| *p > 0.0), "bins without numbers are left out");
        let gaussian = |x: f64| (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt();
        // 20,000 numbers in bins of a tenth: 800 in the middle, known to 3.5%; five times that.
        let middle = density.iter().filter(|(x, _)| x.abs() < 1.0);
        assert!(middle.clone().count() > 15);
        assert!(middle.clone().all(|&(x, p)| (p / gaussian(x) - 1.0).abs() < 0.25), "{density:?}");
        let bin = density[9].0 - density[8].0;
        assert!((density.iter().map(|(_, p)| p * bin).sum::<f64>() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn nothing_and_zeros_are_taken() {
        let mut histogram = Histogram::default();
        assert!(histogram.counts().is_empty());
        histogram.add(f64::NAN);
        histogram.add(0.0);
        assert_eq!(histogram.count(), 1.0);
        histogram.add(-3.0);
        assert_eq!(histogram.count(), 2.0);
    }
}
