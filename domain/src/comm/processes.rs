//! Ranks that are processes under a launcher such as `mpirun`. Only this file and `messages.rs` call MPI.

use super::window::Segment;
use super::{Comm, CommError, Job, Launcher};
use bytemuck::Pod;
use mpi::Threading;
use mpi::datatype::{Equivalence, Partition, PartitionMut};
use mpi::environment::Universe;
use mpi::raw::FromRaw;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, CommunicatorCollectives};
use std::cell::Cell;
use std::io::Write as _;
use std::mem::{ManuallyDrop, MaybeUninit};
use std::ops::{Deref, Range};
use std::rc::Rc;
use std::sync::{Arc, Once};

/// A process in a group of processes. MPI is finalised when the last of these values is dropped.
#[derive(Clone)]
pub(super) struct ProcessRank {
    communicator: Rc<OwnedCommunicator>,
    /// `None` if other code initialised MPI, which then finalises it.
    universe: Option<Rc<Universe>>,
}

/// A communicator that is freed when dropped, unless MPI was finalised before.
struct OwnedCommunicator {
    communicator: ManuallyDrop<SimpleCommunicator>,
    /// Number of exchanges of lists so far.
    exchanges: Cell<usize>,
}

impl OwnedCommunicator {
    fn of(communicator: SimpleCommunicator) -> Rc<Self> {
        Rc::new(Self { communicator: ManuallyDrop::new(communicator), exchanges: Cell::new(0) })
    }
}

impl Deref for OwnedCommunicator {
    type Target = SimpleCommunicator;

    fn deref(&self) -> &SimpleCommunicator {
        &self.communicator
    }
}

impl Drop for OwnedCommunicator {
    fn drop(&mut self) {
        if !mpi::environment::is_finalized() {
            // SAFETY: it is not accessed after this.
            unsafe { ManuallyDrop::drop(&mut self.communicator) }
        }
    }
}

impl ProcessRank {
    pub(super) fn world(launcher: &Launcher) -> Result<Self, CommError> {
        let disagree = |seen| match launcher.job {
            Job::Of(launched) if launched != seen && launcher.connects => {
                Err(CommError::WrongLauncher { launched, seen })
            }
            Job::Of(launched) if launched != seen => Err(CommError::Unconnected { launched }),
            _ => Ok(()),
        };
        // Open MPI would end the program here with a page of its own messages; others continue, with each process
        // alone.
        if !launcher.connects && mpi::environment::library_version().is_ok_and(|name| name.contains("Open MPI")) {
            disagree(1)?;
        }
        let (universe, granted) =
            mpi::initialize_with_threading(Threading::Funneled).expect("the ranks are asked for once");
        if granted < Threading::Funneled {
            return Err(CommError::NoThreads);
        }
        let world = universe.world();
        disagree(world.size() as usize)?;
        abort_all_on_panic(world.rank());
        Ok(Self { communicator: OwnedCommunicator::of(world), universe: Some(Rc::new(universe)) })
    }

    /// Ranks of a communicator that other code made, given by its Fortran handle and the version of its library.
    /// Collective among them.
    pub(super) fn of_handle(handle: i32, library: &str) -> Result<Self, CommError> {
        let plain = |name: &str| name.trim_matches(|c: char| c.is_whitespace() || c == '\0').to_owned();
        let [ours, theirs] = [&mpi::environment::library_version().unwrap_or_default(), library].map(plain);
        if ours != theirs || !mpi::environment::is_initialized() {
            return Err(CommError::OtherLibrary { ours, theirs });
        }
        if mpi::environment::threading_support() < Threading::Funneled {
            return Err(CommError::NoThreads);
        }
        let mut copy = MaybeUninit::uninit();
        // SAFETY: the handle belongs to this library, which is initialised; the copy is ours alone.
        let communicator = unsafe {
            mpi::ffi::MPI_Comm_dup(mpi::ffi::RSMPI_Comm_f2c(handle), copy.as_mut_ptr());
            SimpleCommunicator::from_raw(copy.assume_init())
        };
        if communicator.size() > 1 {
            ABORTS.call_once(|| abort_all_on_panic(communicator.rank()));
        }
        Ok(Self { communicator: OwnedCommunicator::of(communicator), universe: None })
    }

    pub(super) fn rank(&self) -> usize {
        self.communicator.rank() as usize
    }

    pub(super) fn size(&self) -> usize {
        self.communicator.size() as usize
    }

    pub(super) fn communicator(&self) -> &SimpleCommunicator {
        &self.communicator
    }

