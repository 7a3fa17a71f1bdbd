//! A rate of shear that changes in the course of a run.

use domain::{Number, ParameterError};

/// A change of the rate of shear at the beginning of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RateChange {
    /// The step.
    pub step: u64,
    /// The rate from then on.
    pub rate: f64,
}

/// The rate of shear in time: constant from change to change.
#[derive(Debug, Clone, PartialEq)]
pub struct ShearRates {
    first: f64,
    changes: Vec<RateChange>,
    time_step: f64,
}

impl ShearRates {
    /// A first rate and its changes, in steps of a length.
    pub fn new(first: f64, changes: &[RateChange], time_step: f64) -> Self {
        Self { first, changes: changes.to_vec(), time_step }
    }

    /// The rate during the step that ends with `step`, and the step at which it began; at step 0 the first one.
    pub fn before(&self, step: u64) -> (f64, u64) {
        let last = self.changes.iter().rev().find(|change| change.step < step);
        last.map_or((self.first, 0), |change| (change.rate, change.step))
    }

    /// The rate to which that changes at a step, if it does.
    pub fn changed_at(&self, step: u64) -> Option<f64> {
        self.changes.iter().find(|change| change.step == step).map(|change| change.rate)
    }

    /// The rate shortly before a time.
    pub fn before_time(&self, time: f64) -> f64 {
        let last = self.changes.iter().rev().find(|change| self.time(change) < time);
        last.map_or(self.first, |change| change.rate)
    }

    /// The strain at a time.
    pub fn strain(&self, time: f64) -> f64 {
        let (mut strain, mut since, mut rate) = (0.0, 0.0, self.first);
        for change in self.changes.iter().take_while(|change| self.time(change) < time) {
            let now = self.time(change);
            strain += rate * (now - since);
            (since, rate) = (now, change.rate);
        }
        strain + rate * (time - since)
    }

    /// Whether it changes.
    pub fn is_constant(&self) -> bool {
        self.changes.is_empty()
    }

    /// The largest rate, without its sign.
    pub fn largest(&self) -> f64 {
        self.changes.iter().map(|change| change.rate.abs()).fold(self.first.abs(), f64::max)
    }

    /// The largest strain at any time up to one, without its sign.
    pub fn largest_strain(&self, end: f64) -> f64 {
        let ends = self.changes.iter().map(|change| self.time(change)).filter(|&time| time < end);
        ends.chain([end]).map(|time| self.strain(time).abs()).fold(0.0, f64::max)
    }

    fn time(&self, change: &RateChange) -> f64 {
        change.step as f64 * self.time_step
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_finite("flow.rate", self.first)?;
        let mut last = 0;
        for change in &self.changes {
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
        let rates = ShearRates::new(2.0, &changes, 0.1);
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
            let error = ShearRates::new(1.0, &changes, 0.5).check().unwrap_err();
            assert!(error.to_string().contains("in their order"), "{error}");
        }
        assert!(ShearRates::new(1.0, &[change(1), change(2)], 0.5).check().is_ok());
    }
}
