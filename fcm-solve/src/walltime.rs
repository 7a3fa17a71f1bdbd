//! The time limit of a run.

use std::sync::OnceLock;
use std::time::{Duration, Instant, SystemTime};

/// Time limit as given on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Walltime {
    /// Time from the start of the program.
    For(Duration),
    /// No limit.
    Unlimited,
}

/// Instant at which the program started.
static START: OnceLock<Instant> = OnceLock::new();

/// Records the present instant as the start of the program, from which time limits count.
pub fn starts_now() {
    START.get_or_init(Instant::now);
}

/// Reads a time as Slurm writes it: `minutes`, `minutes:seconds`, `hours:minutes:seconds`, `days-hours`,
/// `days-hours:minutes`, `days-hours:minutes:seconds` or `UNLIMITED`.
pub fn parse(text: &str) -> Result<Walltime, String> {
    if text.eq_ignore_ascii_case("unlimited") {
        return Ok(Walltime::Unlimited);
    }
    let seconds = seconds(text).ok_or(
        "write it as hours:minutes:seconds, days-hours:minutes:seconds, minutes, or UNLIMITED, as Slurm does: \
         23:50:00 is ten minutes less than a day",
    )?;
    if seconds == 0 { Err("needs to be above 0".to_owned()) } else { Ok(Walltime::For(Duration::from_secs(seconds))) }
}

fn seconds(text: &str) -> Option<u64> {
    let (days, rest) = text.split_once('-').map_or((None, text), |(days, rest)| (Some(days), rest));
    let digits = |part: &str| part.bytes().all(|b| b.is_ascii_digit()).then(|| part.parse::<u32>().ok())?;
    let parts: Vec<u64> = rest.split(':').map(|part| digits(part).map(u64::from)).collect::<Option<_>>()?;
    let days = days.map(|days| digits(days).map(u64::from));
    match (days, &parts[..]) {
        (None, [minutes]) => Some(minutes * 60),
        (None, [minutes, seconds]) => Some(minutes * 60 + seconds),
        (None, [hours, minutes, seconds]) => Some((hours * 60 + minutes) * 60 + seconds),
        (Some(days), [hours]) => Some((days? * 24 + hours) * 3600),
        (Some(days), [hours, minutes]) => Some(((days? * 24 + hours) * 60 + minutes) * 60),
        (Some(days), [hours, minutes, seconds]) => Some(((days? * 24 + hours) * 60 + minutes) * 60 + seconds),
        _ => None,
    }
}

/// Instant by which the run has to be over: its time limit, or the end of its Slurm job.
pub fn end(given: Option<Walltime>) -> Option<Instant> {
    match given {
        Some(Walltime::Unlimited) => None,
        Some(Walltime::For(time)) => START.get_or_init(Instant::now).checked_add(time),
        None => end_of_job(&std::env::var("SLURM_JOB_END_TIME").ok()?, SystemTime::now()),
    }
}

/// Instant of the end of a job, given in seconds since 1970. An end in the past belongs to another job, and an end more
/// than ten years ahead means no limit.
fn end_of_job(seconds: &str, now: SystemTime) -> Option<Instant> {
    let end = SystemTime::UNIX_EPOCH.checked_add(Duration::from_secs(seconds.parse().ok()?))?;
    let left = end.duration_since(now).ok()?;
    Instant::now().checked_add(left).filter(|_| left < Duration::from_secs(10 * 365 * 86_400))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_as_slurm_writes_them() {
        let cases = [
            ("90", 5400),
            ("1:30", 90),
            ("23:50:00", 85_800),
            ("100:00:01", 360_001),
            ("2-12", 216_000),
            ("1-0:30", 88_200),
            ("1-00:00:05", 86_405),
        ];
        for (text, seconds) in cases {
            assert_eq!(parse(text), Ok(Walltime::For(Duration::from_secs(seconds))), "{text}");
        }
        assert_eq!(parse("UNLIMITED"), Ok(Walltime::Unlimited));
        for text in
            ["", "-", "1-", "-1", "1:2:3:4", "1-2:3:4:5", "1h", "+5", "1.5", "0", "0:00", "99999999999999999999"]
        {
            assert!(parse(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_job_that_has_ended_sets_no_end() {
        let now = SystemTime::UNIX_EPOCH + Duration::from_secs(1000);
        let left = |text: &str| end_of_job(text, now).map(|end| (end - Instant::now()).as_secs_f64().round());
        assert_eq!(left("1060"), Some(60.0));
        for text in ["999", "x", "", "99999999999999", "18446744073709551615"] {
            assert_eq!(left(text), None, "{text}");
        }
    }
}
