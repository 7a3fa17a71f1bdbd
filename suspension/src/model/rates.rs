//! A rate of shear that changes in the course of a run.

use domain::{Number, ParameterError};
use std::f64::consts::FRAC_PI_2;

/// A change of the rate of shear at the beginning of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RateChange {
    /// The step.
    pub step: u64,
    /// The rate from then on.
    pub rate: f64,
}

/// How the rate of shear changes in the course of a run.
#[derive(Debug, Clone, PartialEq)]
pub enum Protocol {
    /// It has the rate of the flow, and these later, in their order.
    Steps(Vec<RateChange>),
    /// It is `rate cos(frequency t)`, so that the strain is `rate / frequency sin(frequency t)`.
    Oscillation {
        /// Angular frequency, one over time.
        frequency: f64,
    },
    /// It is what this shear stress makes it, about the rate of the flow at first.
    Stress(f64),
}

impl Protocol {
    /// The rate of the flow and no other.
    pub const STEADY: Self = Self::Steps(Vec::new());
}

/// The rate of shear in time.
#[derive(Debug, Clone, PartialEq)]
pub struct ShearRates {
    first: f64,
    protocol: Protocol,
    time_step: f64,
}

impl ShearRates {
    /// A first rate and how it changes, in steps of a length.
    pub fn new(first: f64, protocol: Protocol, time_step: f64) -> Self {
        Self { first, protocol, time_step }
    }

    /// The rate during the step that ends with `step`, or at that moment if it changes all the time, and the step at which it
    /// began; at step 0 the first one.
    pub fn before(&self, step: u64) -> (f64, u64) {
        let last = self.changes().iter().rev().find(|change| change.step < step);
        let began = last.map_or(0, |change| change.step);
        (self.before_time(step as f64 * self.time_step), began)
    }

    /// The rate to which that changes at a step, if it does.
    pub fn changed_at(&self, step: u64) -> Option<f64> {
        self.changes().iter().find(|change| change.step == step).map(|change| change.rate)
    }

    /// The rate shortly before a time.
    pub fn before_time(&self, time: f64) -> f64 {
        match &self.protocol {
            Protocol::Steps(changes) => {
                let last = changes.iter().rev().find(|change| self.time(change) < time);
                last.map_or(self.first, |change| change.rate)
            }
            Protocol::Oscillation { frequency } => self.first * (frequency * time).cos(),
            Protocol::Stress(_) => self.first,
        }
    }

    /// The strain at a time.
    pub fn strain(&self, time: f64) -> f64 {
        if let Protocol::Oscillation { frequency } = self.protocol {
            return self.first / frequency * (frequency * time).sin();
        }
        let (mut strain, mut since, mut rate) = (0.0, 0.0, self.first);
        for change in self.changes().iter().take_while(|change| self.time(change) < time) {
            let now = self.time(change);
            strain += rate * (now - since);
            (since, rate) = (now, change.rate);
        }
        strain + rate * (time - since)
    }

    /// Whether it is always the same.
    pub fn is_constant(&self) -> bool {
        self.protocol == Protocol::STEADY
    }

    /// The angular frequency, if it oscillates.
    pub fn frequency(&self) -> Option<f64> {
        if let Protocol::Oscillation { frequency } = self.protocol { Some(frequency) } else { None }
    }

    /// The shear stress, if that is given.
    pub fn stress(&self) -> Option<f64> {
        if let Protocol::Stress(stress) = self.protocol { Some(stress) } else { None }
    }

    /// The largest rate, without its sign.
    pub fn largest(&self) -> f64 {
        self.changes().iter().map(|change| change.rate.abs()).fold(self.first.abs(), f64::max)
    }

    /// The largest strain at any time up to one, without its sign.
    pub fn largest_strain(&self, end: f64) -> f64 {
        if let Protocol::Oscillation { frequency } = self.protocol {
            return self.strain(end.min(FRAC_PI_2 / frequency)).abs();
        }
        let ends = self.changes().iter().map(|change| self.time(change)).filter(|&time| time < end);
        ends.chain([end]).map(|time| self.strain(time).abs()).fold(0.0, f64::max)
    }

