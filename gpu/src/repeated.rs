//! Commands that are the same each time, run from a recording.

use crate::device::DeviceError;
use crate::far_field::SplitFarField;

/// Commands that run again and again with the same arguments.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) enum Repeated {
    /// They have not run yet.
    #[default]
    New,
    /// They have run once, so that all memory and plans that they need are there.
    Tried(Vec<u64>),
    /// They are the last recording.
    Recorded(Vec<u64>),
    /// The device does not record them.
    Plain(Vec<u64>),
}

impl SplitFarField {
    /// Runs commands that belong to addresses, by which they are known: as they are at first, then from a recording.
    pub(crate) fn repeat(
        &mut self,
        addresses: &[u64],
        commands: impl Fn(&mut Self) -> Result<(), DeviceError>,
    ) -> Result<(), DeviceError> {
        let known = std::mem::take(&mut self.repeated);
        self.repeated = match known {
            Repeated::Recorded(of) if of == addresses => {
                self.device.replay()?;
                Repeated::Recorded(of)
            }
            Repeated::Tried(of) if of == addresses => {
                if self.record(&commands)? {
                    self.device.replay()?;
                    Repeated::Recorded(of)
                } else {
                    commands(self)?;
                    Repeated::Plain(of)
                }
            }
            Repeated::Plain(of) if of == addresses => {
                commands(self)?;
                Repeated::Plain(of)
            }
            _ => {
                commands(self)?;
                Repeated::Tried(addresses.to_vec())
            }
        };
        Ok(())
    }

    /// Records commands. Returns whether the device has kept them.
    fn record(&mut self, commands: &impl Fn(&mut Self) -> Result<(), DeviceError>) -> Result<bool, DeviceError> {
        if !self.device.begin_recording()? {
            return Ok(false);
        }
        let is_recorded = commands(self).is_ok();
        Ok(self.device.end_recording()? && is_recorded)
    }
}
