//! The collision rule of eqs (16) to (23), the same for both engines.
//!
//! Impulses are per mass of a grain. A grain is a uniform sphere with the moment of inertia `J = 2/5 m R^2`.

use super::Side;
use domain::Vector;

/// Moment of inertia over `m R^2`.
pub const INERTIA: f64 = 0.4;

/// Translational and angular velocity of a grain.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GrainMotion {
    /// Velocity of the centre.
    pub velocity: Vector,
    /// Angular velocity.
    pub spin: Vector,
}

/// Coulomb's bound on the two tangential components at a wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FrictionLaw {
    /// On each component separately, as in eq. (20): up to `sqrt 2` times the friction cone in all.
    #[default]
    Box,
    /// On both components together.
    Cone,
}

/// Collision parameters of two surfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CollisionRule {
    /// Coefficient of restitution.
    pub restitution: f64,
    /// Coefficient of friction.
    pub friction: f64,
    /// Bound on friction at a wall; two grains always slide along the line of their slip.
    pub law: FrictionLaw,
}

/// Conditions on the speed of separation after a collision; zero for grains that do not grow.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Rebound {
    /// Growth rate of the distance at contact.
    pub growth: f64,
    /// Smallest speed of separation.
    pub least: f64,
}

/// A wall at the time of a collision.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallContact {
    /// The wall.
    pub side: Side,
    /// Its velocity.
    pub velocity: Vector,
    /// Mass of a grain over that of the wall along the normal: 0 for a fixed wall.
    pub mass_ratio: f64,
}

impl GrainMotion {
    /// Kinetic energy per mass of a grain of radius `radius`.
    pub fn energy(&self, radius: f64) -> f64 {
        0.5 * (self.velocity.length_squared() + INERTIA * radius * radius * self.spin.length_squared())
    }

    /// Velocity of the surface at `arm` from the centre.
    fn surface(&self, arm: Vector) -> Vector {
        self.velocity + self.spin.cross(arm)
    }

    /// Applies an impulse per mass at `arm` from the centre.
    fn push(&mut self, impulse: Vector, arm: Vector) {
        self.velocity += impulse;
        self.spin += arm.cross(impulse) / (INERTIA * arm.length_squared());
    }
}

impl CollisionRule {
    /// Collision of two equal grains of radius `radius` along the unit vector `n` from the first to the second:
    ///
    /// ```text
    /// Jn = (1 + e)(g - vn)/2,   Jt = min(mu Jn, |s|/7),   speed of separation at least `least`
    /// ```
    ///
    /// with `vn` the rate at which their centres separate, `g` the growth rate of their diameter, and `s` the slip
    /// between their surfaces. Returns the impulse on the second grain, per mass.
    pub fn strike_pair(&self, pair: [&mut GrainMotion; 2], n: Vector, radius: f64, rebound: Rebound) -> Vector {
        let [a, b] = pair;
        let arm = n * radius;
        let approach = rebound.growth - (b.velocity - a.velocity).dot(n);
        let normal = 0.5 * (approach + f64::max(self.restitution * approach, rebound.least));
        let slip = a.surface(arm) - b.surface(-arm);
        let slip = slip - n * slip.dot(n);
        let speed = slip.length();
        let along = if speed > 0.0 { slip * (f64::min(self.friction * normal, speed / 7.0) / speed) } else { slip };
        let impulse = n * normal + along;
        a.push(-impulse, arm);
        b.push(impulse, -arm);
        impulse
    }

