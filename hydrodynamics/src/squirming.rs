//! Squirmers: spheres that swim by a slip velocity at their surface.

use domain::parallel::{mapped, of_rows};
use domain::{Traceless, Units, Vector, sphere};
use fcm::{Envelope, Motion, Multipoles, Plan};
use std::f64::consts::PI;
use thiserror::Error;

/// Slip modes of squirmers, one entry per sphere of the rank, zero for a passive sphere; empty lists stand for zeros.
/// At the point of the surface with the outward normal `n`, the fluid moves relative to the sphere with
///
/// ```text
/// u_s = (B1 + B2 n.p) [(n.p) n - p]
/// ```
///
/// where `p` is the axis. A sphere with `B1 > 0` swims along its axis, alone in unbounded fluid with the velocity
/// `2/3 B1 p`. With `B2/B1 < 0` it is a pusher, with `B2/B1 > 0` a puller.
///
/// In the force-coupling method (Delmotte, Keaveny, Plouraboué & Climent, J. Comput. Phys. 302, 524, 2015) a squirmer
/// of radius `a` has, besides its force and torque, a degenerate quadrupole and a stresslet,
///
/// ```text
/// H = -4/3 pi mu a^3 B1 p,        G = 4/3 pi mu a^2 B2 (3 p p - I),
/// ```
///
/// which are those of its flow alone in unbounded fluid. With the total stresslet `S`, which includes `G`, its motion
/// is that of a rigid sphere with a known strain rate and a known additional velocity,
///
/// ```text
/// E[F, T, S, H] + E_inf = -B2/(5 a) (3 p p - I),        U = V[F, T, S, H] + (2/3 - w) B1 p,
/// ```
///
/// where `w B1 p` is the velocity by `H` itself, averaged over the sphere's envelope. So squirmers change right-hand
/// sides alone.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Squirming {
    /// `B1 p`: first mode times the axis, a velocity.
    pub first: Vec<Vector>,
    /// `B2 (p p - I/3)`: second mode, a velocity.
    pub second: Vec<Traceless>,
}

/// Squirmers with a plan for forces alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("squirmers need the stresslets of rigid spheres: the multipoles must include dipoles")]
pub struct SquirmingRefused;

impl Squirming {
    /// Checks that a plan has a far field of squirmers.
    ///
    /// # Errors
    /// If the plan has no dipoles.
    pub fn check(plan: &Plan) -> Result<(), SquirmingRefused> {
        match plan.multipoles {
            Multipoles::Monopole | Multipoles::Moments => Err(SquirmingRefused),
            Multipoles::Dipole => Ok(()),
        }
    }

    /// Squirmers that alone in unbounded fluid have these velocities, `2/3 B1 p`, and stresslets `4 pi mu a^2 B2 (p p -
    /// I/3)`, or any other symmetric traceless ones; empty lists stand for zeros.
    pub fn moving_alone(velocities: &[Vector], stresslets: &[Traceless], viscosity: f64, radii: &[f64]) -> Self {
        let second = |(&stresslet, a): (&Traceless, &f64)| stresslet * (1.0 / (4.0 * PI * viscosity * a * a));
        Self {
            first: velocities.iter().map(|&velocity| velocity * 1.5).collect(),
            second: stresslets.iter().zip(radii).map(second).collect(),
        }
    }

    /// Whether no list has entries.
    pub fn is_empty(&self) -> bool {
        self.first.is_empty() && self.second.is_empty()
    }

    /// Active stresslets `G` of spheres of the given radii: what the slip of each contributes to its stresslet alone in
    /// unbounded fluid. The rest of a total stresslet is the reaction of the sphere to the flow of all others.
    pub fn stresslets(&self, viscosity: f64, radii: &[f64]) -> Vec<Traceless> {
        of_rows(radii.len(), |row| self.second_of(row) * (4.0 * PI * viscosity * radii[row] * radii[row]))
    }

    /// Degenerate quadrupoles `H` of spheres of the given radii.
    pub fn quadrupoles(&self, viscosity: f64, radii: &[f64]) -> Vec<Vector> {
        of_rows(radii.len(), |row| self.first_of(row) * (-viscosity * sphere::volume(radii[row])))
    }

    /// `(2/3 - w) B1 p` and `B2/(5 a) (3 p p - I)` of spheres of the given radii.
    pub(crate) fn own_motion(&self, radii: &[f64]) -> Motion {
        let velocity = 2.0 / 3.0 - own_share();
        Motion {
            velocities: of_rows(radii.len(), |row| self.first_of(row) * velocity),
            angular_velocities: mapped(radii, |_| Vector::ZERO),
            strain_rates: of_rows(radii.len(), |row| self.second_of(row) * (3.0 / (5.0 * radii[row]))),
        }
    }

    /// The same in other units.
    pub(crate) fn in_units(&self, units: &Units) -> Self {
        let over = 1.0 / units.velocity();
        Self { first: mapped(&self.first, |&b| b * over), second: mapped(&self.second, |&q| q * over) }
    }

    /// `B1 p` of a sphere.
    pub(crate) fn first_of(&self, row: usize) -> Vector {
        self.first.get(row).copied().unwrap_or_default()
    }

    /// `B2 (p p - I/3)` of a sphere.
    pub(crate) fn second_of(&self, row: usize) -> Traceless {
        self.second.get(row).copied().unwrap_or_default()
    }
}

/// `w`, the velocity of a sphere by its own degenerate quadrupole over `B1`, the same for all radii.
fn own_share() -> f64 {
    let envelope = Envelope::of_sphere(1.0);
    -envelope.quadrupole().own_mobility(envelope.monopole) * sphere::volume(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With the limit of equal widths, `w = 8/9 pi [2 pi (sigma^2 + sigma'^2)/a^2]^(-3/2)`; the central difference in
    /// the variance changes it by `(e k^2)^2/24` at wavenumbers near `k^2 = 5/(sigma^2 + sigma'^2)`, 2e-4.
    #[test]
    fn own_velocity_is_that_of_a_gaussian_quadrupole() {
        let Envelope { monopole, dipole } = Envelope::of_sphere(1.0);
        let limit = 8.0 / 9.0 * PI * (2.0 * PI * (monopole * monopole + dipole * dipole)).powf(-1.5);
        assert!((own_share() / limit - 1.0).abs() < 5e-4, "{} and {limit}", own_share());
    }
}
