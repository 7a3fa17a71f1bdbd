//! Communication among ranks. Only this folder knows how a rank is implemented: as a single process, as a thread of a
//! test, or as a process under `mpirun`.

mod collectives;
mod cores;
mod failure;
mod launcher;
#[cfg(all(feature = "mpi", target_os = "linux"))]
mod mapped;
#[cfg(feature = "mpi")]
mod messages;
mod threads;
mod window;

#[cfg(feature = "mpi")]
#[path = "processes.rs"]
mod processes;
#[cfg(not(feature = "mpi"))]
#[path = "no_processes.rs"]
mod processes;

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

    /// Number of messages that this rank has sent to others so far: non-empty lists of values to one rank each, and as
    /// many for values that all ranks combine or the first one distributes as a tree of the ranks has levels. Access to
    /// the memory of other ranks on the same machine does not count.
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
    #[must_use]
    #[cfg_attr(not(feature = "mpi"), expect(unreachable_code, reason = "no processes without MPI"))]
    pub fn machine(&self) -> Self {
        match &self.backend {
            Backend::Alone => Self::alone(),
            Backend::Threads(rank) => self.split(rank.machine()),
            Backend::Processes(rank) => {
                Self { backend: Backend::Processes(rank.on_this_machine()), sent: self.sent.clone() }
            }
        }
    }

    /// Whether the ranks of this group are on several machines. Collective.
    pub fn spans_machines(&self) -> bool {
        self.machine().size() < self.size()
    }

    /// Counts bytes that went to other ranks through a [`Window`].
    pub fn count_sent(&self, bytes: usize) {
        self.sent.bytes.fetch_add(bytes as u64, Ordering::Relaxed);
    }

    /// Sends the values `send_ranges[r]` to each rank `r`, and writes the values from rank `r` to
    /// `receive_ranges[r]`. These ranges must not overlap.
    pub fn all_to_all_ranges<T: Pod>(&self, send: (&[T], &[Range<usize>]), receive: (&mut [T], &[Range<usize>])) {
        self.count_lists::<T>(send.1.iter().map(Range::len));
        match &self.backend {
            Backend::Alone => receive.0[receive.1[0].clone()].copy_from_slice(&send.0[send.1[0].clone()]),
            Backend::Threads(rank) => rank.all_to_all(send, receive),
            Backend::Processes(rank) => rank.all_to_all(send, receive),
        }
    }

    /// Sends one list to each rank and returns the list from each rank. Only lists that are not empty are sent, so that
    /// a rank has as many messages as other ranks with which it has something to exchange.
    pub fn exchange<T: Pod>(&self, send: &[Vec<T>]) -> Vec<Vec<T>> {
        self.count_lists::<T>(send.iter().map(Vec::len));
        match &self.backend {
            Backend::Alone => send.to_vec(),
            Backend::Threads(rank) => rank.exchange(send),
            Backend::Processes(rank) => rank.exchange(send),
        }
    }

    /// Sends a number to each rank and returns the number from each rank. Zeros are not sent.
    pub fn exchange_counts(&self, counts: &[usize]) -> Vec<usize> {
        let list = |&count: &usize| if count == 0 { Vec::new() } else { vec![count] };
        let received = self.exchange(&counts.iter().map(list).collect::<Vec<_>>());
        received.into_iter().map(|list| list.first().copied().unwrap_or(0)).collect()
    }

    /// Sends the next `counts[r]` values to each rank `r`, and fills the room with the values received, as many from
    /// each rank as it has counts, in rank order. Ranks without values for each other exchange no message.
    pub fn send_receive<T: Pod>(&self, send: Outgoing<T>, receive: Incoming<T>) {
        assert_eq!(send.values.len(), send.counts.iter().sum::<usize>(), "send counts cover the values to send");
        assert_eq!(
            receive.room.len(),
            receive.counts.iter().sum::<usize>(),
            "receive counts cover the room to receive"
        );
        self.count_lists::<T>(send.counts.iter().copied());
        match &self.backend {
            Backend::Alone => receive.room.copy_from_slice(send.values),
            Backend::Threads(rank) => {
                let [sent, received] = [send.counts, receive.counts].map(consecutive);
                rank.all_to_all((send.values, &sent), (receive.room, &received));
            }
            Backend::Processes(rank) => rank.send_receive(send, receive),
        }
    }

    /// Counts lists of given lengths, one for each rank, as sent.
    fn count_lists<T>(&self, lengths: impl Iterator<Item = usize>) {
        let others = lengths.enumerate().filter(|&(rank, length)| rank != self.rank() && length > 0);
        let (messages, values) = others.fold((0, 0), |(count, sum), (_, length)| (count + 1, sum + length));
        self.count_sent(values * size_of::<T>());
        self.sent.messages.fetch_add(messages, Ordering::Relaxed);
    }
}

/// Values to send, the next `counts[r]` to each rank `r`.
#[derive(Debug, Clone, Copy)]
pub struct Outgoing<'a, T> {
    /// The values.
    pub values: &'a [T],
    /// Number of values for each rank.
    pub counts: &'a [usize],
}

/// Room for values to receive, the next `counts[r]` from each rank `r`.
#[derive(Debug)]
pub struct Incoming<'a, T> {
    /// The room.
    pub room: &'a mut [T],
    /// Number of values from each rank.
    pub counts: &'a [usize],
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
