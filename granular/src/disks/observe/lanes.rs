//! Lanes of disks along the flow.

use super::Snapshot;
use glam::DVec2;
use std::f64::consts::TAU;

/// Strongest periodic component of the disks' heights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LaneOrder {
    /// Peak of `|sum exp(i k y)|^2 / N^2`: 1 for perfect lanes, about `1/N` for none.
    pub peak: f64,
    /// Distance between two lanes, `2 pi / k`.
    pub spacing: f64,
}

impl Snapshot {
    /// The strongest period that fits into the height, no shorter than the mean radius.
    pub fn lanes(&self) -> LaneOrder {
        let (count, height) = (self.disks.len() as f64, self.edges[1]);
        let radius = self.disks.iter().map(|d| d.radius).sum::<f64>() / count;
        let turns: Vec<DVec2> = self.disks.iter().map(|d| DVec2::from_angle(TAU * d.position.y / height)).collect();
        let mut waves = vec![DVec2::X; turns.len()];
        let mut strongest = LaneOrder { peak: 0.0, spacing: height };
        for periods in 1..=(height / radius) as u32 {
            let mut sum = DVec2::ZERO;
            for (wave, turn) in waves.iter_mut().zip(&turns) {
                // exp(i k y) of the next period: a rotation costs less than a sine.
                *wave = turn.rotate(*wave);
                sum += *wave;
            }
            let peak = sum.length_squared() / (count * count);
            if peak > strongest.peak {
                strongest = LaneOrder { peak, spacing: height / f64::from(periods) };
            }
        }
        strongest
    }
}

#[cfg(test)]
mod tests {
    use super::super::Disk;
    use super::*;

    #[test]
    fn lanes_are_found_at_their_spacing() {
        let disk = |y: f64| Disk { position: DVec2::new(0.0, y), radius: 1.0, ..Disk::default() };
        let disks = (0..400).map(|i| disk(f64::from(i % 50) * 2.0 + 0.1 * (f64::from(i) * 0.7).sin())).collect();
        let lanes = Snapshot { edges: [100.0; 2], disks }.lanes();
        assert!((lanes.spacing - 2.0).abs() < 1e-12);
        // Debye-Waller: exp(-k^2 <u^2>), <u^2> = 0.005, k = pi, to the next order in k^2 u^2.
        assert!((lanes.peak - (-0.005 * std::f64::consts::PI.powi(2)).exp()).abs() < 2e-3);
    }
}
