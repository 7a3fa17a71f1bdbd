//! How the program was started: ranks, threads, and what to say when that went wrong.

use anyhow::Context;
use domain::{Comm, CommError};
use std::process::ExitCode;

/// Lets others read the HDF5 files of a run while it goes on. Must come first of all.
pub fn leave_files_unlocked() {
    // SAFETY: no other thread of the program runs yet.
    unsafe { std::env::set_var("HDF5_USE_FILE_LOCKING", "FALSE") };
}

/// Keeps memory that was freed for the next step, which needs as much: given back to the system, it would come again
/// page by page, each filled with zeros.
pub fn keep_memory() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: two numbers are set, of which any value is allowed.
    unsafe {
        libc::mallopt(libc::M_MMAP_THRESHOLD, 1 << 30);
        libc::mallopt(libc::M_TRIM_THRESHOLD, i32::MAX);
    }
}

/// Says why the ranks could not be reached; once, where the launcher tells which process this is.
pub fn refused(error: &CommError) -> ExitCode {
    if number(&["OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK"]).unwrap_or(0) == 0 {
        eprintln!("error: {error}");
    }
    ExitCode::FAILURE
}

/// Prints help, or a mistake in the command line, once.
pub fn explain(comm: &Comm, message: &clap::Error) -> ExitCode {
    if comm.is_first() {
        // Nobody listens to a closed pipe, as in `fcm-solve --help | head`.
        let _ = message.print();
    }
    ExitCode::from(u8::try_from(message.exit_code()).unwrap_or(1))
}

/// Starts the threads of this rank: as many as asked for, or this rank's share of the machine's cores.
pub fn start_threads(asked: Option<u16>) -> anyhow::Result<()> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = asked.map_or_else(|| (cores / ranks_on_this_machine()).max(1), usize::from);
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .use_current_thread()
        .build_global()
        .context("can't start the threads")
}

/// As the launchers of Open MPI, MPICH and Slurm announce it.
fn ranks_on_this_machine() -> usize {
    number(&["OMPI_COMM_WORLD_LOCAL_SIZE", "MPI_LOCALNRANKS", "SLURM_NTASKS_PER_NODE"]).unwrap_or(1).max(1)
}

/// The first of these variables of the environment that is a number.
fn number(names: &[&str]) -> Option<usize> {
    names.iter().find_map(|name| std::env::var(name).ok()?.parse().ok())
}
