//! Contact of rough spheres: elastic, with friction.

use crate::pair_kind::PairKind;
use domain::{ParameterError, Vector};

/// Dependence of the contact force on the overlap.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Elasticity {
    /// Proportional to the overlap.
    #[default]
    Linear,
    /// Proportional to its power 3/2.
    Hertz,
}

/// Contact law between rough elastic spheres, or a sphere and a wall (see [`PairKind`]), of radii `a_i` and `a_j`,
/// mean radius `a = (a_i + a_j) / 2` and gap `h` of their smooth surfaces (Cundall & Strack, Geotechnique 29, 47,
/// 1979; Gallier et al., J. Fluid Mech. 757, 514, 2014). They touch if the overlap of their asperities is positive,
///
/// ```text
/// d = roughness a - h > 0
/// ```
///
/// and repel each other with the force
///
/// ```text
/// F_n = k a d                              linear
/// F_n = k (2 a_i a_j / (a_i + a_j))^1/2 d^3/2      Hertz
/// ```
///
/// with `k` the stiffness, a force over the square of a length. Tangentially the contact is a spring that resists
/// slip: its force grows with the slip by `tangential_ratio dF_n/dd` and is limited to
/// `friction (F_n - critical_load)`, at which the contact slides. Rolling is resisted likewise, up to
/// `rolling_friction F_n`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Coefficient of friction.
    pub friction: f64,
    /// Height of the asperities of both spheres together, over the mean radius.
    pub roughness: f64,
    /// `k`
    pub stiffness: f64,
    /// Tangential over normal stiffness.
    pub tangential_ratio: f64,
    /// Largest force of rolling resistance over the normal force; 0 for none.
    pub rolling_friction: f64,
    /// Normal force up to which there is no friction.
    pub critical_load: f64,
    /// Dependence of the normal force on the overlap.
    pub elasticity: Elasticity,
}

/// Smallest and largest roughness, over the mean radius.
const ROUGHNESS: [f64; 2] = [1e-5, 0.1];

impl Contact {
    /// Default roughness, over the mean radius.
    pub const ROUGHNESS: f64 = 0.005;
    /// Default of the tangential over the normal stiffness.
    pub const TANGENTIAL_RATIO: f64 = 0.4;

    /// Checks the parameters; error messages name the keys of a scene.
    pub fn check(&self) -> Result<(), ParameterError> {
        let least_zero = |key: &str, value: f64, what: &str| {
            let message = format!("is {}; {what} needs to be 0 or more, and finite", domain::Number(value));
            if value >= 0.0 && value.is_finite() { Ok(()) } else { Err(ParameterError::new(key, message)) }
        };
        least_zero("contacts.friction", self.friction, "the coefficient of friction")?;
        least_zero("contacts.rolling_friction", self.rolling_friction, "the coefficient of rolling friction")?;
        least_zero("contacts.critical_load", self.critical_load, "the load below which there is no friction")?;
        ParameterError::require_between("contacts.roughness", self.roughness, ROUGHNESS)?;
        ParameterError::require_between("contacts.tangential_ratio", self.tangential_ratio, [1e-3, 10.0])?;
        ParameterError::require_positive("contacts.stiffness", self.stiffness).map(drop)
    }

    /// Distance of the centres, or of the centre from a wall, below which spheres touch.
    pub fn reach(&self, between: impl Into<PairKind>) -> f64 {
        between.into().at_gap(self.roughness)
    }

    /// Overlap of the asperities of spheres at a distance of their centres; negative if they are apart.
    pub fn overlap(&self, distance: f64, between: impl Into<PairKind>) -> f64 {
        self.reach(between) - distance
    }

    /// Normal force of an overlap; zero if that is negative.
    pub fn force(&self, overlap: f64, between: impl Into<PairKind>) -> f64 {
        let depth = overlap.max(0.0);
        match self.elasticity {
            Elasticity::Linear => self.stiffness * between.into().mean_radius() * depth,
            Elasticity::Hertz => self.stiffness * between.into().harmonic_radius().sqrt() * depth * depth.sqrt(),
        }
    }

    /// Normal stiffness: derivative of the normal force by the overlap.
    pub fn normal_stiffness(&self, overlap: f64, between: impl Into<PairKind>) -> f64 {
        let depth = overlap.max(0.0);
        match self.elasticity {
            Elasticity::Linear => self.stiffness * between.into().mean_radius(),
            Elasticity::Hertz => 1.5 * self.stiffness * (between.into().harmonic_radius() * depth).sqrt(),
        }
    }

