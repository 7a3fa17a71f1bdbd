//! Forces between the surfaces of two spheres, along their line of centres.

use crate::barrier::Barrier;
use crate::pair_kind::PairKind;
use domain::Vector;
use std::f64::consts::PI;

/// Force between two spheres of radii `a_i` and `a_j` at a gap `h` between their surfaces, with the mean radius `a`
/// and the harmonic mean `a_h = 2 a_i a_j / (a_i + a_j)`; a repulsion has a positive sign. It may also act between a
/// sphere and a wall (see [`PairKind`]).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SurfaceForce {
    /// Barrier of the force-coupling method.
    Barrier(Barrier),
    /// Screened electrostatic repulsion of charged spheres in an electrolyte with thin double layers (Derjaguin),
    ///
    /// ```text
    /// F = strength a_h^n exp(-h / length)       up to 16 lengths
    /// ```
    Screened {
        /// Force at contact at a harmonic mean radius of 1.
        strength: f64,
        /// Power of that radius.
        radius_power: u8,
        /// Debye length.
        length: f64,
    },
    /// Van der Waals attraction at small gaps (Derjaguin; Hamaker, Physica 4, 1058, 1937), bounded by a gap
    /// `h_0 = closest a`,
    ///
    /// ```text
    /// F = -(hamaker a_h / 12) / (h + h_0)^2
    /// ```
    ///
    /// minus its value at the gap `range a`, where it ends.
    VanDerWaals {
        /// Hamaker constant, an energy.
        hamaker: f64,
        /// `h_0 / a`
        closest: f64,
        /// Gap at which it ends, over `a`.
        range: f64,
    },
    /// Depletion attraction by small spheres that are excluded from between two large ones (Asakura & Oosawa, J.
    /// Chem. Phys. 22, 1255, 1954): their osmotic pressure times the area of the circle in which the two exclusion
    /// shells intersect,
    ///
    /// ```text
    /// F = -pressure pi rho^2,   rho^2 = R_i^2 - [(r^2 + R_i^2 - R_j^2) / (2 r)]^2,   R = a + thickness
    /// ```
    Depletion {
        /// Osmotic pressure of the small spheres.
        pressure: f64,
        /// Radius of the small spheres.
        thickness: f64,
    },
}

/// Cutoff of the screened repulsion in Debye lengths, where it is 1e-7 of its value at contact.
const LENGTHS: f64 = 16.0;

impl SurfaceForce {
    /// Distance of the centres, or of the centre from a wall, up to which it acts.
    pub fn reach(&self, between: impl Into<PairKind>) -> f64 {
        let between = between.into();
        let contact = between.contact();
        match self {
            Self::Barrier(barrier) => barrier.reach(between),
            Self::Screened { length, .. } => contact + LENGTHS * length,
            Self::VanDerWaals { range, .. } => between.at_gap(*range),
            Self::Depletion { thickness, .. } => contact + 2.0 * thickness,
        }
    }

    /// Force on the first sphere; `separation` is `x_j - x_i`, or points from the sphere's centre to the nearest
    /// point of a wall. The force on the second sphere is opposite.
    pub fn force(&self, separation: Vector, between: impl Into<PairKind>) -> Vector {
        let between = between.into();
        if let Self::Barrier(barrier) = self {
            return barrier.force(separation, between);
        }
        let distance = separation.length();
        if distance >= self.reach(between) {
            return Vector::ZERO;
        }
        separation * (-self.magnitude_and_slope(distance, between)[0] / distance)
    }

    /// Decrease of the force with the distance, `-dF/dr`, if positive; else 0.
    pub fn stiffness(&self, gap: f64, between: impl Into<PairKind>) -> f64 {
        let between = between.into();
        if let Self::Barrier(barrier) = self {
            return barrier.stiffness(gap, between);
        }
        let distance = between.contact() + gap;
        if distance >= self.reach(between) { 0.0 } else { (-self.magnitude_and_slope(distance, between)[1]).max(0.0) }
    }

