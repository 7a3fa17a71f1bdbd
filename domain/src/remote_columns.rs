//! Columns whose numbers are where they were computed, in the order of the particles' ids.

use crate::parallel::{all_rows, mapped};
use crate::rows::{RowMove, Selection};
use crate::{ColumnValues, RemoteHolder, RemoteList};

/// Place of each id in their order, from 0 on. Ids are unique.
pub fn places_by_id(ids: &[u64]) -> Vec<u32> {
    // Those from 0 on without gaps are places.
    if all_rows(ids.len(), |row| ids[row] < ids.len() as u64) {
        return mapped(ids, |&id| id as u32);
    }
    let mut order: Vec<u32> = (0..ids.len() as u32).collect();
    order.sort_unstable_by_key(|&row| ids[row as usize]);
    let mut places = vec![0; ids.len()];
    order.iter().zip(0..).for_each(|(&row, place)| places[row as usize] = place);
    places
}

/// Copies the numbers of columns, with their widths, for particles with these ids from the memory that holds them;
/// those that are here are left alone.
pub fn fetch(ids: &[u64], columns: &[(&ColumnValues, usize)], holder: &dyn RemoteHolder) {
    let mut missing: Vec<(&ColumnValues, usize)> = Vec::new();
    for &(values, width) in columns.iter().filter(|(values, _)| !values.is_here()) {
        if !missing.iter().any(|(other, _)| other.shares_memory_with(values)) {
            missing.push((values, width));
        }
    }
    if missing.is_empty() {
        return;
    }
    let rows: Vec<usize> = places_by_id(ids).into_iter().map(|place| place as usize).collect();
    let lists: Vec<&RemoteList> = missing.iter().filter_map(|(values, _)| values.remote_list()).collect();
    for ((values, width), copy) in missing.iter().zip(holder.copies(&lists)) {
        values.receive(Selection(&rows).of(&copy, *width));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::remote_memory::RemoteMemory;
    use crate::{Comm, Particles, Vector};

    /// A column with the ids, in their order, and some other numbers.
    fn column(memory: &RemoteMemory, ids: &[u64], factor: f64) -> ColumnValues {
        let mut ids = ids.to_vec();
        ids.sort_unstable();
        let values: Vec<f64> = ids.iter().flat_map(|&id| [id as f64, factor * id as f64]).collect();
        ColumnValues::remote(memory.hold(&values))
    }

    fn particles(memory: &RemoteMemory) -> Particles {
        let mut particles = Particles::default();
        for (row, id) in [40, 7, 900, 12].into_iter().enumerate() {
            particles.push(id, Vector::splat(row as f64), 1.0, 0);
        }
        particles.column("far", 2).values = column(memory, &particles.ids, 3.0);
        particles
    }

    fn expected(ids: &[u64]) -> Vec<f64> {
        ids.iter().flat_map(|&id| [id as f64, 3.0 * id as f64]).collect()
    }

    /// Rows have their own numbers, whether they are fetched before or after they change their places, and a state to
    /// which particles go back has those of its rows.
    #[test]
    fn rows_have_their_numbers_in_any_order() {
        for is_early in [false, true] {
            let memory = RemoteMemory::default();
            let mut particles = particles(&memory);
            particles.save(&Comm::alone());
            if is_early {
                particles.fetch(&memory);
            }
            particles.arrange(&[2, 0, 3, 1]);
            particles.fetch(&memory);
            assert_eq!(*particles.column("far", 2).values, expected(&[900, 40, 12, 7]));
            assert!(particles.column("far", 2).values.remote_list().is_some());
            particles.restore(&Comm::alone());
            assert_eq!(particles.ids, [40, 7, 900, 12]);
            particles.fetch(&memory);
            assert_eq!(*particles.column("far", 2).values, expected(&[40, 7, 900, 12]));
        }
    }

    /// Ids without gaps, which are the usual ones, and others.
    #[test]
    fn places_are_the_order_of_ids() {
        assert_eq!(places_by_id(&[2, 0, 3, 1]), [2, 0, 3, 1]);
        assert_eq!(places_by_id(&[40, 7, 900, 12]), [2, 0, 3, 1]);
        assert_eq!(places_by_id(&[]), []);
    }

    /// Lists that several columns share are copied once, and no list that is here; numbers that change are no longer
    /// those of the remote list, which its holder may release.
    #[test]
    fn lists_are_copied_once() {
        let memory = RemoteMemory::default();
        let mut particles = particles(&memory);
        particles.column("past", 2).values = particles.column("far", 2).values.clone();
        particles.fetch(&memory);
        particles.fetch(&memory);
        assert_eq!(memory.copies.get(), 1);
        particles.column("far", 2).values[0] = -1.0;
        assert!(particles.column("far", 2).values.remote_list().is_none());
        assert_eq!(particles.column("past", 2).values[..2], [40.0, 120.0]);
        assert!(!memory.lists.borrow()[0].0.is_alone());
        particles.remove(|name| name == "past");
        assert!(memory.lists.borrow()[0].0.is_alone());
    }
}
