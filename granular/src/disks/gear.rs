//! Gear's predictor-corrector for second-order equations (Allen & Tildesley, Computer Simulation of Liquids, 1987,
//! appendix E), in Nordsieck form: `q_k = dt^k x^(k) / k!`.

/// Gear's schemes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Gear {
    /// Four values: third order, robust against stiff damping.
    FourValue,
    /// Five values, with 19/90 for forces that depend on velocity: fourth order.
    FiveValue,
    /// Five values with 19/120, for forces that depend on position only: fourth order.
    FiveValuePositional,
}

/// Increments of `x`, `v` and the higher `q` in the corrector per unit of `Delta = dt^2 a / 2 - q_2`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Corrector {
    position: f64,
    velocity: f64,
    higher: [f64; 3],
    dt: f64,
    frequency: f64,
}

impl Gear {
    pub(super) fn corrector(self, dt: f64) -> Corrector {
        let (position, velocity, higher) = match self {
            // The fourth derivative stays zero, which makes the predictor that of four values.
            Self::FourValue => (1.0 / 6.0, 5.0 / 6.0, [1.0, 1.0 / 3.0, 0.0]),
            Self::FiveValue => (19.0 / 90.0, 3.0 / 4.0, [1.0, 1.0 / 2.0, 1.0 / 12.0]),
            Self::FiveValuePositional => (19.0 / 120.0, 3.0 / 4.0, [1.0, 1.0 / 2.0, 1.0 / 12.0]),
        };
        Corrector { position, velocity: velocity / dt, higher, dt, frequency: 1.0 / dt }
    }

    /// Number of derivatives that the scheme carries beyond the velocity.
    pub(super) fn derivatives(self) -> usize {
        if self == Self::FourValue { 2 } else { 3 }
    }
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Coordinate {
    pub(super) x: f64,
    pub(super) v: f64,
    /// `q_2, q_3, q_4`.
    pub(super) q: [f64; 3],
}

impl Corrector {
    /// Advances the state by one step with Taylor's series.
    #[inline(always)]
    pub(super) fn predict(&self, state: &mut Coordinate) {
        let [a, b, c] = state.q;
        state.x += state.v * self.dt + (a + b + c);
        state.v += (a * 2.0 + b * 3.0 + c * 4.0) * self.frequency;
        state.q = [a + b * 3.0 + c * 6.0, b + c * 4.0, c];
    }

    /// Corrects a predicted state by `half_kick = dt^2 a / 2` with the acceleration `a` there.
    #[inline(always)]
    pub(super) fn correct(&self, state: &mut Coordinate, half_kick: f64) {
        let delta = half_kick - state.q[0];
        state.x += delta * self.position;
        state.v += delta * self.velocity;
        let ([a, b, c], [p, q, r]) = (state.q, self.higher);
        state.q = [a + delta * p, b + delta * q, c + delta * r];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Error in position at t = 10 of the damped oscillator `x'' = -x - 0.2 x'`, started with its true derivatives.
    fn error(gear: Gear, steps: u32) -> f64 {
        let dt = 10.0 / f64::from(steps);
        let (damping, frequency) = (0.1, 0.99_f64.sqrt());
        let corrector = gear.corrector(dt);
        let a = -1.0;
        let jerk = 0.2;
        let snap = -a - 0.2 * jerk;
        let mut q = [a / 2.0, jerk * dt / 6.0, snap * dt * dt / 24.0].map(|d| d * dt * dt);
        if gear == Gear::FourValue {
            q[2] = 0.0;
        }
        let mut state = Coordinate { x: 1.0, v: 0.0, q };
        for _ in 0..steps {
            corrector.predict(&mut state);
            let a = -state.x - 0.2 * state.v;
            corrector.correct(&mut state, a * (0.5 * dt * dt));
        }
        let exact =
            (-damping * 10.0_f64).exp() * ((frequency * 10.0).cos() + damping / frequency * (frequency * 10.0).sin());
        (state.x - exact).abs()
    }

    #[test]
    fn orders_are_three_and_four() {
        for (gear, order) in [(Gear::FourValue, 2.9), (Gear::FiveValue, 3.7), (Gear::FiveValuePositional, 3.7)] {
            let observed = (error(gear, 400) / error(gear, 800)).log2();
            assert!(observed > order && observed < order + 1.0, "{gear:?}: {observed}");
        }
    }
}
