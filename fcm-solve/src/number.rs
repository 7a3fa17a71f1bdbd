//! Numbers on the command line.

use std::ops::RangeInclusive;

/// Parses a relative tolerance of evaluations, from 1e-12 to 0.5.
pub fn tolerance(text: &str) -> Result<f64, String> {
    within(text, 1e-12..=0.5).ok_or_else(|| "needs to be between 1e-12 and 0.5".to_owned())
}

/// Parses a volume fraction at which spheres can be placed at random, above 0 and up to 0.5.
pub fn fraction(text: &str) -> Result<f64, String> {
    within(text, f64::MIN_POSITIVE..=0.5).ok_or_else(|| "needs to be above 0 and at most 0.5".to_owned())
}

/// Parses a ratio of sphere radii, from 0.05 to 20.
pub fn ratio(text: &str) -> Result<f64, String> {
    within(text, 0.05..=20.0).ok_or_else(|| "needs to be between 0.05 and 20".to_owned())
}

/// Parses a finite number above 0, such as a length or a time.
pub fn positive(text: &str) -> Result<f64, String> {
    within(text, f64::MIN_POSITIVE..=f64::MAX).ok_or_else(|| "needs to be a finite number above 0".to_owned())
}

/// Parses a finite number of any sign, such as a time.
pub fn finite(text: &str) -> Result<f64, String> {
    within(text, f64::MIN..=f64::MAX).ok_or_else(|| "needs to be a finite number".to_owned())
}

fn within(text: &str, range: RangeInclusive<f64>) -> Option<f64> {
    text.parse().ok().filter(|number| range.contains(number))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_out_of_range_are_refused_with_their_range() {
        assert_eq!((tolerance("1e-3"), fraction("0.5"), ratio("0.05")), (Ok(1e-3), Ok(0.5), Ok(0.05)));
        assert_eq!((positive("1e-300"), finite("-2")), (Ok(1e-300), Ok(-2.0)));
        for text in ["-1", "0", "nan", "inf", "many", ""] {
            assert!(tolerance(text).unwrap_err().contains("1e-12 and 0.5"), "{text}");
            assert!(fraction(text).is_err() && ratio(text).is_err() && positive(text).is_err(), "{text}");
        }
        assert!(finite("nan").is_err() && finite("-inf").is_err());
    }
}
