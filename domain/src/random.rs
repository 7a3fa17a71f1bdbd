//! Counter-based random numbers, which depend only on a seed and a name.

use std::collections::HashMap;

/// Stream of random numbers by a seed and a name, such as a particle's id or the number of a step. It is the same on
/// any rank and in any order of use: `SplitMix64` (Steele, Lea & Flood, OOPSLA 2014, Fig. 14), started at a state
/// mixed from seed and name.
#[derive(Debug, Clone)]
pub struct Random {
    state: u64,
}

/// 2^64 over the golden ratio, made odd.
const STRIDE: u64 = 0x9e37_79b9_7f4a_7c15;

impl Random {
    /// Stream of this name.
    pub fn new(seed: u64, name: u64) -> Self {
        Self { state: mix(mix(seed.wrapping_add(STRIDE)) ^ name.wrapping_mul(STRIDE)) }
    }

    /// The next 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(STRIDE);
        mix(self.state)
    }

    /// Skips `count` times 64 bits.
    pub fn skip(&mut self, count: u64) {
        self.state = self.state.wrapping_add(STRIDE.wrapping_mul(count));
    }

    /// The next number in `[0, 1)`, a multiple of 2^-53.
    pub fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// The next two independent numbers of a normal distribution of mean 0 and variance 1 (Box & Muller 1958).
    pub fn normal(&mut self) -> [f64; 2] {
        let [radius, turn] = [(-2.0 * (1.0 - self.uniform()).ln()).sqrt(), std::f64::consts::TAU * self.uniform()];
        [radius * turn.cos(), radius * turn.sin()]
    }

    /// Next number of a uniform distribution with mean 0 and variance 1.
    pub fn uniform_unit_variance(&mut self) -> f64 {
        12.0_f64.sqrt() * (self.uniform() - 0.5)
    }

    /// Three uniform numbers in `[0, 1)`.
    pub fn point(&mut self) -> crate::Vector {
        let [x, y, z] = std::array::from_fn(|_| self.uniform());
        crate::Vector::new(x, y, z)
    }

    /// A number from 0 to `last`.
    fn up_to(&mut self, last: usize) -> usize {
        ((u128::from(self.bits()) * (last as u128 + 1)) >> 64) as usize
    }

    /// Shuffles a list, with all orders equally likely (Fisher-Yates).
    pub fn shuffle<T>(&mut self, list: &mut [T]) {
        for last in (1..list.len()).rev() {
            list.swap(last, self.up_to(last));
        }
    }

    /// Numbers below `count` that [`Random::shuffle`] of the list `0..count` moves to its places from `kept` on, at
    /// least 1, in ascending order. Takes memory for these only.
    pub fn shuffled_beyond(&mut self, kept: usize, count: usize) -> Vec<usize> {
        let mut moved: HashMap<usize, usize> = HashMap::new();
        let mut beyond: Vec<usize> = (kept.max(1)..count)
            .rev()
            .map(|last| {
                let (other, own) = (self.up_to(last), moved.remove(&last).unwrap_or(last));
                if other == last { own } else { moved.insert(other, own).unwrap_or(other) }
            })
            .collect();
        beyond.sort_unstable();
        beyond
    }
}

/// Streams of `N` names of one seed in parallel: the numbers of [`Random`].
#[derive(Debug, Clone)]
pub struct RandomLanes<const N: usize> {
    states: [u64; N],
}

impl<const N: usize> RandomLanes<N> {
    /// Streams of these names.
    #[inline(always)]
    pub fn new(seed: u64, names: &[u64; N]) -> Self {
        let seed = mix(seed.wrapping_add(STRIDE));
        Self { states: names.map(|name| mix(seed ^ name.wrapping_mul(STRIDE))) }
    }

