//! Averages over horizontal strips.

use super::Snapshot;
use domain::Vector;

/// Averages over the disks whose centres are in a strip, weighted by mass.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ProfileStrip {
    /// Height of the strip's middle.
    pub height: f64,
    /// Number of disks.
    pub count: u64,
    /// Mass of the disks.
    pub mass: f64,
    /// Mean velocity along x and y.
    pub velocity: [f64; 2],
    /// Mean velocity along x in excess of the liquid's.
    pub excess: f64,
    /// xx, xy and yy of the covariance of the excess velocities: half of xx and yy is the granular temperature.
    pub covariance: Vector,
}

impl Snapshot {
    /// The profile over the height in the given number of strips. Strips without a disk are zero.
    pub fn profile(&self, strips: usize) -> Vec<ProfileStrip> {
        let width = self.edges[1] / strips as f64;
        let mut stripes: Vec<ProfileStrip> =
            (0..strips).map(|k| ProfileStrip { height: (k as f64 + 0.5) * width, ..ProfileStrip::default() }).collect();
        let mut means = vec![(0.0, Vector::ZERO); strips];
        for disk in &self.disks {
            let k = ((disk.position.y / width) as usize).min(strips - 1);
            let (s, w, m) = (&mut stripes[k], disk.excess, disk.mass);
            s.count += 1;
            s.mass += m;
            s.velocity = [s.velocity[0] + m * disk.velocity.x, s.velocity[1] + m * disk.velocity.y];
            s.excess += m * w.x;
            means[k].0 += m * w.y;
            means[k].1 += Vector::new(w.x * w.x, w.x * w.y, w.y * w.y) * m;
        }
        for (s, (across, squares)) in stripes.iter_mut().zip(means).filter(|(s, _)| s.count > 0) {
            s.velocity = s.velocity.map(|v| v / s.mass);
            s.excess /= s.mass;
            let (x, y) = (s.excess, across / s.mass);
            s.covariance = squares / s.mass - Vector::new(x * x, x * y, y * y);
        }
        stripes
    }
}

#[cfg(test)]
mod tests {
    use super::super::Disk;
    use super::*;
    use glam::DVec2;

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
        assert_eq!((stripes[0].excess, stripes[0].velocity), (1.0, [2.0, 2.0]));
        assert_eq!((stripes[0].covariance.x, stripes[1].covariance.x), (3.0, 0.0));
    }
}
