//! The thread pool of the computations.

use crate::error::{error, input_error};
use domain::Comm;
use pyo3::prelude::*;
use std::sync::OnceLock;
use std::thread::ThreadId;

/// The thread pool, which is started once.
struct Pool {
    threads: usize,
    process: u32,
    home: ThreadId,
}

static POOL: OnceLock<Pool> = OnceLock::new();

/// Starts the thread pool, of which this thread is one: with as many threads as asked for, or as there are cores. Their
/// number can't be changed afterwards. Returns it.
#[pyfunction]
#[pyo3(signature = (threads=None))]
pub fn start_threads(threads: Option<usize>) -> PyResult<usize> {
    if threads == Some(0) {
        return Err(input_error("threads is 0; it needs to be at least 1"));
    }
    if POOL.get().is_none() {
        start(threads.unwrap_or_else(|| Comm::alone().cores()))?;
    }
    check_this_thread()?;
    let pool = POOL.get().expect("started above");
    match threads.filter(|&asked| asked != pool.threads) {
        Some(asked) => Err(input_error(format!(
            "threads is {asked}, but {} compute already; their number is that of the first use, and needs a new \
             process to be another",
            pool.threads
        ))),
        None => Ok(pool.threads),
    }
}

fn start(threads: usize) -> PyResult<()> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).use_current_thread().build_global();
    pool.map_err(|cause| error(format!("can't start the threads: {cause}")))?;
    let home = std::thread::current().id();
    POOL.get_or_init(|| Pool { threads, process: std::process::id(), home });
    Ok(())
}

/// Refuses threads and processes that the pool does not serve, where a computation would never return.
pub fn check_this_thread() -> PyResult<()> {
    let Some(pool) = POOL.get() else { return Ok(()) };
    if std::process::id() != pool.process {
        return Err(error(
            "this process was forked from one that computes, and has none of its threads; start processes by \
             multiprocessing.get_context(\"spawn\")",
        ));
    }
    if std::thread::current().id() != pool.home {
        return Err(error(
            "fcm_solve computes in the thread of Python that used it first, on as many threads as threads= says; call \
             it there, or use processes",
        ));
    }
    Ok(())
}
