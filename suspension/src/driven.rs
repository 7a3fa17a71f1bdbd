//! A rate of shear that keeps the stress at what it is to be.

use domain::{Comm, Particles};

/// The column that says what the flow was, the same for all particles: the strain, the rates of shear, and the slope.
pub const DRIVEN: &str = "driven flow";

/// Its width.
pub const DRIVEN_NUMBERS: usize = 5;

/// The stress is brought so near to what it is to be, over it and the tolerance of the solve.
const TOLERANCE: f64 = 0.5;

/// Rates that differ by less than this part of one of them tell no slope: the stresses have the errors of their solves.
const APART: f64 = 0.02;

/// Solves for one rate, at most.
const MOST_SOLVES: usize = 6;

/// A suspension is jammed where the fluid alone would be sheared this many times as fast.
const JAMMED: f64 = 1e5;

/// A flow whose rate of shear is found such that the shear stress is what it is to be. With all forces linear in the motions,
/// the stress is linear in the rate too,
///
/// ```text
/// s(rate) = s_F + slope rate,        slope >= viscosity
/// ```
///
/// so that two solves at the same places give the rate, and one will do where the slope is known from the last step and the
/// rate from the last two. In time the rate and the strain are one more velocity and one more place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Driven {
    stress: f64,
    viscosity: f64,
    tolerance: f64,
    /// The strain, and that to which the box is to go.
    strain: f64,
    aim: f64,
    /// Rates: of now, before, and the mean of the last substep, like the columns of velocities.
    rates: [f64; 3],
    /// The rate expected at the end of a substep.
    expected: f64,
    slope: f64,
}

impl Driven {
    /// A flow by a shear stress in a fluid of a viscosity, at a rate to start from, solved for with a tolerance.
    pub fn start((stress, viscosity, tolerance): (f64, f64, f64), rate: f64) -> Self {
        let slope = (stress / rate).max(viscosity);
        Self { stress, viscosity, tolerance, strain: 0.0, aim: 0.0, rates: [rate, 0.0, 0.0], expected: rate, slope }
    }

    /// As particles remember it, which are on the first rank, if they do. Collective.
    pub fn recalled(mut self, particles: &Particles, comm: &Comm) -> Self {
        let column = particles.columns.iter().find(|column| column.name == DRIVEN && column.width == DRIVEN_NUMBERS);
        let mut known: Vec<f64> =
            column.and_then(|column| column.values.get(..DRIVEN_NUMBERS)).map(<[f64]>::to_vec).unwrap_or_default();
        comm.broadcast(&mut known);
        if let [strain, now, past, mean, slope] = known[..] {
            (self.strain, self.aim, self.slope) = (strain, strain, slope);
            (self.rates, self.expected) = ([now, past, mean], now);
        }
        self
    }

    /// Lets particles remember it.
    pub fn note(&self, particles: &mut Particles) {
        let [now, past, mean] = self.rates;
        let numbers = [self.strain, now, past, mean, self.slope];
        let column = particles.column(DRIVEN, DRIVEN_NUMBERS);
        column.values.chunks_exact_mut(DRIVEN_NUMBERS).for_each(|values| values.copy_from_slice(&numbers));
    }

    /// The strain so far.
    pub fn strain(&self) -> f64 {
        self.strain
    }

    /// The rate at the last end of a substep.
    pub fn rate(&self) -> f64 {
        self.rates[0]
    }

    /// The strain by a sum of weights times rates: of now, before, and the mean of the last substep.
    pub fn carry(&self, weights: [f64; 3]) -> f64 {
        self.rates.iter().zip(weights).map(|(rate, weight)| rate * weight).sum()
    }

    /// Expects the rate that weights of that of now and the one before give, and the strain that other weights do.
    pub fn expect(&mut self, [now, past]: [f64; 2], weights: [f64; 3]) {
        self.expected = now * self.rates[0] + past * self.rates[1];
        self.aim = self.strain + self.carry(weights);
    }

    /// The rate expected.
    pub fn expected(&self) -> f64 {
        self.expected
    }

