//! Results of a run for its reader: answers, which are means with errors and verdicts, and a page in HTML with charts
//! and a player of the trajectory.

mod about;
mod answer_table;
mod answers;
mod chart;
mod charts;
mod error;
mod facts;
mod html;
mod page;
mod playback;
mod report;
mod tables;
mod warnings;

pub use answers::{
    AnswerRange, PlainMean, RunAnswer, answers_in_json, answers_in_lines, read_answers, run_answers, second_half,
    value_in_words, verdict_in_words, verdict_word, write_answers,
};
pub use error::ReportError;
pub use report::write_report;