    /// Force and its derivative by the distance of the centres, within reach.
    fn magnitude_and_slope(&self, distance: f64, between: PairKind) -> [f64; 2] {
        let (mean, harmonic) = (between.mean_radius(), between.harmonic_radius());
        let gap = distance - between.contact();
        match *self {
            Self::Barrier(_) => unreachable!("a barrier has its own"),
            Self::Screened { strength, radius_power, length } => {
                let force = strength * harmonic.powi(radius_power.into()) * (-gap / length).exp();
                [force, -force / length]
            }
            Self::VanDerWaals { hamaker, closest, range } => {
                let (factor, at_end) = (hamaker * harmonic / 12.0, (range + closest) * mean);
                // Overlapping spheres attract each other as at contact.
                let (apart, is_apart) = (gap.max(0.0) + closest * mean, f64::from(u8::from(gap > 0.0)));
                [factor * (at_end.powi(-2) - apart.powi(-2)), is_apart * 2.0 * factor * apart.powi(-3)]
            }
            Self::Depletion { pressure, thickness } => {
                let PairKind::Spheres(radii) = between else {
                    // The exclusion shell of the wall ends in a plane.
                    let (shell, along) = (between.contact() + thickness, distance - thickness);
                    return [-pressure * PI * (shell * shell - along * along).max(0.0), pressure * PI * 2.0 * along];
                };
                let [first, second] = radii.map(|radius| (radius + thickness).powi(2));
                let along = (distance * distance + first - second) / (2.0 * distance);
                let slope = (distance * distance - first + second) / (2.0 * distance * distance);
                [-pressure * PI * (first - along * along).max(0.0), pressure * PI * 2.0 * along * slope]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RADII: [f64; 2] = [1.0, 1.7];

    fn all() -> [SurfaceForce; 4] {
        [
            SurfaceForce::Barrier(Barrier::new(3.0, 0.2).unwrap()),
            SurfaceForce::Screened { strength: 3.0, radius_power: 1, length: 0.05 },
            SurfaceForce::VanDerWaals { hamaker: 0.6, closest: 0.01, range: 0.5 },
            SurfaceForce::Depletion { pressure: 2.0, thickness: 0.15 },
        ]
    }

    fn along(force: &SurfaceForce, gap: f64) -> f64 {
        -force.force(Vector::X * (RADII[0] + RADII[1] + gap), RADII).x
    }

    /// A wall of radius 1e7, with lengths that do not scale with the mean radius.
    #[test]
    fn a_wall_is_a_large_sphere() {
        let (large, unit) = (1e7, 2.0 / (1e7 + 1.3));
        let attraction =
            |unit: f64| SurfaceForce::VanDerWaals { hamaker: 0.6, closest: 0.01 * unit, range: 0.5 * unit };
        let [_, screened, _, depletion] = all();
        for (wall, sphere) in [(screened, screened), (attraction(1.0), attraction(1.3 * unit)), (depletion, depletion)]
        {
            for gap in [0.0, 0.05, 0.2, 0.7] {
                let at_wall = wall.force(Vector::X * (1.3 + gap), PairKind::Wall(1.3)).x;
                let at_sphere = sphere.force(Vector::X * (1.3 + large + gap), [1.3, large]).x;
                assert!((at_wall - at_sphere).abs() < 1e-4 * (0.1 + at_wall.abs()), "{wall:?}: {at_wall}, {at_sphere}");
                let [a, b] = [wall.stiffness(gap, PairKind::Wall(1.3)), sphere.stiffness(gap, [1.3, large])];
                assert!((a - b).abs() < 1e-4 * (0.1 + a), "{wall:?}: {a}, {b}");
            }
        }
    }

    #[test]
    fn values_at_contact_are_those_of_the_formulae() {
        let harmonic = 2.0 * 1.7 / 2.7;
        let shells = [1.15_f64, 1.85];
        let area = PI * (shells[0].powi(2) - ((2.7_f64.powi(2) + shells[0].powi(2) - shells[1].powi(2)) / 5.4).powi(2));
        let attraction = -0.6 * harmonic / 12.0 * ((0.01_f64 * 1.35).powi(-2) - (0.51_f64 * 1.35).powi(-2));
        for (force, expected) in all().iter().zip([3.0, 3.0 * harmonic, attraction, -2.0 * area]) {
            assert!((along(force, 0.0) / expected - 1.0).abs() < 1e-12, "{force:?}");
        }
    }

    /// The area of the shells' intersection is minus the derivative of their common volume, which is two caps.
    #[test]
    fn depletion_is_the_slope_of_the_common_volume() {
        let common = |gap: f64| {
            let ([a, b], d) = ([1.15_f64, 1.85], 2.7 + gap);
            PI * (a + b - d).powi(2) * (d * d + 2.0 * d * (a + b) - 3.0 * (a - b).powi(2)) / (12.0 * d)
        };
        let force = all()[3];
        for gap in [0.0, 0.1, 0.25] {
            let slope = (common(gap + 1e-5) - common(gap - 1e-5)) / 2e-5;
            assert!((along(&force, gap) / (2.0 * slope) - 1.0).abs() < 1e-6, "{gap}");
        }
    }

    #[test]
    fn forces_end_where_they_reach_and_stiffness_is_their_slope() {
        for force in all() {
            let end = force.reach(RADII) - 2.7;
            assert!(along(&force, end * (1.0 + 1e-12)) == 0.0 && along(&force, 0.999 * end).abs() < 0.02, "{force:?}");
            for gap in [0.02, 0.1, 0.9 * end] {
                let slope = (along(&force, gap + 1e-6) - along(&force, gap - 1e-6)) / 2e-6;
                let stiffness = force.stiffness(gap, RADII);
                assert!((stiffness - (-slope).max(0.0)).abs() < 1e-6 * (1.0 + slope.abs()), "{force:?} at {gap}");
                let turned = SurfaceForce::force(&force, Vector::Y * (2.7 + gap), [RADII[1], RADII[0]]);
                assert!((turned + Vector::Y * along(&force, gap)).length() < 1e-12);
            }
        }
    }
}
