//! Adapter that measures the tasks of a parallel loop.

use super::recorder::{Recording, TaskClock};
use rayon::iter::plumbing::{Consumer, Folder, ProducerCallback, UnindexedConsumer};
use rayon::prelude::*;
use std::panic::Location;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Number of tasks into which a measured loop is divided, if it has as many items: enough to tell 128 threads apart.
const TASKS: usize = 256;

/// Parallel loops that can be measured.
pub trait MeasuredLoop: IndexedParallelIterator {
    /// The same loop, recorded while a [`measure`](super::measure) is under way. To be called last, before `for_each`,
    /// `collect`, or an adapter after which the number of items is not known.
    #[track_caller]
    fn measured(self) -> Measured<Self> {
        self.moving(0)
    }

    /// [`Self::measured`] of a loop that reads and writes a number of bytes of memory.
    #[track_caller]
    fn moving(self, bytes: usize) -> Measured<Self> {
        Measured { base: self, bytes, place: Location::caller() }
    }
}

impl<I: IndexedParallelIterator> MeasuredLoop for I {}

/// Parallel loop made by [`MeasuredLoop::measured`].
#[must_use = "an iterator does nothing until it is consumed"]
pub struct Measured<I> {
    base: I,
    bytes: usize,
    place: &'static Location<'static>,
}

impl<I: IndexedParallelIterator> ParallelIterator for Measured<I> {
    type Item = I::Item;

    fn drive_unindexed<C: UnindexedConsumer<I::Item>>(self, consumer: C) -> C::Result {
        self.drive(consumer)
    }

    fn opt_len(&self) -> Option<usize> {
        Some(self.base.len())
    }
}

impl<I: IndexedParallelIterator> IndexedParallelIterator for Measured<I> {
    fn len(&self) -> usize {
        self.base.len()
    }

    fn drive<C: Consumer<I::Item>>(self, consumer: C) -> C::Result {
        let Some(recording) = Recording::begin(self.place) else {
            return self.base.with_max_len(usize::MAX).drive(TaskConsumer { consumer, tasks: None });
        };
        let (tasks, longest) = (Tasks::timed_by(recording.clock()), self.base.len().div_ceil(TASKS).max(1));
        let result = self.base.with_max_len(longest).drive(TaskConsumer { consumer, tasks: Some(&tasks) });
        recording.end(&tasks, self.bytes);
        result
    }

    /// Loops that are part of a longer chain are not measured.
    fn with_producer<P: ProducerCallback<I::Item>>(self, callback: P) -> P::Output {
        self.base.with_producer(callback)
    }
}

/// Tasks of one loop so far.
pub(super) struct Tasks {
    clock: TaskClock,
    count: AtomicU64,
    nanoseconds: AtomicU64,
    largest: AtomicU64,
}

impl Tasks {
    pub fn timed_by(clock: TaskClock) -> Self {
        let [count, nanoseconds, largest] = [const { AtomicU64::new(0) }; 3];
        Self { clock, count, nanoseconds, largest }
    }

    pub fn add(&self, count: u64, nanoseconds: u64) {
        self.count.fetch_add(count, Ordering::Relaxed);
        self.nanoseconds.fetch_add(nanoseconds, Ordering::Relaxed);
        self.largest.fetch_max(nanoseconds / count.max(1), Ordering::Relaxed);
    }

    /// Number of tasks, and seconds of all and of the largest.
    pub fn sums(&self) -> (u64, f64, f64) {
        let of = |sum: &AtomicU64| sum.load(Ordering::Relaxed);
        (of(&self.count), 1e-9 * of(&self.nanoseconds) as f64, 1e-9 * of(&self.largest) as f64)
    }
}

struct TaskConsumer<'a, C> {
    consumer: C,
    tasks: Option<&'a Tasks>,
}

impl<'a, T, C: Consumer<T>> Consumer<T> for TaskConsumer<'a, C> {
    type Folder = TaskFolder<'a, C::Folder>;
    type Reducer = C::Reducer;
    type Result = C::Result;

    fn split_at(self, index: usize) -> (Self, Self, C::Reducer) {
        let (left, right, reducer) = self.consumer.split_at(index);
        let part = |consumer| Self { consumer, tasks: self.tasks };
        (part(left), part(right), reducer)
    }

    fn into_folder(self) -> Self::Folder {
        let task = self.tasks.map(|tasks| (tasks, (tasks.clock)()));
        TaskFolder { folder: self.consumer.into_folder(), task }
    }

    fn full(&self) -> bool {
        self.consumer.full()
    }
}

impl<T, C: UnindexedConsumer<T>> UnindexedConsumer<T> for TaskConsumer<'_, C> {
    fn split_off_left(&self) -> Self {
        Self { consumer: self.consumer.split_off_left(), tasks: self.tasks }
    }

    fn to_reducer(&self) -> C::Reducer {
        self.consumer.to_reducer()
    }
}

/// One task, with its beginning if it is measured.
struct TaskFolder<'a, F> {
    folder: F,
    task: Option<(&'a Tasks, Duration)>,
}

impl<T, F: Folder<T>> Folder<T> for TaskFolder<'_, F> {
    type Result = F::Result;

    fn consume(self, item: T) -> Self {
        Self { folder: self.folder.consume(item), ..self }
    }

    fn consume_iter<I: IntoIterator<Item = T>>(self, items: I) -> Self {
        Self { folder: self.folder.consume_iter(items), ..self }
    }

    fn complete(self) -> F::Result {
        let result = self.folder.complete();
        if let Some((tasks, start)) = self.task {
            tasks.add(1, (tasks.clock)().saturating_sub(start).as_nanos() as u64);
        }
        result
    }

    fn full(&self) -> bool {
        self.folder.full()
    }
}
