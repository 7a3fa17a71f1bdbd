//! Particle store: one column per property, one row per particle, and the scalars of the state.

pub mod remote_motion;
pub mod saved_state;

use crate::column::{Column, ColumnError, ColumnValues, ParticleValues};
use crate::parallel::{FusedLoops, MeasuredLoop, change_rows, sort, stage};
use crate::rows::{RowExchange, RowMove, Selection, SortedExchange};
use crate::{Partition, PeriodicBox, Scalars, Vector};
use rayon::prelude::*;
use saved_state::{SavedRows, SavedState};
use std::mem::take;

/// Particles that this rank owns. Positions are inside the box; `steps` counts the lattice vectors that wrapping took
/// out of each, so `position + lattice(steps)` is the position without periodicity.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Particles {
    /// Unique ids; a particle keeps its id for the whole run.
    pub ids: Vec<u64>,
    /// Centres, inside the box.
    pub positions: ParticleValues<Vector>,
    /// Lattice steps that wrapping has taken out of each position.
    pub steps: ParticleValues<[i32; 3]>,
    /// Radii.
    pub radii: Vec<f64>,
    /// Species, as indices into the scene's list.
    pub species: Vec<u32>,
    /// Displacements that have yet to be added to positions in a remote list, as columns of vectors and their weights.
    pub displacements: Vec<(ColumnValues, f64)>,
    /// All other properties.
    pub columns: Vec<Column>,
    /// Numbers of the run as a whole, equal on all ranks.
    pub scalars: Scalars,
    /// State to which [`Self::restore`] returns.
    pub saved: Option<Box<SavedState>>,
}

/// Particles that one thread processes at a time.
const BATCH: usize = 256;

impl Particles {
    /// Number of particles that this rank owns.
    pub fn len(&self) -> usize {
        self.ids.len()
    }

