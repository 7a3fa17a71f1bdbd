//! Start of the program: ranks, threads, stack and memory, and messages about failures.

use crate::streams;
use anyhow::Context;
use domain::{Comm, CommError, Launcher};
use std::process::ExitCode;

/// Allows other processes to read the HDF5 files of a run while they are written. To be called first of all.
pub fn leave_files_unlocked() {
    // SAFETY: no other thread of the program runs yet.
    unsafe { std::env::set_var("HDF5_USE_FILE_LOCKING", "FALSE") };
}

/// Keeps freed memory for the next step, which needs as much: memory returned to the system would have to be mapped and
/// zeroed again page by page. Only blocks of 32 MB and more are returned, such as copies of large grids, which are
/// rare: if kept, they would leave holes that smaller blocks then fragment.
pub fn keep_memory() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: the calls set two numbers, for which any value is allowed.
    unsafe {
        libc::mallopt(libc::M_MMAP_THRESHOLD, 32 << 20);
        libc::mallopt(libc::M_TRIM_THRESHOLD, i32::MAX);
    }
}

/// Makes a write beyond the limit on file sizes (`ulimit -f`) an error, where the program would otherwise be killed
/// without a message.
pub fn survive_long_files() {
    // SAFETY: an ignored signal calls no handler.
    unsafe {
        libc::signal(libc::SIGXFSZ, libc::SIG_IGN);
    }
}

/// Stack that the program may need, for parsers of deeply nested texts and kernels with blocks of values; bytes.
const STACK: usize = 8 << 20;

/// Calls a function on a stack that is large enough: in a thread of its own if the stack of the process is limited to
/// less (`ulimit -s`).
pub fn with_stack(work: fn() -> ExitCode) -> ExitCode {
    if stack_limit().is_none_or(|limit| limit >= STACK) {
        return work();
    }
    let thread = std::thread::Builder::new().name("program".to_owned()).stack_size(STACK);
    match thread.spawn(work) {
        Ok(thread) => thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)),
        Err(error) => {
            failed(true, &format_args!("the stack is limited (ulimit -s), and no thread can be started: {error}"))
        }
    }
}

/// Limit on the stack of the process in bytes; `None` if it is unlimited.
fn stack_limit() -> Option<usize> {
    let mut limit = libc::rlimit { rlim_cur: 0, rlim_max: 0 };
    // SAFETY: the call writes one limit to the given address.
    let is_known = unsafe { libc::getrlimit(libc::RLIMIT_STACK, &raw mut limit) } == 0;
    (is_known && limit.rlim_cur != libc::RLIM_INFINITY).then_some(limit.rlim_cur as usize)
}

/// Reports that the ranks could not be reached; once, if the launcher tells which process this is.
pub fn refused(error: &CommError) -> ExitCode {
    failed(Launcher::of_this_process().is_first(), error)
}

/// Reports the failure of the program, on the first rank.
pub fn failed(is_first: bool, error: &dyn std::fmt::Display) -> ExitCode {
    if is_first {
        streams::log(format_args!("error: {}", in_one_line(&format!("{error:#}"))));
        streams::finish_log();
    }
    ExitCode::FAILURE
}

/// A message in one line, with control characters in quoted names escaped as in source code.
pub fn in_one_line(message: &str) -> String {
    let plain = |c: char| if c.is_control() { c.escape_default().to_string() } else { c.to_string() };
    message.chars().map(plain).collect()
}

/// Prints help, or an error of usage, once.
pub fn explain(comm: &Comm, message: &clap::Error) -> ExitCode {
    if comm.is_first() && !message.use_stderr() && streams::is_output_closed() {
        return failed(true, &format_args!("can't write what was asked for: the standard output is closed"));
    }
    match if comm.is_first() { message.print() } else { Ok(()) } {
        // A closed pipe has no reader, as in `fcm-solve --help | head`.
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            failed(true, &format_args!("can't write what was asked for: {error}"))
        }
        _ => ExitCode::from(u8::try_from(message.exit_code()).unwrap_or(1)),
    }
}

/// Starts the threads of this rank: as many as asked for, here or by rayon's variable of the environment, or as it has
/// cores. Collective.
pub fn start_threads(asked: Option<u16>, comm: &Comm) -> anyhow::Result<()> {
    let cores = comm.cores();
    let named = || threads_named(&std::env::var("RAYON_NUM_THREADS").ok()?);
    let threads = asked.or_else(named).map_or(cores, usize::from);
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .use_current_thread()
        .build_global()
        .context("can't start the threads")
}

/// Number of threads that a variable of the environment names; as for rayon, 0 and what is no number stand for none.
fn threads_named(value: &str) -> Option<u16> {
    value.trim().parse().ok().filter(|&threads| threads > 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_variable_names_a_number_of_threads_or_none() {
        assert_eq!(["3", " 12 ", "0", "", "all", "-1"].map(threads_named), [Some(3), Some(12), None, None, None, None]);
    }

    #[test]
    fn names_do_not_break_lines() {
        assert_eq!(
            in_one_line("can't read a\nb\u{1b}[2J: µ is no \"file\""),
            "can't read a\\nb\\u{1b}[2J: µ is no \"file\""
        );
    }
}
