//! Method of a case, as the user specifies it.

use fcm::Method;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Evaluation method of the far field.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum CaseMethod {
    /// The fastest one.
    #[default]
    Auto,
    /// The envelopes themselves on the grid.
    Direct,
    /// Wider envelopes on a coarser grid, and a pair correction for the difference.
    Split,
    /// A matrix of exact sums over all pairs.
    Dense,
}

/// An unknown method.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("method is {0:?}; it needs to be \"auto\", \"direct\", \"split\" or \"dense\"")]
pub struct UnknownMethod(String);

impl CaseMethod {
    /// Method of this name.
    pub fn of_word(word: &str) -> Result<Self, UnknownMethod> {
        serde_json::from_value(serde_json::Value::from(word)).map_err(|_| UnknownMethod(word.to_owned()))
    }

    /// The only method that a plan may use, or `None` if there is a choice.
    pub fn alone(self) -> Option<Method> {
        match self {
            Self::Auto => None,
            Self::Direct => Some(Method::Direct),
            Self::Split => Some(Method::Split),
            Self::Dense => Some(Method::Dense),
        }
    }
}
