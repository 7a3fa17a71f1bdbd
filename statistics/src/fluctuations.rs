//! Means and fluctuation tensors of vectors.

use crate::moments::COMPONENTS;
use crate::{Blocks, Estimate, SecondMoments, State, Store, VectorSum};
use domain::{Tensor, Vector};

/// Mean and fluctuation tensor of a vector over particles and time,
///
/// ```text
/// T_ij = <v_i v_j> - <v_i> <v_j>,
/// ```
///
/// eqs. (14) and (15) of Abbas et al. (2006), in dimensional form. Errors come from the series of means over the
/// particles of each sample.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Fluctuations {
    count: f64,
    mean: Vector,
    /// `sum (v - mean)(v - mean)`, xx xy xz yy yz zz.
    moments: [f64; 6],
    means: [Blocks; 3],
    seconds: [Blocks; 6],
}

impl Fluctuations {
    /// Adds the vectors of all particles at one time.
    pub fn add(&mut self, vectors: impl Iterator<Item = Vector> + Clone) {
        let (mut sum, mut moments) = (VectorSum::default(), SecondMoments::default());
        vectors.clone().for_each(|vector| sum.add(vector));
        let mean = sum.mean();
        vectors.for_each(|vector| moments.add(vector - mean));
        self.add_sums(&sum, &moments);
    }

    /// Adds the vectors of all particles at one time by their sums, with `moments` about their mean.
    pub fn add_sums(&mut self, sum: &VectorSum, moments: &SecondMoments) {
        let (count, mean, SecondMoments(moments)) = (sum.count, sum.mean(), *moments);
        if count == 0.0 {
            return;
        }
        self.merge(count, mean, moments);
        for i in 0..3 {
            self.means[i].add(mean[i]);
        }
        for c in 0..6 {
            self.seconds[c].add(moments[c] / count);
        }
    }

    /// Merges the moments of two sets (Chan et al., Stanford report STAN-CS-79-773, 1979).
    fn merge(&mut self, count: f64, mean: Vector, moments: [f64; 6]) {
        let total = self.count + count;
        let apart = mean - self.mean;
        for (c, (i, j)) in COMPONENTS.into_iter().enumerate() {
            self.moments[c] += moments[c] + apart[i] * apart[j] * (self.count * count / total);
        }
        self.mean += apart * (count / total);
        self.count = total;
    }

    /// Number of samples so far.
    pub fn samples(&self) -> u64 {
        self.means[0].count()
    }

    /// Mean of each component over time, with its error.
    pub fn mean(&self) -> [Estimate; 3] {
        self.means.each_ref().map(Blocks::estimate)
    }

    /// Mean over all vectors of all samples, with the errors of the samples' own means; NaN if there are none.
    pub fn pooled_mean(&self) -> [Estimate; 3] {
        let mean = |i: usize| if self.count > 0.0 { self.mean[i] } else { f64::NAN };
        std::array::from_fn(|i| Estimate { mean: mean(i), ..self.means[i].estimate() })
    }

    /// Fluctuation tensor.
    pub fn tensor(&self) -> Tensor {
        let [xx, xy, xz, yy, yz, zz] = self.moments.map(|sum| sum / self.count);
        Tensor::from_cols(Vector::new(xx, xy, xz), Vector::new(xy, yy, yz), Vector::new(xz, yz, zz))
    }

    /// Components xx, xy, xz, yy, yz and zz of the tensor, with the errors of the samples' own.
    pub fn components(&self) -> [Estimate; 6] {
        std::array::from_fn(|c| Estimate { mean: self.moments[c] / self.count, ..self.seconds[c].estimate() })
    }
}

impl State for Fluctuations {
    fn visit(&mut self, store: &mut dyn Store) {
        store.number(&mut self.count);
        let Vector { x, y, z } = &mut self.mean;
        [x, y, z].into_iter().chain(&mut self.moments).for_each(|number| store.number(number));
        self.means.iter_mut().chain(&mut self.seconds).for_each(|blocks| blocks.visit(store));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::Random;

    fn sample(time: u64) -> Vec<Vector> {
        (0..40).map(|id| Random::new(time, id).point() * Vector::new(1.0, 2.0, 3.0) + Vector::splat(1e3)).collect()
    }

    #[test]
    fn a_stream_of_samples_is_all_of_them_at_once() {
        let mut stream = Fluctuations::default();
        for time in 0..50 {
            stream.add(sample(time).into_iter());
        }
        let all: Vec<Vector> = (0..50).flat_map(sample).collect();
        let mut batch = Fluctuations::default();
        batch.add(all.into_iter());
        assert!(stream.tensor().abs_diff_eq(batch.tensor(), 1e-12));
        assert!((stream.mean()[2].mean - batch.mean()[2].mean).abs() < 1e-11);
    }

    #[test]
    fn uniform_numbers_have_a_variance_of_a_twelfth() {
        let mut fluctuations = Fluctuations::default();
        for time in 0..500 {
            fluctuations.add(sample(time).into_iter());
        }
        let found = fluctuations.components();
        let expected = [1.0, 0.0, 0.0, 4.0, 0.0, 9.0].map(|c| c / 12.0);
        for (found, expected) in found.iter().zip(expected) {
            assert!((found.mean - expected).abs() < 5.0 * found.error, "{found:?} for {expected}");
            assert!(found.error < 0.02);
        }
        let mut again = Fluctuations::default();
        assert!(again.load(&fluctuations.save()));
        assert_eq!(again, fluctuations);
    }
}