    /// Tangential stiffness: derivative of the tangential force by the slip.
    pub fn tangential_stiffness(&self, overlap: f64, between: impl Into<PairKind>) -> f64 {
        self.tangential_ratio * self.normal_stiffness(overlap, between)
    }

    /// Coulomb limit of the tangential force under a normal force, beyond which the contact slides.
    pub fn coulomb_limit(&self, normal_force: f64) -> f64 {
        self.friction * (normal_force - self.critical_load).max(0.0)
    }

    /// Elastic energy of an overlap and of tangential forces.
    pub fn energy(&self, overlap: f64, between: impl Into<PairKind>, across: [Vector; 2]) -> f64 {
        let between = between.into();
        let power = match self.elasticity {
            Elasticity::Linear => 0.5,
            Elasticity::Hertz => 0.4,
        };
        let springs: f64 = across.iter().map(|force| force.length_squared()).sum();
        let stiffness = self.tangential_stiffness(overlap, between);
        let sheared = if springs > 0.0 { 0.5 * springs / stiffness } else { 0.0 };
        power * self.force(overlap, between) * overlap.max(0.0) + sheared
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(elasticity: Elasticity) -> Contact {
        Contact {
            friction: 0.5,
            roughness: 0.01,
            stiffness: 3e4,
            tangential_ratio: 0.4,
            rolling_friction: 0.0,
            critical_load: 2.0,
            elasticity,
        }
    }

    #[test]
    fn forces_are_slopes_of_the_energy_and_stiffnesses_of_forces() {
        let laws = [law(Elasticity::Linear), law(Elasticity::Hertz)];
        let between = [PairKind::Spheres([1.0, 1.7]), PairKind::Wall(1.3)];
        for (law, radii) in laws.into_iter().flat_map(|law| between.map(|surfaces| (law, surfaces))) {
            for overlap in [1e-4, 3e-3] {
                let slope = |of: &dyn Fn(f64) -> f64| (of(overlap * 1.001) - of(overlap * 0.999)) / (0.002 * overlap);
                let force = slope(&|d| law.energy(d, radii, [Vector::ZERO; 2]));
                assert!((force / law.force(overlap, radii) - 1.0).abs() < 1e-5);
                let stiffness = slope(&|d| law.force(d, radii));
                assert!((stiffness / law.normal_stiffness(overlap, radii) - 1.0).abs() < 1e-5);
            }
            assert_eq!((law.force(-1e-3, radii), law.energy(-1e-3, radii, [Vector::ZERO; 2])), (0.0, 0.0));
        }
    }

    #[test]
    fn contact_begins_at_the_roughness() {
        let (law, radii) = (law(Elasticity::Linear), [1.0, 2.0]);
        assert!((law.reach(radii) - 3.015).abs() < 1e-15);
        assert!((law.overlap(3.005, radii) - 0.01).abs() < 1e-14);
        assert!((law.force(0.01, radii) - 450.0).abs() < 1e-12);
        let wall = PairKind::Wall(2.0);
        assert!((law.reach(wall) - 2.02).abs() < 1e-15 && (law.force(0.01, wall) - 600.0).abs() < 1e-12);
    }

    #[test]
    fn no_friction_below_the_critical_load() {
        let law = law(Elasticity::Linear);
        assert_eq!((law.coulomb_limit(1.0), law.coulomb_limit(2.0), law.coulomb_limit(12.0)), (0.0, 0.0, 5.0));
    }

    #[test]
    fn parameters_out_of_their_ranges_are_named() {
        let good = law(Elasticity::Linear);
        let said = |law: Contact| law.check().unwrap_err().to_string();
        assert!(good.check().is_ok());
        assert!(said(Contact { friction: -0.1, ..good }).starts_with("contacts.friction is -0.1; "));
        assert!(said(Contact { roughness: 0.2, ..good }).starts_with("contacts.roughness is 0.2; "));
        assert!(said(Contact { stiffness: 0.0, ..good }).starts_with("contacts.stiffness is 0; "));
        assert!(said(Contact { critical_load: f64::NAN, ..good }).starts_with("contacts.critical_load is NaN; "));
    }
}
