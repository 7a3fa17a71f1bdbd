//! Numbers in the memory of a device that kernels read, and that change without a change of the commands.

use crate::buffers::Buffer;
use crate::device::{Device, DeviceError};
use crate::task::DeviceAddress;
use bytemuck::{Pod, Zeroable};

/// Numbers with the fields of `gpu/kernels/task.h`, which explains them, in the same order.
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct KernelNumbers {
    pub edges: [f64; 3],
    pub inverse_spacing: [f64; 3],
    pub strain: f64,
    pub tilt_x: f64,
    pub tilt_y: f64,
    pub tilt_across: f64,
    pub axes: [f64; 9],
    pub solve_factor: f64,
    pub background: [f64; 5],
    pub slope: [f64; 2],
    pub lowest: f64,
    pub force: f64,
    pub torque: f64,
    pub velocity: f64,
    pub rate: f64,
    pub noise_seed: u64,
    pub near_entries: [i64; 2],
    pub given_entries: i64,
    pub length: f64,
}

/// Numbers of a direction and a step of the coupled iteration, and of an iteration for near pairs, which the host sets.
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct SolveSettings {
    pub turn: f64,
    pub product: f64,
    pub products: [f64; 2],
    pub goes_on: [f64; 2],
    pub square: f64,
    pub steps: f64,
}

impl SolveSettings {
    /// For an iteration for near pairs that begins, to a relative error.
    pub fn new(tolerance: f64) -> Self {
        Self { goes_on: [1.0; 2], square: tolerance * tolerance, ..Self::default() }
    }
}

/// Number of sums of a coupled iteration.
pub(crate) const COUPLED_SUMS: usize = 5;

/// State of a solve with near pairs, as in `gpu/kernels/task.h`: settings, which kernels change, and sums.
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct SolveState {
    pub settings: SolveSettings,
    pub sums: [f64; COUPLED_SUMS],
}

/// Memory of the numbers and of the state.
#[derive(Default)]
pub(crate) struct NumberBuffers {
    numbers: Buffer,
    state: Buffer,
}

impl NumberBuffers {
    /// Addresses of the numbers, which have their default values, and of the state.
    pub fn reserve(&mut self, on: &mut dyn Device) -> Result<[DeviceAddress; 2], DeviceError> {
        let numbers = self.numbers.fill(on, bytemuck::bytes_of(&KernelNumbers::default()))?;
        Ok([numbers, self.state.reserve(on, size_of::<SolveState>())?])
    }
}
