//! Readable numbers of any magnitude.

use std::fmt::{Display, Formatter, Result};

/// A number in a message. `{}` shows the fewest digits that identify it, `{:.4}` at most four significant ones; both
/// without trailing zeros, and with an exponent if that is shorter: 0.15, 5500, 5.2e-8, 1e30.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Number(pub f64);

/// Powers of ten that are written without an exponent.
const PLAIN: std::ops::Range<i32> = -4..7;

impl Display for Number {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let scientific = match f.precision() {
            None => format!("{:e}", self.0),
            Some(digits) => format!("{:.*e}", digits.saturating_sub(1), self.0),
        };
        let Some((digits, power)) = scientific.split_once('e') else { return f.write_str(&scientific) };
        let power: i32 = power.parse().unwrap_or(0);
        if !PLAIN.contains(&power) {
            return write!(f, "{}e{power}", trimmed(digits));
        }
        let decimals = (digits.chars().filter(char::is_ascii_digit).count() as i32 - 1 - power).max(0);
        f.write_str(trimmed(&format!("{:.*}", decimals as usize, self.0)))
    }
}

/// Removes zeros at the end of a fraction.
fn trimmed(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_any_size_can_be_read() {
        let shown = |x: f64| format!("{} {:.4}", Number(x), Number(x));
        for (number, text) in [
            (0.15000000000000002, "0.15000000000000002 0.15"),
            (5500.0, "5500 5500"),
            (5.2e-8, "5.2e-8 5.2e-8"),
            (1e30, "1e30 1e30"),
            (1e-30, "1e-30 1e-30"),
            (0.0, "0 0"),
            (-0.25, "-0.25 -0.25"),
            (1e-4, "0.0001 0.0001"),
            (9_999_999.0, "9999999 1e7"),
            (123_456.7, "123456.7 123457"),
            (std::f64::consts::PI, "3.141592653589793 3.142"),
            (-1.23456e-12, "-1.23456e-12 -1.235e-12"),
            (0.99999, "0.99999 1"),
            (f64::INFINITY, "inf inf"),
            (f64::NAN, "NaN NaN"),
        ] {
            assert_eq!(shown(number), text);
        }
    }

    proptest::proptest! {
        #[test]
        fn the_fewest_digits_give_the_number_back(bits: u64) {
            let number = f64::from_bits(bits);
            proptest::prop_assume!(number.is_finite());
            let text = Number(number).to_string();
            proptest::prop_assert_eq!(text.parse().map(f64::to_bits), Ok(number.to_bits()));
            proptest::prop_assert!(text.len() <= 24, "{}", text);
        }
    }
}
