//! Stress control: the shear rate that keeps the shear stress at a given value.

use crate::scalars::STRESS_CONTROL;
use domain::Scalars;

/// Relative error of the stress at which the search ends, over the tolerance of the solve.
const TOLERANCE: f64 = 0.5;

/// Smallest relative difference of two rates from which a slope is taken: the stresses have the errors of their solves.
const APART: f64 = 0.02;

/// Largest number of solves for one rate.
const MOST_SOLVES: usize = 6;

/// A suspension counts as jammed if the fluid alone would shear this many times faster.
const JAMMED: f64 = 1e5;

/// A flow whose shear rate is found such that the shear stress has a given value. All forces are linear in the motions,
/// so the stress is linear in the rate,
///
/// ```text
/// s(rate) = s_F + slope rate,        slope >= viscosity
/// ```
///
/// and two solves at the same positions give the rate. A single solve suffices if the slope is known from the last step
/// and the rate is extrapolated from the last two. In time integration, rate and strain are treated like one more
/// velocity and position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StressControl {
    stress: f64,
    viscosity: f64,
    tolerance: f64,
    /// Strain, and strain to which the box will advance.
    strain: f64,
    predicted_strain: f64,
    /// Present and past rates, and the mean over the last substep, like the columns of velocities.
    rates: [f64; 3],
    /// Rate expected at the end of a substep.
    expected: f64,
    slope: f64,
}

/// A shear stress that the rate is adapted to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StressTarget {
    /// The stress.
    pub stress: f64,
    /// Viscosity of the fluid.
    pub viscosity: f64,
    /// Tolerance of the solve.
    pub tolerance: f64,
}

impl StressControl {
    /// A flow under a shear stress, with a first guess of the rate.
    pub fn start(StressTarget { stress, viscosity, tolerance }: StressTarget, rate: f64) -> Self {
        let slope = (stress / rate).max(viscosity);
        Self {
            stress,
            viscosity,
            tolerance,
            strain: 0.0,
            predicted_strain: 0.0,
            rates: [rate, 0.0, 0.0],
            expected: rate,
            slope,
        }
    }

    /// Restores the state from scalars, if they have it.
    pub fn restored(mut self, scalars: &Scalars) -> Self {
        if let Some([strain, now, past, mean, slope]) = scalars.numbers(STRESS_CONTROL) {
            (self.strain, self.predicted_strain, self.slope) = (strain, strain, slope);
            (self.rates, self.expected) = ([now, past, mean], now);
        }
        self
    }

    /// Stores the state.
    pub fn store(&self, scalars: &mut Scalars) {
        let [now, past, mean] = self.rates;
        scalars.set(STRESS_CONTROL, &[self.strain, now, past, mean, self.slope]);
    }

    /// Present strain.
    pub fn strain(&self) -> f64 {
        self.strain
    }

    /// Rate at the end of the last substep.
    pub fn rate(&self) -> f64 {
        self.rates[0]
    }

    /// Strain increment: weighted sum of the present and past rates and the mean over the last substep.
    pub fn advect(&self, weights: [f64; 3]) -> f64 {
        self.rates.iter().zip(weights).map(|(rate, weight)| rate * weight).sum()
    }

    /// Predicts the rate from the present and past rates, with the first weights, and the strain from the second
    /// weights.
    pub fn predict(&mut self, [now, past]: [f64; 2], weights: [f64; 3]) {
        self.expected = now * self.rates[0] + past * self.rates[1];
        self.predicted_strain = self.strain + self.advect(weights);
    }

    /// Predicted rate.
    pub fn expected(&self) -> f64 {
        self.expected
    }

    /// Corrects the predicted rate and strain by a rate that was found; `implicit` is the weight of this rate in the
    /// strain of the substep. Returns the correction of the strain.
    pub fn correct(&mut self, rate: f64, implicit: f64) -> f64 {
        let missing = implicit * (rate - self.expected);
        (self.predicted_strain, self.expected) = (self.strain + missing, rate);
        missing
    }

    /// Advances to the predicted strain. Returns the increment.
    pub fn go(&mut self) -> f64 {
        let carry = self.predicted_strain - self.strain;
        self.strain = self.predicted_strain;
        carry
    }

