//! Checks of the drivers' parameters.

pub use domain::ParameterError;
use domain::{Number, Vector};

/// Values that an error message can show.
pub(crate) trait Found {
    /// The value in words or digits.
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

/// An error that states the value found and the values allowed.
pub(crate) fn refused(key: &'static str, found: &str, allowed: &str) -> ParameterError {
    ParameterError::new(key, format!("is {found}; it needs {allowed}"))
}

/// Returns `Ok` if `holds`; otherwise an error with the key, the value found and the values allowed.
pub(crate) fn require(
    holds: bool,
    key: &'static str,
    found: &impl Found,
    allowed: impl Into<String>,
) -> Result<(), ParameterError> {
    if holds { Ok(()) } else { Err(refused(key, &found.shown(), &allowed.into())) }
}

/// Accepts 0 and numbers of magnitude `10^-power` to `10^power`: products of larger ones would leave the range of
/// floating-point numbers. Measurable quantities are within it in any units from 1e-30 to 1e30.
pub(crate) fn of_sensible_size(key: &'static str, found: f64, power: i32) -> Result<(), ParameterError> {
    let sensible = found == 0.0 || (found.abs().log10()).abs() <= f64::from(power);
    require(sensible, key, &found, format!("a size from 1e-{power} to 1e{power}: take another unit"))
}

/// Accepts a positive, finite number.
pub(crate) fn positive(key: &'static str, found: f64) -> Result<(), ParameterError> {
    require(found > 0.0 && found.is_finite(), key, &found, "a positive, finite number")
}
