//! Distributed Fourier transform between physical and spectral space.

mod local_transform;
mod noise;
mod transposition;

use crate::fourier::{AnyLength, Direction};
use crate::layout::{Layout, ModeRows};
use crate::memory::AlignedMemory;
use crate::shared::Shared;
use crate::{Field, Physical, Real, Spectral, Stokes};
use domain::Partition;
use domain::parallel::MeasuredLoop;
use local_transform::{LocalTransform, PlaneTask};
pub use noise::Draw;
use num_complex::Complex;
use rayon::prelude::*;
use transposition::{Transposition, WholeColumns};

/// Fourier transform of a field of `C` components, three of a vector field, on a periodic grid over any number of
/// ranks: planned once, run without allocating.
///
/// Forward is `u_hat(m) = sum_x u(x) exp(-i k(m).x)`, backward `u(x) = sum_m u_hat(m) exp(+i k(m).x)`. Neither
/// scales: forward and backward together give `nx ny nz` times the field, by which [`Stokes`] divides. Coefficients
/// of real fields come in conjugate pairs, of which those with `0 <= m1 < nx/2` are kept. The Nyquist mode of x,
/// `m1 = nx/2`, whose derivative is undefined and which every operator here would set to zero, is dropped.
///
/// Rows along x are complete on a rank. Columns along y and then along z are assembled by one exchange each, of all
/// components at once, among the ranks that share them; a table of ranks with a single row or column saves that
/// exchange, and a single rank copies nothing. The exchange along z runs in rounds of at most 64 MB of whole columns,
/// so large grids need little memory beside their fields. Between ranks on one machine rows are copied directly to
/// their destination, in shared memory. In the exchange along y the ranks share blocks of 8 (`f64`) or 16 (`f32`)
/// columns of `nx/2`: with more ranks along y than blocks, some are idle.
///
/// Lengths with factors 2, 3, 5 and 7 alone are transformed by kernels that process as many rows at once as a vector
/// has lanes; all others by rustfft, which is slower.
///
/// Methods use the threads of the rayon pool in which they are called; results are the same bits for any number of
/// threads and ranks.
pub struct Transform<T, const C: usize = 3> {
    local: LocalTransform<T>,
    along_y: Option<Transposition<T>>,
    along_z: Option<Transposition<T>>,
}

impl<T: Real> Transform<T> {
    /// Plans the transform of vector fields on grids of `points` values, which [`crate::Grid`] allows, distributed by
    /// `partition`, with room for `halo` values after each row; longer halos wrap around the row several times. A
    /// collective call, as all others.
    ///
    /// # Panics
    /// If the partition is for a different number of rows.
    pub fn new(points: [usize; 3], partition: &Partition, halo: usize) -> Self {
        Self::of_components(points, partition, halo)
    }

    /// As [`Self::new`], but by rustfft for all lengths: the reference for the lane kernels.
    #[doc(hidden)]
    pub fn by_rustfft(points: [usize; 3], partition: &Partition, halo: usize) -> Self {
        Self::planned(points, partition, halo, ROOM, AnyLength::by_rustfft)
    }
}

impl<T: Real, const C: usize> Transform<T, C> {
    /// As [`Transform::new`], for fields of any number of components.
    ///
    /// # Panics
    /// If the partition is for a different number of rows.
    pub fn of_components(points: [usize; 3], partition: &Partition, halo: usize) -> Self {
        Self::planned(points, partition, halo, ROOM, AnyLength::new)
    }

    fn planned(
        points: [usize; 3],
        partition: &Partition,
        halo: usize,
        room: usize,
        plan: fn(usize) -> AnyLength<T>,
    ) -> Self {
        let layout = Layout::new::<T>(C, points, partition.place(), halo);
        let along_y = Transposition::along_y(&layout, partition);
        let rounds = layout.rounds(partition.row().size(), room / size_of::<T>());
        let along_z = Transposition::along_z(&layout, partition, rounds);
        Self { local: LocalTransform::new(layout, plan), along_y, along_z }
    }

    /// Bytes of the transform: whole columns, and work space for each thread.
    #[cfg(test)]
    pub(crate) fn bytes(&self) -> usize {
        let columns = [&self.along_y, &self.along_z].map(|planned| planned.as_ref().map_or(0, Transposition::reals));
        size_of::<T>() * columns.iter().sum::<usize>() + self.local.bytes()
    }

    /// A field of zeros for this transform.
    pub fn field(&self) -> Field<T, Physical, C> {
        Field::zero(self.local.layout())
    }

