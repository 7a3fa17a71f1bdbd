//! Selection of the neighbours in straight flight that may collide with a grain, computed in SIMD vectors.

use super::cells::{NEAR, nearest_image};
use super::contact_time::{GrowingDiameter, StraightFlight};
use super::grain::Grain;
use bytemuck::Zeroable;
use domain::Vector;
use simd::vectorised;

/// One number for each nearby grain.
type Lane = [f64; NEAR];

/// Lanes are processed in whole groups of this size; results of unused lanes are ignored.
const GROUP: usize = 8;

/// Work space for the flights of the grains near one.
#[derive(Zeroable)]
pub struct Flights {
    separations: [Lane; 3],
    velocities: [Lane; 3],
    pairs: [Lane; 3],
    may_meet: [bool; NEAR],
    /// Indices in the list of the grains that may meet the grain.
    chosen: [u32; NEAR],
}

/// Input of a selection, the same for all nearby grains.
pub struct FlightInput<'a> {
    pub grains: &'a [Grain],
    /// The grain that they may meet, at the present time.
    pub grain: &'a Grain,
    pub now: f64,
    /// Lengths of the periodic axes; infinite where there are walls.
    pub periods: [f64; 3],
    pub size: GrowingDiameter,
}

impl Flights {
    /// The first grain of the list, other than `i` itself, that is met earlier than the best so far;
    /// otherwise the best so far.
    pub fn first(&mut self, i: usize, list: &[u32], view: &FlightInput, mut best: (f64, u32)) -> (f64, u32) {
        vectorised(
            #[inline(always)]
            || {
                self.relative_motions(list, view);
                self.pair(list.len(), view);
            },
        );
        let mut count = 0;
        for (k, &j) in list.iter().enumerate() {
            // Most pairs miss each other or separate: they are dropped without a branch.
            self.chosen[count] = k as u32;
            count += usize::from(self.may_meet[k]) & usize::from(j as usize != i);
        }
        for &k in &self.chosen[..count] {
            let k = k as usize;
            let pair = StraightFlight { a: self.pairs[0][k], b: self.pairs[1][k], c: self.pairs[2][k] };
            if let Some(t) = pair.time()
                && t < best.0
            {
                best = (t, list[k]);
            }
        }
        best
    }

    /// Computes separations at the present time and relative velocities.
    #[inline(always)]
    fn relative_motions(&mut self, list: &[u32], view: &FlightInput) {
        let Grain { position, velocity, .. } = *view.grain;
        for (k, &j) in list.iter().enumerate().take(NEAR) {
            let grain = &view.grains[j as usize];
            let (there, speed) = grain.at(view.now, None);
            let (separation, relative) = (there - position, speed - velocity);
            for axis in 0..3 {
                self.separations[axis][k] = separation[axis];
                self.velocities[axis][k] = relative[axis];
            }
        }
    }

    /// Takes the nearest images, and determines which flights may end in a contact.
    #[inline(always)]
    fn pair(&mut self, count: usize, view: &FlightInput) {
        let (periods, size) = (view.periods, view.size);
        let Self { separations: [x, y, z], velocities: [u, v, w], pairs: [a, b, c], may_meet, .. } = self;
        for k in 0..count.next_multiple_of(GROUP).min(NEAR) {
            let separation = Vector::new(
                nearest_image(x[k], periods[0]),
                nearest_image(y[k], periods[1]),
                nearest_image(z[k], periods[2]),
            );
            let pair = StraightFlight::new(separation, Vector::new(u[k], v[k], w[k]), size);
            (a[k], b[k], c[k], may_meet[k]) = (pair.a, pair.b, pair.c, pair.may_meet());
        }
    }
}
