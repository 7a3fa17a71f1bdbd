//! Uniform solutions: without energy through the walls (R6 = R7 = R8 = 0) shear heating balances collisional cooling
//! everywhere, and the problem is one equation for the solid fraction.

use super::ContinuumProblem;
use statistics::maximum;

/// A uniform flow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UniformFlow {
    /// Solid fraction.
    pub solid_fraction: f64,
    /// Slip at each wall over `U`.
    pub slip: f64,
    /// Shear stress over `P`.
    pub stress_ratio: f64,
}

/// Intervals of the scan for roots, equally spaced in the logit of the solid fraction.
const SCAN_INTERVALS: usize = 400;
/// Range of logits of the scan: solid fractions from 1e-6 of packing to 1e-6 below it.
const LOGIT: f64 = 14.0;

impl ContinuumProblem {
    /// All uniform solutions of the problem without energy through its walls, densest first: `R5 B5 u_slip = |u'|`,
    /// `U = 2 u_slip + |u'| H`, `P = (C1 C2 / C6) u'^2`.
    pub fn uniform(&self) -> Vec<UniformFlow> {
        let excess = |z: f64| self.uniform_at(self.solid_fraction(z)).1;
        let logit = |i: usize| LOGIT * (1.0 - 2.0 * i as f64 / SCAN_INTERVALS as f64);
        let mut found = Vec::new();
        for i in 0..SCAN_INTERVALS {
            let (high, low) = (logit(i), logit(i + 1));
            if excess(high) * excess(low) <= 0.0 {
                found.push(self.uniform_at(self.solid_fraction(bisect(excess, low, high))).0);
            }
        }
        found
    }

    /// The uniform flow at a solid fraction, and the logarithm of the pressure that it needs over the given pressure
    /// (NaN where the walls cannot drive such a flow).
    fn uniform_at(&self, v: f64) -> (UniformFlow, f64) {
        let f = self.parameters().grains.functions(v);
        let (c1, c2, c6) = (f.c1.value(), f.c2.value(), f.c6.value());
        let bumps = self.bump_integrals(f.contact);
        let slip_length = (c1 / c2 - bumps.gradient.value()) / (self.parameters().wall.roughness.r5 * bumps.slip);
        let gradient = 1.0 / (2.0 * self.half_gap() + 2.0 * slip_length);
        let load = c1 * c2 / c6 * gradient * gradient;
        let flow = UniformFlow {
            solid_fraction: v,
            slip: slip_length * gradient,
            stress_ratio: (c6 / c2).sqrt() * (c1 / c2).sqrt(),
        };
        (flow, if gradient > 0.0 { (load / self.load()).ln() } else { f64::NAN })
    }

    /// Solid fraction below which a thinner uniform shear flow needs more pressure: the dilute branch.
    pub fn dilute_below(&self) -> f64 {
        let need = |z: f64| {
            let f = self.parameters().grains.functions(self.solid_fraction(z));
            (f.c1.value() * f.c2.value() / f.c6.value()).ln()
        };
        // The pressure at a given shear rate falls with v and then rises.
        self.solid_fraction(maximum(|z| -need(z), [-LOGIT, LOGIT]))
    }

    /// Solid fraction of a logit: `v0 / (1 + exp(-z))`, always below packing.
    pub(super) fn solid_fraction(&self, z: f64) -> f64 {
        self.parameters().grains.radial.packed() / (1.0 + (-z).exp())
    }

    /// Logit of a solid fraction.
    pub(super) fn logit(&self, v: f64) -> f64 {
        (v / (self.parameters().grains.radial.packed() - v)).ln()
    }
}

fn bisect(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let sign = f(low) > 0.0;
    while high - low > 1e-14 * (1.0 + low.abs()) {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if (f(middle) > 0.0) == sign { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}
