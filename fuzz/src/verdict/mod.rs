//! Acceptable reactions of a process to hostile input.

mod cells;
mod named;
mod numbers;

use crate::program::Ended;
pub use cells::of_cells;
pub use named::Names;
use named::is_option;
pub use numbers::{of_hdf5, of_table, of_text};
use std::ffi::OsString;
use std::os::unix::process::ExitStatusExt;

/// The end of a process that did nothing wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProcessEnd {
    /// It did what it was asked to do.
    Answered,
    /// It reported in one line what is wrong.
    Refused,
    /// It ran for a long time, and stopped when it was asked to.
    Stopped,
}

/// The signal that asks a run to stop, and the exit codes of a run that does: 75, or the code
/// of shells for that signal.
const TERM: i32 = 15;
const STOPPED: [i32; 2] = [75, 128 + TERM];

/// Judges a process. An error must name a file, a key or an option.
pub fn judge(ended: &Ended, names: &Names) -> Result<ProcessEnd, String> {
    if let Some(line) = ended.stderr.lines().find(|line| line.contains("panicked at")) {
        return Err(format!("panic: {line}"));
    }
    if let Some(line) = ended.stderr.lines().find(|line| line.contains("memory allocation of")) {
        return Err(format!("abort: {line}"));
    }
    match (ended.status.code(), ended.status.signal()) {
        (Some(0), _) => answered(ended).map(|()| ProcessEnd::Answered),
        (Some(1), _) => refused(ended, names),
        (Some(2), _) => misused(ended).map(|()| ProcessEnd::Refused),
        (Some(code), _) if ended.asked_to_stop && STOPPED.contains(&code) => stopped(ended),
        (None, Some(TERM)) if ended.asked_to_stop => stopped(ended),
        (Some(code), _) => Err(format!("exit code {code}")),
        (None, Some(9 | 24)) => Err("hang: it used up its time".to_owned()),
        (None, signal) => Err(format!("killed by signal {}", signal.unwrap_or(0))),
    }
}

fn stopped(ended: &Ended) -> Result<ProcessEnd, String> {
    answered(ended).map(|()| ProcessEnd::Stopped)
}

fn answered(ended: &Ended) -> Result<(), String> {
    let answers = [&ended.stdout, &ended.stderr];
    answers.into_iter().try_for_each(|text| of_text(&without_words(text, &ended.arguments)))
}

/// A text without the words of the command line: they may be names of files.
fn without_words(text: &str, words: &[OsString]) -> String {
    let is_given = |word: &&str| !words.iter().any(|given| given.as_os_str() == *word);
    let of_line = |line: &str| line.split_whitespace().filter(is_given).collect::<Vec<_>>().join(" ");
    text.lines().map(of_line).collect::<Vec<_>>().join("\n")
}

fn refused(ended: &Ended, names: &Names) -> Result<ProcessEnd, String> {
    let errors: Vec<&str> = ended.stderr.lines().skip_while(|line| !line.starts_with("error: ")).collect();
    match errors[..] {
        [] => Err("it failed without an error".to_owned()),
        [one] if names.are_in(one) => Ok(ProcessEnd::Refused),
        [one] => Err(format!("an error that names no key and no file: {one}")),
        _ => Err(format!("an error of {} lines: {}", errors.len(), errors.join(" | "))),
    }
}

