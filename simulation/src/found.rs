//! What a run finds out for its scene.

use std::fmt::{Display, Formatter};

/// A number that stays what it is from some step on, and with which the scene may be run from the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// The key of the scene that has it.
    pub key: &'static str,
    /// The number.
    pub value: f64,
    /// What has happened, in words.
    pub what: &'static str,
}

impl Found {
    /// As a setting of the scene, with all digits.
    pub fn setting(&self) -> String {
        format!("{}={:e}", self.key, self.value)
    }
}

impl Display for Found {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {} = {}", self.what, self.key, domain::Number(self.value))
    }
}
