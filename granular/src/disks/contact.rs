//! The contact between two disks: a damped harmonic spring.

use std::f64::consts::PI;

/// A contact with overlap `xi > 0` repels with the force `mu (xi + 2 kappa dxi/dt)`, `mu` the reduced mass: the
/// stiffness scales with the reduced mass, so that an undamped contact lasts `pi` for every pair. Eq. (1) of Santra,
/// Schwarzer & Herrmann, PRE 54, 5066 (1996), with the dot and the sign that make `xi'' + 2 kappa xi' + xi = 0`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpringContact {
    restitution: f64,
    clips_attraction: bool,
}

impl SpringContact {
    /// A contact that leaves the fraction `restitution` of the normal velocity, `0 < restitution <= 1`. With
    /// `clips_attraction` it never attracts, which raises the fraction a little.
    pub(super) fn new(restitution: f64, clips_attraction: bool) -> Self {
        Self { restitution, clips_attraction }
    }

    /// The damping constant `kappa = 1 / sqrt(1 + (pi / ln e)^2)`; 0 at `e = 1`.
    pub fn damping(&self) -> f64 {
        if self.restitution < 1.0 { 1.0 / (1.0 + (PI / self.restitution.ln()).powi(2)).sqrt() } else { 0.0 }
    }

    /// Duration of a contact, `pi / sqrt(1 - kappa^2)`; shorter with `clips_attraction`, as it
    /// ends when the force vanishes.
    pub fn duration(&self) -> f64 {
        let (k, w) = (self.damping(), self.frequency());
        if self.clips_attraction { (PI - (2.0 * k * w).atan2(w * w - k * k)) / w } else { PI / w }
    }

    /// Fraction of the normal velocity after a contact: `exp(-kappa * duration)`.
    pub fn restitution(&self) -> f64 {
        (-self.damping() * self.duration()).exp()
    }

    /// Lower bound of the contact force over the reduced mass.
    pub(super) fn floor(&self) -> f64 {
        if self.clips_attraction { 0.0 } else { f64::NEG_INFINITY }
    }

    fn frequency(&self) -> f64 {
        (1.0 - self.damping().powi(2)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn damping_follows_from_restitution() {
        for (e, kappa) in [(0.8, 0.0708503), (0.1, 0.5911550), (1.0, 0.0)] {
            let contact = SpringContact::new(e, false);
            assert!((contact.damping() - kappa).abs() < 1e-7);
            assert!((contact.restitution() - e).abs() < 1e-15);
        }
        assert!((SpringContact::new(0.8, false).duration() - 3.14951).abs() < 1e-5);
        assert!((SpringContact::new(0.1, false).duration() - 3.89506).abs() < 1e-5);
    }

    #[test]
    fn clipping_raises_restitution() {
        assert!((SpringContact::new(0.8, true).restitution() - 0.80809).abs() < 1e-5);
        assert!((SpringContact::new(1.0, true).restitution() - 1.0).abs() < 1e-15);
    }
}
