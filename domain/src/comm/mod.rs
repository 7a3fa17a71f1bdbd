//! Communication among ranks. Only this folder knows how a rank is implemented: as a single process, as a thread of a
//! test, or as a process under `mpirun`.

mod cores;
mod failure;
mod launcher;
#[cfg(all(feature = "mpi", target_os = "linux"))]
mod mapped;
mod threads;
mod window;

#[cfg(feature = "mpi")]
#[path = "processes.rs"]
mod processes;
#[cfg(not(feature = "mpi"))]
#[path = "no_processes.rs"]
mod processes;

use crate::block;
use bytemuck::Pod;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

pub use failure::Failure;
use launcher::Job;
pub use launcher::Launcher;
use window::Segment;
pub use window::Window;

/// Reason why the ranks could not be connected.
#[derive(Debug, thiserror::Error)]
pub enum CommError {
    /// The launcher started several processes, but the program was built for one.
    #[error(
        "a launcher started {} processes, but this program was built without MPI and every one of them would \
         run the whole scene; build with `cargo build --release --features mpi`, run without mpirun or srun, or say by \
         --alone that each is a run of its own",
         found.map_or_else(|| "several".to_owned(), |found| found.to_string())
    )]
    BuiltWithout {
        /// Processes that the launcher announced, if it said how many.
        found: Option<usize>,
    },
    /// Slurm started several processes that cannot find each other.
    #[error(
        "srun started {launched} processes that can't find each other, and every one of them would run the whole \
         scene; start them by `srun --mpi=pmix` if the program was built with Open MPI, `srun --mpi=pmi2` with MPICH \
         or Intel MPI (`srun --mpi=list` names what this Slurm has), or by mpirun in the job; or say by --alone that \
         each is a run of its own"
    )]
    Unconnected {
        /// Processes that Slurm announced.
        launched: usize,
    },
    /// The launcher and the MPI library do not match.
    #[error(
        "the launcher started {launched} processes, but the MPI library sees {seen}: the program was built for \
         another MPI than the one that runs it; build it again with this machine's mpicc first in PATH, or start it by \
         that MPI's own mpirun"
    )]
    WrongLauncher {
        /// Processes that the launcher announced.
        launched: usize,
        /// Processes that the library found.
        seen: usize,
    },
    /// A communicator of another MPI library.
    #[error(
        "the communicator is of {theirs:?}, but this program was built with {ours:?}; build both with the same mpicc, \
         and start MPI before"
    )]
    OtherLibrary {
        /// Library with which this program was built.
        ours: String,
        /// Library of the communicator.
        theirs: String,
    },
    /// The MPI library does not support the threads that the program needs.
    #[error("the MPI library refuses to run beside threads (it needs the level MPI_THREAD_FUNNELED)")]
    NoThreads,
}

/// A communicator: a group of ranks. Every call is collective: all ranks of the group make the same calls in the same
/// order. Sums are taken in rank order, so results do not depend on timing.
#[derive(Clone)]
pub struct Comm {
    backend: Backend,
    /// Data that this group and those split from it sent to other ranks.
    sent: Arc<SentCounters>,
}

#[derive(Default)]
struct SentCounters {
    bytes: AtomicU64,
    messages: AtomicU64,
}

#[derive(Clone)]
enum Backend {
    Alone,
    Threads(threads::ThreadRank),
    Processes(processes::ProcessRank),
}

impl Comm {
    /// A single rank: every exchange is a copy.
    pub fn alone() -> Self {
        Self::of(Backend::Alone)
    }

    fn of(backend: Backend) -> Self {
        Self { backend, sent: Arc::default() }
    }

    /// All processes that a launcher such as `mpirun` started, or a single rank without a launcher.
    pub fn world() -> Result<Self, CommError> {
        let launcher = Launcher::of_this_process();
        match launcher.job {
            Job::Alone => Ok(Self::alone()),
            Job::Of(1) if cfg!(not(feature = "mpi")) => Ok(Self::alone()),
            _ => processes::ProcessRank::world(&launcher).map(|rank| Self::of(Backend::Processes(rank))),
        }
    }

    /// Ranks of an MPI communicator that another part of the process made, given by its Fortran handle, from
    /// `MPI_Comm_c2f`, and the text of `MPI_Get_library_version` of its library. It has to be an intracommunicator
    /// and is duplicated. MPI has to stay initialised until the last use. Collective among its ranks.
    #[cfg(feature = "mpi")]
    pub fn of_handle(handle: i32, library: &str) -> Result<Self, CommError> {
        processes::ProcessRank::of_handle(handle, library).map(|rank| Self::of(Backend::Processes(rank)))
    }

    /// Runs `body` once on each of `ranks` ranks that are threads of this process, and returns the results in rank
    /// order. A panic on one rank is a panic of the call. Ranks 0 and 1, 2 and 3, and so on stand for ranks on one
    /// machine.
    pub fn threads<R: Send>(ranks: usize, body: impl Fn(Self) -> R + Sync) -> Vec<R> {
        threads::run(ranks, |rank| body(Self::of(Backend::Threads(rank))))
    }

