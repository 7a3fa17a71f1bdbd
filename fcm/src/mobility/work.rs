//! Work done by evaluations, and the time of each part.

use std::time::Instant;

/// Counts of the work since the start, and its time.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Work {
    /// Evaluations of the mobility.
    pub evaluations: u64,
    /// Particles spread to the grid, summed over evaluations.
    pub particles_spread: u64,
    /// Evaluations that spread dipoles.
    pub dipole_spreads: u64,
    /// Evaluations that interpolated velocity gradients.
    pub dipole_interpolations: u64,
    /// Grid solves, each with a forward and a backward transform.
    pub transforms: u64,
    /// Neighbours visited in the near field.
    pub neighbours: u64,
    /// Neighbour searches.
    pub searches: u64,
    /// Seconds by part.
    pub seconds: Seconds,
}

/// Seconds spent in the parts of evaluations.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Seconds {
    /// Sorting of the particles, and spreading of loads to the grid.
    pub spread: f64,
    /// Forward transform, Stokes solve and backward transform, in one pass over the grid.
    pub fft: f64,
    /// Interpolation from the grid to motions.
    pub interpolate: f64,
    /// Neighbour search and pair correction.
    pub near: f64,
    /// Exchanging positions, loads and motions with other ranks.
    pub exchange: f64,
}

impl std::ops::Sub for Seconds {
    type Output = Self;

    fn sub(self, before: Self) -> Self {
        Self {
            spread: self.spread - before.spread,
            fft: self.fft - before.fft,
            interpolate: self.interpolate - before.interpolate,
            near: self.near - before.near,
            exchange: self.exchange - before.exchange,
        }
    }
}

/// Stopwatch for consecutive parts.
pub(crate) struct Stopwatch(Instant);

impl Stopwatch {
    pub fn start() -> Self {
        Self(Instant::now())
    }

    /// Discards the time since the last stop.
    pub fn restart(&mut self) {
        self.0 = Instant::now();
    }

    /// Adds the time since the last stop to a part.
    pub fn stop(&mut self, part: &mut f64) {
        let now = Instant::now();
        *part += (now - self.0).as_secs_f64();
        self.0 = now;
    }
}