    /// Values to coefficients. Halos are added to the starts of the rows first; after a backward transform, call
    /// [`Field::clear_halo`] before. Allocates a field if columns are exchanged in several rounds.
    #[must_use]
    pub fn forward(&mut self, mut field: Field<T, Physical, C>) -> Field<T, Spectral, C> {
        let planes = self.planes_forward(&mut field.memory, self.local.all_lines());
        if self.rounds() == 1 {
            let columns = self.whole(&planes, 0);
            self.local.pencils::<C>(&columns, Direction::Forward);
            self.store(&columns, &mut field.memory);
            return field.into_space();
        }
        let mut spectrum = Field::zero(self.local.layout());
        for round in 0..self.rounds() {
            let columns = self.whole(&planes, round);
            self.local.pencils::<C>(&columns, Direction::Forward);
            self.store(&columns, &mut spectrum.memory);
        }
        spectrum
    }

    /// Coefficients to values. The halos are filled. Allocates a field if columns are exchanged in several rounds.
    #[must_use]
    pub fn backward(&mut self, mut field: Field<T, Spectral, C>) -> Field<T, Physical, C> {
        self.along_y.iter().for_each(Transposition::begin);
        let mut values = if self.rounds() > 1 { Some(Field::zero(self.local.layout())) } else { None };
        let planes = self.planes(values.as_mut().map_or(&mut field.memory, |values| &mut values.memory));
        for round in 0..self.rounds() {
            self.along_z.iter().for_each(Transposition::begin);
            let columns = self.columns(&planes, round);
            self.fetch(&columns, &mut field.memory);
            self.local.pencils::<C>(&columns, Direction::Backward);
            self.give_back(&planes, round);
        }
        let mut values = values.unwrap_or_else(|| field.into_space());
        self.planes_backward(&mut values.memory, self.local.all_lines());
        values
    }

    /// Force density to velocity: forward, times the operator, backward. Columns along z go both ways while a few of
    /// them are in the cache. Halos are added to the rows first, and filled at the end.
    pub fn apply(&mut self, field: &mut Field<T, Physical, C>, operator: &Stokes<T, C>) {
        assert_eq!(self.local.layout().points, operator.points(), "transform and operator have one grid");
        let planes = self.planes_forward(&mut field.memory, operator.occupied());
        for round in 0..self.rounds() {
            let columns = self.whole(&planes, round);
            self.local.pencils_through(&columns, operator);
            self.give_back(&planes, round);
        }
        self.planes_backward(&mut field.memory, operator.occupied());
    }

    /// Folds over the modes of a field that this rank owns after the transform, which are those of
    /// [`Field::for_each_mode`] after [`Self::forward`], but without another field: the values of this one are
    /// overwritten. Returns partial results, each begun by `start` and folded by `visit` over a part of the modes.
    pub fn fold_modes<S: Send>(
        &mut self,
        field: &mut Field<T, Physical, C>,
        start: impl Fn() -> S + Sync,
        visit: impl Fn(S, [usize; 3], [Complex<T>; C]) -> S + Sync,
    ) -> Vec<S> {
        let (mut parts, planes_of_modes) = (Vec::new(), self.local.layout().points[2]);
        let planes = self.planes_forward(&mut field.memory, self.local.all_lines());
        for round in 0..self.rounds() {
            let columns = self.whole(&planes, round);
            self.local.pencils::<C>(&columns, Direction::Forward);
            let WholeColumns { memory, strides, modes } = &columns;
            let of_plane = |m3: usize| {
                // SAFETY: the columns have all these modes, and are not written before the next round.
                let read = |place| unsafe { *memory.at(place) };
                self.local.layout().fold_modes_of_plane(ModeRows { strides, modes, m3 }, read, start(), &visit)
            };
            parts.extend((0..planes_of_modes).into_par_iter().map(of_plane).measured().collect::<Vec<_>>());
        }
        parts
    }

    /// Number of rounds in which columns along z are exchanged.
    fn rounds(&self) -> usize {
        self.along_z.as_ref().map_or(1, Transposition::rounds)
    }

    /// Memory with the whole planes of a field.
    fn planes(&self, memory: &mut AlignedMemory<T>) -> Shared<T> {
        assert!(memory.values().len() >= self.local.layout().capacity, "the field is of this transform");
        self.along_y.as_ref().map_or_else(|| Shared::new(memory.values_mut()), Transposition::columns)
    }

    /// Transforms the first rows along x and y, the others being zero, into the memory with whole planes, and packs
    /// them if columns along z are exchanged in one round.
    fn planes_forward(&mut self, memory: &mut AlignedMemory<T>, occupied: [usize; 2]) -> Shared<T> {
        let planes = self.planes(memory);
        let rows = Shared::new(memory.values_mut());
        let mut tasks = vec![PlaneTask::X];
        if let Some(exchange) = &self.along_y {
            exchange.begin();
            tasks.push(PlaneTask::Pack(exchange.packing(0)));
            self.local.planes(&rows, Direction::Forward, occupied, &tasks);
            tasks.clear();
            exchange.exchange(0);
        }
        tasks.push(PlaneTask::Y);
        if let Some(exchange) = self.at_once() {
            exchange.begin();
            tasks.push(PlaneTask::Pack(exchange.packing(0)));
        }
        self.local.planes(&planes, Direction::Forward, occupied, &tasks);
        planes
    }

