//! Size distributions, represented by a few classes.

use domain::{Number, ParameterError};

/// Number distribution of the radii.
#[derive(Debug, Clone, PartialEq)]
pub enum SizeDistribution {
    /// Log-normal distribution.
    LogNormal {
        /// Mean radius.
        mean: f64,
        /// Standard deviation of the radius.
        deviation: f64,
    },
    /// Density proportional to a power of the radius.
    PowerLaw {
        /// Smallest radius.
        smallest: f64,
        /// Largest radius.
        largest: f64,
        /// Exponent: with -3 each logarithmic range of radii has the same surface, with -4 the same volume.
        exponent: f64,
    },
    /// Rows of a radius and the relative number of spheres of that radius.
    Table(Vec<[f64; 2]>),
}

/// Class of spheres of one radius, representing a range of radii.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SizeClass {
    /// Radius of the class.
    pub radius: f64,
    /// Number fraction of the class.
    pub share: f64,
}

/// Largest number of classes: a few already match the moments of the distribution.
pub const MOST_CLASSES: usize = 12;

/// Points at which a density is sampled, and the sampled standard deviations of the logarithm on either side of its
/// mean.
const POINTS: usize = 4000;
const DEVIATIONS: f64 = 7.0;

/// Bisection steps for each radius.
const HALVINGS: usize = 80;

impl SizeDistribution {
    /// `classes` radii and number fractions with the same moments as the distribution, from order 0 to `2 classes - 1`:
    /// nodes and weights of its Gauss quadrature (Golub & Welsch, Math. Comp. 23, 221, 1969). `key` is the prefix of
    /// the keys in messages.
    pub fn classes(&self, classes: usize, key: &str) -> Result<Vec<SizeClass>, ParameterError> {
        self.check(key)?;
        if !(1..=MOST_CLASSES).contains(&classes) {
            let message = format!("is {classes}; a distribution stands for 1 to {MOST_CLASSES} classes");
            return Err(ParameterError::new(format!("{key}.classes"), message));
        }
        let points = self.points();
        if points.len() <= classes {
            return Ok(points);
        }
        Ok(quadrature(&points, classes))
    }

    fn check(&self, key: &str) -> Result<(), ParameterError> {
        let key = |name: &str| format!("{key}.{name}");
        match self {
            Self::LogNormal { mean, deviation } => {
                ParameterError::require_positive(&key("mean"), *mean)?;
                ParameterError::require_positive(&key("standard_deviation"), *deviation)?;
                ParameterError::require_between(&key("standard_deviation"), *deviation, [1e-6 * mean, *mean]).map(drop)
            }
            Self::PowerLaw { smallest, largest, exponent } => {
                ParameterError::require_positive(&key("smallest"), *smallest)?;
                ParameterError::require_between(&key("exponent"), *exponent, [-20.0, 20.0])?;
                if *largest > *smallest && *largest <= 1e3 * smallest {
                    return Ok(());
                }
                let [found, least] = [*largest, *smallest].map(Number);
                let message =
                    format!("is {found}; it needs to be more than smallest = {least}, and at most a thousand times it");
                Err(ParameterError::new(key("largest"), message))
            }
            Self::Table(rows) => {
                let is_good = |row: &[f64; 2]| row.iter().all(|number| *number > 0.0 && number.is_finite());
                if !rows.is_empty() && rows.iter().all(is_good) {
                    return Ok(());
                }
                let message = "needs rows of a radius and how many there are of it, both above 0";
                Err(ParameterError::new(key("table"), message))
            }
        }
    }

    /// Ascending radii and their fractions: the rows of a table, or the samples of a density.
    fn points(&self) -> Vec<SizeClass> {
        let mut points: Vec<SizeClass> = match self {
            Self::LogNormal { mean, deviation } => {
                let variance = (1.0 + (deviation / mean).powi(2)).ln();
                let (middle, width) = (mean.ln() - 0.5 * variance, variance.sqrt());
                let point = |t: f64| SizeClass { radius: (middle + width * t).exp(), share: (-0.5 * t * t).exp() };
                midpoints([-DEVIATIONS, DEVIATIONS]).map(point).collect()
            }
            Self::PowerLaw { smallest, largest, exponent } => {
                let point =
                    |t: f64| SizeClass { radius: t.exp(), share: ((exponent + 1.0) * (t - smallest.ln())).exp() };
                midpoints([smallest.ln(), largest.ln()]).map(point).collect()
            }
            Self::Table(rows) => rows.iter().map(|&[radius, share]| SizeClass { radius, share }).collect(),
        };
        points.sort_by(|a, b| a.radius.total_cmp(&b.radius));
        points.dedup_by(|later, first| {
            let is_same = later.radius <= first.radius;
            first.share += if is_same { later.share } else { 0.0 };
            is_same
        });
        let sum: f64 = points.iter().map(|point| point.share).sum();
        points.into_iter().map(|point| SizeClass { share: point.share / sum, ..point }).collect()
    }
}

fn midpoints([from, to]: [f64; 2]) -> impl Iterator<Item = f64> {
    (0..POINTS).map(move |k| from + (to - from) * (k as f64 + 0.5) / POINTS as f64)
}