    /// Collision of a grain of radius `radius` with a wall: `vn -> -e vn` relative to the wall, and for each tangential
    /// component `Ji = min(mu Jn, 2/7 |si|)` against the slip `si` (or both together for the cone); a wall that is free
    /// to move along its normal recoils, `Jn = (1 + e)|vn| / (1 + m/M)`. Returns the impulse on the grain, per mass.
    pub fn strike_wall(&self, grain: &mut GrainMotion, wall: &WallContact, radius: f64, rebound: Rebound) -> Vector {
        let n = wall.side.normal();
        let arm = -n * radius;
        let approach = rebound.growth - (grain.velocity - wall.velocity).dot(n);
        let normal = (approach + f64::max(self.restitution * approach, rebound.least)) / (1.0 + wall.mass_ratio);
        let slip = grain.surface(arm) - wall.velocity;
        let slip = slip - n * slip.dot(n);
        let stick = slip * (-2.0 / 7.0);
        let bound = self.friction * normal;
        let along = match self.law {
            FrictionLaw::Box => stick.clamp(Vector::splat(-bound), Vector::splat(bound)),
            FrictionLaw::Cone => stick.clamp_length_max(bound),
        };
        let impulse = n * normal + along;
        grain.push(impulse, arm);
        impulse
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const RADIUS: f64 = 0.4;
    const STILL: Rebound = Rebound { growth: 0.0, least: 0.0 };

    fn contact(friction: f64, law: FrictionLaw) -> CollisionRule {
        CollisionRule { restitution: 0.9, friction, law }
    }

    fn floor(speed: f64) -> WallContact {
        WallContact { side: Side::Bottom, velocity: Vector::X * speed, mass_ratio: 0.0 }
    }

    fn near(a: Vector, b: Vector) {
        assert!((a - b).length() < 1e-12, "{a} should be {b}");
    }

    /// v = (1, -2, 0.5), w = 0, e = 0.9: Jn = 3.8. Slip (1, 0, 0.5); sticking removes 2/7 of it; the bound is
    /// 0.19 with mu = 0.05.
    #[test]
    fn wall_hits_follow_the_closed_form() {
        let start = GrainMotion { velocity: Vector::new(1.0, -2.0, 0.5), spin: Vector::ZERO };
        let hit = |mu, law| {
            let mut grain = start;
            contact(mu, law).strike_wall(&mut grain, &floor(0.0), RADIUS, STILL);
            grain
        };
        let stuck = hit(0.3, FrictionLaw::Box);
        near(stuck.velocity, Vector::new(5.0 / 7.0, 1.8, 2.5 / 7.0));
        near(stuck.velocity + stuck.spin.cross(Vector::NEG_Y * RADIUS), Vector::new(0.0, 1.8, 0.0));
        assert_eq!(stuck, hit(0.3, FrictionLaw::Cone));
        let boxed = hit(0.05, FrictionLaw::Box);
        near(boxed.velocity, Vector::new(0.81, 1.8, 0.5 - 1.0 / 7.0));
        near(boxed.spin, Vector::new(1.0 / 7.0, 0.0, -0.19) / (INERTIA * RADIUS));
        let cone = hit(0.05, FrictionLaw::Cone);
        near(cone.velocity, Vector::new(1.0, 1.8, 0.5) - Vector::new(2.0, 0.0, 1.0) / 5f64.sqrt() * 0.19);
    }

    /// Galilean invariance: the same relative to a moving wall.
    #[test]
    fn a_moving_wall_is_a_wall_at_rest_seen_in_passing() {
        let mut still = GrainMotion { velocity: Vector::new(1.0, -2.0, 0.5), spin: Vector::new(0.3, 2.0, -1.0) };
        let mut moving = GrainMotion { velocity: still.velocity + Vector::X * 3.0, ..still };
        let rule = contact(0.1, FrictionLaw::Box);
        rule.strike_wall(&mut still, &floor(0.0), RADIUS, STILL);
        rule.strike_wall(&mut moving, &floor(3.0), RADIUS, STILL);
        near(still.velocity + Vector::X * 3.0, moving.velocity);
        near(still.spin, moving.spin);
    }

    /// A top wall of three grain masses: momentum along the normal is shared, the relative velocity is multiplied by
    /// -e.
    #[test]
    fn a_lid_with_mass_takes_its_share() {
        let mut grain = GrainMotion { velocity: Vector::Y * 2.0, spin: Vector::ZERO };
        let top_wall = WallContact { side: Side::Top, velocity: Vector::Y * -1.0, mass_ratio: 1.0 / 3.0 };
        let impulse = contact(0.0, FrictionLaw::Box).strike_wall(&mut grain, &top_wall, RADIUS, STILL);
        let after = top_wall.velocity - impulse * top_wall.mass_ratio;
        assert!((after.y - grain.velocity.y - 0.9 * 3.0).abs() < 1e-12);
        assert!((3.0 * after.y + grain.velocity.y + 1.0).abs() < 1e-12);
    }

    /// Head-on along x with a sideways slip of 1 between the surfaces: Jn = 1.9, sticking impulse 1/7.
    #[test]
    fn pair_hits_follow_the_closed_form() {
        let hit = |mu| {
            let mut a = GrainMotion { velocity: Vector::new(1.0, 1.0, 0.0), spin: Vector::ZERO };
            let mut b = GrainMotion { velocity: Vector::new(-1.0, 0.0, 0.0), spin: Vector::ZERO };
            contact(mu, FrictionLaw::Box).strike_pair([&mut a, &mut b], Vector::X, RADIUS, STILL);
            (a, b)
        };
        let (a, b) = hit(0.3);
        near(a.velocity, Vector::new(-0.9, 6.0 / 7.0, 0.0));
        near(b.velocity, Vector::new(0.9, 1.0 / 7.0, 0.0));
        near(a.spin, b.spin);
        near(a.spin, Vector::Z * (-1.0 / 7.0 / (INERTIA * RADIUS)));
        near(a.surface(Vector::X * RADIUS), Vector::new(-0.9, 0.5, 0.0));
        let (a, b) = hit(0.01);
        near(a.velocity, Vector::new(-0.9, 0.981, 0.0));
        near(b.velocity, Vector::new(0.9, 0.019, 0.0));
    }

    fn vectors() -> impl Strategy<Value = Vector> {
        prop::array::uniform3(-1.0..1.0).prop_map(Vector::from)
    }

    proptest! {
        #[test]
        fn pair_hits_keep_both_momenta_and_never_gain_energy(
            v in prop::array::uniform4(vectors()), n in vectors(), mu in 0.0..1.5, e in 0.0..1.0,
        ) {
            prop_assume!(n.length() > 0.1);
            let n = n.normalize();
            let mut a = GrainMotion { velocity: v[0], spin: v[1] * 3.0 };
            let mut b = GrainMotion { velocity: v[2], spin: v[3] * 3.0 };
            prop_assume!((b.velocity - a.velocity).dot(n) < 0.0);
            // About the point of contact: orbits of -n R and n R.
            let angular = |a: &GrainMotion, b: &GrainMotion| {
                (a.spin + b.spin) * INERTIA * RADIUS * RADIUS + (n * RADIUS).cross(b.velocity - a.velocity)
            };
            let before = (a.velocity + b.velocity, angular(&a, &b), a.energy(RADIUS) + b.energy(RADIUS));
            CollisionRule { restitution: e, friction: mu, law: FrictionLaw::Box }
                .strike_pair([&mut a, &mut b], n, RADIUS, STILL);
            prop_assert!((a.velocity + b.velocity - before.0).length() < 1e-12);
            prop_assert!((angular(&a, &b) - before.1).length() < 1e-12);
            prop_assert!(a.energy(RADIUS) + b.energy(RADIUS) <= before.2 + 1e-12);
        }

        #[test]
        fn a_wall_at_rest_never_gives_energy(v in vectors(), w in vectors(), mu in 0.0..1.5, cone in any::<bool>()) {
            let mut grain = GrainMotion { velocity: v - Vector::Y, spin: w * 3.0 };
            let before = grain.energy(RADIUS);
            let law = if cone { FrictionLaw::Cone } else { FrictionLaw::Box };
            contact(mu, law).strike_wall(&mut grain, &floor(0.0), RADIUS, STILL);
            prop_assert!(grain.energy(RADIUS) <= before + 1e-12);
        }
    }
}
