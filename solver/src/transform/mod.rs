//! The only way from one space to the other.

mod share;
mod transposition;

use crate::fourier::{AnyLength, Direction};
use crate::layout::Layout;
use crate::memory::Memory;
use crate::shared::Shared;
use crate::{Field, Physical, Real, Spectral, Stokes};
use domain::Partition;
use num_complex::Complex;
use share::{Share, Task};
use transposition::Transposition;

/// The Fourier transform of a vector field on a periodic grid over any number of ranks: planned once, run without
/// allocating.
///
/// Forward is `u_hat(m) = sum_x u(x) exp(-i k(m).x)`, backward `u(x) = sum_m u_hat(m) exp(+i k(m).x)`. Neither scales:
/// forward and backward give `nx ny nz` times the field, which [`Stokes`] divides by. Coefficients of real fields come
/// in conjugate pairs, and those of `0 <= m1 < nx/2` are kept. The highest mode of x, `m1 = nx/2`, in which a
/// derivative has no meaning and which every operator here would set to zero, is dropped.
///
/// Rows along x are whole on a rank. Columns along y and then along z are made whole by one exchange each, of all three
/// components at once, among the ranks that split them; a table of ranks with a single row or column saves that
/// exchange, and a rank on its own copies nothing. Between ranks on one machine rows go straight from where they are to
/// where they are needed, in memory that both reach. In the exchange along y the ranks share out blocks of 8 (`f64`) or
/// 16 (`f32`) columns of `nx/2`: beyond as many ranks along y as there are blocks, some wait.
///
/// Lengths with factors 2, 3, 5 and 7 alone are transformed by kernels that take as many lines at once as a vector has
/// lanes; all others by rustfft, which takes longer.
///
/// Threads of the pool in which a method is called work side by side; results are the same bits for any number of
/// threads and ranks.
pub struct Transform<T> {
    share: Share<T>,
    along_y: Option<Transposition<T>>,
    along_z: Option<Transposition<T>>,
}

impl<T: Real> Transform<T> {
    /// Plans the transform of grids of `points` values, which [`crate::Grid`] allows, shared out by `partition`, with
    /// room for `halo` values after each row, which go around the row as often as they need. A collective call, as all
    /// others.
    ///
    /// # Panics
    /// If the partition shares out other lines than those of the grid.
    pub fn new(points: [usize; 3], partition: &Partition, halo: usize) -> Self {
        Self::planned(points, partition, halo, AnyLength::new)
    }

    /// As [`Self::new`], but by rustfft for all lengths: what its own kernels are measured against.
    #[doc(hidden)]
    pub fn by_rustfft(points: [usize; 3], partition: &Partition, halo: usize) -> Self {
        Self::planned(points, partition, halo, AnyLength::by_rustfft)
    }

    fn planned(points: [usize; 3], partition: &Partition, halo: usize, plan: fn(usize) -> AnyLength<T>) -> Self {
        let layout = Layout::new::<T>(points, partition.place(), halo);
        let along_y = Transposition::along_y(&layout, partition);
        let along_z = Transposition::along_z(&layout, partition);
        Self { share: Share::new(layout, plan), along_y, along_z }
    }

    /// Bytes of its own: whole columns, and room for each thread.
    #[cfg(test)]
    pub(crate) fn bytes(&self) -> usize {
        let columns = [&self.along_y, &self.along_z].map(|planned| planned.as_ref().map_or(0, Transposition::reals));
        size_of::<T>() * columns.iter().sum::<usize>() + self.share.bytes()
    }

    /// A field of zeros for this transform.
    pub fn field(&self) -> Field<T, Physical> {
        Field::zero(self.share.layout())
    }

    /// From values to coefficients. What stands in the halos is added to the starts of the rows first; after a backward
    /// transform, [`Field::clear_halo`] comes before.
    #[must_use]
    pub fn forward(&mut self, mut field: Field<T, Physical>) -> Field<T, Spectral> {
        let columns = self.planes_forward(&mut field.memory, self.share.all_lines());
        self.share.pencils(&columns, Direction::Forward);
        if let Some(columns) = self.whole_columns() {
            field.memory.values_mut()[..columns.len()].copy_from_slice(columns);
        }
        field.into_space()
    }

    /// From coefficients to values. The halos are filled.
    #[must_use]
    pub fn backward(&mut self, mut field: Field<T, Spectral>) -> Field<T, Physical> {
        for exchange in [&self.along_y, &self.along_z].into_iter().flatten() {
            exchange.open();
        }
        let mut columns = Shared::new(field.memory.values_mut());
        if let Some(whole) = self.whole_columns() {
            whole.copy_from_slice(&field.memory.values()[..whole.len()]);
            columns = Shared::new(whole);
        }
        self.share.pencils(&columns, Direction::Backward);
        self.planes_backward(&mut field.memory, self.share.all_lines());
        field.into_space()
    }