/// Gauss quadrature of a discrete measure: its orthonormal polynomials by Stieltjes's procedure,
/// `b_k p_k = (x - a_{k-1}) p_{k-1} - b_{k-1} p_{k-2}`. The nodes are the eigenvalues of the Jacobi matrix with `a` on
/// the diagonal and `b` beside it.
fn quadrature(points: &[SizeClass], classes: usize) -> Vec<SizeClass> {
    let (mut diagonal, mut beside) = (Vec::new(), Vec::new());
    let (mut before, mut values) = (vec![0.0; points.len()], vec![1.0; points.len()]);
    for _ in 0..classes {
        let moment = |f: &dyn Fn(usize) -> f64| (0..points.len()).map(|i| points[i].share * f(i)).sum::<f64>();
        let centre = moment(&|i| points[i].radius * values[i] * values[i]);
        let last = beside.last().copied().unwrap_or(0.0);
        let next: Vec<f64> =
            (0..points.len()).map(|i| (points[i].radius - centre) * values[i] - last * before[i]).collect();
        let norm = moment(&|i| next[i] * next[i]).sqrt();
        diagonal.push(centre);
        beside.push(norm);
        before = std::mem::replace(&mut values, next.iter().map(|value| value / norm).collect());
    }
    let range = [points[0].radius, points[points.len() - 1].radius];
    let jacobi = JacobiMatrix { diagonal, beside };
    (0..classes).map(|k| class(k, range, &jacobi)).collect()
}

/// A symmetric tridiagonal matrix.
struct JacobiMatrix {
    diagonal: Vec<f64>,
    beside: Vec<f64>,
}

/// The class of the `k`-th smallest node, found by bisection on the number of eigenvalues below a radius (Sturm
/// sequence). Its fraction is the inverse sum of squares of the orthonormal polynomials at the node.
fn class(k: usize, [mut low, mut high]: [f64; 2], JacobiMatrix { diagonal, beside }: &JacobiMatrix) -> SizeClass {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let mut pivot = 1.0;
        let below = (0..diagonal.len()).filter(|&i| {
            let coupling = if i == 0 { 0.0 } else { beside[i - 1] * beside[i - 1] / pivot };
            pivot = diagonal[i] - middle - coupling;
            pivot < 0.0
        });
        if below.count() > k { high = middle } else { low = middle }
    }
    let radius = 0.5 * (low + high);
    let (mut before, mut value, mut sum) = (0.0, 1.0, 1.0);
    for i in 0..diagonal.len() - 1 {
        let last = if i == 0 { 0.0 } else { beside[i - 1] };
        (before, value) = (value, ((radius - diagonal[i]) * value - last * before) / beside[i]);
        sum += value * value;
    }
    SizeClass { radius, share: 1.0 / sum }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moment(classes: &[SizeClass], order: i32) -> f64 {
        classes.iter().map(|class| class.share * class.radius.powi(order)).sum()
    }

    /// The moment of order n of the log-normal distribution is `mean^n (1 + (deviation / mean)^2)^(n (n - 1) / 2)`.
    #[test]
    fn classes_have_the_moments_of_the_distribution() {
        let classes = SizeDistribution::LogNormal { mean: 2.0, deviation: 0.5 }.classes(4, "d").unwrap();
        for order in 0..8 {
            let exact = 2.0_f64.powi(order) * 1.0625_f64.powi(order * (order - 1) / 2);
            let error = moment(&classes, order) / exact - 1.0;
            // Bounds the truncation beyond seven standard deviations.
            assert!(error.abs() < 1e-6, "{order}: {error}");
        }
        let classes =
            SizeDistribution::PowerLaw { smallest: 1.0, largest: 4.0, exponent: -3.0 }.classes(3, "d").unwrap();
        let integral = |power: f64| (4.0_f64.powf(power) - 1.0) / power;
        for order in [1, 3, 4, 5] {
            let exact = integral(f64::from(order) - 2.0) / integral(-2.0);
            assert!((moment(&classes, order) / exact - 1.0).abs() < 1e-6, "{order}");
        }
        assert!(classes.iter().all(|class| class.share > 0.0 && (1.0..4.0).contains(&class.radius)));
        assert!(classes.is_sorted_by(|a, b| a.radius < b.radius));
    }

    #[test]
    fn a_short_table_is_its_own_classes() {
        let rows = vec![[2.0, 1.0], [1.0, 2.0], [2.0, 1.0]];
        let classes = SizeDistribution::Table(rows.clone()).classes(5, "d").unwrap();
        assert_eq!(classes, [SizeClass { radius: 1.0, share: 0.5 }, SizeClass { radius: 2.0, share: 0.5 }]);
        let one = SizeDistribution::Table(rows).classes(1, "d").unwrap();
        assert!((one[0].radius - 1.5).abs() < 1e-12 && (one[0].share - 1.0).abs() < 1e-12);
    }

    #[test]
    fn distributions_out_of_range_are_named() {
        let said = |d: SizeDistribution, n| d.classes(n, "species[0].distribution").unwrap_err().to_string();
        let normal = |mean, deviation| SizeDistribution::LogNormal { mean, deviation };
        let power = |smallest, largest| SizeDistribution::PowerLaw { smallest, largest, exponent: -3.0 };
        assert!(said(normal(1.0, 0.0), 3).starts_with("species[0].distribution.standard_deviation is 0; "));
        assert!(said(normal(1.0, 0.1), 13).starts_with("species[0].distribution.classes is 13; "));
        assert!(said(power(2.0, 1.0), 3).starts_with("species[0].distribution.largest is 1; "));
        assert!(said(SizeDistribution::Table(vec![[1.0, -1.0]]), 3).starts_with("species[0].distribution.table needs"));
    }
}
