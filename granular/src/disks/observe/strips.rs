//! Area fractions of the disks in horizontal strips, and the segregation parameter.

use super::Snapshot;
use std::f64::consts::FRAC_PI_2;

/// Fractions of the area of horizontal strips that disks cover.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Strips {
    /// Area fractions of the small disks.
    pub small: Vec<f64>,
    /// Area fractions of the large disks.
    pub large: Vec<f64>,
}

/// Area of the part of a disk below the height `h` relative to its centre:
/// `r^2 (pi/2 + asin(h/r)) + h sqrt(r^2 - h^2)`.
pub fn segment(radius: f64, height: f64) -> f64 {
    let h = height.clamp(-radius, radius);
    radius * radius * (FRAC_PI_2 + (h / radius).asin()) + h * (radius * radius - h * h).max(0.0).sqrt()
}

impl Strips {
    /// A whole number of strips of about the given width, the first of which starts at the height `origin`.
    pub fn of(snapshot: &Snapshot, width: f64, origin: f64) -> Self {
        let [length, height] = snapshot.edges;
        let count = (height / width).round().max(1.0) as usize;
        let width = height / count as f64;
        let mut strips = Self { small: vec![0.0; count], large: vec![0.0; count] };
        for disk in &snapshot.disks {
            let (centre, r) = (disk.position.y - origin, disk.radius);
            let covered = if disk.is_large { &mut strips.large } else { &mut strips.small };
            let [low, high] = [centre - r, centre + r].map(|y| (y / width).floor() as i64);
            let mut below = 0.0;
            for k in low..=high {
                let up_to_here = segment(r, (k + 1) as f64 * width - centre);
                covered[k.rem_euclid(count as i64) as usize] += (up_to_here - below) / (length * width);
                below = up_to_here;
            }
        }
        strips
    }

    /// The segregation parameter `delta` of eq. (7): the standard deviation over the strips of the difference between
    /// the area fractions of large and small disks.
    pub fn segregation(&self) -> f64 {
        let differences: Vec<f64> = self.large.iter().zip(&self.small).map(|(l, s)| l - s).collect();
        let count = differences.len() as f64;
        let mean = differences.iter().sum::<f64>() / count;
        (differences.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / count).sqrt()
    }
}

impl Snapshot {
    /// The segregation parameter `delta` with strips of width 1 that start at the bottom.
    pub fn segregation(&self) -> f64 {
        Strips::of(self, 1.0, 0.0).segregation()
    }

    /// The segregation parameter averaged over `shifts` positions of the first strip.
    pub fn mean_segregation(&self, shifts: usize) -> f64 {
        let at = |k: usize| Strips::of(self, 1.0, k as f64 / shifts as f64).segregation();
        (0..shifts).map(at).sum::<f64>() / shifts as f64
    }
}

#[cfg(test)]
mod tests {
    use super::super::Disk;
    use super::*;
    use std::f64::consts::PI;

    fn snapshot(disks: &[(f64, f64)]) -> Snapshot {
        let disk = |&(y, radius): &(f64, f64)| Disk {
            position: glam::DVec2::new(1.0, y),
            radius,
            is_large: radius > 1.0,
            ..Disk::default()
        };
        Snapshot { edges: [10.0, 20.0], disks: disks.iter().map(disk).collect() }
    }

    #[test]
    fn a_disk_is_cut_as_geometry_says() {
        // A disk of radius 1 around the edge between two strips, across the bottom: half in each.
        let strips = Strips::of(&snapshot(&[(0.0, 1.0)]), 1.0, 0.0);
        assert!((strips.small[0] - PI / 20.0).abs() < 1e-15 && (strips.small[19] - PI / 20.0).abs() < 1e-15);
        assert!(strips.small[1..19].iter().all(|&c| c == 0.0));
        // One around the middle of a strip: the caps beyond +-1/2 have the area pi/3 - sqrt(3)/4 each.
        let strips = Strips::of(&snapshot(&[(3.5, 1.0)]), 1.0, 0.0);
        let cap = PI / 3.0 - 3.0_f64.sqrt() / 4.0;
        assert!((strips.small[4] - cap / 10.0).abs() < 1e-15);
        assert!((strips.small[3] - (PI - 2.0 * cap) / 10.0).abs() < 1e-15);
    }

    #[test]
    fn strips_add_up_and_their_spread_is_delta() {
        let some = snapshot(&[(0.3, 3.5), (7.7, 0.875), (19.9, 3.5), (12.2, 0.5)]);
        for (width, origin) in [(1.0, 0.0), (0.7, 3.3), (30.0, 0.0)] {
            let strips = Strips::of(&some, width, origin);
            let mean = |c: &[f64]| c.iter().sum::<f64>() / c.len() as f64;
            assert!((mean(&strips.large) - 2.0 * PI * 3.5 * 3.5 / 200.0).abs() < 1e-12);
            assert!((mean(&strips.small) - PI * (0.875 * 0.875 + 0.25) / 200.0).abs() < 1e-12);
        }
        // One disk of radius 1 in two of twenty strips: fractions a = pi/20 there, so
        // `delta^2 = 2 a^2/20 - (2 a/20)^2`.
        let a = PI / 20.0;
        let expected = (2.0 * a * a / 20.0 - (2.0 * a / 20.0_f64).powi(2)).sqrt();
        let centred = snapshot(&[(5.0, 1.0)]);
        assert!((centred.segregation() - expected).abs() < 1e-15);
        // With strips that start half a strip higher, it is in three.
        let shifted = Strips::of(&centred, 1.0, 0.5).segregation();
        assert!((shifted - expected).abs() > 1e-3);
        assert!((centred.mean_segregation(2) - 0.5 * (expected + shifted)).abs() < 1e-15);
    }
}
