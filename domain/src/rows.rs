//! Moving the rows of a table, one property after the other: reordering, and sending to other ranks.

use crate::Comm;
use bytemuck::Pod;

/// Moves rows of values, `width` numbers each. May be collective.
pub(crate) trait Way {
    /// The values of the rows after the move.
    fn of<T: Pod>(&self, values: &[T], width: usize) -> Vec<T>;
}

/// The rows of a list, in its order.
#[derive(Clone, Copy)]
pub(crate) struct Picked<'a>(pub &'a [usize]);

impl Way for Picked<'_> {
    fn of<T: Pod>(&self, values: &[T], width: usize) -> Vec<T> {
        let mut picked = Vec::with_capacity(self.0.len() * width);
        for &row in self.0 {
            picked.extend_from_slice(&values[row * width..(row + 1) * width]);
        }
        picked
    }
}

/// Sends each row to a rank. Received rows are in the order of the sending ranks, and of each rank in its own order.
pub(crate) struct Delivery {
    comm: Comm,
    /// Rows sorted by the receiving rank.
    order: Vec<usize>,
    leaving: Vec<usize>,
    arriving: Vec<usize>,
}

impl Delivery {
    /// Plans the delivery of each row to the rank in a list. Collective.
    pub fn plan(owners: &[usize], comm: &Comm) -> Self {
        let mut leaving = vec![0; comm.size()];
        for &owner in owners {
            leaving[owner] += 1;
        }
        let mut order: Vec<usize> = (0..owners.len()).collect();
        order.sort_by_key(|&row| owners[row]);
        let (mut arriving, ones) = (vec![0; comm.size()], vec![1; comm.size()]);
        comm.all_to_all((&leaving, &ones), (&mut arriving, &ones));
        Self { comm: comm.clone(), order, leaving, arriving }
    }
}

impl Way for Delivery {
    fn of<T: Pod>(&self, values: &[T], width: usize) -> Vec<T> {
        let send = Picked(&self.order).of(values, width);
        if self.comm.size() == 1 {
            return send;
        }
        let numbers = |rows: &[usize]| rows.iter().map(|rows| rows * width).collect::<Vec<_>>();
        let mut received = vec![T::zeroed(); width * self.arriving.iter().sum::<usize>()];
        self.comm.all_to_all((&send, &numbers(&self.leaving)), (&mut received, &numbers(&self.arriving)));
        received
    }
}

/// A delivery, followed by reordering.
pub(crate) struct Sorted<'a> {
    pub delivery: Delivery,
    pub order: Picked<'a>,
}

impl Way for Sorted<'_> {
    fn of<T: Pod>(&self, values: &[T], width: usize) -> Vec<T> {
        self.order.of(&self.delivery.of(values, width), width)
    }
}