    /// Whether this rank owns none.
    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }

    /// Particles numbered from 0.
    pub fn numbered(positions: Vec<Vector>, radii: Vec<f64>, species: Vec<u32>) -> Self {
        let (ids, steps) = ((0..positions.len() as u64).collect(), vec![[0; 3]; positions.len()].into());
        Self { ids, positions: positions.into(), steps, radii, species, ..Self::default() }
    }

    /// Adds a particle, with zeros in its columns.
    pub fn push(&mut self, id: u64, position: Vector, radius: f64, species: u32) {
        self.ids.push(id);
        self.positions.push(position);
        self.steps.push([0; 3]);
        self.radii.push(radius);
        self.species.push(species);
        let count = self.len();
        for column in &mut self.columns {
            column.values.resize(column.width * count, 0.0);
        }
    }

    /// The column of this name, created with zeros if there is none yet.
    pub fn column(&mut self, name: &str, width: usize) -> &mut Column {
        let place = self.columns.iter().position(|c| c.name == name).unwrap_or_else(|| {
            let values = vec![0.0; width * self.len()].into();
            self.columns.push(Column { name: name.to_owned(), width, values });
            self.columns.len() - 1
        });
        &mut self.columns[place]
    }

    /// Sets the values of the column of this name, which is made if there is none yet.
    pub fn set_column(&mut self, name: &str, width: usize, values: ColumnValues) {
        match self.columns.iter_mut().find(|column| column.name == name) {
            Some(column) => column.values = values,
            None => self.columns.push(Column { name: name.to_owned(), width, values }),
        }
    }

    /// The values of columns of these names and widths, all different, created with zeros if there are none yet.
    pub fn columns_of<const N: usize>(&mut self, names: [&str; N], widths: [usize; N]) -> [&mut Vec<f64>; N] {
        names.iter().zip(widths).for_each(|(name, width)| _ = self.column(name, width));
        let mut found = [const { None }; N];
        for column in &mut self.columns {
            if let Some(k) = names.iter().position(|name| *name == column.name) {
                found[k] = Some(&mut *column.values);
            }
        }
        found.map(|values| values.expect("columns of different names"))
    }

    /// Rows of the column of this name with `N` numbers per particle, if there is one.
    pub fn rows<const N: usize>(&self, name: &str) -> Option<&[[f64; N]]> {
        let column = self.columns.iter().find(|column| column.name == name && column.width == N)?;
        let (rows, rest) = column.values.as_chunks();
        (rest.is_empty() && rows.len() == self.len()).then_some(rows)
    }

    /// A column of vectors, one per particle.
    pub fn vectors(&mut self, name: &str) -> &mut [Vector] {
        bytemuck::cast_slice_mut(&mut self.column(name, 3).values)
    }

    /// Removes the columns and scalars whose names are unwanted.
    pub fn remove(&mut self, is_unwanted: impl Fn(&str) -> bool) {
        self.columns.retain(|column| !is_unwanted(&column.name));
        self.scalars.retain(|name| !is_unwanted(name));
    }

    /// Adds the sum of `weights[k] * columns[k]` to the positions; columns that are missing are made, of zeros. If the
    /// positions are in a remote list, they are displaced there by [`Self::advance_remotely`].
    pub fn displace_by<const N: usize>(&mut self, columns: [&str; N], weights: [f64; N]) {
        for name in columns {
            self.column(name, 3);
        }
        let find = |name: &str| self.columns.iter().find(|column| column.name == name).expect("made above");
        if let Some(list) = self.positions.remote_list() {
            let terms: Vec<_> =
                columns.into_iter().zip(weights).map(|(name, w)| (find(name).values.clone(), w)).collect();
            self.positions = ParticleValues::remote(list.clone());
            self.displacements.extend(terms);
            return;
        }
        let columns: [&[Vector]; N] = columns.map(|name| bytemuck::cast_slice(&find(name).values));
        let displacement = |row: usize| (0..N).map(|k| columns[k][row] * weights[k]).sum::<Vector>();
        change_rows(&mut self.positions, |row, position| *position += displacement(row));
    }

    /// Refuses a store whose columns do not fit its number of particles.
    pub fn check(&self) -> Result<(), ColumnError> {
        let particles = self.len();
        let fits = |name: &str, found: usize, width: usize| {
            let error = || ColumnError { name: name.to_owned(), found, width, particles };
            if found == width * particles { Ok(()) } else { Err(error()) }
        };
        fits("positions", self.positions.len(), 1)?;
        fits("steps", self.steps.len(), 1)?;
        fits("radii", self.radii.len(), 1)?;
        fits("species", self.species.len(), 1)?;
        self.columns.iter().try_for_each(|c| fits(&c.name, c.values.len(), c.width))
    }

    /// Moves every position back inside the box and counts the lattice steps.
    pub fn wrap(&mut self, cell: &PeriodicBox) {
        let places = self.positions.par_iter_mut().with_min_len(BATCH).zip(&mut *self.steps);
        places.measured().for_each(|(position, steps)| {
            let (wrapped, taken) = cell.wrap(*position);
            *position = wrapped;
            *steps = std::array::from_fn(|i| steps[i].wrapping_add(taken[i]));
        });
    }

    /// Updates the lattice steps after a change of the basis of the same lattice: the new `steps` are an integer
    /// matrix, row by row, times the former ones. Steps beyond the range of their type are counted modulo `2^32`.
    pub fn relabel(&mut self, matrix: &[[i32; 3]; 3]) {
        for steps in &mut self.steps {
            let before = *steps;
            *steps = matrix.map(|row| (0..3).fold(0, |sum: i32, k| sum.wrapping_add(row[k].wrapping_mul(before[k]))));
        }
    }

    /// Reorders the particles by a list of rows; rows that are not in the list are dropped.
    pub fn arrange(&mut self, order: &[usize]) {
        let Self { ids, positions, steps, radii, species, saved, .. } = self;
        let (mut arranged, mut rows) = (Self::default(), SavedRows::default());
        let mut loops = FusedLoops::default();
        loops.mapped(&mut arranged.ids, order, |&row| ids[row]);
        arranged.positions.arrange_in(&mut loops, positions, order);
        arranged.steps.arrange_in(&mut loops, steps, order);
        loops.mapped(&mut arranged.radii, order, |&row| radii[row]);
        loops.mapped(&mut arranged.species, order, |&row| species[row]);
        if let Some(saved) = saved {
            rows.arrange_in(&mut loops, &saved.rows, order);
        }
        loops.run();
        if let Some(saved) = saved {
            saved.rows = rows;
        }
        let Self { ids, positions, steps, radii, species, .. } = arranged;
        let (columns, scalars, saved) = (take(&mut self.columns), take(&mut self.scalars), self.saved.take());
        let displacements = take(&mut self.displacements);
        *self = Self { ids, positions, steps, radii, species, displacements, columns, scalars, saved };
        self.arrange_columns(Selection(order));
    }

    /// The given rows, in that order, as a new store.
    #[must_use]
    pub fn selected(&self, rows: &[usize]) -> Self {
        self.mapped(&Selection(rows), |_| true)
    }

    /// Moves every particle, with all its columns, to the rank that owns its position, and sorts each rank's
    /// particles by grid line and, within a line, by id, so that the order does not depend on where they came from.
    /// Positions must be inside the box; all ranks have the same columns.
    pub fn migrate(&mut self, partition: &Partition, cell: &PeriodicBox) {
        let _stage = stage("migration");
        if partition.comm().size() > 1 {
            let owners: Vec<usize> = self.positions.iter().map(|&p| partition.owner(cell, p)).collect();
            self.each_property(&RowExchange::plan(&owners, partition.comm()));
        }
        let lines = partition.lines();
        let place = |(&position, &id): (&Vector, &u64)| {
            let p = cell.fractional_coordinates(position);
            ((p.z * lines[1] as f64) as i64, (p.y * lines[0] as f64) as i64, id)
        };
        let places: Vec<_> =
            self.positions.par_iter().with_min_len(BATCH).zip(&self.ids).map(place).measured().collect();
        if !places.is_sorted() {
            let mut order: Vec<usize> = (0..self.len()).collect();
            sort(places.len(), || order.par_sort_by_key(|&row| places[row]));
            self.arrange(&order);
        }
    }

    /// The same particles without their columns.
    #[must_use]
    pub fn without_columns(&self) -> Self {
        self.with_columns(|_| false)
    }

    /// The same particles with only the columns whose names are wanted, whose numbers both share until they change.
    #[must_use]
    pub fn with_columns(&self, wanted: impl Fn(&str) -> bool) -> Self {
        let columns = self.columns.iter().filter(|column| wanted(&column.name)).cloned().collect();
        let (positions, steps) = (self.positions.clone(), self.steps.clone());
        let displacements = self.displacements.clone();
        let mut copy =
            Self { positions, steps, displacements, columns, scalars: self.scalars.clone(), ..Self::default() };
        let mut loops = FusedLoops::default();
        loops.copied(&mut copy.ids, &self.ids);
        loops.copied(&mut copy.radii, &self.radii);
        loops.copied(&mut copy.species, &self.species);
        loops.run();
        copy
    }

    /// All particles on the first rank, in the order of their ids; none on the others. Collective.
    #[must_use]
    pub fn gathered(&self, partition: &Partition) -> Self {
        self.gathered_with(partition, |_| true)
    }

    /// The same with only the columns whose names are wanted. Collective.
    #[must_use]
    pub fn gathered_with(&self, partition: &Partition, wanted: impl Fn(&str) -> bool) -> Self {
        let exchange = RowExchange::plan(&vec![0; self.len()], partition.comm());
        let ids = exchange.of(&self.ids, 1);
        let mut order: Vec<usize> = (0..ids.len()).collect();
        order.sort_by_key(|&row| ids[row]);
        self.mapped(&SortedExchange { exchange, order: Selection(&order) }, wanted)
    }

    /// A copy, with the saved state.
    #[must_use]
    pub fn copied(&self) -> Self {
        Self { saved: self.saved.clone(), ..self.with_columns(|_| true) }
    }

    /// Moves the rows of one property after the other, so that only one is in memory twice.
    fn each_property(&mut self, exchange: &RowExchange) {
        self.ids = exchange.of(&self.ids, 1);
        self.positions = self.positions.rearranged(|values| exchange.of(values, 1));
        self.steps = self.steps.rearranged(|values| exchange.of(values, 1));
        self.radii = exchange.of(&self.radii, 1);
        self.species = exchange.of(&self.species, 1);
        if let Some(saved) = &mut self.saved {
            saved.rows.move_by(exchange);
        }
        self.exchange_columns(exchange);
    }

    /// A new store with the moved rows of this one and the columns that are wanted.
    pub(crate) fn mapped(&self, row_move: &impl RowMove, wanted: impl Fn(&str) -> bool) -> Self {
        let column = |c: &Column| Column {
            name: c.name.clone(),
            width: c.width,
            values: row_move.of(&c.values, c.width).into(),
        };
        Self {
            ids: row_move.of(&self.ids, 1),
            positions: row_move.of(&self.positions, 1).into(),
            steps: row_move.of(&self.steps, 1).into(),
            radii: row_move.of(&self.radii, 1),
            species: row_move.of(&self.species, 1),
            columns: self.columns.iter().filter(|c| wanted(&c.name)).map(column).collect(),
            scalars: self.scalars.clone(),
            ..Self::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Comm;

    fn scattered(count: u64) -> Particles {
        let mut particles = Particles::default();
        for id in 0..count {
            let t = id as f64;
            let position = Vector::new((t * 0.37) % 1.0, (t * 0.73) % 1.0, (t * 0.57) % 1.0) * 4.0;
            particles.push(id, position, 1.0 + t, (id % 3) as u32);
        }
        for (id, v) in particles.vectors("velocity").iter_mut().enumerate() {
            *v = Vector::splat(id as f64);
        }
        particles
    }

    #[test]
    fn vectors_are_a_column_of_three_numbers_each() {
        let mut particles = scattered(2);
        assert_eq!(particles.vectors("velocity"), [Vector::ZERO, Vector::ONE]);
        particles.vectors("force")[1] = Vector::new(1.0, 2.0, 3.0);
        assert_eq!(*particles.column("force", 3).values, [0.0, 0.0, 0.0, 1.0, 2.0, 3.0]);
    }

    #[test]
    fn columns_are_set_whether_they_are_there_or_not() {
        let mut particles = scattered(2);
        for number in [4.0, 5.0] {
            particles.set_column("spin", 1, vec![number, -number].into());
            assert_eq!(*particles.column("spin", 1).values, [number, -number]);
            assert_eq!(particles.columns.len(), 2);
        }
    }

    #[test]
    fn stores_whose_columns_do_not_fit_are_refused() {
        let whole = scattered(3);
        assert_eq!(whole.check(), Ok(()));
        let mut short = whole.clone();
        short.column("velocity", 3).values.pop();
        let error = ColumnError { name: "velocity".to_owned(), found: 8, width: 3, particles: 3 };
        assert_eq!(short.check(), Err(error));
        let mut without_radii = whole;
        without_radii.radii.clear();
        assert_eq!(without_radii.check().unwrap_err().name, "radii");
    }

    #[test]
    fn migration_keeps_every_row_whole_and_home() {
        let cell = PeriodicBox::new(Vector::splat(4.0)).unwrap();
        let alone = scattered(60);
        for ranks in [1, 2, 3, 4, 7, 13, 16, 64] {
            let gathered = Comm::threads(ranks, |comm| {
                let partition = Partition::new(&comm, [8, 8]);
                let rows: Vec<usize> = (0..60).filter(|r| r % ranks == comm.rank()).collect();
                let mut particles = alone.selected(&rows);
                particles.migrate(&partition, &cell);
                particles.check().unwrap();
                assert!(particles.positions.iter().all(|&p| partition.owner(&cell, p) == comm.rank()));
                particles.gathered(&partition)
            });
            assert_eq!(gathered[0], alone);
            assert!(gathered[1..].iter().all(Particles::is_empty));
        }
    }

    #[test]
    fn the_order_on_a_rank_does_not_depend_on_the_order_before() {
        let cell = PeriodicBox::new(Vector::splat(4.0)).unwrap();
        let partition = Partition::new(&Comm::alone(), [8, 8]);
        let mut forwards = scattered(40);
        let mut backwards = forwards.selected(&(0..40).rev().collect::<Vec<_>>());
        forwards.migrate(&partition, &cell);
        backwards.migrate(&partition, &cell);
        assert_eq!(forwards, backwards);
    }

    #[test]
    fn wrapping_and_relabelling_keep_the_unwrapped_place() {
        let edges = Vector::new(2.0, 2.0, 3.0);
        let (before, after) = (PeriodicBox::sheared(edges, 0.49).unwrap(), PeriodicBox::sheared(edges, 0.51).unwrap());
        let mut particles = Particles::default();
        let start = Vector::new(9.3, -7.7, 14.2);
        particles.push(0, start, 1.0, 0);
        particles.wrap(&before);
        let unwrapped = particles.positions[0] + before.lattice(particles.steps[0]);
        assert!((unwrapped - start).length() < 1e-12);
        let rows = f64::from(particles.steps[0][1]);
        particles.relabel(&[[1, 1, 0], [0, 1, 0], [0, 0, 1]]);
        let carried = particles.positions[0] + after.lattice(particles.steps[0]);
        assert!((carried - start - Vector::X * rows * 2.0 * 0.02).length() < 1e-12, "the lattice has sheared by 0.02");
    }
}
