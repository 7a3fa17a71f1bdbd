//! Short-range repulsion that keeps spheres apart.

use crate::pair_kind::PairKind;
use domain::{Number, Vector};
use thiserror::Error;

/// Repulsion between two spheres, Dance, Climent & Maxey (2004), and eq. (13) of Abbas et al. (2006), for any two
/// radii.
///
/// With `r` the distance of the centres, `c = a_i + a_j` their distance at contact and `R = c + range (a_i + a_j)/2`
/// the distance where the barrier starts, the force on sphere `i` is
///
/// ```text
/// F_i = -(F_ref / c) [(R² - r²) / (R² - c²)]² (x_j - x_i)     for r < R,     0 beyond,
/// ```
///
/// and opposite on sphere `j`. Its magnitude is `F_ref` at contact; the formula continues into overlap, where the
/// force grows further until `r = R/√5`.
///
/// `F_ref` is `strength` for every pair, or grows with a power of the harmonic mean radius:
///
/// ```text
/// F_ref = strength [2 a_i a_j / (a_i + a_j)]^n
/// ```
///
/// A wall is the limit of a large second sphere, with the sphere's own radius in place of the mean: the force on a
/// sphere at a gap `h` is `F_ref [1 - h/(range a)]²`, with a harmonic mean radius of `2 a`.
///
/// Surface forces have `n = 1` (Derjaguin); the force with which shear presses a pair together grows with `n = 2`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Barrier {
    strength: f64,
    range: f64,
    radius_power: u8,
}

/// An invalid parameter of the barrier.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum BarrierError {
    /// The force at contact is negative or not finite.
    #[error(
        "barrier strength is {}; it is the repulsive force at contact: give a finite number, 0 or more",
        Number(*.0)
    )]
    Strength(f64),
    /// The activation gap is not a positive number up to 1.
    #[error(
        "barrier range is {}; it is the gap at activation over the mean radius: give a number above 0, at most 1",
        Number(*.0)
    )]
    Range(f64),
}

impl Barrier {
    /// Activation gap over the mean radius if only the barrier keeps spheres apart.
    pub const RANGE_ALONE: f64 = 0.1;
    /// Activation gap over the mean radius together with lubrication.
    pub const RANGE_WITH_LUBRICATION: f64 = 0.025;

    /// Barrier with the force `strength` at contact, for every pair, that starts at a gap of `range` mean radii.
    pub fn new(strength: f64, range: f64) -> Result<Self, BarrierError> {
        if !(strength.is_finite() && strength >= 0.0) {
            return Err(BarrierError::Strength(strength));
        }
        if !(range > 0.0 && range <= 1.0) {
            return Err(BarrierError::Range(range));
        }
        Ok(Self { strength, range, radius_power: 0 })
    }

    /// The same with a force at contact that grows with a power of the harmonic mean radius; `strength` is the force
    /// at a mean of 1.
    #[must_use]
    pub fn growing(self, radius_power: u8) -> Self {
        Self { radius_power, ..self }
    }

    /// Force at contact of two spheres, `F_ref`.
    pub fn strength(&self, between: impl Into<PairKind>) -> f64 {
        self.strength * between.into().harmonic_radius().powi(self.radius_power.into())
    }

    /// Activation gap over the mean radius.
    pub fn range(&self) -> f64 {
        self.range
    }

    /// Distance of the centres, or of the centre from a wall, at which the barrier starts.
    pub fn reach(&self, between: impl Into<PairKind>) -> f64 {
        between.into().at_gap(self.range)
    }

    /// Decrease of the force with the gap, `-dF/dr`: zero beyond the range, and negative deep in an overlap, where
    /// the force decreases with it.
    pub fn stiffness(&self, gap: f64, between: impl Into<PairKind>) -> f64 {
        let radii = match between.into() {
            PairKind::Spheres(radii) => radii,
            wall @ PairKind::Wall(radius) => {
                return 2.0 * self.strength(wall) * self.depth_at_wall(gap, radius) / (self.range * radius);
            }
        };
        let (contact, reach_squared) = (radii[0] + radii[1], self.reach(radii).powi(2));
        let (distance, width) = (contact + gap, reach_squared - contact * contact);
        let depth = (reach_squared - distance * distance) / width;
        if depth <= 0.0 {
            return 0.0;
        }
        self.strength(radii) / contact * depth * (4.0 * distance * distance / width - depth).max(0.0)
    }

    /// Depth of a sphere in the barrier of a wall, over the range.
    fn depth_at_wall(&self, gap: f64, radius: f64) -> f64 {
        (1.0 - gap / (self.range * radius)).max(0.0)
    }

