//! Ratios of lengths as the exact fractions that they stand for.
//!
//! A random start is chaotic: a hundred collisions amplify the last bit of a ratio of two lengths to a different
//! state. That bit depends on the unit in which a file gives the lengths: 0.004 / 0.000787 and 4 / 0.787 may differ
//! in it, but both mean 4000 / 787.

/// Largest denominator, enough for two lengths of a few digits. Hardly any other number is this
/// close to such a fraction.
const LARGEST: u64 = 100_000;
/// Relative round-off of two numbers and their ratio.
const ROUND_OFF: f64 = 4.0 * f64::EPSILON;

/// The fraction with the smallest denominator that equals a positive ratio up to round-off, by its continued fraction.
pub fn fraction(ratio: f64) -> Option<[u64; 2]> {
    let (mut before, mut now, mut rest) = ([0_u64, 1], [1_u64, 0], ratio);
    while rest.is_finite() && rest < 1e15 {
        let next = [0, 1].map(|k| (rest.floor() as u64).checked_mul(now[k]).and_then(|n| n.checked_add(before[k])));
        let [Some(above), Some(below)] = next else { return None };
        (before, now) = (now, [above, below]);
        if below > LARGEST {
            return None;
        }
        if above > 0 && (above as f64 / below as f64 - ratio).abs() <= ROUND_OFF * ratio {
            return Some(now);
        }
        rest = 1.0 / (rest - rest.floor());
    }
    None
}

/// Ratio of two positive numbers, independent of the unit in which both are given.
pub fn ratio(a: f64, b: f64) -> f64 {
    fraction(a / b).map_or(a / b, |[above, below]| above as f64 / below as f64)
}

/// Length, height, width and diameter in a unit that does not depend on that of the input, in which decimal numbers
/// become whole numbers times a power of ten, and the diameter is from 1e-4 to 1e-3, like that of sand in metres.
/// Lengths that are not decimal numbers are returned unchanged.
pub fn without_unit(lengths: [f64; 4]) -> [f64; 4] {
    whole(lengths).and_then(|whole| decimal(&whole)?.try_into().ok()).unwrap_or(lengths)
}

/// Whole numbers with the same ratios.
fn whole(lengths: [f64; 4]) -> Option<Vec<u64>> {
    let ratios = lengths.iter().map(|length| fraction(length / lengths[3])).collect::<Option<Vec<_>>>()?;
    let mut belows = ratios.iter().map(|[_, below]| *below);
    let common = belows.try_fold(1, |common: u64, below| common.checked_mul(below / divisor(common, below)))?;
    ratios.iter().map(|[above, below]| above.checked_mul(common / below)).collect()
}

fn divisor(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { divisor(b, a % b) }
}

/// The numbers divided by the power of ten that brings the last one into its range.
fn decimal(whole: &[u64]) -> Option<Vec<f64>> {
    let power = 4 + whole.last()?.ilog10();
    whole.iter().map(|n| format!("{n}e-{power}").parse().ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_of_decimal_numbers_are_the_same_in_any_unit() {
        for (a, b, exact) in [("4", "0.787", [4000, 787]), ("0.7", "2.1", [1, 3]), ("1.4142", "1", [7071, 5000])] {
            for power in -30..=30 {
                let [a, b] = [a, b].map(|digits| format!("{digits}e{power}").parse::<f64>().unwrap());
                for factor in [1.0, 2_f64.powi(-77), 2_f64.powi(9)] {
                    assert_eq!(fraction(a * factor / (b * factor)), Some(exact));
                    assert!((ratio(a, b) - exact[0] as f64 / exact[1] as f64).abs() == 0.0);
                }
            }
        }
    }

    #[test]
    fn other_ratios_stay_as_they_are() {
        for number in [std::f64::consts::PI, 2_f64.sqrt(), 1.234_567_890_123_456, 1e-9 / 3.0, 1e300, f64::INFINITY] {
            assert!(fraction(number).is_none(), "{number}");
        }
        assert!((ratio(std::f64::consts::PI, 1.0) - std::f64::consts::PI).abs() == 0.0);
    }

    #[test]
    fn lengths_are_the_same_in_any_unit() {
        let lengths = [0.008, 0.004, 0.0075, 0.787e-3];
        assert_eq!(without_unit(lengths).map(f64::to_bits), lengths.map(f64::to_bits));
        for power in -30..=30 {
            let scaled = ["8", "4", "7.5", "0.787"].map(|digits| format!("{digits}e{power}").parse().unwrap());
            assert_eq!(without_unit(scaled).map(f64::to_bits), lengths.map(f64::to_bits), "1e{power}");
            let doubled = lengths.map(|length| length * 2_f64.powi(3 * power));
            assert_eq!(without_unit(doubled).map(f64::to_bits), lengths.map(f64::to_bits), "2^{}", 3 * power);
        }
        let odd = [std::f64::consts::PI, 4.0, 5.0, 1.0];
        assert_eq!(without_unit(odd).map(f64::to_bits), odd.map(f64::to_bits));
    }
}