    /// By how much the strain is off with a rate that was found, where a substep has this much of it. From now on that rate is
    /// expected.
    pub fn correct(&mut self, rate: f64, implicit: f64) -> f64 {
        let missing = implicit * (rate - self.expected);
        (self.aim, self.expected) = (self.strain + missing, rate);
        missing
    }

    /// Goes to the strain aimed at; by how much that is more than the one before.
    pub fn go(&mut self) -> f64 {
        let carry = self.aim - self.strain;
        self.strain = self.aim;
        carry
    }

    /// Ends a substep in which the rate at its end had a share.
    pub fn end(&mut self, share: f64) {
        let [now, _, mean] = self.rates;
        self.rates = [self.expected, now, share * self.expected + (1.0 - share) * mean];
    }

    /// Starts from a rate that was found.
    pub fn start_from(&mut self, rate: f64) {
        (self.rates[0], self.expected) = (rate, rate);
    }

    /// Whether it has been next to none for two substeps.
    pub fn is_jammed(&self) -> bool {
        self.rates[..2].iter().all(|rate| rate.abs() * self.viscosity * JAMMED < self.stress)
    }

    /// A search for the rate, from the one expected.
    pub fn search(&self) -> Search {
        Search { driven: *self, rate: self.expected, last: None, solves: 0 }
    }

    /// Keeps what a search has learnt.
    pub fn learn(&mut self, search: &Search) {
        self.slope = search.driven.slope;
    }
}

/// A search for the rate at one moment.
#[derive(Debug)]
pub struct Search {
    driven: Driven,
    rate: f64,
    /// The rate and the stress of the last solve.
    last: Option<[f64; 2]>,
    solves: usize,
}

impl Search {
    /// The rate to solve with.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// Takes in the stress that a solve has found; whether another one is needed, with another rate.
    pub fn goes_on(&mut self, stress: f64) -> bool {
        let Driven { stress: wanted, viscosity, tolerance, .. } = self.driven;
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

    /// The stress of a suspension that is linear in the rate is met in three solves, and in one where it was met before.
    #[test]
    fn a_linear_stress_is_met() {
        let stress = |rate: f64| 0.7 + 9.0 * rate;
        let mut driven = Driven::start((2.0, 1.0, 1e-3), 0.9);
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

    /// Over substeps of any length, rate and strain follow `strain' = rate` to second order, and what particles remember goes on.
    #[test]
    fn strain_follows_the_rate() {
        let error = |steps: u32| {
            let (h, mut time) = (1.0 / f64::from(steps), 0.0_f64);
            let mut driven = Driven::start((1.0, 1.0, 1e-3), 1.0);
            for k in 0..steps {
                let share = if k == 0 { 1.0 } else { 2.0 / 3.0 };
                let now_and_past = if k == 0 { [1.0, 0.0] } else { [2.0, -1.0] };
                let [now, past] = now_and_past.map(|weight| weight * share * h);
                driven.expect(now_and_past, [now, past, (1.0 - share) * h]);
                driven.go();
                time += h;
                driven.correct(time.cos(), share * h);
                driven.go();
                driven.end(share);
                let mut particles = Particles::default();
                particles.push(0, domain::Vector::ZERO, 1.0, 0);
                driven.note(&mut particles);
                let again = Driven::start((1.0, 1.0, 1e-3), 5.0).recalled(&particles, &Comm::alone());
                assert_eq!((again.strain, again.rates), (driven.strain, driven.rates));
            }
            (driven.strain() - 1.0_f64.sin()).abs()
        };
        let order = (error(50) / error(100)).log2();
        assert!((order - 2.0).abs() < 0.2, "order {order}");
    }

    #[test]
    fn what_stands_still_is_jammed() {
        let mut driven = Driven::start((1.0, 1.0, 1e-3), 1e-6);
        assert!(!{
            driven.rates[1] = 0.1;
            driven.is_jammed()
        });
        driven.end(1.0);
        assert!(driven.is_jammed());
    }
}
