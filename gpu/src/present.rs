//! Numbers and state of a device at present.

use crate::buffers::changed;
use crate::device::DeviceError;
use crate::far_field::SplitFarField;
use crate::numbers::{KernelNumbers, SolveSettings, SolveState};
use crate::task::DeviceAddress;

impl SplitFarField {
    /// Copies numbers to the device, from the first to the last that is not there.
    pub(crate) fn set_numbers(&mut self, numbers: &KernelNumbers) -> Result<(), DeviceError> {
        let bytes = bytemuck::bytes_of(numbers);
        if let Some(changed) = changed(bytemuck::bytes_of(&self.numbers), bytes) {
            self.device.upload(self.task.numbers + changed.start as u64, &bytes[changed])?;
            self.numbers = *numbers;
        }
        Ok(())
    }

    /// Sets what the host sets of the state of a solve.
    pub(crate) fn set_state(&mut self, settings: &SolveSettings) -> Result<(), DeviceError> {
        self.device.upload(self.task.state, bytemuck::bytes_of(settings))
    }

    /// The present state of a solve.
    pub(crate) fn state(&mut self) -> Result<SolveState, DeviceError> {
        let mut state = SolveState::default();
        self.device.download(self.task.state, bytemuck::bytes_of_mut(&mut state))?;
        Ok(state)
    }

    /// Address of the sums of the state.
    pub(crate) fn sums_of_state(&self) -> DeviceAddress {
        self.task.state + size_of::<SolveSettings>() as u64
    }
}
