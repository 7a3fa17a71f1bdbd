//! Messages between processes: lists for few others, whose lengths are known or not, and lists that all ranks or the
//! first one receive.

use super::processes::{ProcessRank, counts_and_starts};
use super::{Incoming, Outgoing, consecutive};
use bytemuck::Pod;
use mpi::Tag;
use mpi::collective::SystemOperation;
use mpi::datatype::{Equivalence, PartitionMut};
use mpi::request::{Request, Scope, scope};
use mpi::traits::{Communicator, CommunicatorCollectives, Destination, Root, Source};
use std::ops::Range;

/// Tag of lists whose lengths the receivers know.
const KNOWN: Tag = 1;

/// Tags of lists of unknown lengths: one rank may begin an exchange while another has not noticed the end of the one
/// before.
const UNKNOWN: [Tag; 2] = [2, 3];

/// Calls a method for words as wide as the alignment of the values, which keeps the counts, of 32 bits in MPI, small.
macro_rules! in_words {
    ($self:ident.$method:ident::<$value:ty>($($argument:expr),*)) => {
        match align_of::<$value>() {
            8 => $self.$method::<$value, u64>($($argument),*),
            4 => $self.$method::<$value, u32>($($argument),*),
            _ => $self.$method::<$value, u8>($($argument),*),
        }
    };
}

impl ProcessRank {
    /// See [`super::Comm::exchange`].
    pub(super) fn exchange<T: Pod>(&self, send: &[Vec<T>]) -> Vec<Vec<T>> {
        in_words!(self.exchange_words::<T>(send))
    }

    /// Sends lists that are not empty, and receives until every rank knows that its own have arrived, which a barrier
    /// tells that does not wait: Hoefler, Siebert & Lumsdaine, *Scalable communication protocols for dynamic sparse
    /// data exchange* (2010).
    fn exchange_words<T: Pod, W: Pod + Equivalence>(&self, send: &[Vec<T>]) -> Vec<Vec<T>> {
        let communicator = self.communicator();
        let tag = UNKNOWN[self.next_exchange() % UNKNOWN.len()];
        let mut received = vec![Vec::new(); send.len()];
        received[self.rank()].clone_from(&send[self.rank()]);
        scope(|sending| {
            let mut open = Vec::new();
            for (rank, list) in send.iter().enumerate().filter(|&(rank, list)| rank != self.rank() && !list.is_empty())
            {
                let (words, receiver) = (bytemuck::cast_slice::<T, W>(list), communicator.process_at_rank(rank as i32));
                open.push(receiver.immediate_synchronous_send_with_tag(sending, words, tag));
            }
            let mut arrived = None;
            loop {
                if let Some((message, status)) = communicator.any_process().immediate_matched_probe_with_tag(tag) {
                    let words = status.count(W::equivalent_datatype()) as usize;
                    let mut list = vec![T::zeroed(); words * size_of::<W>() / size_of::<T>()];
                    message.matched_receive_into(bytemuck::cast_slice_mut::<T, W>(&mut list));
                    received[status.source_rank() as usize] = list;
                    continue;
                }
                open = still_open(open);
                let barrier = match arrived.take() {
                    None if !open.is_empty() => None,
                    None => Some(communicator.immediate_barrier()),
                    Some(barrier) => match Request::test(barrier) {
                        Ok(_) => break,
                        Err(barrier) => Some(barrier),
                    },
                };
                arrived = barrier;
                std::thread::yield_now();
            }
        });
        received
    }

    /// See [`super::Comm::send_receive`].
    pub(super) fn send_receive<T: Pod>(&self, send: Outgoing<T>, receive: Incoming<T>) {
        in_words!(self.send_receive_words::<T>(send, receive));
    }

    fn send_receive_words<T: Pod, W: Pod + Equivalence>(&self, send: Outgoing<T>, receive: Incoming<T>) {
        let (communicator, me) = (self.communicator(), self.rank());
        let lists = consecutive(send.counts).into_iter().map(|range| &send.values[range]).enumerate();
        scope(|transfer| {
            let mut open = Vec::new();
            let (mut rest, mut own) = (receive.room, None);
            for (rank, &count) in receive.counts.iter().enumerate() {
                let (list, after) = rest.split_at_mut(count);
                rest = after;
                if rank == me {
                    own = Some(list);
                } else if count > 0 {
                    let words = bytemuck::cast_slice_mut::<T, W>(list);
                    let source = communicator.process_at_rank(rank as i32);
                    open.push(source.immediate_receive_into_with_tag(transfer, words, KNOWN));
                }
            }
            let mut sent = Vec::new();
            for (rank, list) in lists {
                if rank == me {
                    own.take().into_iter().for_each(|own| own.copy_from_slice(list));
                } else if !list.is_empty() {
                    let words: &[W] = bytemuck::cast_slice(list);
                    let destination = communicator.process_at_rank(rank as i32);
                    sent.push(destination.immediate_send_with_tag(transfer, words, KNOWN));
                }
            }
            open.into_iter().for_each(Request::wait_without_status);
            sent.into_iter().for_each(Request::wait_without_status);
        });
    }

