//! Averages over horizontal strips, at one time and over a run.

use super::Snapshot;
use domain::Vector;
use glam::DVec2;
use statistics::{Blocks, Estimate, State, Store};

/// Averages over the disks whose centres are in a strip, weighted by mass.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ProfileStrip {
    /// Height of the strip's middle.
    pub height: f64,
    /// Number of disks.
    pub count: u64,
    /// Mass of the disks.
    pub mass: f64,
    /// Mean velocity.
    pub velocity: DVec2,
    /// Mean velocity in excess of the liquid's.
    pub excess: DVec2,
    /// xx, xy and yy of the covariance of the excess velocities: half of xx and yy is the granular temperature.
    pub covariance: Vector,
}

impl Snapshot {
    /// The profile over the height in the given number of strips. Strips without a disk are zero.
    pub fn profile(&self, strips: usize) -> Vec<ProfileStrip> {
        let width = self.edges[1] / strips as f64;
        let squares = |w: DVec2| Vector::new(w.x * w.x, w.x * w.y, w.y * w.y);
        let mut stripes: Vec<ProfileStrip> =
            (0..strips).map(|k| ProfileStrip { height: (k as f64 + 0.5) * width, ..ProfileStrip::default() }).collect();
        for disk in &self.disks {
            let k = ((disk.position.y / width) as usize).min(strips - 1);
            let (s, w, m) = (&mut stripes[k], disk.excess, disk.mass);
            s.count += 1;
            s.mass += m;
            s.velocity += disk.velocity * m;
            s.excess += w * m;
            s.covariance += squares(w) * m;
        }
        for s in stripes.iter_mut().filter(|s| s.count > 0) {
            s.velocity /= s.mass;
            s.excess /= s.mass;
            s.covariance = s.covariance / s.mass - squares(s.excess);
        }
        stripes
    }
}

/// Averages over the times at which a profile was sampled, strip by strip from the bottom up, with errors by blocks.
#[derive(Debug, Clone, PartialEq)]
pub struct AveragedProfile {
    strips: Vec<AveragedStrip<Blocks>>,
}

/// A strip of an averaged profile. Times at which the strip was empty count in the number of disks only: averages of a
/// strip that never had a disk are NaN, except the number of disks, which is zero.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AveragedStrip<T = Estimate> {
    /// Height of the strip's middle.
    pub height: f64,
    /// Number of disks.
    pub count: T,
    /// Their velocity along x.
    pub velocity: T,
    /// The same in excess of the liquid's.
    pub excess: T,
    /// Their granular temperature.
    pub temperature: T,
}

/// The number of disks in a strip that was never sampled.
const NONE: Estimate = Estimate { mean: 0.0, error: f64::INFINITY, converged: false };

impl AveragedProfile {
    /// Bytes of a strip after any number of samples: four series, each of blocks of a few dozen lengths.
    pub(in crate::disks) const STRIP: f64 = (size_of::<AveragedStrip<Blocks>>() + 4 * Blocks::MOST_BYTES) as f64;

    /// An empty profile with the given number of strips.
    pub fn new(strips: usize) -> Self {
        Self { strips: vec![AveragedStrip::default(); strips] }
    }

    /// Adds a sample.
    pub fn add(&mut self, snapshot: &Snapshot) {
        let profile = snapshot.profile(self.strips.len());
        for (strip, now) in self.strips.iter_mut().zip(profile) {
            strip.height = now.height;
            strip.count.add(now.count as f64);
            if now.count > 0 {
                strip.velocity.add(now.velocity.x);
                strip.excess.add(now.excess.x);
                strip.temperature.add(0.5 * (now.covariance.x + now.covariance.z));
            }
        }
    }

    /// The averages so far.
    pub fn strips(&self) -> impl Iterator<Item = AveragedStrip> {
        self.strips.iter().map(|strip| AveragedStrip {
            height: strip.height,
            count: Some(strip.count.estimate()).filter(|count| !count.mean.is_nan()).unwrap_or(NONE),
            velocity: strip.velocity.estimate(),
            excess: strip.excess.estimate(),
            temperature: strip.temperature.estimate(),
        })
    }
}

impl State for AveragedProfile {
    fn visit(&mut self, store: &mut dyn Store) {
        for AveragedStrip { height, count, velocity, excess, temperature } in &mut self.strips {
            store.number(height);
            for blocks in [count, velocity, excess, temperature] {
                blocks.visit(store);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Disk;
    use super::*;

    #[test]
    fn averages_are_weighted_by_mass() {
        let disk = |y, mass, x| Disk {
            position: DVec2::new(0.0, y),
            velocity: DVec2::new(x + 1.0, 2.0 * x),
            excess: DVec2::new(x, 0.0),
            mass,
            ..Disk::default()
        };
        let disks = vec![disk(1.0, 1.0, 4.0), disk(2.0, 3.0, 0.0), disk(7.0, 1.0, 2.0)];
        let stripes = Snapshot { edges: [10.0; 2], disks }.profile(2);
        assert_eq!((stripes[0].height, stripes[0].count, stripes[1].count), (2.5, 2, 1));
        assert_eq!((stripes[0].excess, stripes[0].velocity), (DVec2::X, DVec2::splat(2.0)));
        assert_eq!((stripes[0].covariance.x, stripes[1].covariance.x), (3.0, 0.0));
    }

    #[test]
    fn a_profile_that_was_never_taken_is_of_no_disks() {
        for strip in AveragedProfile::new(2).strips() {
            assert!(strip.count.mean.to_bits() == 0 && strip.velocity.mean.is_nan(), "{strip:?}");
        }
    }

    fn moment(x: f64, y: f64) -> Snapshot {
        let (position, velocity) = (DVec2::new(0.0, y), DVec2::new(x, 0.0));
        let disk = Disk { position, velocity, excess: velocity - DVec2::X, mass: 2.0, ..Disk::default() };
        Snapshot { edges: [10.0; 2], disks: vec![disk] }
    }

    #[test]
    fn strips_average_the_moments_at_which_they_had_disks() {
        let mut profile = AveragedProfile::new(2);
        for (x, y) in [(4.0, 1.0), (6.0, 2.0), (9.0, 7.0), (5.0, 3.0)] {
            profile.add(&moment(x, y));
        }
        let [low, high]: [AveragedStrip; 2] = profile.strips().collect::<Vec<_>>().try_into().unwrap();
        assert_eq!((low.height, low.count.mean, high.count.mean), (2.5, 0.75, 0.25));
        assert!((low.velocity.mean - 5.0).abs() < 1e-15 && (low.excess.mean - 4.0).abs() < 1e-15);
        // Samples 4, 6 and 5: a variance of 1 over three samples.
        assert!((low.velocity.error - (1.0_f64 / 3.0).sqrt()).abs() < 1e-15);
        assert_eq!((high.velocity.mean, high.velocity.error), (9.0, f64::INFINITY));
    }

    #[test]
    fn an_average_is_taken_up_again() {
        let mut profile = AveragedProfile::new(3);
        profile.add(&moment(1.0, 4.0));
        let mut again = AveragedProfile::new(3);
        assert!(again.load(&profile.save()));
        for profile in [&mut profile, &mut again] {
            profile.add(&moment(2.0, 9.0));
        }
        assert_eq!(profile, again);
        assert!(!AveragedProfile::new(2).load(&profile.save()));
    }
}
