//! Errors with their causes.

/// An error with all its causes in a line, for the other ranks.
pub fn in_full(error: &anyhow::Error) -> String {
    format!("{error:#}")
}
