//! Ranks that are threads of one process, so that ordinary tests exercise every exchange. Like processes with a thread
//! each, they share no threads for parallel loops.

use super::window::Segment;
use bytemuck::Pod;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// A thread in a group of threads.
#[derive(Clone)]
pub(super) struct ThreadRank {
    number: usize,
    group: Arc<ThreadGroup>,
    machine: usize,
}

/// Shared state of the threads of a group: a barrier, and a mailbox from every rank to every other.
struct ThreadGroup {
    size: usize,
    meeting: Mutex<Meeting>,
    everyone: Condvar,
    mail: Vec<Mutex<Vec<u8>>>,
    subgroups: Mutex<HashMap<(usize, usize), Arc<ThreadGroup>>>,
    segments: Mutex<HashMap<(usize, usize), Arc<Segment>>>,
}

#[derive(Default)]
struct Meeting {
    waiting: usize,
    round: usize,
    broken: bool,
}

pub(super) fn run<R: Send>(ranks: usize, body: impl Fn(ThreadRank) -> R + Sync) -> Vec<R> {
    let group = ThreadGroup::new(ranks);
    let body = &body;
    std::thread::scope(|scope| {
        let spawn = |rank| {
            let group = group.clone();
            scope.spawn(move || {
                let _guard = BreakOnPanic(group.clone());
                let of_rank = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
                of_rank.expect("a new thread is in no pool");
                body(ThreadRank { number: rank, group, machine: rank / 2 })
            })
        };
        let threads: Vec<_> = (0..ranks).map(spawn).collect();
        threads.into_iter().map(|t| t.join().expect("a rank panicked")).collect()
    })
}

/// Releases the other threads when this rank panics; they would wait for it forever.
struct BreakOnPanic(Arc<ThreadGroup>);

impl Drop for BreakOnPanic {
    fn drop(&mut self) {
        if std::thread::panicking() {
            lock(&self.0.meeting).broken = true;
            self.0.everyone.notify_all();
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl ThreadGroup {
    fn new(size: usize) -> Arc<Self> {
        Arc::new(Self {
            size,
            meeting: Mutex::default(),
            everyone: Condvar::new(),
            mail: (0..size * size).map(|_| Mutex::default()).collect(),
            subgroups: Mutex::default(),
            segments: Mutex::default(),
        })
    }

    fn meet(&self) -> usize {
        let mut meeting = lock(&self.meeting);
        let round = meeting.round;
        meeting.waiting += 1;
        if meeting.waiting == self.size {
            meeting.waiting = 0;
            meeting.round += 1;
            self.everyone.notify_all();
        }
        while meeting.round == round && !meeting.broken {
            meeting = self.everyone.wait(meeting).unwrap_or_else(PoisonError::into_inner);
        }
        assert!(meeting.round != round, "another rank panicked");
        round
    }
}

impl ThreadRank {
    pub(super) fn rank(&self) -> usize {
        self.number
    }

    pub(super) fn size(&self) -> usize {
        self.group.size
    }

    pub(super) fn barrier(&self) {
        self.group.meet();
    }

    /// Simulated machine of the rank.
    pub(super) fn machine(&self) -> usize {
        self.machine
    }

    /// Memory of every rank of the group.
    pub(super) fn share(&self, bytes: usize) -> Vec<Arc<Segment>> {
        let round = self.group.meet();
        lock(&self.group.segments).insert((round, self.number), Arc::new(Segment::private(bytes)));
        self.barrier();
        let all = (0..self.size()).map(|rank| lock(&self.group.segments)[&(round, rank)].clone()).collect();
        self.barrier();
        lock(&self.group.segments).remove(&(round, self.number));
        all
    }

    pub(super) fn split(&self, colour: usize) -> Self {
        let ones: Vec<_> = (0..self.size()).map(|rank| rank..rank + 1).collect();
        let mut colours = vec![0; self.size()];
        self.all_to_all((&vec![colour; self.size()], &ones), (&mut colours, &ones));
        let members = colours.iter().filter(|&&c| c == colour).count();
        let number = colours[..self.number].iter().filter(|&&c| c == colour).count();
        let round = self.group.meet();
        let group =
            lock(&self.group.subgroups).entry((round, colour)).or_insert_with(|| ThreadGroup::new(members)).clone();
        self.barrier();
        lock(&self.group.subgroups).remove(&(round, colour));
        Self { number, group, machine: self.machine }
    }

    pub(super) fn all_to_all<T: Pod>(&self, send: (&[T], &[Range<usize>]), receive: (&mut [T], &[Range<usize>])) {
        let (room, ranges) = receive;
        for (to, range) in send.1.iter().enumerate() {
            *lock(self.mailbox(self.number, to)) = bytemuck::cast_slice(&send.0[range.clone()]).to_vec();
        }
        self.barrier();
        for (from, range) in ranges.iter().enumerate() {
            let mail = std::mem::take(&mut *lock(self.mailbox(from, self.number)));
            bytemuck::cast_slice_mut::<T, u8>(&mut room[range.clone()]).copy_from_slice(&mail);
        }
        self.barrier();
    }

    pub(super) fn exchange<T: Pod>(&self, send: &[Vec<T>]) -> Vec<Vec<T>> {
        for (to, list) in send.iter().enumerate() {
            *lock(self.mailbox(self.number, to)) = bytemuck::cast_slice(list).to_vec();
        }
        self.barrier();
        let take = |from| values_of(&std::mem::take(&mut *lock(self.mailbox(from, self.number))));
        let received = (0..self.size()).map(take).collect();
        self.barrier();
        received
    }

    /// Values of each rank, in rank order.
    pub(super) fn all_gather<T: Pod>(&self, values: &[T]) -> Vec<T> {
        self.published(values, 0..self.size())
    }

    /// Values of each rank, in rank order, on the first rank; empty on the others.
    pub(super) fn gather<T: Pod>(&self, values: &[T]) -> Vec<T> {
        self.published(values, if self.number == 0 { 0..self.size() } else { 0..0 })
    }

    /// Replaces the values by those of the first rank, which has equally many.
    pub(super) fn broadcast<T: Pod>(&self, values: &mut [T]) {
        let first = self.published(values, 0..1);
        values.copy_from_slice(&first);
    }

    /// Values that some ranks passed, in rank order.
    fn published<T: Pod>(&self, values: &[T], ranks: Range<usize>) -> Vec<T> {
        *lock(self.mailbox(self.number, self.number)) = bytemuck::cast_slice(values).to_vec();
        self.barrier();
        let mut all = Vec::new();
        for rank in ranks {
            all.extend(values_of::<T>(&lock(self.mailbox(rank, rank))));
        }
        self.barrier();
        all
    }

    fn mailbox(&self, from: usize, to: usize) -> &Mutex<Vec<u8>> {
        &self.group.mail[from * self.group.size + to]
    }
}

/// Values from their bytes.
fn values_of<T: Pod>(bytes: &[u8]) -> Vec<T> {
    let mut values = vec![T::zeroed(); bytes.len() / size_of::<T>()];
    bytemuck::cast_slice_mut::<T, u8>(&mut values).copy_from_slice(bytes);
    values
}
