//! Extreme values, and plausible ones.

use proptest::prelude::*;
use proptest::sample::select;
use toml::{Table, Value};

const NUMBERS: [f64; 22] = [
    0.0,
    -0.0,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    1e308,
    -1e308,
    f64::MAX,
    5e-324,
    -5e-324,
    f64::MIN_POSITIVE,
    1e-30,
    1e30,
    -1.0,
    1e-12,
    1e12,
    9007199254740993.0,
    1.8446744073709552e19,
    1e-160,
    1e160,
    -1e-9,
    0.5000000000000001,
];

const USUAL: [f64; 12] = [0.1, 0.5, 1.0, 1.5, 2.0, 3.0, 5.0, 10.0, 0.01, 1e-3, 1e-6, 100.0];

const WHOLE: [i64; 16] =
    [0, 1, 2, 3, 5, 7, 64, -1, i64::MAX, i64::MIN, 1 << 31, (1 << 32) - 1, 1 << 32, 1 << 53, 1_000_000, 255];

const WORDS: [&str; 44] = [
    "",
    " ",
    "a",
    "nan",
    "1",
    "-",
    ".",
    "..",
    "x=y",
    "Ж",
    "\u{feff}",
    "\u{202e}abc",
    "a\nb",
    "\t",
    "\"",
    "'",
    "none",
    "shear",
    "poiseuille",
    "random",
    "lattice",
    "positions",
    "file",
    "adaptive",
    "implicit",
    "adams-bashforth",
    "monopole",
    "direct",
    "split",
    "gear-five",
    "time-stepped",
    "event-driven",
    "free",
    "fixed",
    "granular-disks",
    "shear-cell",
    "shear-cell-continuum",
    "suspension",
    "sphere",
    "aligned",
    "doublet",
    "rod",
    "shell",
    "aggregate",
];

/// A number: extreme, plausible, or of any magnitude.
pub fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => select(&NUMBERS[..]),
        5 => select(&USUAL[..]),
        2 => (-40..40i32).prop_map(|power| 10f64.powi(power)),
        2 => -100.0..100.0,
        1 => any::<u64>().prop_map(f64::from_bits),
    ]
}

/// A whole number.
pub fn whole() -> impl Strategy<Value = i64> {
    prop_oneof![3 => select(&WHOLE[..]), 1 => 0..20i64, 1 => any::<i64>()]
}

/// Text without slashes, so that no file name leads out of its folder.
pub fn word() -> impl Strategy<Value = String> {
    prop_oneof![
        6 => select(&WORDS[..]).prop_map(str::to_owned),
        2 => "[^/\\x00]{0,12}",
        1 => (1..5000usize).prop_map(|length| "x".repeat(length)),
        1 => (0..40usize).prop_map(|depth| "[".repeat(depth)),
    ]
}

/// A value of any type, including nested lists and sections.
pub fn value() -> impl Strategy<Value = Value> {
    leaf().prop_recursive(3, 12, 4, |inner| {
        prop_oneof![
            2 => prop::collection::vec(inner.clone(), 0..4).prop_map(Value::Array),
            1 => prop::collection::vec((word(), inner), 0..3)
                .prop_map(|entries| Value::Table(entries.into_iter().collect::<Table>())),
        ]
    })
}

fn leaf() -> impl Strategy<Value = Value> {
    prop_oneof![
        6 => number().prop_map(Value::Float),
        3 => whole().prop_map(Value::Integer),
        3 => word().prop_map(Value::String),
        2 => any::<bool>().prop_map(Value::Boolean),
        1 => prop::collection::vec(number().prop_map(Value::Float), 0..6).prop_map(Value::Array),
        1 => Just(Value::Datetime("1979-05-27T07:32:00Z".parse().expect("a date"))),
    ]
}
