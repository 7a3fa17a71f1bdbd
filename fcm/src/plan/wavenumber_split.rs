//! Split of the wavenumbers of the walls' flow between the grid and pairs of spheres.
//!
//! The grid carries the fraction `erfc((k - middle)/width) / erfc(-middle/width)` of the wavenumbers `k` along the
//! walls, and images of spheres in each other carry the rest. The split is smooth, so the images decay in real space
//! like a Gaussian: `exp(-(width r/2)^2)` at the distance `r` along the walls. Lengths here are in units of the
//! smallest radius.

use crate::envelope::Envelope;
use crate::grid::window::KaiserBessel;
use std::f64::consts::PI;

/// Split between the wavenumbers of the grid and those of images.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct WavenumberSplit {
    centre: f64,
    width: f64,
    /// Wavenumber beyond which the grid has nothing.
    pub grid_cutoff: f64,
}

/// Parameters of a grid at walls.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SplitInput {
    /// Distance between points along the walls.
    pub spacing: f64,
    /// Window that stands for the Gaussian on the grid.
    pub window: KaiserBessel,
    /// Coefficient of the correction `1 - own lap` for a sphere's own width, in units of the spacing.
    pub own: f64,
    /// Distance within which spheres have images in each other.
    pub cutoff: f64,
    /// Distance between the walls, or infinity for one wall.
    pub height: f64,
    /// Error allowed for the walls' flow.
    pub allowed: f64,
}

/// Highest wavenumber on the grid over the highest that it represents, above which windows have large errors: of the
/// sharp split, and of the smooth ones to try.
const SHARP: f64 = 0.85;
const SMOOTH: [f64; 4] = [0.69, 0.61, 0.53, 0.45];

/// Factor of the allowed error that is accepted: truncation and aliasing may each have a share.
pub(crate) const ENOUGH: f64 = std::f64::consts::SQRT_2;

/// Shares of the allowed error for wavenumbers beyond the highest, and for long waves that are not on the grid.
const BEYOND_SHARE: f64 = 0.3;
const LONG_SHARE: f64 = 0.1;

/// Number of wavenumbers sampled.
const PARTS: usize = 16;

/// Weight of a wavenumber, times the radius, in the velocity gradients that a wall reflects to spheres touching it:
/// `((1 - x)^2 + x^2) k^2 exp(-2 k)` for one sphere, `x = k - s^2 k^2` with the dipole's width `s` (see
/// [`crate::walls::wall_kernel`]). For spheres at different positions the highest wavenumbers contribute only a small
/// part of that.
fn weight(wavenumber: f64) -> f64 {
    let x = wavenumber - Envelope::of_sphere(1.0).dipole.powi(2) * wavenumber * wavenumber;
    (1.0 + 0.12 * x * (x - 1.0)) * wavenumber * wavenumber * (-2.0 * wavenumber).exp()
}

/// Largest weight of any wavenumber from this one on: weights grow up to `k = 1`.
fn from(wavenumber: f64) -> f64 {
    weight(wavenumber.max(1.0))
}

/// The same for the flow that spheres reflect to each other.
fn of_pairs(wavenumber: f64, height: f64) -> f64 {
    0.5 * at_walls(height) * from(wavenumber)
}

/// Fraction of the spheres that are near walls: a third, or more if the walls are close to each other.
fn at_walls(height: f64) -> f64 {
    (3.0 / (height - 0.5)).clamp(0.36, 1.0)
}

/// Argument at which `erfc(x)/2` has fallen to a value below a half, to within a hundredth (Winitzki 2008).
fn falls_to(value: f64) -> f64 {
    let (value, factor) = (value.clamp(1e-15, 0.5), 0.147);
    let log = (4.0 * value * (1.0 - value)).ln();
    let half = 2.0 / (PI * factor) + 0.5 * log;
    ((half * half - log / factor).sqrt() - half).max(0.0).sqrt()
}

/// `erfc(x)/2` as a logistic function, to a few percent where it is not small, which is enough for weights of errors.
fn share(x: f64) -> f64 {
    1.0 / (1.0 + (x * (2.26 + 0.2 * x * x)).exp())
}

impl WavenumberSplit {
    /// No wavenumbers between spheres, on a grid of this spacing.
    pub fn none(spacing: f64) -> Self {
        let highest = SHARP * PI / spacing;
        Self { centre: highest, width: 0.0, grid_cutoff: highest }
    }

