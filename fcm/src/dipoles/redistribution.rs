//! Particles on the ranks of another partition, and results of them on the ranks where they came from.

use bytemuck::Pod;
use domain::parallel::{copied, of_rows};
use domain::{DomainView, Particles, Partition, Vector};
use std::borrow::Cow;

/// Particles with lists of vectors on the ranks of another partition. On a single rank they stay as they are.
pub(super) struct Elsewhere<'a> {
    pub particles: Cow<'a, Particles>,
    home: DomainView<'a>,
    /// Ids and lists where the particles came from.
    ids: &'a [u64],
    lists: Vec<&'a [Vector]>,
    is_alone: bool,
}

/// Name of the column with the results.
const RESULT: &str = "result";

fn name(list: usize) -> String {
    format!("list {list}")
}

impl<'a> Elsewhere<'a> {
    /// Moves this rank's particles, with lists of a vector for each. Collective.
    pub fn new(partition: &Partition, home: DomainView<'a>, particles: &'a Particles, lists: &[&'a [Vector]]) -> Self {
        let (ids, lists, is_alone) = (&particles.ids[..], lists.to_vec(), partition.comm().size() == 1);
        if is_alone {
            return Self { particles: Cow::Borrowed(particles), home, ids, lists, is_alone };
        }
        let mut moved = particles.without_columns();
        for (index, list) in lists.iter().enumerate() {
            moved.vectors(&name(index)).copy_from_slice(list);
        }
        moved.migrate(partition, home.cell);
        Self { particles: Cow::Owned(moved), home, ids, lists, is_alone }
    }

    /// One of the lists, in the order of the particles here.
    pub fn vectors(&self, list: usize) -> Cow<'a, [Vector]> {
        if self.is_alone {
            return Cow::Borrowed(self.lists[list]);
        }
        let rows = self.particles.rows::<3>(&name(list)).expect("the column was made");
        Cow::Owned(of_rows(rows.len(), |row| Vector::from_array(rows[row])))
    }

    /// Results for the particles here, in the order of the particles where they came from. Collective.
    pub fn back<T: Pod + Send + Sync>(&self, results: Vec<T>) -> Vec<T> {
        if self.is_alone {
            return results;
        }
        let width = size_of::<T>() / size_of::<f64>();
        let mut particles = self.particles.without_columns();
        particles.column(RESULT, width).values.copy_from_slice(bytemuck::cast_slice(&results));
        particles.migrate(self.home.partition, self.home.cell);
        let values = std::mem::take(&mut particles.column(RESULT, width).values);
        let sorted: &[T] = bytemuck::cast_slice(&values);
        if particles.ids == self.ids {
            return copied(sorted);
        }
        let mut rows: Vec<usize> = (0..sorted.len()).collect();
        rows.sort_by_key(|&row| particles.ids[row]);
        let row = |id: &u64| rows.binary_search_by_key(id, |&row| particles.ids[row]);
        let found = self.ids.iter().map(|id| row(id).expect("each particle is back where it came from"));
        found.map(|place| sorted[rows[place]]).collect()
    }
}
