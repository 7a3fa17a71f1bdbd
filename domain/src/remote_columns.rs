//! Columns whose numbers are where they were computed, in the order of the particles' ids.

use crate::rows::{RowMove, Selection};
use crate::{ColumnValues, RemoteHolder, RemoteList};

/// Place of each id in their order, from 0 on.
pub fn places_by_id(ids: &[u64]) -> Vec<u32> {
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
