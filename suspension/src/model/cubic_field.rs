//! Lattice that repeats under uniaxial stretching.

use super::extension::Extremes;
use domain::{PeriodicBox, Vector};
use std::f64::consts::SQRT_2;

/// The lattice of the integers of the cubic field of `x^3 = x + 1`, with the real root `rho` and the complex root `z`,
/// `|z|^2 = 1 / rho`. It is spanned by the vectors with `k = 0, 1, -1` of
///
/// ```text
/// b_k = (rho^k, sqrt(2) Re z^k, sqrt(2) Im z^k),      b_(k+3) = b_(k+1) + b_k.
/// ```
///
/// Stretching by `rho` along the first axis, with contraction by `sqrt(rho)` across it, maps the lattice to itself up
/// to a rotation about that axis by the angle of `z`: each `b_k` becomes `b_(k+1)`. (The lattices of Dobson, J. Chem.
/// Phys. 141, 184103, 2014, repeat by two integer matrices, without a rotation.) The shortest vector is never shorter
/// than 1.027 times the edge of a cube of the same volume.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CubicField {
    rho: f64,
    angle: f64,
}

impl CubicField {
    /// The field with its roots.
    pub fn get() -> Self {
        let inner = (23.0_f64 / 108.0).sqrt();
        let rho = (0.5 + inner).cbrt() + (0.5 - inner).cbrt();
        // The three roots add up to zero.
        Self { rho, angle: (-0.5 * rho * rho.sqrt()).acos() }
    }

    /// Strain along the axis after which the lattice repeats.
    pub fn period(&self) -> f64 {
        self.rho.ln()
    }

    /// Argument of `z`.
    pub fn angle(&self) -> f64 {
        self.angle
    }

    /// The vectors `b_0`, `b_1` and `b_-1`, scaled to the volume of a cube of the given edge; the first component is
    /// along the axis.
    pub fn vectors(&self, edge: f64) -> [Vector; 3] {
        // The volume of the unscaled lattice is the square root of the discriminant.
        let scale = edge / 23.0_f64.sqrt().cbrt();
        [0.0, 1.0, -1.0].map(|k: f64| {
            let (sin, cos) = (k * self.angle).sin_cos();
            let across = SQRT_2 * self.rho.powf(-0.5 * k);
            Vector::new(self.rho.powf(k), across * cos, across * sin) * scale
        })
    }

    /// Extremes of the box of these vectors over strains from minus to plus half a period.
    pub fn extremes(&self) -> Extremes {
        let vectors = self.vectors(1.0);
        let at = |strain: f64| {
            let stretch = (Vector::new(1.0, -0.5, -0.5) * strain).exp();
            PeriodicBox::of_lattice(vectors.map(|vector| stretch * vector)).expect("a lattice keeps its volume")
        };
        let (start, ends) = (at(0.0), [-0.5, 0.5].map(|part| at(part * self.period())));
        let longest = ends.iter().fold(start.edges(), |longest, end| longest.max(end.edges()));
        let shortest = ends.iter().fold(start.edges(), |shortest, end| shortest.min(end.edges()));
        let largest = |of: &dyn Fn(&PeriodicBox) -> f64| ends.iter().map(|end| of(end).abs()).fold(0.0, f64::max);
        Extremes {
            longest: longest / start.edges(),
            contraction: (shortest / longest).min_element(),
            strain: largest(&|end| end.strain()),
            tilts: [largest(&|end| end.tilts()[0]), largest(&|end| end.tilts()[1])],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_roots_are_those_of_the_cubic() {
        let CubicField { rho, angle } = CubicField::get();
        assert!((rho.powi(3) - rho - 1.0).abs() < 1e-15 && (rho - 1.324_717_957_244_746).abs() < 1e-15);
        // z^3 = z + 1, real and imaginary part
        let size = rho.powf(-0.5);
        let (cube, once) = ((3.0 * angle).sin_cos(), angle.sin_cos());
        assert!((size.powi(3) * cube.1 - size * once.1 - 1.0).abs() < 1e-15);
        assert!((size.powi(3) * cube.0 - size * once.0).abs() < 1e-15);
    }

    #[test]
    fn vectors_follow_the_recurrence() {
        let [zeroth, first, before] = CubicField::get().vectors(2.0);
        // b_2 = b_0 + b_-1 is b_1 stretched and rotated.
        let second = zeroth + before;
        let CubicField { rho, angle } = CubicField::get();
        let stretched = Vector::new(rho, rho.powf(-0.5), rho.powf(-0.5)) * first;
        let turned = domain::Tensor::from_rotation_x(angle) * stretched;
        assert!((turned - second).length() < 1e-15 * 4.0, "{turned} {second}");
        assert!((zeroth.cross(first).dot(before) - 8.0).abs() < 1e-14);
    }
}