    /// The exchange along z, if it takes a single round.
    fn at_once(&self) -> Option<&Transposition<T>> {
        self.along_z.as_ref().filter(|exchange| exchange.rounds() == 1)
    }

    /// The exchange along z, if it takes several rounds.
    fn in_rounds(&self) -> Option<&Transposition<T>> {
        self.along_z.as_ref().filter(|exchange| exchange.rounds() > 1)
    }

    /// Whole columns along z of a round.
    fn columns(&self, planes: &Shared<T>, round: usize) -> WholeColumns<T> {
        let Layout { spectral, modes, .. } = self.local.layout();
        // SAFETY: a pointer to the first plane.
        let own = || WholeColumns {
            memory: Shared::from_pointer(unsafe { planes.at(0) }),
            strides: *spectral,
            modes: modes.clone(),
        };
        self.along_z.as_ref().map_or_else(own, |exchange| exchange.columns_along_z(round))
    }

    /// Assembles the whole columns along z of a round.
    fn whole(&self, planes: &Shared<T>, round: usize) -> WholeColumns<T> {
        if let Some(exchange) = self.in_rounds() {
            exchange.begin();
            self.local.planes(
                planes,
                Direction::Forward,
                self.local.all_lines(),
                &[PlaneTask::Pack(exchange.packing(round))],
            );
        }
        self.along_z.iter().for_each(|exchange| exchange.exchange(round));
        self.columns(planes, round)
    }

    /// Returns the columns along z of a round.
    fn give_back(&self, planes: &Shared<T>, round: usize) {
        self.along_z.iter().for_each(|exchange| exchange.exchange_back(round));
        if let Some(exchange) = self.in_rounds() {
            self.local.planes(
                planes,
                Direction::Backward,
                self.local.all_lines(),
                &[PlaneTask::Unpack(exchange.packing(round))],
            );
        }
    }

    /// Copies coefficients from whole columns to a field.
    fn store(&self, columns: &WholeColumns<T>, memory: &mut AlignedMemory<T>) {
        let values = memory.values_mut();
        // SAFETY: the row is one of these columns, with no concurrent access.
        self.each_row(columns, |row, place, width| unsafe {
            values[place..place + width].copy_from_slice(std::slice::from_raw_parts(row, width));
        });
    }

    /// Copies coefficients from a field to whole columns.
    fn fetch(&self, columns: &WholeColumns<T>, memory: &mut AlignedMemory<T>) {
        let values = memory.values_mut();
        // SAFETY: the row is one of these columns, with no concurrent access.
        self.each_row(columns, |row, place, width| unsafe {
            std::slice::from_raw_parts_mut(row, width).copy_from_slice(&values[place..place + width]);
        });
    }

    /// Visits each row of whole columns that are not in the field itself: pointer, position in the field, and number
    /// of values.
    fn each_row(
        &self,
        WholeColumns { memory, strides, modes }: &WholeColumns<T>,
        mut visit: impl FnMut(*mut T, usize, usize),
    ) {
        let layout = self.local.layout();
        if self.along_y.is_none() && self.along_z.is_none() {
            return;
        }
        for z in 0..layout.points[2] {
            for (component, mode) in (0..C).flat_map(|component| (0..modes.len()).map(move |mode| (component, mode))) {
                let place = layout.spectral.at(component, modes.start - layout.modes.start + mode, z);
                // SAFETY: the columns have this row.
                visit(unsafe { memory.at(strides.at(component, mode, z)) }, place, layout.width);
            }
        }
    }

    /// Backward transform of the first rows from columns along z that were returned.
    fn planes_backward(&mut self, memory: &mut AlignedMemory<T>, occupied: [usize; 2]) {
        let rows = Shared::new(memory.values_mut());
        let mut tasks = Vec::new();
        if let Some(exchange) = self.at_once() {
            tasks.push(PlaneTask::Unpack(exchange.packing(0)));
        }
        tasks.push(PlaneTask::Y);
        if let Some(exchange) = &self.along_y {
            self.local.planes(&exchange.columns(), Direction::Backward, occupied, &tasks);
            exchange.exchange_back(0);
            tasks = vec![PlaneTask::Unpack(exchange.packing(0))];
        }
        tasks.push(PlaneTask::X);
        self.local.planes(&rows, Direction::Backward, occupied, &tasks);
    }
}

/// Approximate upper bound of the bytes of whole columns along z in a round.
pub(crate) const ROOM: usize = 64 << 20;

#[cfg(test)]
mod tests;
