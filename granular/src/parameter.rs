//! Checks of parameters, with errors that state the value found and the values allowed.

pub use domain::ParameterError;
pub(crate) use domain::{refused, require};

use domain::Number;
use std::fmt::{Display, Formatter, Result as FormatResult};

/// The components of a vector, as an error shows them.
pub(crate) struct Components<const N: usize>(pub(crate) [f64; N]);

impl<const N: usize> Display for Components<N> {
    fn fmt(&self, f: &mut Formatter<'_>) -> FormatResult {
        write!(f, "[{}]", self.0.map(|x| Number(x).to_string()).join(", "))
    }
}

/// Accepts 0 and numbers of magnitude `10^-power` to `10^power`: products of larger ones would leave the range of
/// floating-point numbers. Measurable quantities are within it in any units from 1e-30 to 1e30.
pub(crate) fn of_sensible_size(key: &'static str, found: f64, power: i32) -> Result<(), ParameterError> {
    let sensible = found == 0.0 || (found.abs().log10()).abs() <= f64::from(power);
    let allowed = format_args!("a size from 1e-{power} to 1e{power}: take another unit");
    require(sensible, key, Number(found), allowed)
}

/// Accepts a positive, finite number.
pub(crate) fn positive(key: &'static str, found: f64) -> Result<(), ParameterError> {
    require(found > 0.0 && found.is_finite(), key, Number(found), "a positive, finite number")
}

/// Accepts a positive, finite number, or zero.
pub(crate) fn not_negative(key: &'static str, found: f64) -> Result<(), ParameterError> {
    require(found >= 0.0 && found.is_finite(), key, Number(found), "a finite number, not negative")
}

/// Accepts a finite number.
pub(crate) fn finite(key: &'static str, found: f64) -> Result<(), ParameterError> {
    require(found.is_finite(), key, Number(found), "a finite number")
}

/// Accepts a coefficient of restitution from 0 to 1.
pub(crate) fn restitution(key: &'static str, found: f64) -> Result<(), ParameterError> {
    require((0.0..=1.0).contains(&found), key, Number(found), "0 <= restitution <= 1")
}
