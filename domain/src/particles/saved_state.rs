//! State of a particle store to which a step that fails returns.

use super::Particles;
use crate::column::{Column, ColumnValues, ParticleValues};
use crate::parallel::{FusedLoops, MeasuredLoop, of_rows};
use crate::rows::{RowExchange, RowMove, Selection};
use crate::{Comm, RemoteHolder, Scalars, Vector, remote_columns};
use rayon::prelude::*;

/// A saved state, row by row with the particles, wherever they move: numbers of columns that have not changed since
/// are in memory once.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SavedState {
    pub(super) rows: SavedRows,
    columns: Vec<Column>,
    scalars: Scalars,
}

/// Positions of a saved state, and where each particle was.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct SavedRows {
    /// Rank and row.
    home: Vec<[u32; 2]>,
    positions: ParticleValues<Vector>,
    steps: ParticleValues<[i32; 3]>,
}

impl SavedState {
    /// Positions and lattice steps.
    pub(super) fn places(&self) -> (&ParticleValues<Vector>, &ParticleValues<[i32; 3]>) {
        (&self.rows.positions, &self.rows.steps)
    }
}

impl SavedRows {
    /// Makes the rows of a list from other ones, as some of several loops.
    pub fn arrange_in<'a>(&'a mut self, loops: &mut FusedLoops<'a>, from: &'a Self, order: &'a [usize]) {
        let Self { home, positions, steps } = self;
        loops.mapped(home, order, |&row| from.home[row]);
        positions.arrange_in(loops, &from.positions, order);
        steps.arrange_in(loops, &from.steps, order);
    }

    /// Moves the rows, one list after the other.
    pub fn move_by(&mut self, row_move: &impl RowMove) {
        self.home = row_move.of(&self.home, 1);
        self.positions = self.positions.rearranged(|values| row_move.of(values, 1));
        self.steps = self.steps.rearranged(|values| row_move.of(values, 1));
    }
}

impl Particles {
    /// Saves the state, for [`Self::restore`]. It follows the particles until then or until [`Self::forget`].
    pub fn save(&mut self, comm: &Comm) {
        let (count, rank) = (self.len(), comm.rank() as u32);
        let home = of_rows(count, |row| [rank, row as u32]);
        let rows = SavedRows { home, positions: self.positions.clone(), steps: self.steps.clone() };
        let (columns, scalars) = (self.columns.clone(), self.scalars.clone());
        self.saved = Some(Box::new(SavedState { rows, columns, scalars }));
    }

    /// Forgets the saved state.
    pub fn forget(&mut self) {
        self.saved = None;
    }

    /// Returns to the saved state, bit for bit, with each particle on the rank and in the row where it was. Collective.
    ///
    /// # Panics
    ///
    /// If no state is saved.
    pub fn restore(&mut self, comm: &Comm) {
        let SavedState { rows, columns, scalars } = *self.saved.take().expect("a saved state");
        let SavedRows { home, positions, steps } = rows;
        (self.positions, self.steps, self.columns, self.scalars) = (positions, steps, columns, scalars);
        self.displacements.clear();
        let owners = of_rows(home.len(), |row| home[row][0] as usize);
        let exchange = RowExchange::plan(&owners, comm);
        let came: Vec<[u32; 2]> = exchange.of(&home, 1);
        self.each_property(&exchange);
        let mut order = vec![0; came.len()];
        came.iter().zip(0..).for_each(|(home, row)| order[home[1] as usize] = row);
        self.arrange(&order);
    }

    /// Moves the rows of all columns at the same time.
    pub(super) fn arrange_columns(&mut self, picked: Selection) {
        let mut values = DistinctValues::take(self, None);
        // In parallel over the columns, as each takes hardly longer than the wake-up of a thread.
        values.lists.par_iter_mut().measured().for_each(|list| list.move_by(&picked));
        values.put_back(self);
    }

    /// Moves the rows of one column after the other, so that only one is in memory twice. Collective.
    pub(super) fn exchange_columns(&mut self, exchange: &RowExchange) {
        let mut values = DistinctValues::take(self, Some(exchange.comm()));
        values.lists.iter_mut().for_each(|list| list.move_by(exchange));
        values.put_back(self);
    }

    /// Copies the values of remote lists, those of the saved state among them, from the memory that holds them.
    pub fn fetch(&self, holder: &dyn RemoteHolder) {
        let saved = self.saved.iter().flat_map(|saved| &saved.columns);
        let columns = self.columns.iter().chain(saved).map(|column| (&column.values, column.width));
        let terms = self.displacements.iter().map(|(values, _)| (values, 3));
        remote_columns::fetch(&self.ids, &columns.chain(terms).collect::<Vec<_>>(), holder);
        self.fetch_positions(holder);
    }

    /// Columns, followed by those of the saved state.
    fn all_columns(&mut self) -> impl Iterator<Item = &mut Column> {
        self.columns.iter_mut().chain(self.saved.iter_mut().flat_map(|saved| &mut saved.columns))
    }
}

/// Numbers of all columns of a store and of its saved state, each list in memory once.
struct DistinctValues {
    lists: Vec<WideList>,
    /// List of each column.
    of_columns: Vec<usize>,
}

/// A list of rows of numbers.
struct WideList {
    values: ColumnValues,
    width: usize,
}

impl WideList {
    fn move_by(&mut self, row_move: &impl RowMove) {
        self.values = self.values.rearranged(|values| row_move.of(values, self.width));
    }
}

impl DistinctValues {
    /// Takes the numbers out of the columns. With several ranks these must agree; then it is collective.
    fn take(particles: &mut Particles, comm: Option<&Comm>) -> Self {
        let has_saved = particles.saved.is_some();
        let taken = |column: &mut Column| WideList { values: std::mem::take(&mut column.values), width: column.width };
        let all: Vec<WideList> = particles.all_columns().map(taken).collect();
        let is_same = |k: usize, other: usize| all[k].values.shares_memory_with(&all[other].values);
        let first = |k: usize| (0..k).find(|&other| has_saved && is_same(k, other)).unwrap_or(k);
        let mut firsts: Vec<usize> = (0..all.len()).map(first).collect();
        if let Some(comm) = comm.filter(|comm| has_saved && comm.size() > 1) {
            keep_agreed(&mut firsts, comm);
        }
        let (mut lists, mut of_columns) = (Vec::new(), Vec::new());
        for (k, list) in all.into_iter().enumerate() {
            let known = firsts[k];
            of_columns.push(if known == k { lists.len() } else { of_columns[known] });
            if known == k {
                lists.push(list);
            }
        }
        Self { lists, of_columns }
    }

    fn put_back(self, particles: &mut Particles) {
        for (column, of_column) in particles.all_columns().zip(self.of_columns) {
            column.values = self.lists[of_column].values.clone();
        }
    }
}

/// Keeps what is the same on all ranks: whether the numbers of a column are those of an earlier one may differ, if only
/// one of them has changed numbers. Collective.
fn keep_agreed(firsts: &mut [usize], comm: &Comm) {
    let mut bounds: Vec<f64> = firsts.iter().flat_map(|&first| [first as f64, -(first as f64)]).collect();
    comm.max(&mut bounds);
    for (k, first) in firsts.iter_mut().enumerate() {
        if bounds[2 * k] + bounds[2 * k + 1] != 0.0 {
            *first = k;
        }
    }
}

#[cfg(test)]
mod tests;
