//! What a process that was given hostile input may do.

use crate::program::Ended;
use std::os::unix::process::ExitStatusExt;

/// How a process ended that did nothing wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// It did what it was asked to.
    Answered,
    /// It said in a line what is wrong.
    Refused,
    /// It ran for long, and stopped when it was asked to.
    Stopped,
}

/// Exit codes: done, failed, a wrong command line, stopped with a checkpoint.
const CODES: [i32; 4] = [0, 1, 2, 75];

/// Judges a process. An error has to name one of `names`: keys and files.
pub fn judge(ended: &Ended, names: &[String]) -> Result<End, String> {
    if let Some(line) = ended.stderr.lines().find(|line| line.contains("panicked at")) {
        return Err(format!("panic: {line}"));
    }
    if let Some(line) = ended.stderr.lines().find(|line| line.contains("memory allocation of")) {
        return Err(format!("abort: {line}"));
    }
    if ended.asked_to_stop {
        return stopped(ended);
    }
    match ended.status.code() {
        Some(0) => finite(&ended.stdout).and_then(|()| finite(&ended.stderr)).map(|()| End::Answered),
        Some(2) => Ok(End::Refused),
        Some(code) if CODES.contains(&code) => refused(ended, names),
        Some(code) => Err(format!("exit code {code}")),
        None => Err(match ended.status.signal() {
            Some(9 | 24) => "hang: it used up its time".to_owned(),
            signal => format!("killed by signal {}", signal.unwrap_or(0)),
        }),
    }
}

fn stopped(ended: &Ended) -> Result<End, String> {
    match (ended.status.code(), ended.status.signal()) {
        (Some(_), _) | (_, Some(15)) => Ok(End::Stopped),
        _ => Err("hang: it does not stop".to_owned()),
    }
}

fn refused(ended: &Ended, names: &[String]) -> Result<End, String> {
    let errors: Vec<&str> = ended.stderr.lines().skip_while(|line| !line.starts_with("error: ")).collect();
    match errors[..] {
        [] => Err("it failed without an error".to_owned()),
        [one] if names.iter().any(|name| one.contains(name)) => Ok(End::Refused),
        [one] => Err(format!("an error that names no key and no file: {one}")),
        _ => Err(format!("an error of {} lines: {}", errors.len(), errors.join(" | "))),
    }
}

/// Columns that may have no number: errors that can't be estimated, what has not been measured yet, and what did not
/// happen, as the page on file formats says.
const UNDEFINED: [&str; 3] = ["error", "wall_stress_", "mean_free_path"];

/// Columns that say, by a zero, that a row averages over nothing.
const OF_NOTHING: [&str; 3] = ["converged", "solid_fraction", "disks"];

/// Refuses a table with a number that is none where one has to be.
pub fn defined(text: &str) -> Result<(), String> {
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let names: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let may_lack = |name: &&str| UNDEFINED.iter().any(|word| name.contains(word));
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        let says_nothing = |(name, cell): (&&str, &&str)| OF_NOTHING.contains(name) && *cell == "0.0";
        if names.iter().zip(&cells).any(says_nothing) {
            continue;
        }
        if let Some((name, cell)) =
            names.iter().zip(cells).find(|(name, cell)| finite(cell).is_err() && !may_lack(name))
        {
            return Err(format!("{name} is {cell} in: {line}"));
        }
    }
    Ok(())
}

/// Refuses text with a number that is none.
pub fn finite(text: &str) -> Result<(), String> {
    let is_none = |word: &&str| ["nan", "inf", "infinity", "null"].contains(&word.to_ascii_lowercase().as_str());
    let line = |line: &&str| line.split(|c: char| !c.is_alphanumeric()).any(|word| is_none(&word));
    text.lines()
        .find(line)
        .map_or(Ok(()), |line| Err(format!("no number: {}", &line.chars().take(200).collect::<String>())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::process::ExitStatus;

    fn ended(status: i32, stdout: &str, stderr: &str) -> Ended {
        let status = ExitStatus::from_raw(status);
        Ended { arguments: vec![], status, stdout: stdout.into(), stderr: stderr.into(), asked_to_stop: false }
    }

    fn verdict(status: i32, stdout: &str, stderr: &str) -> Result<End, String> {
        judge(&ended(status, stdout, stderr), &["a.toml".to_owned(), "radius".to_owned()])
    }

    #[test]
    fn answers_are_numbers() {
        assert_eq!(verdict(0, "gap 0.5, information\n", "warning: none\n"), Ok(End::Answered));
        assert!(verdict(0, "gap NaN\n", "").is_err());
        assert!(verdict(0, "gap -inf\n", "").is_err());
        assert!(verdict(0, "{\"velocities\": [null]}", "").is_err());
    }

    #[test]
    fn errors_name_something_in_a_line() {
        assert_eq!(verdict(1 << 8, "", "error: a.toml:3: it is bad\n"), Ok(End::Refused));
        assert_eq!(verdict(1 << 8, "", "warning: hm\nerror: radius is -1\n"), Ok(End::Refused));
        assert_eq!(verdict(2 << 8, "", "error: unexpected argument\n\nUsage: ...\n"), Ok(End::Refused));
        assert!(verdict(1 << 8, "", "error: it is bad\n").unwrap_err().contains("names no key"));
        assert!(verdict(1 << 8, "", "error: radius\nis bad\n").unwrap_err().contains("2 lines"));
        assert!(verdict(1 << 8, "", "").unwrap_err().contains("without an error"));
    }

    #[test]
    fn crashes_are_faults() {
        assert!(verdict(101 << 8, "", "thread 'main' panicked at a.rs:1:1\n").unwrap_err().contains("panic"));
        assert!(verdict(6, "", "memory allocation of 9 bytes failed\n").unwrap_err().contains("abort"));
        assert!(verdict(11, "", "").unwrap_err().contains("signal 11"));
        assert!(verdict(9, "", "").unwrap_err().contains("hang"));
        assert!(verdict(3 << 8, "", "").unwrap_err().contains("exit code 3"));
        let stopped = |status| judge(&Ended { asked_to_stop: true, ..ended(status, "", "") }, &[]);
        assert_eq!((stopped(15), stopped(75 << 8)), (Ok(End::Stopped), Ok(End::Stopped)));
        assert!(stopped(9).unwrap_err().contains("does not stop"));
    }

    #[test]
    fn tables_may_lack_what_does_not_exist() {
        assert_eq!(defined("time,mean_free_path,a_error\n0.0,inf,NaN\n"), Ok(()));
        assert!(defined("time,gap\n0.0,inf\n").unwrap_err().contains("gap is inf"));
        assert_eq!(defined("disks,velocity\n0.0,NaN\n"), Ok(()));
        assert!(defined("disks,velocity\n1.0,NaN\n").is_err());
    }
}
