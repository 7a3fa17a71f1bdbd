//! Time of contact of two grains, and time at which a grain reaches a plane.

use domain::Vector;

/// The separation of two grains at one time and its motion from then on: `r + w t + a t^2/2`.
#[derive(Debug, Clone, Copy, Default)]
pub struct RelativeFlight {
    /// Vector from the first to the second grain.
    pub separation: Vector,
    /// Relative velocity.
    pub velocity: Vector,
    /// Relative acceleration.
    pub acceleration: Vector,
}

/// Diameter of the grains at one time, and its growth rate.
#[derive(Debug, Clone, Copy)]
pub struct GrowingDiameter {
    pub diameter: f64,
    pub growth: f64,
}

/// Round-off of the squared distance at contact, over the squared diameter.
const TOUCH: f64 = 1e-13;

/// A pair without relative acceleration, with a growing diameter: the squared distance minus the squared
/// diameter is `c + 2 b t + a t^2`.
#[derive(Debug, Clone, Copy, Default)]
pub struct StraightFlight {
    pub a: f64,
    pub b: f64,
    pub c: f64,
}

impl StraightFlight {
    #[inline]
    pub fn new(r: Vector, w: Vector, GrowingDiameter { diameter, growth }: GrowingDiameter) -> Self {
        Self {
            a: w.length_squared() - growth * growth,
            b: r.dot(w) - diameter * growth,
            c: f64::max(r.length_squared() - diameter * diameter, 0.0),
        }
    }

    /// Whether the two grains may meet; `false` is certain.
    #[inline]
    #[expect(clippy::needless_bitwise_bool, reason = "half of all pairs pass each test: a branch is guessed wrong")]
    pub fn may_meet(&self) -> bool {
        (self.b < 0.0 || self.a < 0.0) & (self.b * self.b >= self.a * self.c)
    }

    /// Time at which they touch while approaching, the smallest root, later than 0 if `b >= 0`: zero if they overlap by
    /// round-off and approach.
    #[inline]
    pub fn time(&self) -> Option<f64> {
        let Self { a, b, c } = *self;
        let d = b * b - a * c;
        if d < 0.0 || (b >= 0.0 && a >= 0.0) {
            None
        } else if b < 0.0 {
            Some(c / (d.sqrt() - b))
        } else {
            Some((b + d.sqrt()) / -a)
        }
    }
}

impl RelativeFlight {
    /// Squared distance minus squared diameter, half its rate, and half the minimum of its second derivative within a
    /// window: a parabola that is a lower bound.
    #[inline]
    fn below(&self, diameter: f64, window: f64) -> StraightFlight {
        let Self { separation: r, velocity: w, acceleration: g } = *self;
        StraightFlight {
            a: w.length_squared() + r.dot(g) + f64::min(0.0, 3.0 * w.dot(g) * window),
            b: r.dot(w),
            c: f64::max(r.length_squared() - diameter * diameter, 0.0),
        }
    }

    /// Whether the two grains may meet within the window; `false` is certain.
    #[inline]
    pub fn may_meet(&self, diameter: f64, window: f64) -> bool {
        self.below(diameter, window).may_meet()
    }

    fn after(&self, t: f64) -> Self {
        let velocity = self.velocity + self.acceleration * t;
        Self { separation: self.separation + (self.velocity + velocity) * (0.5 * t), velocity, ..*self }
    }
}

/// Time of contact of two grains with a relative acceleration. The squared distance is a quartic `f(t)`. From any
/// time on, `f` stays above the parabola `f + f' t + m t^2/2` with `m` the minimum of `f''` in the window; the first
/// root of the parabola is reached without passing a contact, and the next parabola starts there. Without
/// acceleration the first parabola is exact.
pub fn curved_contact_time(start: &RelativeFlight, diameter: f64, window: f64) -> Option<f64> {
    let mut elapsed = 0.0;
    // Each parabola squares the error; sixty are for grazing contacts, where the roots are nearly double.
    for _ in 0..60 {
        let left = window - elapsed;
        let parabola = start.after(elapsed).below(diameter, left);
        let StraightFlight { b, c, .. } = parabola;
        if b < 0.0 && c < if elapsed > 0.0 { TOUCH * diameter * diameter } else { f64::MIN_POSITIVE } {
            break;
        }
        match parabola.time() {
            Some(step) if step <= left => elapsed += step,
            _ => return None,
        }
    }
    Some(elapsed)
}

