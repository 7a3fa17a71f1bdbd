//! Parameters that a run determines for its scene.

use std::fmt::{Display, Formatter};

/// A parameter that is constant from some step on, and with which the scene may be run from the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SettledParameter {
    /// Key of the parameter in the scene.
    pub key: &'static str,
    /// Value of the parameter.
    pub value: f64,
    /// Description of how it was determined.
    pub what: &'static str,
}

impl SettledParameter {
    /// The parameter as a setting of the scene, with all digits.
    pub fn setting(&self) -> String {
        format!("{}={:e}", self.key, self.value)
    }
}

impl Display for SettledParameter {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {} = {}", self.what, self.key, domain::Number(self.value))
    }
}
