//! Ranks that are threads of one process, so that ordinary tests exercise every exchange.

use bytemuck::Pod;
use std::collections::HashMap;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// One thread's place in a group of threads.
#[derive(Clone)]
pub(super) struct Rank {
    rank: usize,
    group: Arc<Group>,
}

/// What the threads of a group share: a meeting point and a mailbox from every rank to every other.
struct Group {
    size: usize,
    meeting: Mutex<Meeting>,
    everyone: Condvar,
    mail: Vec<Mutex<Vec<u8>>>,
    subgroups: Mutex<HashMap<(usize, usize), Arc<Group>>>,
}

#[derive(Default)]
struct Meeting {
    waiting: usize,
    round: usize,
    broken: bool,
}

pub(super) fn run<R: Send>(ranks: usize, body: impl Fn(Rank) -> R + Sync) -> Vec<R> {
    let group = Group::new(ranks);
    let body = &body;
    std::thread::scope(|scope| {
        let spawn = |rank| {
            let group = group.clone();
            scope.spawn(move || {
                let guard = BreakOnPanic(group.clone());
                let value = body(Rank { rank, group });
                std::mem::forget(guard);
                value
            })
        };
        let threads: Vec<_> = (0..ranks).map(spawn).collect();
        threads.into_iter().map(|t| t.join().expect("a rank panicked")).collect()
    })
}

/// Lets the others go when this rank panics, rather than wait for it for ever.
struct BreakOnPanic(Arc<Group>);

impl Drop for BreakOnPanic {
    fn drop(&mut self) {
        lock(&self.0.meeting).broken = true;
        self.0.everyone.notify_all();
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Group {
    fn new(size: usize) -> Arc<Self> {
        Arc::new(Self {
            size,
            meeting: Mutex::default(),
            everyone: Condvar::new(),
            mail: (0..size * size).map(|_| Mutex::default()).collect(),
            subgroups: Mutex::default(),
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

impl Rank {
    pub(super) fn rank(&self) -> usize {
        self.rank
    }

    pub(super) fn size(&self) -> usize {
        self.group.size
    }

    pub(super) fn barrier(&self) {
        self.group.meet();
    }

    pub(super) fn split(&self, colour: usize) -> Self {
        let ones = vec![1; self.size()];
        let mut colours = vec![0; self.size()];
        self.all_to_all((&vec![colour; self.size()], &ones), (&mut colours, &ones));
        let members = colours.iter().filter(|&&c| c == colour).count();
        let rank = colours[..self.rank].iter().filter(|&&c| c == colour).count();
        let round = self.group.meet();
        let group = lock(&self.group.subgroups).entry((round, colour)).or_insert_with(|| Group::new(members)).clone();
        self.barrier();
        lock(&self.group.subgroups).remove(&(round, colour));
        Self { rank, group }
    }

    pub(super) fn all_to_all<T: Pod>(&self, send: (&[T], &[usize]), receive: (&mut [T], &[usize])) {
        let mut rest = send.0;
        for (to, &count) in send.1.iter().enumerate() {
            let (part, tail) = rest.split_at(count);
            *lock(self.mailbox(self.rank, to)) = bytemuck::cast_slice(part).to_vec();
            rest = tail;
        }
        self.barrier();
        let mut room = receive.0;
        for (from, &count) in receive.1.iter().enumerate() {
            let (part, tail) = room.split_at_mut(count);
            let mail = std::mem::take(&mut *lock(self.mailbox(from, self.rank)));
            bytemuck::cast_slice_mut::<T, u8>(part).copy_from_slice(&mail);
            room = tail;
        }
        self.barrier();
    }

    fn mailbox(&self, from: usize, to: usize) -> &Mutex<Vec<u8>> {
        &self.group.mail[from * self.group.size + to]
    }
}