    /// Number of this rank, from 0.
    pub fn rank(&self) -> usize {
        match &self.backend {
            Backend::Alone => 0,
            Backend::Threads(rank) => rank.rank(),
            Backend::Processes(rank) => rank.rank(),
        }
    }

    /// Number of ranks.
    pub fn size(&self) -> usize {
        match &self.backend {
            Backend::Alone => 1,
            Backend::Threads(rank) => rank.size(),
            Backend::Processes(rank) => rank.size(),
        }
    }

    /// Whether this is the first rank, which prints messages and writes files.
    pub fn is_first(&self) -> bool {
        self.rank() == 0
    }

    /// Subgroup of the ranks that passed the same `colour`, in their present order.
    #[must_use]
    #[cfg_attr(not(feature = "mpi"), expect(unreachable_code, reason = "no processes without MPI"))]
    pub fn split(&self, colour: usize) -> Self {
        let backend = match &self.backend {
            Backend::Alone => Backend::Alone,
            Backend::Threads(rank) => Backend::Threads(rank.split(colour)),
            Backend::Processes(rank) => Backend::Processes(rank.split(colour)),
        };
        Self { backend, sent: self.sent.clone() }
    }

    /// Bytes that this rank has sent to others so far.
    pub fn bytes_sent(&self) -> u64 {
        self.sent.bytes.load(Ordering::Relaxed)
    }

    /// Number of messages that this rank has sent to others so far: non-empty lists of values to one rank each.
    /// Access to the memory of other ranks on the same machine does not count.
    pub fn messages_sent(&self) -> u64 {
        self.sent.messages.load(Ordering::Relaxed)
    }

    /// Waits for all ranks.
    pub fn barrier(&self) {
        match &self.backend {
            Backend::Alone => {}
            Backend::Threads(rank) => rank.barrier(),
            Backend::Processes(rank) => rank.barrier(),
        }
    }

    /// Memory of `bytes` on each rank that all ranks of the group on the same machine can access. If a machine does
    /// not let its processes share memory, each of them counts as a machine of its own.
    pub fn window(&self, bytes: usize) -> Window {
        let machine = self.machine();
        let shared = match &machine.backend {
            Backend::Alone => None,
            Backend::Threads(rank) => Some(rank.share(bytes)),
            Backend::Processes(rank) => rank.share(bytes, &machine),
        };
        match shared {
            Some(segments) => Window::new(self, machine, segments),
            None => Window::new(self, Self::alone(), vec![Arc::new(Segment::private(bytes))]),
        }
    }

    /// The ranks of this group on the same machine.
    #[cfg_attr(not(feature = "mpi"), expect(unreachable_code, reason = "no processes without MPI"))]
    pub(crate) fn machine(&self) -> Self {
        match &self.backend {
            Backend::Alone => Self::alone(),
            Backend::Threads(rank) => self.split(rank.machine()),
            Backend::Processes(rank) => {
                Self { backend: Backend::Processes(rank.on_this_machine()), sent: self.sent.clone() }
            }
        }
    }

    /// Counts bytes that went to other ranks through a [`Window`].
    pub fn count_sent(&self, bytes: usize) {
        self.sent.bytes.fetch_add(bytes as u64, Ordering::Relaxed);
    }

    /// Sends the next `send_counts[r]` values of `send` to each rank `r`, and fills `receive` with the values
    /// received, `receive_counts[r]` from rank `r`, in rank order.
    pub fn all_to_all<T: Pod>(&self, send: (&[T], &[usize]), receive: (&mut [T], &[usize])) {
        let (room, counts) = receive;
        assert_eq!(send.0.len(), send.1.iter().sum::<usize>(), "send counts cover the values to send");
        assert_eq!(room.len(), counts.iter().sum::<usize>(), "receive counts cover the room to receive");
        self.all_to_all_ranges((send.0, &consecutive(send.1)), (room, &consecutive(counts)));
    }

    /// Sends the values `send_ranges[r]` to each rank `r`, and writes the values from rank `r` to
    /// `receive_ranges[r]`. These ranges must not overlap.
    pub fn all_to_all_ranges<T: Pod>(&self, send: (&[T], &[Range<usize>]), receive: (&mut [T], &[Range<usize>])) {
        let others = send.1.iter().enumerate().filter(|&(rank, range)| rank != self.rank() && !range.is_empty());
        let (messages, values) = others.fold((0, 0), |(count, sum), (_, range)| (count + 1, sum + range.len()));
        self.count_sent(values * size_of::<T>());
        self.sent.messages.fetch_add(messages, Ordering::Relaxed);
        match &self.backend {
            Backend::Alone => receive.0[receive.1[0].clone()].copy_from_slice(&send.0[send.1[0].clone()]),
            Backend::Threads(rank) => rank.all_to_all(send, receive),
            Backend::Processes(rank) => rank.all_to_all(send, receive),
        }
    }