    /// Equally many values of each rank, in rank order, on every rank.
    pub(super) fn all_gather_equal<T: Pod>(&self, values: &[T]) -> Vec<T> {
        in_words!(self.all_gather_equal_words::<T>(values))
    }

    fn all_gather_equal_words<T: Pod, W: Pod + Equivalence>(&self, values: &[T]) -> Vec<T> {
        let mut all = vec![T::zeroed(); values.len() * self.size()];
        if !values.is_empty() {
            let words: &[W] = bytemuck::cast_slice(values);
            self.communicator().all_gather_into(words, bytemuck::cast_slice_mut::<T, W>(&mut all));
        }
        all
    }

    /// Values of each rank, `counts[r]` of rank `r`, in rank order, on every rank.
    pub(super) fn all_gather<T: Pod>(&self, values: &[T], counts: &[usize]) -> Vec<T> {
        in_words!(self.all_gather_words::<T>(values, counts))
    }

    fn all_gather_words<T: Pod, W: Pod + Equivalence>(&self, values: &[T], counts: &[usize]) -> Vec<T> {
        let mut all = vec![T::zeroed(); counts.iter().sum()];
        if !all.is_empty() {
            let mut into = partition::<T, W>(&mut all, counts);
            self.communicator().all_gather_varcount_into(words_of::<T, W>(values, &[W::zeroed()]), &mut into);
        }
        all
    }

    /// Values of each rank, `counts[r]` of rank `r`, in rank order, on the first rank; empty on the others.
    pub(super) fn gather<T: Pod>(&self, values: &[T], counts: &[usize]) -> Vec<T> {
        in_words!(self.gather_words::<T>(values, counts))
    }

    fn gather_words<T: Pod, W: Pod + Equivalence>(&self, values: &[T], counts: &[usize]) -> Vec<T> {
        let (first, nothing) = (self.communicator().process_at_rank(0), [W::zeroed()]);
        let words = words_of::<T, W>(values, &nothing);
        let total = counts.iter().sum();
        if total == 0 {
            return Vec::new();
        }
        if self.rank() > 0 {
            first.gather_varcount_into(words);
            return Vec::new();
        }
        let mut all = vec![T::zeroed(); total];
        first.gather_varcount_into_root(words, &mut partition::<T, W>(&mut all, counts));
        all
    }

    /// Replaces the values by those of the first rank, which has equally many.
    pub(super) fn broadcast<T: Pod>(&self, values: &mut [T]) {
        in_words!(self.broadcast_words::<T>(values));
    }

    fn broadcast_words<T: Pod, W: Pod + Equivalence>(&self, values: &mut [T]) {
        if !values.is_empty() {
            self.communicator().process_at_rank(0).broadcast_into(bytemuck::cast_slice_mut::<T, W>(values));
        }
    }

    /// Whether `yes` is true on any rank.
    pub(super) fn any(&self, yes: bool) -> bool {
        let mut any = 0;
        self.communicator().all_reduce_into(&i32::from(yes), &mut any, SystemOperation::logical_or());
        any != 0
    }
}

/// The requests that have not been completed.
fn still_open<'a, D: ?Sized, S: Scope<'a>>(requests: Vec<Request<'a, D, S>>) -> Vec<Request<'a, D, S>> {
    requests.into_iter().filter_map(|request| request.test().err()).collect()
}

/// Values in words. Rust places an empty list of bytes at address 1, which Open MPI mistakes for its constant
/// `MPI_IN_PLACE`; in place of an empty list it gets the beginning of `elsewhere`.
fn words_of<'a, T: Pod, W: Pod>(values: &'a [T], elsewhere: &'a [W]) -> &'a [W] {
    if values.is_empty() { &elsewhere[..0] } else { bytemuck::cast_slice(values) }
}

/// Room for the values of each rank.
fn partition<'a, T: Pod, W: Pod + Equivalence>(
    all: &'a mut [T],
    counts: &[usize],
) -> PartitionMut<'a, [W], Vec<i32>, Vec<i32>> {
    let ranges: Vec<Range<usize>> = consecutive(counts);
    let (counts, starts) = counts_and_starts(&ranges, size_of::<T>() / size_of::<W>());
    PartitionMut::new(bytemuck::cast_slice_mut(all), counts, starts)
}
