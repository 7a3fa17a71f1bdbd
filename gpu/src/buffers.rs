//! Memory of a device that grows as it is needed.

use crate::device::{Device, DeviceError};
use crate::task::DeviceAddress;
use std::ops::Range;

/// Part of the memory of a list that it takes in addition when it grows: one over this.
const SPARE: usize = 8;

/// A list in the memory of a device.
#[derive(Debug, Default)]
pub(crate) struct Buffer {
    address: DeviceAddress,
    bytes: usize,
}

impl Buffer {
    /// Address of memory for this many bytes. It holds what it did unless it had to grow. Memory that grows takes some
    /// more, so that it keeps its address while a number of pairs fluctuates.
    pub fn reserve(&mut self, device: &mut dyn Device, bytes: usize) -> Result<DeviceAddress, DeviceError> {
        if bytes > self.bytes || self.address == 0 {
            let more = if self.bytes > 1 { bytes / SPARE } else { 0 };
            if self.address != 0 {
                device.release(self.address);
                self.address = 0;
            }
            let bytes = (bytes + more).max(1);
            (self.address, self.bytes) = (device.allocate(bytes)?, bytes);
        }
        Ok(self.address)
    }

    /// Address of the memory; 0 if there is none.
    pub fn address(&self) -> DeviceAddress {
        self.address
    }

    /// Address of a copy of these bytes.
    pub fn fill(&mut self, device: &mut dyn Device, bytes: &[u8]) -> Result<DeviceAddress, DeviceError> {
        let address = self.reserve(device, bytes.len())?;
        device.upload(address, bytes)?;
        Ok(address)
    }
}

/// A list whose values the host knows, so that only those are copied that change.
#[derive(Debug, Default)]
pub(crate) struct KnownBuffer {
    buffer: Buffer,
    bytes: Vec<u8>,
}

impl KnownBuffer {
    /// Address of a copy of these bytes, of which those from the first to the last one that is not there are copied.
    pub fn fill(&mut self, device: &mut dyn Device, bytes: &[u8]) -> Result<DeviceAddress, DeviceError> {
        if self.bytes.len() != bytes.len() || bytes.is_empty() {
            bytes.clone_into(&mut self.bytes);
            return self.buffer.fill(device, bytes);
        }
        let address = self.buffer.address();
        if let Some(changed) = changed(&self.bytes, bytes) {
            device.upload(address + changed.start as u64, &bytes[changed])?;
            self.bytes.copy_from_slice(bytes);
        }
        Ok(address)
    }

    /// Address of the values; 0 if there are none.
    pub fn address(&self) -> DeviceAddress {
        self.buffer.address()
    }

    /// Forgets the values, which the device has changed.
    pub fn forget(&mut self) {
        self.bytes.clear();
    }
}

/// The range from the first to the last of some bytes that differs from the same number of others.
pub(crate) fn changed(known: &[u8], bytes: &[u8]) -> Option<Range<usize>> {
    let is_new = |&place: &usize| known[place] != bytes[place];
    let first = (0..bytes.len()).find(is_new)?;
    let last = (first..bytes.len()).rfind(is_new)?;
    Some(first..last + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bytes that change are copied with those between them, and others are not.
    #[test]
    fn changes_are_from_the_first_to_the_last() {
        assert_eq!(changed(&[1, 2, 3], &[1, 2, 3]), None);
        assert_eq!(changed(&[1, 2, 3, 4], &[1, 0, 3, 0]), Some(1..4));
        assert_eq!(changed(&[1, 2, 3], &[0, 2, 3]), Some(0..1));
    }
}
