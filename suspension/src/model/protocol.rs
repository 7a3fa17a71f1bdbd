//! Shear rates that change during a run.

use domain::{Number, ParameterError};
use std::f64::consts::FRAC_PI_2;

/// Change of the shear rate at the beginning of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RateChange {
    /// Number of the step.
    pub step: u64,
    /// Rate from then on.
    pub rate: f64,
}

/// Shear rate as a function of time.
#[derive(Debug, Clone, PartialEq)]
pub enum Protocol {
    /// The rate of the flow at first, then these rates in their order.
    Steps(Vec<RateChange>),
    /// `rate cos(frequency t)`, with the strain `rate / frequency sin(frequency t)`.
    Oscillation {
        /// Angular frequency (1/time).
        frequency: f64,
    },
    /// The rate that results from a given shear stress; the rate of the flow is the first guess.
    Stress(f64),
}

impl Protocol {
    /// Constant rate.
    pub const STEADY: Self = Self::Steps(Vec::new());
}

/// Shear rate as a function of time.
#[derive(Debug, Clone, PartialEq)]
pub struct ShearRates {
    first: f64,
    protocol: Protocol,
    time_step: f64,
}

impl ShearRates {
    /// Rates from a first one, a protocol and the time step.
    pub fn new(first: f64, protocol: Protocol, time_step: f64) -> Self {
        Self { first, protocol, time_step }
    }

    /// The rate during the step that ends with `step` (at its end, if the rate varies continuously) and the step at
    /// which this rate began; at step 0 the first rate.
    pub fn before(&self, step: u64) -> (f64, u64) {
        let last = self.changes().iter().rev().find(|change| change.step < step);
        let began = last.map_or(0, |change| change.step);
        (self.before_time(step as f64 * self.time_step), began)
    }

    /// The new rate if the rate changes at the beginning of `step`.
    pub fn changed_at(&self, step: u64) -> Option<f64> {
        self.changes().iter().find(|change| change.step == step).map(|change| change.rate)
    }

    /// Rate just before a time.
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

    /// Strain at a time.
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

    /// Whether the rate is constant.
    pub fn is_constant(&self) -> bool {
        self.protocol == Protocol::STEADY
    }

    /// Angular frequency of an oscillation.
    pub fn frequency(&self) -> Option<f64> {
        if let Protocol::Oscillation { frequency } = self.protocol { Some(frequency) } else { None }
    }

    /// Shear stress, if the protocol gives one.
    pub fn stress(&self) -> Option<f64> {
        if let Protocol::Stress(stress) = self.protocol { Some(stress) } else { None }
    }

    /// Largest magnitude of the rate.
    pub fn largest(&self) -> f64 {
        self.changes().iter().map(|change| change.rate.abs()).fold(self.first.abs(), f64::max)
    }

    /// Largest magnitude of the strain up to time `end`.
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
            ParameterError::require_positive("flow.oscillation.frequency", frequency)?;
            return ParameterError::require_finite("flow.oscillation.amplitude", self.first).map(drop);
        }
        ParameterError::require_finite("flow.rate", self.first)?;
        if let Protocol::Stress(stress) = self.protocol {
            ParameterError::require_positive("flow.stress", stress)?;
            return ParameterError::require_positive("flow.rate", self.first).map(drop);
        }
        let mut last = 0;
        for change in self.changes() {
            ParameterError::require_finite("flow.rate", change.rate)?;
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
