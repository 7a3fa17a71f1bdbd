//! Averages over all particles and starting times.

use super::{GROUPS, KEPT, Lag, SUMS};
use crate::Estimate;
use domain::Vector;

/// Sums over particles and starting times of a [`super::Lagrangian`]. Sums of parts of the particles at the same
/// times are added number by number.
#[derive(Debug, Clone, PartialEq)]
pub struct LagSums {
    class_count: usize,
    /// `[level][lag][class][sum]`
    numbers: Vec<f64>,
}

impl LagSums {
    /// From their numbers, for `species` species.
    pub fn of_numbers(species: usize, numbers: Vec<f64>) -> Self {
        Self { class_count: species * GROUPS, numbers }
    }

    /// Numbers of the sums.
    pub fn into_numbers(self) -> Vec<f64> {
        self.numbers
    }

    /// Sums of each level.
    fn levels(&self) -> impl Iterator<Item = &[f64]> {
        self.numbers.chunks_exact((KEPT * self.class_count * SUMS).max(1))
    }

    /// Averages over the particles of a species, or over all, at all lags with samples, in ascending order.
    pub fn lags(&self, species: Option<usize>) -> Vec<Lag> {
        let of_species = |s: usize| s * GROUPS..(s + 1) * GROUPS;
        self.averages(&species.map_or(0..self.class_count, of_species).collect::<Vec<_>>())
    }

    /// A number computed from averages, with its error from its values in the groups of a species, or of all
    /// particles.
    pub fn estimate(&self, species: Option<usize>, number: impl Fn(&[Lag]) -> f64) -> Estimate {
        let is_meant = |class: &usize| species.is_none_or(|s| class / GROUPS == s);
        let group = |group: usize| {
            let classes: Vec<usize> = (0..self.class_count).filter(is_meant).filter(|c| c % GROUPS == group).collect();
            let lags = self.averages(&classes);
            (!lags.is_empty()).then(|| number(&lags))
        };
        let groups: Vec<f64> = (0..GROUPS).filter_map(group).collect();
        let count = groups.len() as f64;
        let mean = groups.iter().sum::<f64>() / count;
        let squares: f64 = groups.iter().map(|value| (value - mean).powi(2)).sum();
        let error = if groups.len() > 1 { (squares / count / (count - 1.0)).sqrt() } else { f64::INFINITY };
        let mean = number(&self.lags(species));
        Estimate { mean, error, converged: groups.len() == GROUPS && mean.is_finite() }
    }

    fn averages(&self, classes: &[usize]) -> Vec<Lag> {
        let lag = |level: &[f64], lag: usize| {
            let mut sums = [0.0; SUMS];
            for class in classes {
                let own = &level[(lag * self.class_count + class) * SUMS..][..SUMS];
                sums.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
            }
            (sums[0] > 0.0).then(|| average(&sums))
        };
        let firsts = (0..).map(|level| if level == 0 { 0 } else { KEPT / 2 });
        let all = self.levels().zip(firsts);
        all.flat_map(|(level, first)| (first..KEPT).filter_map(move |k| lag(level, k))).collect()
    }
}

fn average(sums: &[f64; SUMS]) -> Lag {
    let mean = |sum: usize, component: usize| sums[2 + 6 * component + sum] / sums[0];
    let covariance = |product: usize, a: usize, b: usize| {
        let at = |i: usize| mean(product, i) - mean(a, i) * mean(b, i);
        Vector::new(at(0), at(1), at(2))
    };
    Lag {
        time: sums[1] / sums[0],
        correlation: covariance(2, 0, 1),
        product: Vector::new(mean(2, 0), mean(2, 1), mean(2, 2)),
        mean_square_displacement: covariance(4, 3, 3),
        correlation_integral: covariance(5, 0, 3),
    }
}
