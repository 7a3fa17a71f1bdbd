//! Parameters and their allowed ranges. Keys are those of a scene.

use crate::{Number, Vector};
use std::fmt::Display;

/// Error for a parameter outside of its range.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{key} {message}")]
pub struct ParameterError {
    /// Key as written in a scene.
    pub key: String,
    /// Value found and values allowed, to be read after the key.
    pub message: String,
}

impl ParameterError {
    /// Error for a key, with the rest of the message.
    pub fn new(key: impl Into<String>, message: impl Into<String>) -> Self {
        Self { key: key.into(), message: message.into() }
    }

    /// Returns a finite number, or an error.
    pub fn require_finite(key: &str, value: f64) -> Result<f64, Self> {
        require(value.is_finite(), key, Number(value), "to be a finite number").map(|()| value)
    }

    /// Returns a finite number above 0, or an error.
    pub fn require_positive(key: &str, value: f64) -> Result<f64, Self> {
        let holds = value > 0.0 && value.is_finite();
        require(holds, key, Number(value), "to be a finite number above 0").map(|()| value)
    }

    /// Returns a number in a range, both ends included, or an error.
    pub fn require_between(key: &str, value: f64, [low, high]: [f64; 2]) -> Result<f64, Self> {
        let allowed = format_args!("to be between {} and {}", Number(low), Number(high));
        require((low..=high).contains(&value), key, Number(value), allowed).map(|()| value)
    }

    /// Returns a vector of finite numbers, or an error.
    pub fn require_finite_vector(key: &str, value: Vector) -> Result<Vector, Self> {
        for (axis, component) in value.to_array().into_iter().enumerate() {
            Self::require_finite(&format!("{key}[{axis}]"), component)?;
        }
        Ok(value)
    }
}

/// Error that states the value found and the values allowed, which are read after "it needs".
pub fn refused(key: &str, found: impl Display, allowed: impl Display) -> ParameterError {
    ParameterError::new(key, format!("is {found}; it needs {allowed}"))
}

/// Returns `Ok` if `holds`; otherwise an error with the key, the value found and the values allowed.
pub fn require(holds: bool, key: &str, found: impl Display, allowed: impl Display) -> Result<(), ParameterError> {
    if holds { Ok(()) } else { Err(refused(key, found, allowed)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_message_names_key_value_and_range() {
        let between = |value| ParameterError::require_between("a.b", value, [0.5, 1.0]);
        assert_eq!((between(0.5), between(1.0)), (Ok(0.5), Ok(1.0)));
        assert_eq!(between(2.0).unwrap_err().to_string(), "a.b is 2; it needs to be between 0.5 and 1");
        assert!(between(f64::NAN).is_err());
        assert!(
            ParameterError::require_positive("a", 0.0).is_err()
                && ParameterError::require_positive("a", 1e-300).is_ok()
        );
        let vector = Vector::new(0.0, f64::INFINITY, 0.0);
        let error = ParameterError::require_finite_vector("x", vector).unwrap_err();
        assert_eq!(error.to_string(), "x[1] is inf; it needs to be a finite number");
    }
}