    /// Number of exchanges of lists before this one.
    pub(super) fn next_exchange(&self) -> usize {
        self.communicator.exchanges.replace(self.communicator.exchanges.get() + 1)
    }

    pub(super) fn split(&self, colour: usize) -> Self {
        let colour = mpi::topology::Color::with_value(colour as i32);
        let communicator = self.communicator.split_by_color(colour).expect("every rank has a colour");
        Self { communicator: OwnedCommunicator::of(communicator), universe: self.universe.clone() }
    }

    pub(super) fn barrier(&self) {
        self.communicator.barrier();
    }

    pub(super) fn on_this_machine(&self) -> Self {
        let communicator = self.communicator.split_shared(self.communicator.rank());
        Self { communicator: OwnedCommunicator::of(communicator), universe: self.universe.clone() }
    }

    /// Shared memory of every rank of a group on one machine, if the machine allows that.
    #[cfg(target_os = "linux")]
    pub(super) fn share(&self, bytes: usize, machine: &Comm) -> Option<Vec<Arc<Segment>>> {
        use super::mapped::SharedMapping;
        if self.size() == 1 {
            return None;
        }
        let mine = SharedMapping::create(bytes).ok();
        let addresses = machine.all_gather(mine.as_ref().map(|(.., address)| *address).as_slice());
        let open = |address| SharedMapping::open(address).map(|memory| Arc::new(Segment::Mapped(memory))).ok();
        let all: Option<Vec<_>> = addresses.into_iter().map(open).collect();
        // All ranks have to succeed, and `mine` stays open until all have mapped it.
        let everybody = !machine.any(all.as_ref().is_none_or(|all| all.len() < self.size()));
        all.filter(|_| everybody)
    }

    /// Other systems have no anonymous shared memory.
    #[cfg(not(target_os = "linux"))]
    pub(super) fn share(&self, _bytes: usize, _machine: &Comm) -> Option<Vec<Arc<Segment>>> {
        None
    }

    pub(super) fn all_to_all<T: Pod>(&self, send: (&[T], &[Range<usize>]), receive: (&mut [T], &[Range<usize>])) {
        // Words as wide as the type's alignment keep the counts, which MPI holds in 32 bits, small.
        match align_of::<T>() {
            8 => self.all_to_all_words::<T, u64>(send, receive),
            4 => self.all_to_all_words::<T, u32>(send, receive),
            _ => self.all_to_all_words::<T, u8>(send, receive),
        }
    }

    #[expect(clippy::needless_pass_by_value, reason = "the receiving slice is written to")]
    fn all_to_all_words<T: Pod, W: Pod + Equivalence>(
        &self,
        send: (&[T], &[Range<usize>]),
        receive: (&mut [T], &[Range<usize>]),
    ) {
        let words = size_of::<T>() / size_of::<W>();
        let (send_counts, send_starts) = counts_and_starts(send.1, words);
        let (receive_counts, receive_starts) = counts_and_starts(receive.1, words);
        // Rust places an empty list of bytes at address 1, which Open MPI mistakes for its constant MPI_IN_PLACE.
        let (nothing, mut no_room) = ([W::zeroed()], [W::zeroed()]);
        let from: &[W] = if send.0.is_empty() { &nothing } else { bytemuck::cast_slice(send.0) };
        let into: &mut [W] = if receive.0.is_empty() { &mut no_room } else { bytemuck::cast_slice_mut(receive.0) };
        let from = Partition::new(from, send_counts, send_starts);
        let mut into = PartitionMut::new(into, receive_counts, receive_starts);
        self.communicator.all_to_all_varcount_into(&from, &mut into);
    }
}

/// Counts and displacements for MPI.
pub(super) fn counts_and_starts(ranges: &[Range<usize>], words: usize) -> (Vec<i32>, Vec<i32>) {
    let in_32_bits = |n: usize| i32::try_from(n * words).expect("a message of fewer than 2^31 words; use more ranks");
    ranges.iter().map(|range| (in_32_bits(range.len()), in_32_bits(range.start))).unzip()
}

/// Set for the first communicator that other code made.
static ABORTS: Once = Once::new();

/// Aborts the job when a rank panics: the others would wait for it forever.
fn abort_all_on_panic(rank: i32) {
    let print = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        let message = "met a fault of the program itself and ends the run on all ranks; please report:";
        // Whether or not it can be written.
        let _ = writeln!(std::io::stderr(), "rank {rank} {message}");
        print(info);
        SimpleCommunicator::world().abort(101);
    }));
}
