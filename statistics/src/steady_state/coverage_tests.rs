//! Coverage: how often the true mean lies within the errors of many short series.

use super::{RequestedPrecision, SteadyMean, TimeSeries, Transient};
use domain::Random;

/// An Ornstein-Uhlenbeck process of variance 1 and correlation time 1 at `count` times, `step` apart.
fn process(random: &mut Random, step: f64, count: usize) -> Vec<f64> {
    let kept = (-step).exp();
    let (mut value, noise) = (random.normal()[0], (1.0 - kept * kept).sqrt());
    let next = |_| {
        let now = value;
        value = kept * value + noise * random.normal()[0];
        now
    };
    (0..count).map(next).collect()
}

/// A sum of two processes: the slow one's share of the variance, and the ratio of the other's speed to it.
#[derive(Debug, Clone, Copy)]
struct Mixed {
    slow: f64,
    faster: f64,
}

impl Mixed {
    /// A series over `times` correlation times of the slow process, which begins `off` away from its mean.
    fn series(self, random: &mut Random, times: f64, off: f64) -> TimeSeries {
        let count = (5.0 * times).max(100.0) as usize;
        let step = times / count as f64;
        let [slow, fast] = [step, step * self.faster].map(|step| process(random, step, count));
        let times: Vec<f64> = (0..count).map(|index| step * index as f64).collect();
        let approach = times.iter().map(|time| off * (-0.5 * time).exp());
        let mixed = slow.iter().zip(fast).map(|(slow, fast)| self.slow.sqrt() * slow + (1.0 - self.slow).sqrt() * fast);
        let values: Vec<f64> = mixed.zip(approach).map(|(value, approach)| value + approach).collect();
        TimeSeries::new(&times, values)
    }
}

/// Fraction of many series (those that have a value) whose true mean, 0, lies within one error and within two.
fn covered(of: Mixed, times: f64, off: f64) -> [f64; 2] {
    let (mut inside, mut given) = ([0.0; 2], 0.0);
    for run in 0..500 {
        let series = of.series(&mut Random::new(run, times.to_bits() ^ of.slow.to_bits()), times, off);
        let found = SteadyMean::of(&series, Transient::of(&series), RequestedPrecision::USUAL);
        for (inside, errors) in inside.iter_mut().zip([1.0, 2.0]) {
            *inside += f64::from(u8::from(found.value.abs() <= errors * found.error));
        }
        given += f64::from(u8::from(found.value.is_finite()));
    }
    inside.map(|inside| inside / given)
}

const PROCESSES: [Mixed; 4] = [
    Mixed { slow: 1.0, faster: 1.0 },
    Mixed { slow: 0.5, faster: 10.0 },
    Mixed { slow: 0.3, faster: 10.0 },
    Mixed { slow: 0.1, faster: 100.0 },
];

/// Close to 68% and 95%, on average over series of 5 to 200 correlation times; from 20 on for each kind by itself.
/// 500 runs determine a fraction to two per cent.
#[test]
fn the_true_mean_lies_within_the_errors_as_often_as_it_should() {
    let mut mean = [0.0; 2];
    for of in PROCESSES {
        for times in [5.0, 10.0, 20.0, 50.0, 200.0] {
            let found = covered(of, times, 0.0);
            let is_right = (0.62..0.82).contains(&found[0]) && (0.90..0.995).contains(&found[1]);
            assert!(is_right || times < 20.0, "{of:?}, {times} correlation times: {found:?}");
            mean.iter_mut().zip(found).for_each(|(mean, found)| *mean += found / 20.0);
        }
    }
    assert!((0.60..0.76).contains(&mean[0]) && (0.90..0.98).contains(&mean[1]), "{mean:?}");
}

/// The same for series that begin far off and approach their steady state within two correlation times.
#[test]
fn transients_are_left_out_of_means() {
    for of in PROCESSES {
        for (times, off) in [(50.0, 3.0), (50.0, 10.0), (200.0, 3.0), (200.0, 10.0)] {
            let found = covered(of, times, off);
            let is_right = (0.62..0.82).contains(&found[0]) && (0.90..0.995).contains(&found[1]);
            assert!(is_right, "{of:?}, {times} correlation times from {off}: {found:?}");
        }
    }
}
