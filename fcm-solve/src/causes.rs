//! Errors with their causes.

/// An error with all its causes in one line, in the form that is sent to the other ranks.
pub fn in_full(error: &anyhow::Error) -> String {
    format!("{error:#}")
}
