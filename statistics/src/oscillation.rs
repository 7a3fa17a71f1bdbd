//! Stress response to an oscillatory strain.

use crate::{Blocks, Estimate, State, Store};
use std::f64::consts::{PI, TAU};

/// Harmonics that are resolved.
pub const HARMONICS: [u32; 5] = [1, 3, 5, 7, 9];

/// Smallest number of samples per period that resolves the harmonics.
pub const FEWEST_SAMPLES: f64 = 40.0;

/// Moduli of a stress `s(t)` under the strain `g sin(w t)`,
///
/// ```text
/// s(t) = g sum_n [G'_n sin(n w t) + G''_n cos(n w t)],        n = 1, 3, 5, ...
/// ```
///
/// by integrals over whole periods, with the trapezoidal rule. For equally spaced samples, with an integer number per
/// period, it is exact for harmonics up to half that number; else the error is of third order in the time between
/// samples. Each period gives one number of the series from which errors come.
#[derive(Debug, Clone, PartialEq)]
pub struct Moduli {
    amplitude: f64,
    frequency: f64,
    /// Phase and stress of the last sample; NaN before the first.
    last: [f64; 2],
    /// Integrals of the stress times sines and cosines since the period began; NaN if it began before the first
    /// sample.
    sums: [[f64; 2]; HARMONICS.len()],
    series: [[Blocks; 2]; HARMONICS.len()],
}

impl Moduli {
    /// Without samples, for a strain with the given amplitude and angular frequency.
    pub fn new(amplitude: f64, frequency: f64) -> Self {
        let (last, sums) = ([f64::NAN; 2], [[f64::NAN; 2]; HARMONICS.len()]);
        Self { amplitude, frequency, last, sums, series: Default::default() }
    }

    /// Adds the stress at a time; the times of samples must increase. Returns `G'` and `G''` of a period that has
    /// ended.
    pub fn add(&mut self, time: f64, stress: f64) -> Option<[f64; 2]> {
        let mut of_period = None;
        let (phase, [mut from, mut before]) = (time * self.frequency, self.last);
        // Samples within this part of a period from its end are taken to be at the end.
        let ended = |phase: f64| (phase / TAU + 1e-9).floor();
        if from.is_nan() {
            if (phase - TAU * ended(phase)).abs() < 1e-8 {
                self.sums = Default::default();
            }
        } else {
            while ended(phase) > ended(from) {
                let end = TAU * (ended(from) + 1.0);
                let at_end = before + (stress - before) * (end - from) / (phase - from);
                self.integrate([from, before], [end, at_end]);
                of_period = self.end_period();
                (from, before) = (end, at_end);
            }
            self.integrate([from, before], [phase, stress]);
        }
        self.last = [phase, stress];
        of_period
    }

    fn integrate(&mut self, [from, before]: [f64; 2], [to, after]: [f64; 2]) {
        for (sums, n) in self.sums.iter_mut().zip(HARMONICS.map(f64::from)) {
            let [(sin, cos), (sin_after, cos_after)] = [from, to].map(|phase| (n * phase).sin_cos());
            sums[0] += 0.5 * (to - from) * (before * sin + after * sin_after);
            sums[1] += 0.5 * (to - from) * (before * cos + after * cos_after);
        }
    }

    fn end_period(&mut self) -> Option<[f64; 2]> {
        let is_whole = self.sums[0][0].is_finite();
        let moduli = self.sums.map(|sums| sums.map(|sum| sum / (PI * self.amplitude)));
        for (series, moduli) in self.series.iter_mut().zip(moduli).filter(|_| is_whole) {
            series.iter_mut().zip(moduli).for_each(|(series, modulus)| series.add(modulus));
        }
        self.sums = Default::default();
        is_whole.then_some(moduli[0])
    }

    /// Number of whole periods.
    pub fn periods(&self) -> u64 {
        self.series[0][0].count()
    }

    /// Each harmonic with its `G'` and `G''`.
    pub fn estimates(&self) -> impl Iterator<Item = (u32, [Estimate; 2])> {
        HARMONICS.into_iter().zip(&self.series).map(|(n, series)| (n, series.each_ref().map(Blocks::estimate)))
    }
}

impl State for Moduli {
    fn visit(&mut self, store: &mut dyn Store) {
        for number in self.last.iter_mut().chain(self.sums.as_flattened_mut()) {
            store.number(number);
        }
        for series in self.series.as_flattened_mut() {
            series.visit(store);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FREQUENCY: f64 = 2.5;

    fn stress(time: f64) -> f64 {
        let phase = FREQUENCY * time;
        3.0 * phase.sin() + 7.0 * phase.cos() - 0.5 * (3.0 * phase).sin() + 0.25 * (5.0 * phase).cos() + 1.0
    }

    fn moduli(first: f64, interval: f64, samples: u32) -> Moduli {
        let mut moduli = Moduli::new(0.5, FREQUENCY);
        for k in 0..samples {
            let time = first + interval * f64::from(k);
            moduli.add(time, stress(time));
        }
        moduli
    }

    fn error(moduli: &Moduli) -> f64 {
        let exact = [[6.0, 14.0], [-1.0, 0.0], [0.0, 0.5], [0.0; 2], [0.0; 2]];
        let found = moduli.estimates().zip(exact);
        let errors = found.flat_map(|((_, found), exact)| [0, 1].map(|k| (found[k].mean - exact[k]).abs()));
        errors.fold(0.0, f64::max)
    }

    #[test]
    fn samples_that_fit_into_a_period_give_exact_moduli() {
        let interval = TAU / FREQUENCY / 40.0;
        let moduli =
            [moduli(0.0, interval, 121), moduli(5.5 * interval, interval, 161), moduli(3.0 * interval, interval, 161)];
        assert_eq!(moduli.each_ref().map(Moduli::periods), [3, 3, 3]);
        assert!(error(&moduli[0]) < 1e-12 && error(&moduli[2]) < 1e-12, "{} {}", error(&moduli[0]), error(&moduli[2]));
        assert!(error(&moduli[1]) < 0.1, "{}", error(&moduli[1]));
    }

    #[test]
    fn others_have_an_error_of_order_three() {
        let at = |interval: f64| error(&moduli(0.1, interval, (20.0 / interval) as u32));
        let order = (at(0.02) / at(0.005)).log2() / 2.0;
        assert!(at(0.02) < 0.01 && (2.0..4.0).contains(&order), "{} {order}", at(0.02));
    }

    #[test]
    fn a_series_in_two_parts_is_one() {
        let (mut parts, whole) = (moduli(0.0, 0.05, 70), moduli(0.0, 0.05, 200));
        let mut second = Moduli::new(0.5, FREQUENCY);
        assert!(second.load(&parts.save()));
        for k in 70..200 {
            let time = 0.05 * f64::from(k);
            second.add(time, stress(time));
        }
        assert_eq!(second, whole);
    }
}