/// First time, not before 0, at which a point at `distance` from a plane reaches it while moving toward it, with
/// speed `v` and acceleration `a` toward the plane. A distance that is negative by round-off counts as zero.
#[inline]
pub fn time_to_plane(distance: f64, v: f64, a: f64) -> f64 {
    let d = f64::max(distance, 0.0);
    let square = v * v + 2.0 * a * d;
    if square < 0.0 {
        f64::INFINITY
    } else if v > 0.0 {
        2.0 * d / (v + square.sqrt())
    } else if a > 0.0 {
        (square.sqrt() - v) / a
    } else {
        f64::INFINITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn straight_flights_meet_where_the_quadratic_says() {
        let v = Vector::new;
        let straight = |r, w, [diameter, growth]: [f64; 2]| {
            let pair = StraightFlight::new(r, w, GrowingDiameter { diameter, growth });
            assert!(pair.may_meet() || pair.time().is_none());
            pair.time()
        };
        // Head-on, from 3 apart at speed 2 with diameter 1; also growing at 0.5; passing by; separating.
        assert_eq!(straight(v(3.0, 0.0, 0.0), v(-2.0, 0.0, 0.0), [1.0, 0.0]), Some(1.0));
        assert_eq!(straight(v(3.0, 0.0, 0.0), v(-2.0, 0.0, 0.0), [1.0, 0.5]), Some(0.8));
        assert_eq!(straight(v(3.0, 1.1, 0.0), v(-2.0, 0.0, 0.0), [1.0, 0.0]), None);
        assert_eq!(straight(v(3.0, 0.0, 0.0), v(2.0, 0.0, 0.0), [1.0, 0.0]), None);
        // Separating at 1, growing at 2: they meet when 1 + 2t = 3 + t.
        assert_eq!(straight(v(3.0, 0.0, 0.0), v(1.0, 0.0, 0.0), [1.0, 2.0]), Some(2.0));
        // In contact: approaching ones collide now, separating ones never.
        assert_eq!(straight(v(1.0 - 1e-16, 0.0, 0.0), v(-1.0, 0.3, 0.0), [1.0, 0.0]), Some(0.0));
        assert_eq!(straight(v(1.0 - 1e-16, 0.0, 0.0), v(1.0, 0.3, 0.0), [1.0, 0.0]), None);
    }

    #[test]
    fn planes_are_reached_where_the_parabola_says() {
        assert!((time_to_plane(1.0, 2.0, 0.0) - 0.5).abs() < 1e-15);
        // Thrown up at 3 under gravity 10: reaches the plane 0.4 above at 0.2, the one 1 above never, and the
        // starting height again at 0.6.
        assert!((time_to_plane(0.4, 3.0, -10.0) - 0.2).abs() < 1e-15);
        assert!(time_to_plane(1.0, 3.0, -10.0).is_infinite());
        assert!((time_to_plane(0.0, -3.0, 10.0) - 0.6).abs() < 1e-15);
    }

    proptest! {
        /// Comparison with the first sign change on a fine grid of times.
        #[test]
        fn curved_flights_meet_at_the_first_root(
            r in prop::array::uniform3(-2.0..2.0), w in prop::array::uniform3(-3.0..3.0),
            a in prop::array::uniform3(-4.0..4.0),
        ) {
            let (r, w, a) = (Vector::from(r), Vector::from(w), Vector::from(a));
            prop_assume!(r.length() > 1.0);
            let gap = |t: f64| (r + w * t + a * (0.5 * t * t)).length() - 1.0;
            let steps = 4000;
            let crossing = (0..=steps).map(|k| f64::from(k) / f64::from(steps)).find(|&t| gap(t) < 0.0);
            let found = curved_contact_time(&RelativeFlight { separation: r, velocity: w, acceleration: a }, 1.0, 1.0);
            match (found, crossing) {
                (Some(t), Some(c)) =>
                    prop_assert!(t <= c && c - t < 1.0 / f64::from(steps) + 1e-9 && gap(t).abs() < 1e-12),
                // The grid may step over a contact shorter than its spacing.
                (Some(t), None) => prop_assert!(gap(t).abs() < 1e-12),
                (None, Some(c)) => prop_assert!(false, "missed the contact at {c}"),
                (None, None) => {}
            }
        }
    }
}
