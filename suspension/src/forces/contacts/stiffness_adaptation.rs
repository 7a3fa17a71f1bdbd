//! Adaptation of the contact stiffness to a target of the overlap.

use crate::model::{Contacts, Model};
use crate::scalars::{ADAPTATION, ADAPTATION_NUMBERS};
use domain::Scalars;
use lubrication::Elasticity;

/// Shortest strain of the running mean: half of it when the adaptation begins.
const SHORTEST: f64 = 0.25;

/// Largest change of the stiffness that one overlap may ask for, as a factor: it bounds the weight of a single overlap.
const MOST: f64 = 4.0;

/// Largest factor between the stiffness and its first estimate, in either direction.
const WIDEST: f64 = 10.0;

/// The stiffness `k` of contacts while it adapts. Under the forces by which a flow presses spheres together, the
/// largest overlap `d` scales as `k^(-1/n)`, with `n = 1` for the linear law and `3/2` for Hertz's. A target overlap
/// `d*` thus needs a stiffness of about `k (d / d*)^n`. The stiffness is the mean of this over the strain `s` so far,
/// with more weight on later values,
///
/// ```text
/// dk/ds = 2 (k (d / d*)^n - k) / s
/// ```
///
/// and is constant from a given strain on, or from the first change of the flow rate. Contacts store forces, so no
/// force jumps as `k` changes: tangential forces continue unchanged (the elongations of their springs are forces over
/// stiffness and change in inverse proportion), and normal forces follow the overlap, which relaxes within a strain of
/// some thousandths, while the stiffness changes by some per cent. All ranks find bitwise the same stiffness, since it
/// depends only on the largest overlap of all contacts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StiffnessAdaptation {
    stiffness: f64,
    strain: f64,
    is_over: bool,
    /// First estimate of the stiffness.
    estimate: f64,
    /// Target of the largest overlap over the roughness, and the exponent `n`.
    target_overlap: f64,
    power: f64,
    /// Strain, as of a shear flow, at which the adaptation ends.
    until: f64,
    /// Rate of the simple shear with equal dissipation over the rate of the flow; and the largest rate of the flow over
    /// its first rate, by which spheres will be pressed together more strongly later.
    as_shear: f64,
    later: f64,
}

impl StiffnessAdaptation {
    /// The adaptation of a model, restored from scalars if they have it. `None` if the scene gives the stiffness.
    pub fn of(model: &Model, scalars: &Scalars) -> Option<Self> {
        let contacts = model.contacts.filter(|contacts| contacts.stiffness.is_none())?;
        let known = scalars.numbers::<ADAPTATION_NUMBERS>(ADAPTATION);
        let settles = contacts.settles(model);
        if known.is_none() && !settles {
            return None;
        }
        let estimate = Contacts { settled: None, ..contacts }.contact(model).stiffness;
        let power = match contacts.law {
            Elasticity::Linear => 1.0,
            Elasticity::Hertz => 1.5,
        };
        let rates = model.shear_rates();
        let later = if rates.stress().is_some() { 1.0 } else { rates.largest() / rates.before(0).0.abs() };
        let [stiffness, strain, is_over] = known.unwrap_or([estimate, 0.0, 0.0]);
        Some(Self {
            stiffness,
            strain,
            is_over: is_over > 0.0,
            estimate,
            target_overlap: contacts.overlap,
            power,
            until: contacts.settling.unwrap_or(Contacts::SETTLING),
            as_shear: model.flow.as_shear(1.0),
            later,
        })
    }

    /// Stores the state.
    pub fn store(&self, scalars: &mut Scalars) {
        let numbers: [f64; ADAPTATION_NUMBERS] = [self.stiffness, self.strain, f64::from(u8::from(self.is_over))];
        scalars.set(ADAPTATION, &numbers);
    }

    /// Present stiffness.
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// Whether the adaptation is over.
    pub fn is_over(&self) -> bool {
        self.is_over
    }

    /// Ends the adaptation.
    pub fn end(&mut self) {
        self.is_over = true;
    }

    /// Adapts the stiffness to the largest overlap (over the roughness) after the flow has advanced by `strain`.
    pub fn adapt(&mut self, overlap: f64, strain: f64) {
        let strain = self.as_shear * strain.abs();
        self.strain += strain;
        let needed = self.later * (overlap / self.target_overlap).powf(self.power);
        let share = (2.0 * strain / self.strain.max(SHORTEST)).min(1.0);
        let stiffness = self.stiffness * (1.0 + share * (needed.min(MOST) - 1.0));
        self.stiffness = stiffness.clamp(self.estimate / WIDEST, self.estimate * WIDEST);
        self.is_over = self.strain >= self.until;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Adaptation to the overlaps of a law under a fluctuating load, in steps of a given strain.
    fn settled(power: f64, estimate: f64, later: f64, step: f64) -> StiffnessAdaptation {
        let (load, until) = (30.0, 2.0);
        let start = StiffnessAdaptation {
            stiffness: estimate,
            strain: 0.0,
            is_over: false,
            estimate,
            target_overlap: 0.3,
            power,
            until,
            as_shear: 1.0,
            later,
        };
        let mut settling = start;
        while !settling.is_over() {
            let scatter = 1.0 + 0.3 * (20.0 * settling.strain).sin();
            settling.adapt((load * scatter / settling.stiffness()).powf(1.0 / power), step);
        }
        assert!((settling.strain - until).abs() < 1.5 * step.abs());
        settling
    }

    /// The result depends neither on the first estimate nor on the step length or the sign of the rate.
    #[test]
    fn it_settles_where_the_overlap_is_what_is_aimed_at() {
        for (power, estimate) in [(1.0, 30.0), (1.0, 400.0), (1.5, 100.0), (1.5, 900.0)] {
            let wanted = 30.0 / 0.3_f64.powf(power);
            for step in [0.005, -0.02] {
                let found = settled(power, estimate, 1.0, step).stiffness();
                assert!((found / wanted - 1.0).abs() < 0.05, "{power} {estimate}: {found}, not {wanted}");
            }
            let twice = settled(power, estimate, 2.0, 0.005).stiffness();
            assert!((twice / wanted - 2.0).abs() < 0.1, "{twice}");
        }
    }

    #[test]
    fn it_stays_within_bounds() {
        let (soft, stiff) = (settled(1.0, 1.0, 1.0, 0.01), settled(1.0, 5000.0, 1.0, 0.01));
        assert_eq!((soft.stiffness(), stiff.stiffness()), (10.0, 500.0));
    }

    #[test]
    fn the_state_is_stored() {
        let (settling, mut scalars) = (settled(1.0, 100.0, 1.0, 0.01), Scalars::default());
        settling.store(&mut scalars);
        assert_eq!(scalars.numbers(ADAPTATION), Some([settling.stiffness, settling.strain, 1.0]));
    }
}
