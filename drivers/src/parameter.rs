//! The one way in which a driver refuses its input.

use domain::{Number, Vector};

/// A parameter outside its range.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{key} is {found}; it needs {allowed}")]
pub struct ParameterError {
    /// The key, as a scene writes it.
    pub key: &'static str,
    /// What was given.
    pub found: String,
    /// What would do.
    pub allowed: String,
}

/// What was given, as a message shows it.
pub(crate) trait Found {
    /// In words or digits.
    fn shown(&self) -> String;
}

impl Found for f64 {
    fn shown(&self) -> String {
        Number(*self).to_string()
    }
}

impl Found for Vector {
    fn shown(&self) -> String {
        format!("[{}, {}, {}]", Number(self.x), Number(self.y), Number(self.z))
    }
}

impl Found for glam::DVec2 {
    fn shown(&self) -> String {
        format!("[{}, {}]", Number(self.x), Number(self.y))
    }
}

impl Found for u64 {
    fn shown(&self) -> String {
        self.to_string()
    }
}

impl Found for usize {
    fn shown(&self) -> String {
        self.to_string()
    }
}

impl Found for i32 {
    fn shown(&self) -> String {
        self.to_string()
    }
}

impl Found for &str {
    fn shown(&self) -> String {
        (*self).to_owned()
    }
}

impl Found for String {
    fn shown(&self) -> String {
        self.clone()
    }
}

/// Passes if `holds`; else names the key, what was found and what is allowed.
pub(crate) fn require(
    holds: bool,
    key: &'static str,
    found: &impl Found,
    allowed: impl Into<String>,
) -> Result<(), ParameterError> {
    if holds { Ok(()) } else { Err(ParameterError { key, found: found.shown(), allowed: allowed.into() }) }
}

/// Passes a positive, finite number.
pub(crate) fn positive(key: &'static str, found: f64) -> Result<(), ParameterError> {
    require(found > 0.0 && found.is_finite(), key, &found, "a positive, finite number")
}