    /// The split with the fewest images among those that keep the allowed error, or the one with the least error; and
    /// its error. The cheapest is sharp: spheres have images of themselves alone.
    pub fn choose(at: &SplitInput) -> (Self, f64) {
        let (folded, long) = (AliasingWeights::new(at), falls_to(LONG_SHARE * at.allowed));
        let cut = |part: f64| {
            let highest = part * PI / at.spacing;
            let margin = falls_to(BEYOND_SHARE * at.allowed / of_pairs(highest, at.height));
            let width = highest / (margin + long);
            let cut = Self { centre: highest - margin * width, width, grid_cutoff: highest };
            (cut, cut.error(at, &folded))
        };
        let sharp = {
            let highest = SHARP * PI / at.spacing;
            let cut = Self { centre: highest, width: 0.0, grid_cutoff: highest };
            (cut, cut.error(at, &folded))
        };
        let mut best: Option<(Self, f64)> = None;
        // If all spheres are near both walls, images in each other are not smaller than their own.
        let sharp = Some(sharp).filter(|_| at_walls(at.height) < 1.0);
        for found in sharp.into_iter().chain(SMOOTH.into_iter().map(cut)) {
            if found.1 <= ENOUGH * at.allowed {
                return found;
            }
            if best.is_none_or(|best| found.1 < best.1) {
                best = Some(found);
            }
        }
        best.expect("there are some")
    }

    /// The same in units in which the smallest radius is `radius`.
    #[must_use]
    pub fn scaled(self, radius: f64) -> Self {
        Self { centre: self.centre / radius, width: self.width / radius, grid_cutoff: self.grid_cutoff / radius }
    }

    /// Fraction of a wavenumber that is on the grid.
    pub fn grid_fraction(&self, wavenumber: f64) -> f64 {
        if self.is_sharp() {
            return if wavenumber <= self.grid_cutoff { 1.0 } else { 0.0 };
        }
        libm::erfc((wavenumber - self.centre) / self.width) / libm::erfc(-self.centre / self.width)
    }

    /// Fraction of a wavenumber that is between spheres.
    pub fn image_fraction(&self, wavenumber: f64) -> f64 {
        if wavenumber > self.grid_cutoff { 1.0 } else { 1.0 - self.grid_fraction(wavenumber) }
    }

    /// Whether spheres have no images in each other.
    pub fn is_sharp(&self) -> bool {
        self.width == 0.0
    }

    /// Approximate distance from a wall at which images fall below a fraction of a sphere's mobility: that of the
    /// long waves that images carry, `exp(-((middle - k)/width)^2 - 2 k z)` at its maximum.
    pub fn reach(&self, part: f64) -> f64 {
        let log = (3.0 / part).ln();
        if self.is_sharp() {
            return 0.5 * log / self.centre;
        }
        let square = self.width * self.width;
        (self.centre - (self.centre * self.centre - square * log).max(0.0).sqrt()) / square
    }

    /// Error of the walls' flow: by wavenumbers beyond the highest, by aliasing through the window, by images beyond
    /// the cutoff, and by reflections between the two walls. The factors are fits to the errors of 8 to 100 spheres
    /// between walls, randomly placed or most of them at walls, with ratios of radii up to 3.
    fn error(&self, at: &SplitInput, folded: &AliasingWeights) -> f64 {
        let beyond = of_pairs(self.grid_cutoff, at.height) * self.grid_fraction(self.grid_cutoff);
        let farther = if self.is_sharp() {
            0.0
        } else {
            0.4 * from(self.centre) * (-(0.5 * self.width * at.cutoff).powi(2)).exp()
        };
        let sent_back = |&[k, _]: &[f64; 2]| {
            let all = 8.0 * k * k * (1.0 + k * at.height).powi(2) * (-k * (at.height + 2.0)).exp();
            if all < 0.01 * at.allowed { 0.0 } else { all * self.image_fraction(k) }
        };
        let sent_back = if at.height.is_finite() { folded.0.iter().map(sent_back).fold(0.0, f64::max) } else { 0.0 };
        let on_grid = |&&[k, _]: &&[f64; 2]| k < self.grid_cutoff;
        let part = |&[k, weight]: &[f64; 2]| {
            if self.is_sharp() { weight } else { weight * share((k - self.centre) / self.width) }
        };
        let folded: f64 = folded.0.iter().take_while(on_grid).map(part).sum();
        let times = if self.is_sharp() { 2.5 } else { 8.0 };
        beyond.hypot(times * folded).hypot(farther).hypot(sent_back)
    }
}

/// Wavenumbers of the walls' flow, and the weight that aliases onto each through the window.
struct AliasingWeights([[f64; 2]; PARTS]);

impl AliasingWeights {
    /// The weight includes the derivatives in units of the spacing: one for a dipole, and `1 - own lap`, which is the
    /// identity for the walls' flow, since its Laplacian vanishes, but not for its aliases. No Gaussian damps these,
    /// unlike in the fluid.
    fn new(at: &SplitInput) -> Self {
        let step = SHARP * PI / at.spacing / PARTS as f64;
        Self(std::array::from_fn(|number| {
            let wavenumber = step * (number as f64 + 0.5);
            let k = wavenumber * at.spacing;
            let other = 2.0 * PI - k;
            let derivatives = other / k * (1.0 + at.own * (other * other - k * k));
            let folded = (at.window.transform(other) / at.window.transform(k)).abs() * derivatives;
            [wavenumber, folded * weight(wavenumber) * step]
        }))
    }
}
