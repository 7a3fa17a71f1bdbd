//! Memory of a device that grows as it is needed.

use crate::device::{Device, DeviceError};
use crate::task::DeviceAddress;

/// A list in the memory of a device.
#[derive(Debug, Default)]
pub(crate) struct Buffer {
    address: DeviceAddress,
    bytes: usize,
}

impl Buffer {
    /// Address of memory for this many bytes. It holds what it did unless it had to grow.
    pub fn reserve(&mut self, device: &mut dyn Device, bytes: usize) -> Result<DeviceAddress, DeviceError> {
        if bytes > self.bytes || self.address == 0 {
            if self.address != 0 {
                device.release(self.address);
                self.address = 0;
            }
            let bytes = bytes.max(1);
            (self.address, self.bytes) = (device.allocate(bytes)?, bytes);
        }
        Ok(self.address)
    }

    /// Address of a copy of these bytes.
    pub fn fill(&mut self, device: &mut dyn Device, bytes: &[u8]) -> Result<DeviceAddress, DeviceError> {
        let address = self.reserve(device, bytes.len())?;
        device.upload(address, bytes)?;
        Ok(address)
    }
}
