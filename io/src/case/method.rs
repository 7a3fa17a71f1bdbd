//! What a user says of the method.

use fcm::MethodName;
use serde::{Deserialize, Serialize};

/// How the far field is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CaseMethod {
    /// In the way that takes less time.
    #[default]
    Auto,
    /// The envelopes themselves on the grid.
    Direct,
    /// Wider envelopes on a coarser grid, and the difference pair by pair.
    Split,
}

/// A word that is none of these.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("method is {0:?}; it needs to be \"auto\", \"direct\" or \"split\"")]
pub struct UnknownMethod(String);

impl CaseMethod {
    /// What a word says.
    pub fn of_word(word: &str) -> Result<Self, UnknownMethod> {
        serde_json::from_value(serde_json::Value::from(word)).map_err(|_| UnknownMethod(word.to_owned()))
    }

    /// The method of a plan that it allows alone, if it does.
    pub fn alone(self) -> Option<MethodName> {
        match self {
            Self::Auto => None,
            Self::Direct => Some(MethodName::Direct),
            Self::Split => Some(MethodName::Split),
        }
    }
}
