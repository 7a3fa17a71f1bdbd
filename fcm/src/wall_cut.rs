//! Which wavenumbers of the walls' flow are on the grid, and which are between spheres.
//!
//! The grid has the part `erfc((k - middle)/width) / erfc(-middle/width)` of the wavenumbers `k` along the walls, and images of
//! spheres in each other have the rest. That is smooth, so that they end in real space as a Gaussian does:
//! `exp(-(width r/2)^2)` at the distance `r` along the walls. Lengths are in units of the smallest radius here.

use crate::envelope::Envelope;
use crate::window::Window;
use std::f64::consts::PI;

/// The cut between the grid's part of the wavenumbers and that of images.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct WallCut {
    middle: f64,
    width: f64,
    /// Beyond which the grid has nothing.
    pub highest: f64,
}

/// A grid, and what there is besides.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AtWalls {
    /// Distance between points along the walls.
    pub spacing: f64,
    /// What stands for a Gaussian there.
    pub window: Window,
    /// What a sphere's own width adds to it, `1 - own lap` in units of the spacing.
    pub own: f64,
    /// How far images reach.
    pub cutoff: f64,
    /// The distance of the other wall, or infinity.
    pub height: f64,
    /// The error that walls may have.
    pub allowed: f64,
}

/// Highest wavenumbers on a grid, in units of the highest that it has: windows err beyond. That of a sharp cut, and those of smooth ones
/// that are tried.
const SHARP: f64 = 0.85;
const SMOOTH: [f64; 4] = [0.69, 0.61, 0.53, 0.45];

/// An error within this of the one that is allowed is enough: what is beyond the wavenumbers of a grid may have its share, and what
/// folds onto them another.
pub(crate) const ENOUGH: f64 = std::f64::consts::SQRT_2;

/// Shares of the allowed error for what is beyond the highest wavenumber, and for long waves that are not on the grid.
const BEYOND_SHARE: f64 = 0.3;
const LONG_SHARE: f64 = 0.1;

/// Wavenumbers that are looked at.
const PARTS: usize = 16;

/// The weight of a wavenumber, times the radius, in the flow that a wall sends back to the gradients of spheres on it:
/// `((1 - x)^2 + x^2) k^2 exp(-2 k)` for one, `x = k - s^2 k^2` with the dipole's width `s` (see [`crate::waves`]), of which the
/// highest wavenumbers have a small part in spheres at different places.
fn weight(wavenumber: f64) -> f64 {
    let x = wavenumber - Envelope::of_sphere(1.0).dipole.powi(2) * wavenumber * wavenumber;
    (1.0 + 0.12 * x * (x - 1.0)) * wavenumber * wavenumber * (-2.0 * wavenumber).exp()
}

/// The most that any wavenumber has from one on: weights grow to `k = 1`.
fn from(wavenumber: f64) -> f64 {
    weight(wavenumber.max(1.0))
}

/// The same for what spheres send to each other.
fn of_pairs(wavenumber: f64, height: f64) -> f64 {
    0.5 * at_walls(height) * from(wavenumber)
}

/// The part of spheres that are at walls: a third, or more between walls that are near each other.
fn at_walls(height: f64) -> f64 {
    (3.0 / (height - 0.5)).clamp(0.36, 1.0)
}

/// Where `erfc(x)/2` has fallen to a value below a half, within a hundredth (Winitzki 2008).
fn falls_to(value: f64) -> f64 {
    let (value, factor) = (value.clamp(1e-15, 0.5), 0.147);
    let log = (4.0 * value * (1.0 - value)).ln();
    let half = 2.0 / (PI * factor) + 0.5 * log;
    ((half * half - log / factor).sqrt() - half).max(0.0).sqrt()
}

/// `erfc(x)/2` within a few percent where it is not small, which is enough for weights of errors: a logistic function.
fn share(x: f64) -> f64 {
    1.0 / (1.0 + (x * (2.26 + 0.2 * x * x)).exp())
}

impl WallCut {
    /// Nothing is between spheres, on a grid of this spacing.
    pub fn none(spacing: f64) -> Self {
        let highest = SHARP * PI / spacing;
        Self { middle: highest, width: 0.0, highest }
    }

