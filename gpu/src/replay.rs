//! Runs of commands that are recorded.

use crate::device::DeviceError;
use crate::far_field::SplitFarField;
use crate::repeated::{CommandKey, CommandList, Repeated};
use crate::task::DeviceAddress;

impl SplitFarField {
    /// Runs commands that depend on the task and some addresses: as they are at first, then from a recording as long as
    /// these do not change. What changes from step to step is in memory, see [`crate::numbers`].
    pub(crate) fn repeat(
        &mut self,
        list: CommandList,
        addresses: &[DeviceAddress],
        commands: impl Fn(&mut Self) -> Result<(), DeviceError>,
    ) -> Result<(), DeviceError> {
        let number = list as usize;
        let addresses = addresses.iter().copied().chain(self.buffers.scratch()).collect();
        let key = CommandKey { task: Box::new(self.task), addresses };
        let known = std::mem::take(&mut self.repeated[number]);
        self.repeated[number] = match known {
            Repeated::Recorded(of) if of == key => {
                self.device.replay(number)?;
                Repeated::Recorded(of)
            }
            Repeated::Tried(of) if of == key => {
                if self.record(number, &commands)? {
                    self.device.replay(number)?;
                    Repeated::Recorded(of)
                } else {
                    commands(self)?;
                    Repeated::Plain(of)
                }
            }
            Repeated::Plain(of) if of == key => {
                commands(self)?;
                Repeated::Plain(of)
            }
            _ => {
                commands(self)?;
                Repeated::Tried(key)
            }
        };
        Ok(())
    }

    /// Records commands. Returns whether the device has kept them.
    fn record(
        &mut self,
        number: usize,
        commands: &impl Fn(&mut Self) -> Result<(), DeviceError>,
    ) -> Result<bool, DeviceError> {
        if !self.device.begin_recording()? {
            return Ok(false);
        }
        let is_recorded = commands(self).is_ok();
        Ok(self.device.end_recording(number)? && is_recorded)
    }
}