    /// Next number of each stream, uniform with mean 0 and variance 1.
    #[inline(always)]
    pub fn uniform_unit_variance(&mut self) -> [f64; N] {
        let root = 12.0_f64.sqrt();
        let mut numbers = [0.0; N];
        for (number, state) in numbers.iter_mut().zip(&mut self.states) {
            *state = state.wrapping_add(STRIDE);
            *number = root * ((mix(*state) >> 11) as f64 / (1_u64 << 53) as f64 - 0.5);
        }
        numbers
    }
}

#[inline(always)]
fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_of_a_shuffle_needs_no_list() {
        for (kept, count) in [(1, 1), (1, 2), (3, 3), (1, 50), (17, 50), (49, 50), (900, 1000)] {
            let mut list: Vec<usize> = (0..count).collect();
            Random::new(3, 9).shuffle(&mut list);
            list[kept..].sort_unstable();
            assert_eq!(Random::new(3, 9).shuffled_beyond(kept, count), list[kept..], "{kept} of {count}");
        }
    }

    #[test]
    fn normal_and_uniform_numbers_have_their_moments() {
        let mut random = Random::new(5, 8);
        let count = 200_000;
        let mut sums = [[0.0; 3]; 3];
        for _ in 0..count {
            let [a, b] = random.normal();
            for (sums, x) in sums.iter_mut().zip([a, b, random.uniform_unit_variance()]) {
                *sums = [sums[0] + x, sums[1] + x * x, sums[2] + x.powi(4)];
            }
        }
        for (sums, fourth) in sums.into_iter().zip([3.0, 3.0, 1.8]) {
            let [mean, variance, found] = sums.map(|sum| sum / f64::from(count));
            assert!(mean.abs() < 0.01 && (variance - 1.0).abs() < 0.02 && (found - fourth).abs() < 0.1);
        }
    }

    #[test]
    fn streams_side_by_side_are_those_of_their_names() {
        let names = [3, u64::MAX, 0, 12_345_678_901];
        let mut lanes = RandomLanes::new(77, &names);
        let mut streams = names.map(|name| Random::new(77, name));
        for _ in 0..10 {
            let expected = streams.each_mut().map(|stream| stream.uniform_unit_variance().to_bits());
            assert_eq!(lanes.uniform_unit_variance().map(f64::to_bits), expected);
        }
    }

    #[test]
    fn follows_the_published_generator() {
        // The first outputs of `SplitMix64` from state 1234567, as published with many implementations of it.
        let mut random = Random { state: 1_234_567 };
        assert_eq!([random.bits(), random.bits()], [6_457_827_717_110_365_317, 3_203_168_211_198_807_973]);
    }

    #[test]
    fn what_is_skipped_is_left_out() {
        let (mut all, mut rest) = (Random::new(3, 4), Random::new(3, 4));
        let expected = (0..18).map(|_| all.bits()).last();
        rest.skip(17);
        assert_eq!(Some(rest.bits()), expected);
    }

    #[test]
    fn streams_are_uniform_and_unrelated() {
        let count = 100_000;
        let (mut mean, mut product) = (0.0, 0.0);
        for name in 0..count {
            let [a, b] = [name, name + 1].map(|n| Random::new(7, n).uniform());
            mean += a / count as f64;
            product += (a - 0.5) * (b - 0.5) / count as f64;
        }
        // Five standard errors: sqrt(1/12/n) and 1/12/sqrt(n).
        assert!((mean - 0.5).abs() < 5.0 * (1.0 / 12.0 / count as f64).sqrt());
        assert!(product.abs() < 5.0 / 12.0 / (count as f64).sqrt());
    }

    #[test]
    fn shuffling_is_fair() {
        let mut firsts = [0; 5];
        for name in 0..10_000 {
            let mut list = [0, 1, 2, 3, 4];
            Random::new(3, name).shuffle(&mut list);
            firsts[list[0]] += 1;
        }
        // Five standard deviations of a binomial with p = 1/5: 5 sqrt(10000 * 0.16) = 200.
        assert!(firsts.iter().all(|&n: &i32| (n - 2000).abs() < 200), "{firsts:?}");
    }
}
