//! The answers of a run: the quantities that a scene of its kind is run for, as means in the steady state with errors
//! and verdicts, from its time series.

mod table;

pub(crate) use table::word;
pub use table::{ANSWERS, RunAnswer, read_answers, write_answers};
