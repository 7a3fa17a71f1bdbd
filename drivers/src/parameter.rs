//! The one way in which a driver refuses its input.

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

/// Passes if `holds`; else names the key, what was found and what is allowed.
pub(crate) fn require(
    holds: bool,
    key: &'static str,
    found: &impl ToString,
    allowed: impl Into<String>,
) -> Result<(), ParameterError> {
    if holds { Ok(()) } else { Err(ParameterError { key, found: found.to_string(), allowed: allowed.into() }) }
}

/// Passes a positive, finite number.
pub(crate) fn positive(key: &'static str, found: f64) -> Result<(), ParameterError> {
    require(found > 0.0 && found.is_finite(), key, &found, "a positive, finite number")
}
