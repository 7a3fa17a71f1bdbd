//! Standard output, for results, and standard error, for the log. Nothing here panics if a stream fails.

use anyhow::{Context, ensure};
use domain::Comm;
use serde_json::Value;
use std::fmt::Display;
use std::io::{IsTerminal, Write};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::time::Duration;

/// Largest number of log lines that wait for a slow reader; further lines are lost.
const WAITING: usize = 1000;
/// Longest wait at the end of the program for the reader of the log.
const PATIENCE: Duration = Duration::from_secs(2);

/// Prints a result on the first rank. Fails on all ranks if it can't be written. Collective.
pub fn print(comm: &Comm, text: &str) -> anyhow::Result<()> {
    let printed = if comm.is_first() { print_here(text) } else { Ok(()) };
    Ok(comm.agree(printed.map_err(|e| format!("{e:#}")))?)
}

/// Prints a result on this rank, independently of the others.
pub fn print_here(text: &str) -> anyhow::Result<()> {
    ensure!(!is_output_closed(), "can't write to the standard output: it is closed");
    let mut out = std::io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).context("can't write to the standard output")
}

/// Whether the program was started without a standard output (`>&-`).
pub fn is_output_closed() -> bool {
    IS_CLOSED.load(Ordering::Relaxed)
}

static IS_CLOSED: AtomicBool = AtomicBool::new(false);

/// Checks for a standard output before the program begins: the Rust runtime replaces a closed one by `/dev/null`, where
/// results would be lost without an error.
extern "C" fn look_for_output() {
    // SAFETY: the call queries the flags of a descriptor, which need not be open.
    let is_closed = unsafe { libc::fcntl(libc::STDOUT_FILENO, libc::F_GETFD) } == -1;
    IS_CLOSED.store(is_closed, Ordering::Relaxed);
}

#[used]
// SAFETY: the section holds pointers to functions that are called before `main`; this one needs nothing of the runtime.
#[cfg_attr(target_os = "linux", unsafe(link_section = ".init_array"))]
static BEFORE_MAIN: extern "C" fn() = look_for_output;

/// A value as indented JSON, with a final line break.
pub fn json(value: &Value) -> String {
    format!("{value:#}\n")
}

/// Suppresses informational lines from now on.
pub fn be_quiet() {
    IS_QUIET.store(true, Ordering::Relaxed);
}

/// Whether the log is limited to warnings, answers and errors.
pub fn is_quiet() -> bool {
    IS_QUIET.load(Ordering::Relaxed)
}

static IS_QUIET: AtomicBool = AtomicBool::new(false);

/// Adds an informational line to the log.
pub fn inform(line: impl Display) {
    if !is_quiet() {
        log(line);
    }
}

/// Adds a line to the log. A reader that is slow or gone does not block the program.
pub fn log(line: impl Display) {
    let line = format!("{line}\n");
    match LOG.get_or_init(start) {
        None => write(&line),
        Some(log) => match log.try_send(LogMessage::Line(line)) {
            Ok(()) | Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) => {}
        },
    }
}

/// Waits until the log is written, for a limited time.
pub fn finish_log() {
    let (done, written) = sync_channel(1);
    if let Some(Some(log)) = LOG.get()
        && log.try_send(LogMessage::End(done)).is_ok()
    {
        let _ = written.recv_timeout(PATIENCE);
    }
}

/// Message to the thread that writes the log.
enum LogMessage {
    Line(String),
    /// Request for a notice when all earlier lines are written.
    End(SyncSender<()>),
}

/// Channel to the thread that writes the log; `None` on a terminal, where lines are written at once.
static LOG: OnceLock<Option<SyncSender<LogMessage>>> = OnceLock::new();

fn start() -> Option<SyncSender<LogMessage>> {
    if std::io::stderr().is_terminal() {
        return None;
    }
    let (log, entries) = sync_channel(WAITING);
    std::thread::Builder::new().name("log".to_owned()).spawn(move || write_all(&entries)).ok()?;
    Some(log)
}

fn write_all(entries: &Receiver<LogMessage>) {
    for entry in entries {
        match entry {
            LogMessage::Line(line) => write(&line),
            LogMessage::End(done) => drop(done.send(())),
        }
    }
}

/// Writes to the standard error; a failure can't be reported anywhere.
fn write(line: &str) {
    let _ = std::io::stderr().write_all(line.as_bytes());
}