    /// Ends a substep in whose mean the rate at its end has the weight `share`.
    pub fn end(&mut self, share: f64) {
        let [now, _, mean] = self.rates;
        self.rates = [self.expected, now, share * self.expected + (1.0 - share) * mean];
    }

    /// Starts from a rate that was found.
    pub fn start_from(&mut self, rate: f64) {
        (self.rates[0], self.expected) = (rate, rate);
    }

    /// Whether the rate has been almost zero for two substeps.
    pub fn is_jammed(&self) -> bool {
        self.rates[..2].iter().all(|rate| rate.abs() * self.viscosity * JAMMED < self.stress)
    }

    /// A search for the rate, starting from the predicted one.
    pub fn search(&self) -> Search {
        Search { driven: *self, rate: self.expected, last: None, solves: 0 }
    }

    /// Takes over the slope from a search.
    pub fn learn(&mut self, search: &Search) {
        self.slope = search.driven.slope;
    }
}

/// Search for the rate at one instant.
#[derive(Debug)]
pub struct Search {
    driven: StressControl,
    rate: f64,
    /// Rate and stress of the last solve.
    last: Option<[f64; 2]>,
    solves: usize,
}

impl Search {
    /// Rate for the next solve.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// Takes the stress of a solve. Returns whether another solve is needed, with a new rate.
    pub fn goes_on(&mut self, stress: f64) -> bool {
        let StressControl { stress: wanted, viscosity, tolerance, .. } = self.driven;
        self.solves += 1;
        if let Some([rate, before]) = self.last.replace([self.rate, stress])
            && (self.rate - rate).abs() > APART * rate.abs()
        {
            self.driven.slope = ((stress - before) / (self.rate - rate)).max(viscosity);
        }
        let missing = wanted - stress;
        if missing.abs() <= TOLERANCE * tolerance * wanted || self.solves == MOST_SOLVES || !missing.is_finite() {
            return false;
        }
        self.rate += missing / self.driven.slope;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A flow under a stress in a fluid of viscosity 1.
    fn start(stress: f64, rate: f64) -> StressControl {
        StressControl::start(StressTarget { stress, viscosity: 1.0, tolerance: 1e-3 }, rate)
    }

    /// A stress that is linear in the rate is met in three solves, and in one solve once the slope is known.
    #[test]
    fn a_linear_stress_is_met() {
        let stress = |rate: f64| 0.7 + 9.0 * rate;
        let mut driven = start(2.0, 0.9);
        for most in [3, 1] {
            let mut search = driven.search();
            let mut solves = 1;
            while search.goes_on(stress(search.rate())) {
                solves += 1;
            }
            assert!((stress(search.rate()) / 2.0 - 1.0).abs() < 1e-3 && solves <= most, "{search:?}");
            driven.learn(&search);
            driven.start_from(search.rate());
        }
        assert!((driven.slope - 9.0).abs() < 1e-9);
    }

    /// For substeps of any length, the strain follows `strain' = rate` to second order, and the stored state is
    /// restored.
    #[test]
    fn strain_follows_the_rate() {
        let error = |steps: u32| {
            let (h, mut time) = (1.0 / f64::from(steps), 0.0_f64);
            let mut driven = start(1.0, 1.0);
            for k in 0..steps {
                let share = if k == 0 { 1.0 } else { 2.0 / 3.0 };
                let now_and_past = if k == 0 { [1.0, 0.0] } else { [2.0, -1.0] };
                let [now, past] = now_and_past.map(|weight| weight * share * h);
                driven.predict(now_and_past, [now, past, (1.0 - share) * h]);
                driven.go();
                time += h;
                driven.correct(time.cos(), share * h);
                driven.go();
                driven.end(share);
                let mut scalars = Scalars::default();
                driven.store(&mut scalars);
                let again = start(1.0, 5.0).restored(&scalars);
                assert_eq!((again.strain, again.rates), (driven.strain, driven.rates));
            }
            (driven.strain() - 1.0_f64.sin()).abs()
        };
        let order = (error(50) / error(100)).log2();
        assert!((order - 2.0).abs() < 0.2, "order {order}");
    }

    #[test]
    fn what_stands_still_is_jammed() {
        let mut driven = start(1.0, 1e-6);
        assert!(!{
            driven.rates[1] = 0.1;
            driven.is_jammed()
        });
        driven.end(1.0);
        assert!(driven.is_jammed());
    }
}
