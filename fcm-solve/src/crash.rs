//! Crashes after an HDF5 file was opened, as errors that name the file: most are of the HDF5 library on damaged files.
//!
//! HDF5 trusts sizes and addresses in a file, such as those of texts of variable length, and may follow wrong ones out
//! of its memory.

use std::ffi::{c_int, c_void};
use std::sync::OnceLock;

const SIGNALS: [c_int; 3] = [libc::SIGSEGV, libc::SIGBUS, libc::SIGFPE];

/// Handlers before: that of the Rust runtime, which reports a stack overflow.
static FORMER: OnceLock<[libc::sigaction; 3]> = OnceLock::new();

/// Turns invalid accesses to memory, and divisions by zero, into an error that names the HDF5 file that was opened
/// last. Without such a file the signal kills the program as before.
pub fn name_damaged_files() {
    // SAFETY: a zeroed action is a valid one; the calls read and write actions that outlive them. The handler calls
    // nothing but functions that are safe in signal handlers.
    let former = SIGNALS.map(|signal| unsafe {
        let mut former: libc::sigaction = std::mem::zeroed();
        libc::sigaction(signal, std::ptr::null(), &raw mut former);
        former
    });
    if FORMER.set(former).is_err() {
        return;
    }
    for signal in SIGNALS {
        // SAFETY: as above.
        unsafe {
            let mut action: libc::sigaction = std::mem::zeroed();
            action.sa_sigaction = crashed as extern "C" fn(c_int, *mut libc::siginfo_t, *mut c_void) as usize;
            action.sa_flags = libc::SA_SIGINFO | libc::SA_ONSTACK;
            libc::sigaction(signal, &raw const action, std::ptr::null_mut());
        }
    }
}

extern "C" fn crashed(signal: c_int, info: *mut libc::siginfo_t, context: *mut c_void) {
    let former = SIGNALS.iter().position(|known| *known == signal).zip(FORMER.get());
    let former = former.map(|(place, all)| all[place].sa_sigaction).filter(|handler| *handler != libc::SIG_DFL);
    if let Some(handler) = former.filter(|handler| *handler != libc::SIG_IGN) {
        // SAFETY: it is the handler that was installed for this signal. It aborts after a stack overflow, and returns
        // otherwise.
        unsafe {
            let handler: extern "C" fn(c_int, *mut libc::siginfo_t, *mut c_void) = std::mem::transmute(handler);
            handler(signal, info, context);
        }
    }
    match files::last_opened() {
        Some(path) => {
            write(b"error: can't read ");
            write(path);
            write(b": the program crashed after it opened this HDF5 file; if the file is damaged, use a whole copy, ");
            write(b"and otherwise please report this\n");
            // SAFETY: the call ends the process at once.
            unsafe { libc::_exit(1) }
        }
        // SAFETY: the default action needs no handler. The instruction is repeated, and kills the program.
        None => unsafe {
            libc::signal(signal, libc::SIG_DFL);
        },
    }
}

fn write(text: &[u8]) {
    // SAFETY: the address and the length are those of a slice.
    unsafe { libc::write(libc::STDERR_FILENO, text.as_ptr().cast(), text.len()) };
}
