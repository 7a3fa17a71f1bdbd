//! Moves of a table's rows, one property after the other: reordering, and sending to other ranks.

use crate::parallel::MeasuredLoop;
use crate::{Comm, Incoming, Outgoing};
use bytemuck::Pod;
use rayon::prelude::*;

/// A value of a row that any thread may move.
pub(crate) trait RowValue: Pod + Send + Sync {}

impl<T: Pod + Send + Sync> RowValue for T {}

/// Moves rows of values, `width` numbers each. May be collective.
pub(crate) trait RowMove {
    /// Values of the rows after the move.
    fn of<T: RowValue>(&self, values: &[T], width: usize) -> Vec<T>;
}

/// Rows of a list, in its order.
#[derive(Clone, Copy)]
pub(crate) struct Selection<'a>(pub &'a [usize]);

/// Rows that one thread moves at a time.
const BATCH: usize = 256;

impl RowMove for Selection<'_> {
    fn of<T: RowValue>(&self, values: &[T], width: usize) -> Vec<T> {
        let mut picked = vec![T::zeroed(); self.0.len() * width];
        if width > 0 {
            let parts = picked.par_chunks_mut(BATCH * width).zip(self.0.par_chunks(BATCH));
            parts.measured().for_each(|(picked, rows)| match width {
                1 => pick::<T, 1>(values, rows, picked),
                3 => pick::<T, 3>(values, rows, picked),
                5 => pick::<T, 5>(values, rows, picked),
                _ => {
                    for (picked, &row) in picked.chunks_exact_mut(width).zip(rows) {
                        picked.copy_from_slice(&values[row * width..][..width]);
                    }
                }
            });
        }
        picked
    }
}

/// Rows of a width known at compile time, which are copied without a call.
fn pick<T: Copy, const WIDTH: usize>(values: &[T], rows: &[usize], picked: &mut [T]) {
    let (values, picked) = (values.as_chunks::<WIDTH>().0, picked.as_chunks_mut::<WIDTH>().0);
    picked.iter_mut().zip(rows).for_each(|(picked, &row)| *picked = values[row]);
}

/// Sends each row to a rank. Incoming rows are in the order of the sending ranks, and from each rank in its own
/// order.
pub(crate) struct RowExchange {
    comm: Comm,
    /// Rows sorted by the receiving rank.
    order: Vec<usize>,
    leaving: Vec<usize>,
    arriving: Vec<usize>,
}

impl RowExchange {
    /// Plans sending each row to the rank in `owners`. Collective.
    pub fn plan(owners: &[usize], comm: &Comm) -> Self {
        let mut leaving = vec![0; comm.size()];
        for &owner in owners {
            leaving[owner] += 1;
        }
        let mut order: Vec<usize> = (0..owners.len()).collect();
        order.sort_by_key(|&row| owners[row]);
        let arriving = comm.exchange_counts(&leaving);
        Self { comm: comm.clone(), order, leaving, arriving }
    }
}

impl RowExchange {
    /// The ranks.
    pub fn comm(&self) -> &Comm {
        &self.comm
    }
}

impl RowMove for RowExchange {
    fn of<T: RowValue>(&self, values: &[T], width: usize) -> Vec<T> {
        let send = Selection(&self.order).of(values, width);
        if self.comm.size() == 1 {
            return send;
        }
        let [sent, arriving] =
            [&self.leaving, &self.arriving].map(|rows| rows.iter().map(|rows| rows * width).collect::<Vec<_>>());
        let mut received = vec![T::zeroed(); arriving.iter().sum()];
        let room = Incoming { room: &mut received, counts: &arriving };
        self.comm.send_receive(Outgoing { values: &send, counts: &sent }, room);
        received
    }
}

/// An exchange, followed by reordering.
pub(crate) struct SortedExchange<'a> {
    pub exchange: RowExchange,
    pub order: Selection<'a>,
}

impl RowMove for SortedExchange<'_> {
    fn of<T: RowValue>(&self, values: &[T], width: usize) -> Vec<T> {
        self.order.of(&self.exchange.of(values, width), width)
    }
}
