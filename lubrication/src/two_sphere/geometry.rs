//! Bispherical coordinates that fit two spheres.

use super::double_double::DoubleDouble;

/// Two spheres as surfaces `xi = -alpha_1` and `xi = alpha_2` of bispherical coordinates.
#[derive(Debug, Clone)]
pub struct Geometry {
    /// Focal distance `c`, in units of the first radius.
    pub focus: DoubleDouble,
    /// `cosh alpha_i`
    pub cosh: [DoubleDouble; 2],
    /// `sinh alpha_i = c/a_i`
    pub sinh: [DoubleDouble; 2],
    /// `exp alpha_i`
    pub exponential: [DoubleDouble; 2],
}

impl Geometry {
    /// Spheres of radii 1 and `ratio`, a positive `gap` apart.
    pub fn new(ratio: f64, gap: f64) -> Self {
        let (one, ratio, gap) = (DoubleDouble::from(1.0), DoubleDouble::from(ratio), DoubleDouble::from(gap));
        let distance = one + ratio + gap;
        // r² - (a1 + a2)² and r² - (a1 - a2)², factored so that a small gap keeps its digits.
        let outer = gap * (distance + one + ratio);
        let inner = (distance + ratio - one) * (distance - ratio + one);
        let focus = (outer * inner).sqrt() / (distance * 2.0);
        let sinh = [focus, focus / ratio];
        let cosh = sinh.map(|s| (s * s + one).sqrt());
        Self { focus, cosh, sinh, exponential: [cosh[0] + sinh[0], cosh[1] + sinh[1]] }
    }

    /// `exp(-(n+1/2) alpha_i)` for every degree that matters: until its square is below 1e-18.
    pub fn decays(&self) -> Vec<[DoubleDouble; 2]> {
        let flattest = self.exponential.map(DoubleDouble::value).into_iter().fold(f64::INFINITY, f64::min);
        let count = 20 + (21.0 / flattest.ln()).ceil() as usize;
        let one = DoubleDouble::from(1.0);
        let factor = self.exponential.map(|e| one / e);
        let first = factor.map(DoubleDouble::sqrt);
        std::iter::successors(Some(first), |decay| Some([decay[0] * factor[0], decay[1] * factor[1]]))
            .take(count)
            .collect()
    }
}

/// Sign of `z` on a sphere.
pub fn side(sphere: usize) -> f64 {
    if sphere == 0 { -1.0 } else { 1.0 }
}
