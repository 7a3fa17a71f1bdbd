//! What an evaluation did and how long each part took.

use std::time::Instant;

/// Counts of work done since the start, and the seconds that went into it.
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
    /// Grid solves: a transform forth and back each.
    pub transforms: u64,
    /// Neighbours visited in the near field.
    pub neighbours: u64,
    /// Searches for neighbours.
    pub searches: u64,
    /// Seconds by part.
    pub seconds: Seconds,
}

/// Seconds spent in the parts of evaluations.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Seconds {
    /// Sorting the particles, and loads to the grid.
    pub spread: f64,
    /// Transform forth, Stokes solve and transform back, which are one pass over the grid.
    pub fft: f64,
    /// Grid to motions.
    pub interpolate: f64,
    /// Finding pairs, and what they add.
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

/// A stopwatch for one part after the other.
pub(crate) struct Clock(Instant);

impl Clock {
    pub fn start() -> Self {
        Self(Instant::now())
    }

    /// Forgets the time since the last stop.
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
