//! Predicted motions of particles that move on a device, see `gpu/kernels/predicted.h`.

use crate::device::DeviceError;
use crate::far_field::SplitFarField;
use crate::lists::DeviceList;
use crate::surface_laws::SurfaceLaws;
use crate::task::DeviceAddress;
use bytemuck::{Pod, Zeroable};

/// Predicted motions: lists in the order of ids, and in the units of the host.
#[derive(Debug, Clone, Copy)]
pub struct PredictedMotion {
    /// Positions.
    pub positions: DeviceList,
    /// Velocities with that of a flow.
    pub velocities: DeviceList,
    /// Gradient of this flow, row by row.
    pub gradient: [f64; 9],
    /// Factor of velocities from the units of the host to those of the solve.
    pub factor: f64,
    /// The time, in the units of the solve.
    pub time: f64,
}

/// Arguments with the fields of `gpu/kernels/predicted.h` in the same order.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Arguments {
    positions: DeviceAddress,
    velocities: DeviceAddress,
    gradient: [f64; 9],
    factor: f64,
    time: f64,
}

impl SplitFarField {
    /// Copies predicted motions, and the laws of forces between surfaces. Returns their place.
    pub(crate) fn place_predicted(
        &mut self,
        predicted: &PredictedMotion,
        laws: &SurfaceLaws,
    ) -> Result<DeviceAddress, DeviceError> {
        self.copy_laws(laws)?;
        let &PredictedMotion { positions, velocities, gradient, factor, time } = predicted;
        let (positions, velocities) = (positions.address, velocities.address);
        let arguments = Arguments { positions, velocities, gradient, factor, time };
        self.buffers.predicted.fill(self.device.as_mut(), bytemuck::bytes_of(&arguments))
    }
}
