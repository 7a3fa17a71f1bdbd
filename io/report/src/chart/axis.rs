//! Range and ticks of an axis.

use domain::Number;

/// Approximate number of ticks of an axis.
const TICKS: f64 = 6.0;
/// Fraction of the range that is left free at either end.
const MARGIN: f64 = 0.04;
/// Larger numbers are not drawn: their differences might be infinite.
const LARGEST: f64 = 1e300;

/// Range of an axis, in decades if it is logarithmic, and its ticks.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ChartAxis {
    low: f64,
    high: f64,
    is_log: bool,
    ticks: Vec<f64>,
    /// Power of ten that is omitted from the labels.
    pub(super) power: i32,
}

impl ChartAxis {
    /// An axis for these values; values that it cannot show are ignored. `None` if there are no others.
    pub(super) fn of(values: impl Iterator<Item = f64>, is_log: bool) -> Option<Self> {
        let shown = values.filter_map(|value| coordinate(value, is_log));
        let (least, most) = shown.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, m), x| (l.min(x), m.max(x)));
        if least > most {
            return None;
        }
        let (least, most) = wide_enough(least, most, is_log);
        let margin = MARGIN * (most - least);
        let (low, high) = (least - margin, most + margin);
        let step = if is_log { ((high - low) / TICKS).ceil() } else { nice((high - low) / TICKS) };
        let ticks = (0..).map(|k| ((low / step).ceil() + f64::from(k)) * step).take_while(|&tick| tick <= high);
        let power = if is_log { 0 } else { left_out(low.abs().max(high.abs())) };
        Some(Self { low, high, is_log, ticks: ticks.collect(), power })
    }

    /// Position of a value, from 0 at the start of the axis to 1 at its end.
    pub(super) fn place(&self, value: f64) -> Option<f64> {
        coordinate(value, self.is_log).map(|x| (x - self.low) / (self.high - self.low))
    }

    /// Positions and labels of the ticks.
    pub(super) fn ticks(&self) -> impl Iterator<Item = (f64, String)> {
        self.ticks.iter().map(|&tick| ((tick - self.low) / (self.high - self.low), self.label(tick)))
    }

    fn label(&self, tick: f64) -> String {
        if self.is_log {
            return power_of_ten(tick as i32);
        }
        let scaled = tick / 10_f64.powi(self.power);
        // Multiples of the step carry its round-off: 0.30000000000000004.
        let text = format!("{:.6}", Number(scaled));
        let is_zero = tick.abs() < 1e-9 * (self.high - self.low);
        if is_zero { "0".to_owned() } else { text.replace('-', "\u{2212}") }
    }
}

/// A power of ten as text with a superscript exponent.
pub(super) fn power_of_ten(power: i32) -> String {
    let raised = |digit: char| {
        "\u{2070}\u{b9}\u{b2}\u{b3}\u{2074}\u{2075}\u{2076}\u{2077}\u{2078}\u{2079}"
            .chars()
            .nth(digit.to_digit(10).map_or(0, |digit| digit as usize))
            .expect("ten digits")
    };
    let sign = if power < 0 { "\u{207b}" } else { "" };
    let digits: String = power.abs().to_string().chars().map(raised).collect();
    format!("10{sign}{digits}")
}

/// Coordinate of a value on the axis, if it can be shown.
fn coordinate(value: f64, is_log: bool) -> Option<f64> {
    let can_be_shown = value.abs() < LARGEST && !(is_log && value < 1.0 / LARGEST);
    can_be_shown.then(|| if is_log { value.log10() } else { value })
}

/// Widens a range that is within round-off, and a logarithmic one to at least a decade.
fn wide_enough(least: f64, most: f64, is_log: bool) -> (f64, f64) {
    if is_log && most - least < 1.0 {
        return (least.floor(), most.ceil().max(least.floor() + 1.0));
    }
    let size = least.abs().max(most.abs());
    if most - least > 1e-9 * size && most - least > 1.0 / LARGEST {
        return (least, most);
    }
    let half = if size > 1.0 / LARGEST { 0.1 * size } else { 1.0 };
    (least - half, most + half)
}

/// Smallest number of the form 1, 2 or 5 times a power of ten that is not less than `step`.
fn nice(step: f64) -> f64 {
    let decade = 10_f64.powf(step.log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|n| n * decade).find(|&nice| nice >= step * (1.0 - 1e-9)).unwrap_or(step)
}

/// Power of ten that labels of numbers up to `largest` omit.
fn left_out(largest: f64) -> i32 {
    let power = largest.log10().floor() as i32;
    if (-2..4).contains(&power) { 0 } else { power }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(values: &[f64], is_log: bool) -> (Vec<String>, i32) {
        let axis = ChartAxis::of(values.iter().copied(), is_log).unwrap();
        (axis.ticks().map(|(_, label)| label).collect(), axis.power)
    }

    #[test]
    fn ticks_are_round_numbers() {
        assert_eq!(labels(&[0.0, 1.0], false).0, ["0", "0.2", "0.4", "0.6", "0.8", "1"]);
        assert_eq!(labels(&[-0.3, 0.31], false).0, ["\u{2212}0.2", "0", "0.2"]);
        assert_eq!(labels(&[0.0, 4.9e-5], false), (["0", "1", "2", "3", "4", "5"].map(String::from).to_vec(), -5));
        assert_eq!(labels(&[1e-3, 1e5], true).0, ["10⁻²", "10⁰", "10²", "10⁴"]);
        assert_eq!(power_of_ten(-12), "10⁻¹²");
    }

    #[test]
    fn any_numbers_have_an_axis_or_none() {
        assert_eq!(ChartAxis::of([f64::NAN, f64::INFINITY].into_iter(), false), None);
        assert_eq!(ChartAxis::of([0.0, -1.0].into_iter(), true), None, "nothing of it is above 0");
        for values in [[0.0, 0.0], [7.0, 7.0], [1e299, -1e299], [5e-324, 0.0], [1.0, 1.0 + 1e-15], [-3e-200, 2e-200]] {
            let axis = ChartAxis::of(values.into_iter(), false).unwrap();
            assert!((1..20).contains(&axis.ticks.len()), "{axis:?}");
            for place in values.map(|value| axis.place(value).unwrap()) {
                assert!((0.0..=1.0).contains(&place), "{axis:?}");
            }
        }
        let axis = ChartAxis::of([2.0, 3.0].into_iter(), true).unwrap();
        assert!(!axis.ticks.is_empty() && axis.place(0.0).is_none() && axis.place(f64::NAN).is_none());
    }
}