    /// Sends one list to each rank and returns the list received from each rank.
    pub fn exchange<T: Pod>(&self, send: &[Vec<T>]) -> Vec<Vec<T>> {
        let counts: Vec<usize> = send.iter().map(Vec::len).collect();
        let mut incoming = vec![0_usize; counts.len()];
        let ones = vec![1; counts.len()];
        self.all_to_all((&counts, &ones), (&mut incoming, &ones));
        let mut flat = vec![T::zeroed(); incoming.iter().sum()];
        self.all_to_all((&send.concat(), &counts), (&mut flat, &incoming));
        let mut rest = flat.as_slice();
        let mut lists = Vec::with_capacity(incoming.len());
        for count in incoming {
            let (list, tail) = rest.split_at(count);
            lists.push(list.to_vec());
            rest = tail;
        }
        lists
    }

    /// Values of all ranks, joined in rank order, on every rank. Ranks may contribute different numbers of values.
    pub fn all_gather<T: Pod>(&self, values: &[T]) -> Vec<T> {
        self.exchange(&vec![values.to_vec(); self.size()]).concat()
    }

    /// Values of all ranks, joined in rank order, on the first rank; empty on the others.
    pub fn gather<T: Pod>(&self, values: &[T]) -> Vec<T> {
        let mut send = vec![Vec::new(); self.size()];
        send[0] = values.to_vec();
        self.exchange(&send).concat()
    }

    /// Copies the first rank's values to every rank.
    pub fn broadcast<T: Pod>(&self, values: &mut Vec<T>) {
        let send = if self.is_first() { vec![values.clone(); self.size()] } else { vec![Vec::new(); self.size()] };
        *values = self.exchange(&send).swap_remove(0);
    }

    /// Copies the first rank's text to every rank.
    pub fn broadcast_text(&self, text: &str) -> String {
        let mut bytes = text.as_bytes().to_vec();
        self.broadcast(&mut bytes);
        String::from_utf8(bytes).expect("the first rank sent text")
    }

    /// Replaces each value by its sum over the ranks, added in rank order.
    pub fn sum(&self, values: &mut [f64]) {
        self.combine(values, |a, b| a + b);
    }

    /// Replaces each value by its maximum over the ranks.
    pub fn max(&self, values: &mut [f64]) {
        self.combine(values, f64::max);
    }

    /// Replaces each value by its minimum over the ranks.
    pub fn min(&self, values: &mut [f64]) {
        self.combine(values, f64::min);
    }

    fn combine(&self, values: &mut [f64], operation: impl Fn(f64, f64) -> f64) {
        if self.size() == 1 || values.is_empty() {
            return;
        }
        if values.len() > WIDE {
            // Each rank combines a share of the values, so that none holds more than twice as many at a time.
            let shares: Vec<_> = (0..self.size()).map(|rank| block(values.len(), self.size(), rank)).collect();
            let parts = self.exchange(&shares.iter().map(|share| values[share.clone()].to_vec()).collect::<Vec<_>>());
            let own = shares[self.rank()].len();
            let combined = combined(&parts.concat(), own, operation);
            values.copy_from_slice(&self.all_gather(&combined));
            return;
        }
        let all = self.all_gather(values);
        values.copy_from_slice(&combined(&all, values.len(), operation));
    }

    /// Whether `yes` is true on any rank.
    pub fn any(&self, yes: bool) -> bool {
        let mut value = [f64::from(u8::from(yes))];
        self.max(&mut value);
        value[0] > 0.0
    }

    /// Makes an error of any rank an error of all: the result is `Ok` on every rank or on none. The message is that
    /// of the lowest rank that failed.
    pub fn agree<T, E: std::fmt::Display>(&self, result: Result<T, E>) -> Result<T, Failure> {
        let (value, message) = match result {
            Ok(value) => (Some(value), String::new()),
            Err(error) => (None, error.to_string()),
        };
        if !self.any(value.is_none()) {
            return Ok(value.expect("no rank failed"));
        }
        let messages = self.exchange(&vec![message.into_bytes(); self.size()]);
        let rank = messages.iter().position(|m| !m.is_empty()).unwrap_or(0);
        let message = String::from_utf8_lossy(&messages[rank]).into_owned();
        Err(Failure { rank, ranks: self.size(), message })
    }
}

/// Number of values above which they are combined by shares.
const WIDE: usize = 4096;

/// The values of all ranks, `width` of each, combined in rank order.
fn combined(all: &[f64], width: usize, operation: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let of_place = |i: usize| all[i..].iter().step_by(width).copied().reduce(&operation).unwrap_or_default();
    (0..width).map(of_place).collect()
}

/// Consecutive ranges of the given lengths.
fn consecutive(counts: &[usize]) -> Vec<Range<usize>> {
    let mut end = 0;
    let range = |count| {
        let start = end;
        end += count;
        start..end
    };
    counts.iter().map(range).collect()
}

#[cfg(test)]
mod tests;
