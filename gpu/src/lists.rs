//! Lists in the memory of a device.

use crate::tables::NumberFormat;
use crate::task::DeviceAddress;

/// Values in the memory of a device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DeviceList {
    pub(crate) address: DeviceAddress,
    pub(crate) count: usize,
    pub(crate) numbers: NumberFormat,
}

impl DeviceList {
    /// Values from one on.
    #[must_use]
    pub fn part(&self, first: usize, count: usize) -> Self {
        Self { address: self.address + (first * self.numbers.size()) as u64, count, ..*self }
    }

    /// Number of values.
    pub fn count(&self) -> usize {
        self.count
    }
}

/// Lists of velocities, angular velocities and rates of strain.
pub type MotionLists = [DeviceList; 3];
