//! Law of the induced moment of a sphere, and its linearisation.

use domain::Vector;

/// Induced moment of a sphere in the field `h` in it: `alpha h` with the polarisability `alpha`, or up to a largest
/// moment `m_s` by the law of Froehlich (1881) and Kennelly (1891),
///
/// ```text
/// m(h) = alpha h / (1 + u),    u = alpha |h| / m_s.
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Magnetisation {
    /// `alpha`; 0 without an induced moment.
    pub polarisability: f64,
    /// `m_s`; infinite for a moment in proportion to the field.
    pub saturation: f64,
}

impl Magnetisation {
    /// The moment in a field.
    pub fn moment(&self, field: Vector) -> Vector {
        field * (self.polarisability / (1.0 + self.excess(field)))
    }

    /// The moment of a sphere alone in an applied field `H_0`, in which `h = H_0 - m / (4 pi a^3)`, with `1 / (4 pi
    /// a^3)` as `own`: the positive root of a quadratic equation for `h`.
    pub fn moment_alone(&self, applied: Vector, own: f64) -> Vector {
        let (alpha, size) = (self.polarisability, applied.length());
        if !self.saturates() || size == 0.0 {
            return applied * (alpha / (1.0 + alpha * own));
        }
        let bend = alpha / self.saturation;
        let linear = 1.0 + alpha * own - bend * size;
        let root = (linear * linear + 4.0 * bend * size).sqrt();
        // Neither form cancels.
        let inside = if linear > 0.0 { 2.0 * size / (linear + root) } else { (root - linear) / (2.0 * bend) };
        self.moment(applied * (inside / size))
    }

    /// Whether there is a largest moment.
    pub fn saturates(&self) -> bool {
        self.saturation.is_finite() && self.polarisability != 0.0
    }

    /// `u`
    fn excess(&self, field: Vector) -> f64 {
        if self.saturates() { self.polarisability * field.length() / self.saturation } else { 0.0 }
    }

    /// The law near a field: that of its tangent, or in proportion to the field. The sphere has an induced moment, with
    /// a positive polarisability if it saturates.
    pub(super) fn linearised(&self, field: Vector, is_tangent: bool) -> LinearLaw {
        let (inverse, excess) = (1.0 / self.polarisability.abs(), 1.0 + self.excess(field));
        let across = inverse * excess;
        if !is_tangent || !self.saturates() || field == Vector::ZERO {
            return LinearLaw { across, ..LinearLaw::NONE };
        }
        let axis = field.normalize();
        LinearLaw { axis, across, more: across * (excess - 1.0), offset: field * (excess - 1.0) }
    }
}

/// Law `T^-1 m = h + offset` with `T^-1 = across I + more axis axis`.
#[derive(Debug, Clone, Copy)]
pub(super) struct LinearLaw {
    axis: Vector,
    across: f64,
    more: f64,
    pub offset: Vector,
}

impl LinearLaw {
    /// The law of a sphere without an induced moment, which no one applies.
    pub const NONE: Self = Self { axis: Vector::ZERO, across: 0.0, more: 0.0, offset: Vector::ZERO };

    /// `T^-1 m`
    pub fn field(&self, moment: Vector) -> Vector {
        moment * self.across + self.axis * (self.more * self.axis.dot(moment))
    }

    /// `(T^-1 + own)^-1 h`
    pub fn alone(&self, field: Vector, own: f64) -> Vector {
        let across = 1.0 / (self.across + own);
        let along = 1.0 / (self.across + self.more + own);
        field * across + self.axis * ((along - across) * self.axis.dot(field))
    }

    /// `m . (T^-1 + own) m`
    pub fn size(&self, moment: Vector, own: f64) -> f64 {
        moment.dot(self.field(moment) + moment * own)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// A sphere of radius 1 with the susceptibility `chi` and the saturation magnetisation `most`.
    fn sphere(chi: f64, most: f64) -> Magnetisation {
        let volume = 4.0 / 3.0 * PI;
        Magnetisation { polarisability: volume * chi, saturation: volume * most }
    }

    /// A linearisation has the value and the slope of the law.
    #[test]
    fn the_tangent_touches_the_law() {
        let (law, field, step) = (sphere(30.0, 2.0), Vector::new(0.3, -0.1, 0.2), 1e-5);
        let tangent = law.linearised(field, true);
        assert!((tangent.field(law.moment(field)) - field - tangent.offset).length() < 1e-14);
        for axis in Vector::AXES {
            let slope = (law.moment(field + axis * step) - law.moment(field - axis * step)) / (2.0 * step);
            assert!((tangent.field(slope) - axis).length() < 1e-8);
            assert!((tangent.alone(tangent.field(axis) + axis * 0.7, 0.7) - axis).length() < 1e-14);
        }
        let chord = law.linearised(field, false);
        assert!((chord.field(law.moment(field)) - field).length() < 1e-15 && chord.offset == Vector::ZERO);
    }

    #[test]
    fn a_sphere_alone_is_in_the_field_that_its_moment_leaves() {
        let own = 1.0 / (4.0 * PI);
        for (chi, most, size) in [(0.5, 1.0, 0.3), (1e4, 2.0, 0.1), (1e4, 2.0, 0.7), (1e4, 2.0, 50.0), (3.0, 1e9, 1.0)]
        {
            let (law, applied) = (sphere(chi, most), Vector::new(0.6, 0.0, 0.8) * size);
            let moment = law.moment_alone(applied, own);
            let inside = applied - moment * own;
            assert!((law.moment(inside) - moment).length() < 1e-9 * moment.length(), "{chi} {most} {size}");
            assert!(moment.length() < law.saturation && moment.dot(applied) > 0.0);
        }
        // Half of the saturation at u = 1; no moment without a field.
        let law = sphere(8.0, 4.0);
        assert!((law.moment(Vector::X * 0.5).length() / law.saturation - 0.5).abs() < 1e-15);
        assert_eq!(law.moment_alone(Vector::ZERO, own), Vector::ZERO);
    }
}
