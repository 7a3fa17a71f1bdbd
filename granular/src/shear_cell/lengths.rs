//! Lengths of a cell in a unit that does not depend on that of the input: a random start would
//! change with the last bit.

use crate::fraction::fraction;

/// Length, height, width and diameter in a unit in which decimal numbers become whole numbers times a power of
/// ten, and the diameter is from 1e-4 to 1e-3, like that of sand in metres. Lengths that are not decimal
/// numbers are returned unchanged.
pub fn without_unit(lengths: [f64; 4]) -> [f64; 4] {
    whole(lengths).and_then(decimal).unwrap_or(lengths)
}

/// Whole numbers with the same ratios.
fn whole(lengths: [f64; 4]) -> Option<[u64; 4]> {
    let [length, height, width, diameter] = lengths;
    let [x, y, z] = [length, height, width].map(|edge| fraction(edge / diameter));
    let edges = [x?, y?, z?];
    let common =
        edges.iter().try_fold(1, |common: u64, [_, below]| common.checked_mul(below / divisor(common, *below)))?;
    let [Some(x), Some(y), Some(z)] = edges.map(|[above, below]| above.checked_mul(common / below)) else {
        return None;
    };
    Some([x, y, z, common])
}

fn divisor(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { divisor(b, a % b) }
}

/// The numbers divided by the power of ten that brings the last one into its range.
fn decimal(whole: [u64; 4]) -> Option<[f64; 4]> {
    let power = 4 + whole[3].ilog10();
    let parsed = whole.map(|n| format!("{n}e-{power}").parse().ok());
    let [Some(x), Some(y), Some(z), Some(diameter)] = parsed else { return None };
    Some([x, y, z, diameter])
}

#[cfg(test)]
mod tests {
    use super::*;

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
