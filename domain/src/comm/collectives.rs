//! Values that all ranks combine, or that the first one gathers or distributes.

use super::{Backend, Comm, Failure};
use crate::block;
use bytemuck::Pod;
use std::sync::atomic::Ordering;

impl Comm {
    /// Values of all ranks, joined in rank order, on every rank. Ranks may contribute different numbers of values.
    pub fn all_gather<T: Pod>(&self, values: &[T]) -> Vec<T> {
        let counts = self.all_gather_equal(&[values.len()]);
        self.count_tree((self.size() - 1) * size_of_val(values));
        match &self.backend {
            Backend::Alone => values.to_vec(),
            Backend::Threads(rank) => rank.all_gather(values),
            Backend::Processes(rank) => rank.all_gather(values, &counts),
        }
    }

    /// Values of each rank on every rank. Ranks may contribute different numbers of values.
    pub fn all_gather_lists<T: Pod>(&self, values: &[T]) -> Vec<Vec<T>> {
        let counts = self.all_gather_equal(&[values.len()]);
        let all = self.all_gather(values);
        super::consecutive(&counts).into_iter().map(|range| all[range].to_vec()).collect()
    }

    /// Equally many values of each rank, joined in rank order, on every rank.
    fn all_gather_equal<T: Pod>(&self, values: &[T]) -> Vec<T> {
        self.count_tree((self.size() - 1) * size_of_val(values));
        match &self.backend {
            Backend::Alone => values.to_vec(),
            Backend::Threads(rank) => rank.all_gather(values),
            Backend::Processes(rank) => rank.all_gather_equal(values),
        }
    }

    /// Values of all ranks, joined in rank order, on the first rank; empty on the others.
    pub fn gather<T: Pod>(&self, values: &[T]) -> Vec<T> {
        let counts = self.all_gather_equal(&[values.len()]);
        if !self.is_first() {
            self.count_sent(size_of_val(values));
            self.sent.messages.fetch_add(1, Ordering::Relaxed);
        }
        match &self.backend {
            Backend::Alone => values.to_vec(),
            Backend::Threads(rank) => rank.gather(values),
            Backend::Processes(rank) => rank.gather(values, &counts),
        }
    }

    /// Copies the first rank's values to every rank.
    pub fn broadcast<T: Pod>(&self, values: &mut Vec<T>) {
        if self.size() == 1 {
            return;
        }
        let mut length = [values.len()];
        self.broadcast_equal(&mut length);
        values.resize(length[0], T::zeroed());
        self.broadcast_equal(values);
    }

    /// Copies the first rank's values to every rank, which have equally many.
    fn broadcast_equal<T: Pod>(&self, values: &mut [T]) {
        if self.is_first() {
            self.count_tree(size_of_val(values) * self.levels());
        }
        match &self.backend {
            Backend::Alone => {}
            Backend::Threads(rank) => rank.broadcast(values),
            Backend::Processes(rank) => rank.broadcast(values),
        }
    }

    /// Copies the first rank's text to every rank.
    pub fn broadcast_text(&self, text: &str) -> String {
        let mut bytes = text.as_bytes().to_vec();
        self.broadcast(&mut bytes);
        String::from_utf8(bytes).expect("the first rank sent text")
    }

    /// Replaces each value by its sum over the ranks, added in rank order. Every rank has equally many values.
    pub fn sum(&self, values: &mut [f64]) {
        self.combine(values, |a, b| a + b);
    }

    /// Replaces each value by its maximum over the ranks. Every rank has equally many values.
    pub fn max(&self, values: &mut [f64]) {
        self.combine(values, f64::max);
    }

    /// Replaces each value by its minimum over the ranks. Every rank has equally many values.
    pub fn min(&self, values: &mut [f64]) {
        self.combine(values, f64::min);
    }

    fn combine(&self, values: &mut [f64], operation: impl Fn(f64, f64) -> f64) {
        if self.size() == 1 || values.is_empty() {
            return;
        }
        if values.len() > WIDE {
            // Each rank combines a share of the values, so that none holds more than twice as many at a time.
            let share = |rank| block(values.len(), self.size(), rank);
            let sent: Vec<_> = (0..self.size()).map(share).collect();
            let own = share(self.rank()).len();
            let mut parts = vec![0.0; own * self.size()];
            let received: Vec<_> = (0..self.size()).map(|rank| own * rank..own * (rank + 1)).collect();
            self.all_to_all_ranges((values, &sent), (&mut parts, &received));
            values.copy_from_slice(&self.all_gather(&combined(&parts, own, operation)));
            return;
        }
        let all = self.all_gather_equal(values);
        values.copy_from_slice(&combined(&all, values.len(), operation));
    }

    /// Whether `yes` is true on any rank.
    pub fn any(&self, yes: bool) -> bool {
        self.count_tree(size_of::<i32>() * self.levels());
        match &self.backend {
            Backend::Alone => yes,
            Backend::Threads(rank) => rank.all_gather(&[u8::from(yes)]).contains(&1),
            Backend::Processes(rank) => rank.any(yes),
        }
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
        let messages = self.all_gather_lists(message.as_bytes());
        let rank = messages.iter().position(|m| !m.is_empty()).unwrap_or(0);
        let message = String::from_utf8_lossy(&messages[rank]).into_owned();
        Err(Failure { rank, ranks: self.size(), message })
    }

    /// Levels of a binary tree of the ranks.
    fn levels(&self) -> usize {
        self.size().next_power_of_two().ilog2() as usize
    }

    /// Counts bytes that a rank sends along a tree of the ranks.
    fn count_tree(&self, bytes: usize) {
        self.count_sent(bytes);
        self.sent.messages.fetch_add(self.levels() as u64, Ordering::Relaxed);
    }
}

/// Number of values above which they are combined by shares.
const WIDE: usize = 4096;

/// The values of all ranks, `width` of each, combined in rank order.
fn combined(all: &[f64], width: usize, operation: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let of_place = |i: usize| all[i..].iter().step_by(width).copied().reduce(&operation).unwrap_or_default();
    (0..width).map(of_place).collect()
}
