//! Interface of a device.

use crate::task::{DeviceAddress, KernelTask};
use std::collections::BTreeMap;

/// Failure of a device: its memory is full, a library is missing, or it reports an error.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct DeviceError(pub String);

/// Properties of a device.
#[derive(Debug, Clone, PartialEq)]
pub struct DeviceInfo {
    /// Name.
    pub name: String,
    /// Number that no other card has.
    pub identity: [u8; 16],
    /// Bytes of its memory.
    pub total_bytes: f64,
    /// Bytes that are free.
    pub free_bytes: f64,
}

/// A kernel and the threads that run it.
#[derive(Debug, Clone, Copy)]
pub struct KernelLaunch<'a> {
    /// Name of the kernel.
    pub kernel: &'a str,
    /// Number of blocks.
    pub blocks: usize,
    /// Threads of a block.
    pub threads: usize,
}

/// Part of a Fourier transform.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TransformPart {
    /// Along all axes.
    Whole,
    /// Along x and y, to the modes of each plane.
    Planes,
    /// Along z, of the modes of planes, in place.
    AlongZ,
}

/// Fourier transform of three components on a grid, without a factor, to the modes `m1 <= nx/2` or back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TransformTask {
    /// From the grid to modes.
    pub is_forward: bool,
    /// In `f32`.
    pub is_single: bool,
    /// Part of the transform.
    pub part: TransformPart,
    /// Points along x, y and z; x is the fastest.
    pub points: [usize; 3],
    /// Address of the values on the grid, which a part along z does not use.
    pub field: u64,
    /// Address of the modes. A transform back overwrites them.
    pub spectrum: u64,
}

/// Memory, kernels and transforms of a device. Commands take effect in their order; those that return nothing may do so
/// later.
pub trait Device {
    /// Properties of the device at present.
    fn info(&self) -> Result<DeviceInfo, DeviceError>;

    /// Memory of this many bytes, whose values are undefined.
    fn allocate(&mut self, bytes: usize) -> Result<DeviceAddress, DeviceError>;

    /// Releases memory.
    fn release(&mut self, address: DeviceAddress);

    /// Sets bytes to zero, from an address within memory.
    fn zero(&mut self, address: DeviceAddress, bytes: usize) -> Result<(), DeviceError>;

    /// Copies bytes to an address within memory.
    fn upload(&mut self, address: DeviceAddress, bytes: &[u8]) -> Result<(), DeviceError>;

    /// Copies bytes from addresses within memory, after all commands before. The host waits once for all of them.
    fn download_all(&mut self, parts: &mut [(DeviceAddress, &mut [u8])]) -> Result<(), DeviceError>;

    /// Copies bytes from an address within memory, after all commands before.
    fn download(&mut self, address: DeviceAddress, bytes: &mut [u8]) -> Result<(), DeviceError> {
        self.download_all(&mut [(address, bytes)])
    }

    /// Runs a kernel.
    fn launch(&mut self, launch: &KernelLaunch, task: &KernelTask) -> Result<(), DeviceError>;

    /// Transforms a field.
    fn transform(&mut self, task: &TransformTask) -> Result<(), DeviceError>;

    /// Begins a recording: kernels and transforms up to its end are kept, and not run. There are no other commands.
    /// Returns whether the device can record.
    fn begin_recording(&mut self) -> Result<bool, DeviceError>;

    /// Ends a recording, which replaces that with the same number. Returns whether the device could keep it.
    fn end_recording(&mut self, number: usize) -> Result<bool, DeviceError>;

    /// Runs the commands of a recording.
    fn replay(&mut self, number: usize) -> Result<(), DeviceError>;

    /// Bytes of its memory that each kernel has read and written, in sectors of 32 bytes that count once in a run;
    /// empty if the device does not count them.
    fn moved(&self) -> BTreeMap<String, u64> {
        BTreeMap::new()
    }

    /// Waits for all commands.
    fn finish(&mut self) -> Result<(), DeviceError>;
}
