//! Bispherical coordinates of two spheres.

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
    /// Number of degrees of the series.
    degrees: usize,
}

/// Radius of the sphere that stands for a plane wall: at a distance of 1000 the smallest function, YB, has an error
/// of 1e-11.
const WALL_RADIUS: f64 = 1e20;

impl Geometry {
    /// Spheres of radii 1 and `ratio` at a positive `gap`.
    pub fn new(ratio: f64, gap: f64) -> Self {
        // Up to the degree at which the square of the slower decay is below 1e-18.
        Self::counted(ratio, gap, |exponential| 21.0 / exponential[0].min(exponential[1]).ln())
    }

    /// A sphere of radius 1 at a positive `gap` from a plane wall, which is the second sphere. The factors of the
    /// wall do not decay, but loads of the first sphere contain the square of its own decay, which ends below 1e-38.
    /// Only the loads of the first sphere by its own motion are valid.
    pub fn at_wall(gap: f64) -> Self {
        Self::counted(WALL_RADIUS, gap, |exponential| 44.0 / exponential[0].ln())
    }

    fn counted(ratio: f64, gap: f64, degrees: impl Fn([f64; 2]) -> f64) -> Self {
        let (one, ratio, gap) = (DoubleDouble::from(1.0), DoubleDouble::from(ratio), DoubleDouble::from(gap));
        let distance = one + ratio + gap;
        // r² - (a1 + a2)² and r² - (a1 - a2)², factored so that a small gap keeps its digits.
        let outer = gap * (distance + one + ratio);
        let inner = (distance + ratio - one) * (distance - ratio + one);
        let focus = (outer * inner).sqrt() / (distance * 2.0);
        let sinh = [focus, focus / ratio];
        let cosh = sinh.map(|s| (s * s + one).sqrt());
        let exponential = [cosh[0] + sinh[0], cosh[1] + sinh[1]];
        let degrees = 20 + degrees(exponential.map(DoubleDouble::value)).ceil() as usize;
        Self { focus, cosh, sinh, exponential, degrees }
    }

    /// `exp(-(n+1/2) alpha_i)` for all degrees of the series.
    pub fn decays(&self) -> Vec<[DoubleDouble; 2]> {
        let one = DoubleDouble::from(1.0);
        let factor = self.exponential.map(|e| one / e);
        let first = factor.map(DoubleDouble::sqrt);
        std::iter::successors(Some(first), |decay| Some([decay[0] * factor[0], decay[1] * factor[1]]))
            .take(self.degrees)
            .collect()
    }
}

/// Sign of `z` on a sphere.
pub fn side(sphere: usize) -> f64 {
    if sphere == 0 { -1.0 } else { 1.0 }
}
