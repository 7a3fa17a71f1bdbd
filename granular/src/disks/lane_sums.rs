//! Sums over the disks for each SIMD lane.

use super::state::{LANES, Lanes};
use super::sums::MotionSums;
use domain::Vector;

/// [`MotionSums`] for each lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct LaneSums {
    pub(super) kinetic: Lanes,
    pub(super) flux: [Lanes; 3],
    pub(super) excess: Lanes,
    pub(super) drag: Lanes,
    pub(super) flow_work: Lanes,
    pub(super) drift_squared: Lanes,
}

impl Default for LaneSums {
    fn default() -> Self {
        let none = [0.0; LANES];
        Self { kinetic: none, flux: [none; 3], excess: none, drag: none, flow_work: none, drift_squared: none }
    }
}

impl LaneSums {
    /// The sums over all lanes.
    pub(super) fn total(&self) -> MotionSums {
        let sum = |lanes: &Lanes| lanes.iter().sum::<f64>();
        let [xx, xy, yy] = &self.flux;
        MotionSums {
            kinetic: sum(&self.kinetic),
            flux: Vector::new(sum(xx), sum(xy), sum(yy)),
            excess: sum(&self.excess),
            drag: sum(&self.drag),
            flow_work: sum(&self.flow_work),
            drift_squared: self.drift_squared.iter().copied().fold(0.0, f64::max),
        }
    }
}