/// Requires that an error of the command line names an option or an argument, or quotes a word; without
/// arguments it is the help.
fn misused(ended: &Ended) -> Result<(), String> {
    if ended.arguments.iter().all(|word| word == "--") && ended.stderr.contains("\nUsage:") {
        return Ok(());
    }
    let said = ended.stderr.split("\nUsage:").next().unwrap_or_default();
    let is_argument = |word: &str| word.starts_with('<') && word.contains('>');
    let names = said.split_whitespace().any(|word| is_option(word) || is_argument(word))
        || said.split('\'').nth(1).is_some_and(|quoted| !quoted.is_empty())
        || ["unrecognized subcommand", "unexpected argument"].iter().any(|what| said.contains(what));
    match (said.starts_with("error: "), names) {
        (true, true) => Ok(()),
        (false, _) => Err("it refused its command line without an error".to_owned()),
        _ => Err(format!("an error that names no option and no argument: {said}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::process::ExitStatus;

    fn ended(status: i32, stdout: &str, stderr: &str) -> Ended {
        let status = ExitStatus::from_raw(status);
        let arguments = vec!["run".into(), "a.toml".into()];
        Ended { arguments, status, stdout: stdout.into(), stderr: stderr.into(), asked_to_stop: false }
    }

    fn names() -> Names {
        Names { files: vec!["a.toml".to_owned()], keys: vec!["radius".to_owned()] }
    }

    fn verdict(status: i32, stdout: &str, stderr: &str) -> Result<ProcessEnd, String> {
        judge(&ended(status, stdout, stderr), &names())
    }

    #[test]
    fn answers_are_numbers() {
        assert_eq!(verdict(0, "gap 0.5, information\n", "warning: none\n"), Ok(ProcessEnd::Answered));
        assert!(verdict(0, "gap NaN\n", "").is_err());
        assert!(verdict(0, "", "gap -inf\n").is_err());
        assert!(verdict(0, "{\"velocities\": [null]}", "").is_err());
        let named = Ended { arguments: vec!["--out".into(), "inf".into()], ..ended(0, "2 frames in inf\n", "") };
        assert_eq!(judge(&named, &names()), Ok(ProcessEnd::Answered));
    }

    #[test]
    fn errors_name_something_in_a_line() {
        assert_eq!(verdict(1 << 8, "", "error: a.toml:3: it is bad\n"), Ok(ProcessEnd::Refused));
        assert_eq!(verdict(1 << 8, "", "warning: hm\nerror: radius is -1\n"), Ok(ProcessEnd::Refused));
        assert!(verdict(1 << 8, "", "error: it is bad\n").unwrap_err().contains("names no key"));
        assert!(verdict(1 << 8, "", "error: the radius of a.tomls\n").unwrap_err().contains("names no key"));
        assert!(verdict(1 << 8, "", "error: radius\nis bad\n").unwrap_err().contains("2 lines"));
        assert!(verdict(1 << 8, "", "").unwrap_err().contains("without an error"));
    }

    #[test]
    fn command_lines_are_refused_by_what_is_in_them() {
        let said = |text: &str| verdict(2 << 8, "", text);
        assert_eq!(said("error: unexpected argument '--x' found\n\nUsage: ...\n"), Ok(ProcessEnd::Refused));
        assert_eq!(said("error: these are missing:\n  <SCENE>\n\nUsage: fcm-solve run\n"), Ok(ProcessEnd::Refused));
        assert_eq!(said("error: unrecognized subcommand 'run'\n"), Ok(ProcessEnd::Refused));
        let no_words = |stderr| judge(&Ended { arguments: vec![], ..ended(2 << 8, "", stderr) }, &names());
        assert_eq!(no_words("What it does\n\nUsage: fcm-solve <COMMAND>\n"), Ok(ProcessEnd::Refused));
        assert!(no_words("").is_err());
        assert!(said("error: something is wrong\n\nUsage: fcm-solve run --out <DIR>\n").is_err());
        assert!(said("").unwrap_err().contains("without an error"));
    }

    #[test]
    fn crashes_are_faults() {
        assert!(verdict(101 << 8, "", "thread 'main' panicked at a.rs:1:1\n").unwrap_err().contains("panic"));
        assert!(verdict(6, "", "memory allocation of 9 bytes failed\n").unwrap_err().contains("abort"));
        assert!(verdict(11, "", "").unwrap_err().contains("signal 11"));
        assert!(verdict(9, "", "").unwrap_err().contains("hang"));
        assert!(verdict(24, "", "").unwrap_err().contains("hang"));
        assert!(verdict(3 << 8, "", "").unwrap_err().contains("exit code 3"));
    }

    #[test]
    fn runs_stop_when_they_are_asked_to() {
        let asked = |status, said| judge(&Ended { asked_to_stop: true, ..ended(status, "", said) }, &names());
        for status in [15, 75 << 8, 143 << 8] {
            assert_eq!(asked(status, "finished at step 3\n"), Ok(ProcessEnd::Stopped));
            assert!(verdict(status, "", "").is_err(), "nobody asked");
        }
        assert_eq!(asked(0, ""), Ok(ProcessEnd::Answered));
        assert!(asked(9, "").unwrap_err().contains("hang"));
        assert!(asked(15, "gap NaN").is_err() && asked(11, "").is_err() && asked(1 << 8, "error: bad").is_err());
    }
}
