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

/// Lines of the log that wait for a slow reader; more are lost.
const WAITING: usize = 1000;
/// How long the program waits at its end for whoever reads the log.
const PATIENCE: Duration = Duration::from_secs(2);

/// Prints a result of the first rank. Fails on all ranks if it can't be written. Collective.
pub fn print(comm: &Comm, text: &str) -> anyhow::Result<()> {
    let printed = if comm.is_first() { print_here(text) } else { Ok(()) };
    Ok(comm.agree(printed.map_err(|e| format!("{e:#}")))?)
}

/// The same for one rank alone.
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

/// Looks for the standard output before the program begins: the runtime of the language puts `/dev/null` in its place,
/// where results would be lost without an error.
extern "C" fn look_for_output() {
    // SAFETY: the call asks for the flags of a descriptor, which need not be open.
    let is_closed = unsafe { libc::fcntl(libc::STDOUT_FILENO, libc::F_GETFD) } == -1;
    IS_CLOSED.store(is_closed, Ordering::Relaxed);
}

#[used]
// SAFETY: the section has pointers to functions that are called before `main`; this one needs nothing of the runtime.
#[cfg_attr(target_os = "linux", unsafe(link_section = ".init_array"))]
static BEFORE_MAIN: extern "C" fn() = look_for_output;

/// A value as JSON for reading, with the end of its last line.
pub fn json(value: &Value) -> String {
    format!("{value:#}\n")
}

/// From now on, no lines that only inform.
pub fn be_quiet() {
    IS_QUIET.store(true, Ordering::Relaxed);
}

/// Whether only warnings and errors are wanted in the log.
pub fn is_quiet() -> bool {
    IS_QUIET.load(Ordering::Relaxed)
}

static IS_QUIET: AtomicBool = AtomicBool::new(false);

/// Adds a line to the log that only informs.
pub fn inform(line: impl Display) {
    if !is_quiet() {
        log(line);
    }
}

/// Adds a line to the log. A reader that is slow, or has gone, does not hold up the program.
pub fn log(line: impl Display) {
    let line = format!("{line}\n");
    match LOG.get_or_init(start) {
        None => write(&line),
        Some(log) => match log.try_send(Entry::Line(line)) {
            Ok(()) | Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) => {}
        },
    }
}

/// Waits until the log is written, but not for ever.
pub fn finish_log() {
    let (done, written) = sync_channel(1);
    if let Some(Some(log)) = LOG.get()
        && log.try_send(Entry::End(done)).is_ok()
    {
        let _ = written.recv_timeout(PATIENCE);
    }
}

/// What goes to the thread that writes the log.
enum Entry {
    Line(String),
    /// Asks for a notice when everything before it is written.
    End(SyncSender<()>),
}

/// The channel to that thread; `None` on a terminal, where lines are written at once.
static LOG: OnceLock<Option<SyncSender<Entry>>> = OnceLock::new();

fn start() -> Option<SyncSender<Entry>> {
    if std::io::stderr().is_terminal() {
        return None;
    }
    let (log, entries) = sync_channel(WAITING);
    std::thread::Builder::new().name("log".to_owned()).spawn(move || write_all(&entries)).ok()?;
    Some(log)
}

fn write_all(entries: &Receiver<Entry>) {
    for entry in entries {
        match entry {
            Entry::Line(line) => write(&line),
            Entry::End(done) => drop(done.send(())),
        }
    }
}

/// An error here can't be reported to anybody.
fn write(line: &str) {
    let _ = std::io::stderr().write_all(line.as_bytes());
}
