//! Range checks of numbers.

use crate::key_error::KeyError;
use domain::ParameterError;
use suspension::MAX_SPHERES;

pub(super) fn positive(key: &str, value: f64) -> Result<f64, KeyError> {
    Ok(ParameterError::require_positive(key, value)?)
}

/// Limits a number of `things` that follows from a key; `found` describes how.
pub(super) fn few_enough(key: &str, found: &str, count: f64, things: &str) -> Result<(), KeyError> {
    if count <= MAX_SPHERES {
        return Ok(());
    }
    let message = format!(
        "is {found}: the scene has {count:.1e} {things}, but they are numbered in 32 bits, {MAX_SPHERES:.1e} at most; \
         take fewer, or a smaller box"
    );
    Err(KeyError::new(key, message))
}

/// Limits the rows of a table that is kept in memory, and rewritten often.
pub(super) fn rows(key: &str, rows: usize) -> Result<usize, KeyError> {
    const MOST: usize = 1_000_000;
    if rows <= MOST {
        return Ok(rows);
    }
    Err(KeyError::new(key, format!("is {rows}; tables have at most {MOST} rows")))
}
