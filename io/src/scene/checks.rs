//! Ranges that numbers have to be in.

use super::error::Fault;
use domain::{Number, Vector};

/// The largest volume fraction that spheres of a scene may have together.
pub(super) const DENSEST: f64 = 0.64;

pub(super) fn volume(radius: f64) -> f64 {
    4.0 / 3.0 * std::f64::consts::PI * radius.powi(3)
}

pub(super) fn finite(key: &str, value: f64) -> Result<f64, Fault> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(Fault::new(key, format!("is {}; it needs to be a finite number", Number(value))))
    }
}

pub(super) fn positive(key: &str, value: f64) -> Result<f64, Fault> {
    let fault = || Fault::new(key, format!("is {}; it needs to be a finite number above 0", Number(value)));
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(fault()) }
}

pub(super) fn between(key: &str, value: f64, [low, high]: [f64; 2]) -> Result<f64, Fault> {
    let fault = || {
        Fault::new(key, format!("is {}; it needs to be between {} and {}", Number(value), Number(low), Number(high)))
    };
    if (low..=high).contains(&value) { Ok(value) } else { Err(fault()) }
}

pub(super) fn vector(key: &str, value: [f64; 3]) -> Result<Vector, Fault> {
    for (i, component) in value.iter().enumerate() {
        finite(&format!("{key}[{i}]"), *component)?;
    }
    Ok(Vector::from_array(value))
}

/// Grid points along an axis that a transform may have.
const MOST_POINTS: usize = 1 << 20;

pub(super) fn grid_points(key: &str, points: usize) -> Result<(), Fault> {
    if points > MOST_POINTS {
        return Err(Fault::new(
            key,
            format!("is {points}; the transform takes up to {MOST_POINTS} points along an axis"),
        ));
    }
    let mut rest = points;
    for prime in [2, 3, 5, 7] {
        while rest > 0 && rest.is_multiple_of(prime) {
            rest /= prime;
        }
    }
    if rest == 1 && points.is_multiple_of(2) {
        return Ok(());
    }
    Err(Fault::new(key, format!("is {points}; the transform takes even numbers whose prime factors are 2, 3, 5 and 7")))
}

/// Rows of particles are numbered in 32 bits.
pub(super) const MOST_PARTICLES: f64 = u32::MAX as f64;

/// A number of `things` that follows from a key; `found` says how.
pub(super) fn few_enough(key: &str, found: &str, (count, things): (f64, &str)) -> Result<(), Fault> {
    if count <= MOST_PARTICLES {
        return Ok(());
    }
    let message = format!(
        "is {found}: the scene has {count:.1e} {things}, but they are numbered in 32 bits, {MOST_PARTICLES:.1e} at most; \
         take fewer, or a smaller box"
    );
    Err(Fault::new(key, message))
}

/// A number of rows of a table that is kept, and written again and again.
pub(super) fn rows(key: &str, rows: usize) -> Result<usize, Fault> {
    const MOST: usize = 1_000_000;
    if rows <= MOST {
        return Ok(rows);
    }
    Err(Fault::new(key, format!("is {rows}; tables have at most {MOST} rows")))
}