    /// From force density to velocity: forward, times the operator, backward. The last direction goes both ways while
    /// a few of its columns are in the cache. Halos are added to the rows first, and filled at the end.
    pub fn apply(&mut self, field: &mut Field<T, Physical>, operator: &Stokes<T>) {
        assert_eq!(self.share.layout().points, operator.points(), "transform and operator have one grid");
        let columns = self.planes_forward(&mut field.memory, operator.occupied());
        self.share.pencils_through(&columns, operator);
        self.planes_backward(&mut field.memory, operator.occupied());
    }

    /// A random velocity field whose covariance is that of the operator over the volume of a point: interpolated with weights
    /// times that volume, it has the covariance of what [`Self::apply`] makes of forces spread with these weights, since
    ///
    /// ```text
    /// u_hat(k) = sqrt(m(k) / volume) (I - k k/k^2) c(k),       <c_i(k) c_j(k)*> = delta_ij
    /// ```
    ///
    /// has the operator's square root. `draw` gives the three complex numbers `c` of a mode by its signed indices; only one of
    /// a mode and its opposite is asked for. Collective.
    pub fn noise(
        &mut self,
        operator: &Stokes<T>,
        volume: f64,
        draw: impl Fn([i64; 3]) -> [Complex<f64>; 3] + Sync,
    ) -> Field<T, Physical> {
        let points = self.share.layout().points;
        assert_eq!(points, operator.points(), "transform and operator have one grid");
        let signed = |mode: usize, axis: usize| {
            if 2 * mode > points[axis] { mode as i64 - points[axis] as i64 } else { mode as i64 }
        };
        let mut field = Field::<T, Spectral>::zero(self.share.layout());
        field.set_modes(|mode| {
            let signed: [i64; 3] = std::array::from_fn(|axis| signed(mode[axis], axis));
            // Of the plane m1 = 0 both a mode and its opposite are kept.
            let is_opposite = signed[0] == 0 && (signed[1], signed[2]) < (0, 0);
            let drawn = if is_opposite { draw(signed.map(|m| -m)).map(|c| c.conj()) } else { draw(signed) };
            let (k, factor) = (operator.wavevector(mode), (operator.factor(mode) / volume).sqrt());
            let square = k.length_squared();
            let along =
                if square > 0.0 { (drawn[0] * k.x + drawn[1] * k.y + drawn[2] * k.z) / square } else { 0.0.into() };
            std::array::from_fn(|axis| (drawn[axis] - along * k[axis]) * factor)
        });
        self.backward(field)
    }

    /// The memory of the last exchange, in which columns along z are whole; none if a field's own are.
    fn whole_columns(&mut self) -> Option<&mut [T]> {
        self.along_z.as_mut().or(self.along_y.as_mut()).map(Transposition::columns_mut)
    }

    /// Transforms along x and y what stands on the first lines along y and z, the others being zero, after which columns
    /// along z are whole: where they are.
    fn planes_forward(&mut self, memory: &mut Memory<T>, occupied: [usize; 2]) -> Shared<T> {
        assert!(memory.values().len() >= self.share.layout().capacity, "the field is of this transform");
        let mut place = Shared::new(memory.values_mut());
        let mut tasks = vec![Task::X];
        if let Some(exchange) = &self.along_y {
            exchange.open();
            tasks.push(Task::Pack(exchange.packing()));
            self.share.planes(&place, (Direction::Forward, occupied), &tasks);
            tasks.clear();
            exchange.deliver();
            place = exchange.columns();
        }
        tasks.push(Task::Y);
        if let Some(exchange) = &self.along_z {
            exchange.open();
            tasks.push(Task::Pack(exchange.packing()));
            self.share.planes(&place, (Direction::Forward, occupied), &tasks);
            exchange.deliver();
            return exchange.columns();
        }
        self.share.planes(&place, (Direction::Forward, occupied), &tasks);
        place
    }

    /// The way back from whole columns along z, to the first lines.
    fn planes_backward(&mut self, memory: &mut Memory<T>, occupied: [usize; 2]) {
        let rows = Shared::new(memory.values_mut());
        let mut tasks = Vec::new();
        if let Some(exchange) = &self.along_z {
            exchange.give_back();
            tasks.push(Task::Unpack(exchange.packing()));
        }
        tasks.push(Task::Y);
        if let Some(exchange) = &self.along_y {
            self.share.planes(&exchange.columns(), (Direction::Backward, occupied), &tasks);
            exchange.give_back();
            tasks = vec![Task::Unpack(exchange.packing())];
        }
        tasks.push(Task::X);
        self.share.planes(&rows, (Direction::Backward, occupied), &tasks);
    }
}

#[cfg(test)]
mod tests;