    /// Force on the first sphere; `separation` is `x_j - x_i`, or points from the sphere's centre to the nearest
    /// point of a wall. The force on the second sphere is opposite.
    pub fn force(&self, separation: Vector, between: impl Into<PairKind>) -> Vector {
        let radii = match between.into() {
            PairKind::Spheres(radii) => radii,
            wall @ PairKind::Wall(radius) => {
                let distance = separation.length();
                let depth = self.depth_at_wall(distance - radius, radius);
                return -self.strength(wall) * depth * depth / distance * separation;
            }
        };
        let reach_squared = self.reach(radii).powi(2);
        let distance_squared = separation.length_squared();
        if distance_squared >= reach_squared {
            return Vector::ZERO;
        }
        let contact = radii[0] + radii[1];
        let depth = (reach_squared - distance_squared) / (reach_squared - contact * contact);
        -self.strength(radii) / contact * depth * depth * separation
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn force_at_contact_is_the_strength() {
        let barrier = Barrier::new(3.0, 0.1).unwrap();
        let force = barrier.force(Vector::new(0.0, 3.0, 0.0), [1.0, 2.0]);
        assert!((force - Vector::new(0.0, -3.0, 0.0)).length() < 1e-14);
    }

    #[test]
    fn equal_spheres_follow_equation_13() {
        // a = 1, R_ref = 2.1, r = 2.05: (2.1² - 2.05²) / (2.1² - 4) = 0.2075/0.41.
        let force = Barrier::new(1.0, 0.1).unwrap().force(Vector::new(2.05, 0.0, 0.0), [1.0, 1.0]);
        assert!((force.x + 0.5 * (0.2075_f64 / 0.41).powi(2) * 2.05).abs() < 1e-13);
    }

    #[test]
    fn force_is_zero_from_the_reach_on_and_starts_smoothly() {
        let barrier = Barrier::new(1.0, 0.025).unwrap();
        let reach = barrier.reach([1.0, 1.5]);
        assert_eq!(barrier.force(Vector::new(0.0, 0.0, reach), [1.0, 1.5]), Vector::ZERO);
        let slight = barrier.force(Vector::new(0.0, 0.0, reach - 1e-6), [1.0, 1.5]).length();
        assert!(slight > 0.0 && slight < 1e-8);
    }

    #[test]
    fn overlap_pushes_harder_than_contact() {
        let barrier = Barrier::new(1.0, 0.1).unwrap();
        assert!(barrier.force(Vector::new(1.9, 0.0, 0.0), [1.0, 1.0]).length() > 1.0);
    }

    #[test]
    fn strength_grows_with_a_power_of_the_harmonic_mean_radius() {
        let barrier = Barrier::new(5.0, 0.1).unwrap();
        for (power, expected) in [(0, 5.0), (1, 15.0), (2, 45.0)] {
            let force = barrier.growing(power).force(Vector::new(0.0, 8.0, 0.0), [2.0, 6.0]);
            assert!((force - Vector::new(0.0, -expected, 0.0)).length() < 1e-13, "power {power}: {force}");
        }
    }

    #[test]
    fn stiffness_is_the_slope_of_the_force() {
        let (barrier, radii, step) = (Barrier::new(3.0, 0.1).unwrap().growing(2), [1.0, 1.5], 1e-6);
        for gap in [0.0, 0.03, 0.1] {
            let force = |gap: f64| barrier.force(Vector::new(2.5 + gap, 0.0, 0.0), radii).length();
            let slope = (force(gap - step) - force(gap + step)) / (2.0 * step);
            assert!((barrier.stiffness(gap, radii) - slope).abs() < 1e-6 * slope, "gap {gap}");
        }
        let nowhere = [0.2, -2.0].map(|gap| barrier.stiffness(gap, radii));
        assert!(nowhere.iter().all(|&k| k == 0.0), "beyond its reach, and deep in an overlap: {nowhere:?}");
    }

    /// Spheres of growing radius, with the range scaled to the growing mean radius, converge to the wall.
    #[test]
    fn a_wall_is_a_large_sphere() {
        let (large, range) = (1e7, 0.1);
        for power in [0, 1, 2] {
            let wall = Barrier::new(3.0, range).unwrap().growing(power);
            let sphere = Barrier::new(3.0, range * 2.0 / (1.0 + large)).unwrap().growing(power);
            for gap in [-0.02, 0.0, 0.03, 0.0999, 0.2] {
                let [at_wall, at_sphere] = [
                    wall.force(Vector::Z * (1.0 + gap), PairKind::Wall(1.0)),
                    sphere.force(Vector::Z * (1.0 + large + gap), [1.0, large]),
                ];
                // Error of the ratio of the radii, and round-off of the large distance.
                assert!((at_wall - at_sphere).length() < 1e-5, "gap {gap}: {at_wall}, not {at_sphere}");
                let stiffness = [wall.stiffness(gap, PairKind::Wall(1.0)), sphere.stiffness(gap, [1.0, large])];
                assert!((stiffness[0] - stiffness[1]).abs() < 1e-4, "gap {gap}: {stiffness:?}");
            }
        }
    }

    #[test]
    fn action_equals_reaction() {
        let barrier = Barrier::new(2.0, 0.1).unwrap();
        let separation = Vector::new(0.3, 2.4, 0.4);
        assert_eq!(barrier.force(separation, [1.0, 1.5]), -barrier.force(-separation, [1.5, 1.0]));
    }

    #[test]
    fn refuses_senseless_parameters() {
        assert!(matches!(Barrier::new(f64::NAN, 0.1), Err(BarrierError::Strength(_))));
        assert_eq!(Barrier::new(-1.0, 0.1), Err(BarrierError::Strength(-1.0)));
        assert_eq!(Barrier::new(1.0, 0.0), Err(BarrierError::Range(0.0)));
        assert!(Barrier::new(1.0, f64::INFINITY).unwrap_err().to_string().contains("at most 1"));
    }
}
