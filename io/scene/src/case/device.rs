//! Device of a case or scene, as the user specifies it.

use fcm::ComputeDevice;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Device that evaluates the far field.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum CaseDevice {
    /// The processors of the host.
    #[default]
    Cpu,
    /// A graphics card.
    Gpu,
}

/// An unknown device.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("device is {0:?}; it needs to be \"cpu\" or \"gpu\"")]
pub struct UnknownDevice(String);

impl CaseDevice {
    /// Device of this name.
    pub fn of_word(word: &str) -> Result<Self, UnknownDevice> {
        serde_json::from_value(serde_json::Value::from(word)).map_err(|_| UnknownDevice(word.to_owned()))
    }
}

impl From<CaseDevice> for ComputeDevice {
    fn from(device: CaseDevice) -> Self {
        match device {
            CaseDevice::Cpu => Self::Cpu,
            CaseDevice::Gpu => Self::Gpu,
        }
    }
}
