//! Commands that are the same each time, run from a recording.

/// Numbers of the recordings: of an evaluation, and of the first and further steps of an iteration for near pairs.
pub(crate) const EVALUATION: usize = 0;
pub(crate) const PAIR_START: usize = 1;
pub(crate) const PAIR_STEPS: usize = 2;

/// Number of recordings.
pub(crate) const RECORDINGS: usize = 3;

/// Commands that run again and again with the same arguments.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) enum Repeated {
    /// They have not run yet.
    #[default]
    New,
    /// They have run once, so that all memory and plans that they need are there.
    Tried(Vec<u64>),
    /// They are the last recording.
    Recorded(Vec<u64>),
    /// The device does not record them.
    Plain(Vec<u64>),
}
