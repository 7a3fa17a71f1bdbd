//! Checks of the drivers' parameters.

pub use domain::ParameterError;
use domain::{Number, Vector};

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

/// An error that says what was found and what is allowed.
pub(crate) fn refused(key: &'static str, found: &str, allowed: &str) -> ParameterError {
    ParameterError::new(key, format!("is {found}; it needs {allowed}"))
}

/// Passes if `holds`; else names the key, what was found and what is allowed.
pub(crate) fn require(
    holds: bool,
    key: &'static str,
    found: &impl Found,
    allowed: impl Into<String>,
) -> Result<(), ParameterError> {
    if holds { Ok(()) } else { Err(refused(key, &found.shown(), &allowed.into())) }
}

/// Passes 0 and numbers whose size is between `10^-power` and `10^power`: beyond, products of them would leave the range
/// of numbers. Units from 1e-30 to 1e30 make no others of what can be measured.
pub(crate) fn of_sensible_size(key: &'static str, found: f64, power: i32) -> Result<(), ParameterError> {
    let sensible = found == 0.0 || (found.abs().log10()).abs() <= f64::from(power);
    require(sensible, key, &found, format!("a size from 1e-{power} to 1e{power}: take another unit"))
}

/// Passes a positive, finite number.
pub(crate) fn positive(key: &'static str, found: f64) -> Result<(), ParameterError> {
    require(found > 0.0 && found.is_finite(), key, &found, "a positive, finite number")
}