    fn changes(&self) -> &[RateChange] {
        if let Protocol::Steps(changes) = &self.protocol { changes } else { &[] }
    }

    fn time(&self, change: &RateChange) -> f64 {
        change.step as f64 * self.time_step
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        if let Protocol::Oscillation { frequency } = self.protocol {
            ParameterError::unless_positive("flow.oscillation.frequency", frequency)?;
            return ParameterError::unless_finite("flow.oscillation.amplitude", self.first).map(drop);
        }
        ParameterError::unless_finite("flow.rate", self.first)?;
        if let Protocol::Stress(stress) = self.protocol {
            ParameterError::unless_positive("flow.stress", stress)?;
            return ParameterError::unless_positive("flow.rate", self.first).map(drop);
        }
        let mut last = 0;
        for change in self.changes() {
            ParameterError::unless_finite("flow.rate", change.rate)?;
            if change.step <= last {
                let time = Number(self.time(change));
                let message = format!("changes at {time:.6}, not after all changes before; give them in their order");
                return Err(ParameterError::new("flow.rate", message));
            }
            last = change.step;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strain_is_the_integral_of_the_rate() {
        let changes = [RateChange { step: 10, rate: -1.0 }, RateChange { step: 30, rate: 3.0 }];
        let rates = ShearRates::new(2.0, Protocol::Steps(changes.to_vec()), 0.1);
        for (time, strain) in [(0.5, 1.0), (1.0, 2.0), (2.0, 1.0), (3.0, 0.0), (4.0, 3.0)] {
            assert!((rates.strain(time) - strain).abs() < 1e-14, "{time}");
        }
        assert_eq!((rates.before(0), rates.before(10), rates.before(11)), ((2.0, 0), (2.0, 0), (-1.0, 10)));
        assert_eq!((rates.changed_at(30), rates.changed_at(31)), (Some(3.0), None));
        assert_eq!((rates.before_time(1.0), rates.before_time(1.01), rates.largest()), (2.0, -1.0, 3.0));
        assert!((rates.largest_strain(3.0) - 2.0).abs() < 1e-14 && (rates.largest_strain(5.0) - 6.0).abs() < 1e-14);
    }

    #[test]
    fn changes_come_one_after_the_other() {
        let change = |step| RateChange { step, rate: 1.0 };
        for changes in [[change(0), change(1)], [change(5), change(5)], [change(5), change(3)]] {
            let error = ShearRates::new(1.0, Protocol::Steps(changes.to_vec()), 0.5).check().unwrap_err();
            assert!(error.to_string().contains("in their order"), "{error}");
        }
        let in_order = Protocol::Steps(vec![change(1), change(2)]);
        assert!(ShearRates::new(1.0, in_order, 0.5).check().is_ok());
    }

    #[test]
    fn an_oscillation_comes_back_after_each_period() {
        let rates = ShearRates::new(0.6, Protocol::Oscillation { frequency: 3.0 }, 0.1);
        let quarter = FRAC_PI_2 / 3.0;
        for (quarters, rate, strain) in [(0.0, 0.6, 0.0), (1.0, 0.0, 0.2), (2.0, -0.6, 0.0), (9.0, 0.0, 0.2)] {
            let time = quarters * quarter;
            assert!((rates.before_time(time) - rate).abs() < 1e-14 && (rates.strain(time) - strain).abs() < 1e-14);
        }
        let (time, h) = (0.37, 1e-5);
        let slope = (rates.strain(time + h) - rates.strain(time - h)) / (2.0 * h);
        assert!((slope - rates.before_time(time)).abs() < 1e-9);
        assert!((rates.largest_strain(100.0) - 0.2).abs() < 1e-14 && rates.largest_strain(0.1 * quarter) < 0.04);
        assert_eq!((rates.is_constant(), rates.changed_at(3), rates.largest()), (false, None, 0.6));
    }
}