    /// The cut with the fewest images of those that are allowed, or the one that errs least; and by how much it errs. At best it is
    /// sharp, and spheres have images in themselves alone.
    pub fn choose(at: &AtWalls) -> (Self, f64) {
        let (folded, long) = (Folded::new(at), falls_to(LONG_SHARE * at.allowed));
        let cut = |part: f64| {
            let highest = part * PI / at.spacing;
            let margin = falls_to(BEYOND_SHARE * at.allowed / of_pairs(highest, at.height));
            let width = highest / (margin + long);
            let cut = Self { middle: highest - margin * width, width, highest };
            (cut, cut.error(at, &folded))
        };
        let sharp = {
            let highest = SHARP * PI / at.spacing;
            let cut = Self { middle: highest, width: 0.0, highest };
            (cut, cut.error(at, &folded))
        };
        let mut best: Option<(Self, f64)> = None;
        // Between walls that all spheres are near, images in each other are not the smaller ones.
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

    /// The same in units in which the smallest radius is this.
    #[must_use]
    pub fn scaled(self, radius: f64) -> Self {
        Self { middle: self.middle / radius, width: self.width / radius, highest: self.highest / radius }
    }

    /// The part of a wavenumber that is on the grid.
    pub fn on_grid(&self, wavenumber: f64) -> f64 {
        if self.is_sharp() {
            return if wavenumber <= self.highest { 1.0 } else { 0.0 };
        }
        libm::erfc((wavenumber - self.middle) / self.width) / libm::erfc(-self.middle / self.width)
    }

    /// The part that is between spheres.
    pub fn between_spheres(&self, wavenumber: f64) -> f64 {
        if wavenumber > self.highest { 1.0 } else { 1.0 - self.on_grid(wavenumber) }
    }

    /// Whether spheres have no images in each other.
    pub fn is_sharp(&self) -> bool {
        self.width == 0.0
    }

    /// About how far from a wall images fall below a part of the mobility of a sphere: that of the long waves that are left to them,
    /// `exp(-((middle - k)/width)^2 - 2 k z)` where that is largest.
    pub fn reach(&self, part: f64) -> f64 {
        let log = (3.0 / part).ln();
        if self.is_sharp() {
            return 0.5 * log / self.middle;
        }
        let square = self.width * self.width;
        (self.middle - (self.middle * self.middle - square * log).max(0.0).sqrt()) / square
    }

    /// The error of walls: by wavenumbers beyond the highest, by what folds onto the others through a window, by images that are
    /// farther apart than they reach, and by what one wall sends back to the other. The factors are fits to the errors of 8 to 100
    /// spheres between walls, at random or most of them at walls, with radii up to 1:3.
    fn error(&self, at: &AtWalls, folded: &Folded) -> f64 {
        let beyond = of_pairs(self.highest, at.height) * self.on_grid(self.highest);
        let farther = if self.is_sharp() {
            0.0
        } else {
            0.4 * from(self.middle) * (-(0.5 * self.width * at.cutoff).powi(2)).exp()
        };
        let sent_back = |&[k, _]: &[f64; 2]| {
            let all = 8.0 * k * k * (1.0 + k * at.height).powi(2) * (-k * (at.height + 2.0)).exp();
            if all < 0.01 * at.allowed { 0.0 } else { all * self.between_spheres(k) }
        };
        let sent_back = if at.height.is_finite() { folded.0.iter().map(sent_back).fold(0.0, f64::max) } else { 0.0 };
        let on_grid = |&&[k, _]: &&[f64; 2]| k < self.highest;
        let part = |&[k, weight]: &[f64; 2]| {
            if self.is_sharp() { weight } else { weight * share((k - self.middle) / self.width) }
        };
        let folded: f64 = folded.0.iter().take_while(on_grid).map(part).sum();
        let times = if self.is_sharp() { 2.5 } else { 8.0 };
        beyond.hypot(times * folded).hypot(farther).hypot(sent_back)
    }
}

/// Wavenumbers, and what folds onto each of those of walls through a window.
struct Folded([[f64; 2]; PARTS]);

impl Folded {
    /// Weighed with what derivatives make of it in units of the spacing: one of a dipole, and `1 - own lap`, where the Laplacian of
    /// the wall's flow is none but that of what folds onto it is. Nothing damps that, as a Gaussian does in the fluid.
    fn new(at: &AtWalls) -> Self {
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
