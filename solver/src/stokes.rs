//! Stokes operator: force density to velocity; and its scalar counterpart: charge density to potential.

mod mode_block;
mod tilted;

use crate::{Channel, Grid, OpenSpace, Real};
use domain::parallel::MeasuredLoop;
pub(crate) use mode_block::ModeBlock;
use rayon::prelude::*;
use simd::{SimdVector, VectorKernel};
use tilted::TiltedTables;

/// Stokes solve `u_hat = (I - k k/k^2) f_hat m(k) / (mu k^2)` on a grid, for [`crate::Transform::apply`]; it includes
/// the factor `1 / (nx ny nz)` of the transforms.
///
/// The mean velocity, `k = 0`, is zero: a uniform pressure gradient balances the net force. The Nyquist mode of each
/// axis is zero as well: it stands for `+k` and `-k` at once, for which the projection (and in a sheared box even
/// `k^2`) differs. So the operator is real, symmetric and positive semi-definite, as the projection is mode by mode.
/// Wavevectors are computed in `f64` and rounded once.
pub struct Stokes<T, const C: usize = 3> {
    points: [usize; 3],
    /// Values for each m1, padded with zeros to whole blocks.
    k1: Vec<T>,
    /// Values for each m2 and m1.
    k2: Vec<T>,
    /// `plane(k1, k2) / (mu nx ny nz)`, 0 where the velocity is zero.
    plane: Vec<T>,
    /// `1 / k^2` at m3 = 0, 0 at the origin.
    inverse: Vec<T>,
    /// Values for each m3.
    k3: Vec<T>,
    axis: Vec<T>,
    widening: T,
    tilted: Option<TiltedTables<T>>,
    channel: Option<Channel<T>>,
    open: Option<OpenSpace<T, C>>,
}

/// The solve of `-mu lap phi = q`, without projection: `phi_hat = q_hat m(k) / (mu k^2)` for a field of one component.
pub type Poisson<T> = Stokes<T, 1>;

/// Multiplier `m(k) = plane(k1, k2) axis(k3) exp(-width^2 k^2) (1 + widening k^2)^2` of the wavevector `k` of the
/// box, with its components `k1` and `k2` in the plane of the first two axes and the lattice's `k3`, see
/// [`Grid::wavevector`]. If `m` is even, like that of every real even kernel, and not negative, the operator keeps
/// its properties. `axis` is called for `k3 >= 0`. If the third lattice vector is not tilted, a Gaussian is part of
/// `plane` and `axis`, and `width` is zero; if it is tilted, both are positive.
#[derive(Debug, Clone, Copy)]
pub struct Multiplier<P, A> {
    /// Factor of `k1` and `k2`.
    pub plane: P,
    /// Factor of `k3`.
    pub axis: A,
    /// Coefficient of `k^2`.
    pub widening: f64,
    /// Width of a Gaussian in a box whose third lattice vector is tilted.
    pub width: f64,
}

impl<T: Real> Stokes<T> {
    /// Solve for a fluid of this viscosity, `m = 1`.
    pub fn new(grid: &Grid, viscosity: f64) -> Self {
        Self::with_multiplier(
            grid,
            viscosity,
            &Multiplier { plane: |_, _| 1.0, axis: |_| 1.0, widening: 0.0, width: 0.0 },
        )
    }

    /// Solve between walls, above a wall, or in a layer that is open along z.
    #[must_use]
    pub fn with_channel(self, channel: Channel<T>) -> Self {
        Self { channel: Some(channel), ..self }
    }
}

impl<T: Real, const C: usize> Stokes<T, C> {
    /// Solve with a multiplier.
    pub fn with_multiplier<P, A>(grid: &Grid, viscosity: f64, multiplier: &Multiplier<P, A>) -> Self
    where
        P: Fn(f64, f64) -> f64 + Sync,
        A: Fn(f64) -> f64,
    {
        let Multiplier { plane, axis, widening, width } = multiplier;
        let is_tilted = !grid.cell().is_orthogonal();
        debug_assert!(is_tilted || *width == 0.0, "an orthogonal box has its Gaussian by axes");
        let [nx, ny, nz] = grid.points();
        let scale = 1.0 / (viscosity * grid.count() as f64);
        let columns = (nx / 2).next_multiple_of(T::LANES);
        let modes = || (0..ny).flat_map(|m2| (0..columns).map(move |m1| [m1, m2, 0]));
        let in_plane = |mode: [usize; 3]| {
            if mode[0] < nx / 2 { grid.wavevector(mode) } else { grid.wavevector([0, mode[1], 0]) }
        };
        let factor = |mode: [usize; 3]| {
            let k = in_plane(mode);
            let plane = if is_tilted { 1.0 } else { plane(k.x, k.y) };
            if mode[0] >= nx / 2 || grid.is_nyquist(1, mode) { 0.0 } else { scale * plane }
        };
        // The multiplier may be expensive.
        let plane_at = |at: usize| T::from_f64(factor([at % columns, at / columns, 0]));
        let inverse = |mode: [usize; 3]| {
            let k = in_plane(mode);
            if k.x == 0.0 && k.y == 0.0 { 0.0 } else { 1.0 / (k.x * k.x + k.y * k.y + k.z * k.z) }
        };
        let tilted = is_tilted.then(|| TiltedTables::new(grid, &modes().map(in_plane).collect::<Vec<_>>(), multiplier));
        let k3 = |m3: usize| grid.wavenumber(2, m3);
        let along_axis = |m3: usize| if grid.is_nyquist(2, [0, 0, m3]) { 0.0 } else { axis(k3(m3).abs()) };
        Self {
            points: grid.points(),
            k1: (0..columns).map(|m1| T::from_f64(in_plane([m1, 0, 0]).x)).collect(),
            k2: modes().map(|mode| T::from_f64(in_plane(mode).y)).collect(),
            plane: (0..columns * ny).into_par_iter().with_min_len(columns).map(plane_at).measured().collect(),
            inverse: modes().map(|mode| T::from_f64(inverse(mode))).collect(),
            k3: (0..nz).map(|m3| T::from_f64(k3(m3))).collect(),
            axis: (0..nz).map(|m3| T::from_f64(along_axis(m3))).collect(),
            widening: T::from_f64(*widening),
            tilted,
            channel: None,
            open: None,
        }
    }

    /// Bytes of the tables, without those of walls and open space.
    #[cfg(test)]
    pub(crate) fn bytes(&self) -> usize {
        let own = [&self.k1, &self.k2, &self.plane, &self.inverse, &self.k3, &self.axis];
        own.map(|table| size_of_val(&table[..])).iter().sum::<usize>()
            + self.tilted.as_ref().map_or(0, TiltedTables::bytes)
    }

    /// Solve in unbounded space, for forces in the first half of the grid along each axis; velocities are defined
    /// only there.
    #[must_use]
    pub fn in_open_space(grid: &Grid, kernel: OpenSpace<T, C>) -> Self {
        let multiplier = Multiplier { plane: |_, _| 1.0, axis: |_| 1.0, widening: 0.0, width: 0.0 };
        Self { open: Some(kernel), ..Self::with_multiplier(grid, 1.0, &multiplier) }
    }

    /// Kernel of unbounded space, if this solve is there.
    pub fn open_space(&self) -> Option<&OpenSpace<T, C>> {
        self.open.as_ref()
    }

    /// Numbers of rows along y and along z, from the first on, that forces and velocities occupy.
    pub(crate) fn occupied(&self) -> [usize; 2] {
        let [_, ny, nz] = self.points;
        if self.open.is_some() { [ny / 2, nz / 2] } else { [ny, nz] }
    }

    /// Update that is added to the periodic solve.
    pub(crate) fn channel(&self) -> Option<&Channel<T>> {
        self.channel.as_ref()
    }

    pub(crate) fn points(&self) -> [usize; 3] {
        self.points
    }

    /// Multiplies the columns along z of one block along x and one mode along y: for each component, for each m3, a
    /// vector of real parts and one of imaginary parts.
    ///
    /// # Safety
    /// The columns can be read and written.
    pub(crate) unsafe fn multiply(&self, place: [usize; 2], components: [*mut T; C]) {
        if let Some(open) = &self.open {
            // SAFETY: guaranteed by the caller.
            unsafe { open.multiply(place, components) };
            return;
        }
        match &self.tilted {
            None => T::dispatch(MultiplyOrthogonal { operator: self, place, components }),
            Some(tilted) => T::dispatch(tilted::MultiplyTilted { operator: self, tilted, place, components }),
        }
    }
}

struct MultiplyOrthogonal<'a, T, const C: usize> {
    operator: &'a Stokes<T, C>,
    place: [usize; 2],
    components: [*mut T; C],
}

impl<T: Real, const C: usize> VectorKernel<T> for MultiplyOrthogonal<'_, T, C> {
    type Output = ();

    #[inline(always)]
    fn run<V: SimdVector<T>>(self) {
        let Stokes { points, k1, k2, plane, inverse, k3, axis, widening, .. } = self.operator;
        let nz = points[2];
        let [block, mode] = self.place;
        let column = block * T::LANES;
        let in_plane = mode * k1.len() + column;
        let [k1, k2] = [part::<T, V>(k1, column), part::<T, V>(k2, in_plane)];
        let plane = part::<T, V>(plane, in_plane);
        let square = k2.mul_add(k2, k1.mul(k1));
        let one = V::splat(T::from_f64(1.0));
        let zero = V::splat(T::default());
        let widening = V::splat(*widening);
        // SAFETY: the columns have nz elements; the mode nz/2 is set to zero, all others are k3 and -k3 in turn.
        unsafe {
            let inverse = part::<T, V>(inverse, in_plane);
            let level = square.mul_add(widening, one);
            let factor = plane.mul(V::splat(axis[0])).mul(inverse).mul(level).mul(level);
            project::<T, V, C>(self.components, [k1, k2, zero], [inverse, factor], 0);
            for m3 in 1..nz / 2 {
                let k3 = V::splat(k3[m3]);
                let square = k3.mul_add(k3, square);
                let (inverse, level) = (one.div(square), square.mul_add(widening, one));
                let factor = plane.mul(V::splat(axis[m3])).mul(inverse).mul(level).mul(level);
                project::<T, V, C>(self.components, [k1, k2, k3], [inverse, factor], m3);
                project::<T, V, C>(self.components, [k1, k2, zero.sub(k3)], [inverse, factor], nz - m3);
            }
            project::<T, V, C>(self.components, [k1, k2, zero], [zero, zero], nz / 2);
        }
    }
}

/// `f <- factor (f - k (k.f) / k^2)`, or `f <- factor f` for a field of one component, for one element of the columns,
/// given `1/k^2` and the factor.
///
/// # Safety
/// The columns have that element.
#[inline(always)]
unsafe fn project<T: Real, V: SimdVector<T>, const C: usize>(
    components: [*mut T; C],
    k: [V; 3],
    [inverse, factor]: [V; 2],
    m3: usize,
) {
    for part in [0, T::LANES] {
        let at = m3 * 2 * T::LANES + part;
        // SAFETY: guaranteed by the caller.
        let place = components.map(|component| unsafe { component.add(at) });
        // SAFETY: guaranteed by the caller.
        let f = place.map(|place| unsafe { V::load(place) });
        if C < 3 {
            // SAFETY: guaranteed by the caller.
            (0..C).for_each(|c| unsafe { f[c].mul(factor).store(place[c]) });
            continue;
        }
        let along = f[2].mul_add(k[2], f[1].mul_add(k[1], f[0].mul(k[0])));
        let along = along.mul(inverse);
        for c in 0..3 {
            // SAFETY: guaranteed by the caller.
            unsafe { along.mul_sub_from(k[c], f[c]).mul(factor).store(place[c]) };
        }
    }
}

/// As many values of a table as a vector has.
#[inline(always)]
fn part<T: Real, V: SimdVector<T>>(table: &[T], first: usize) -> V {
    let values = &table[first..first + T::LANES];
    // SAFETY: the slice has as many values as a vector.
    unsafe { V::load(values.as_ptr()) }
}

#[cfg(test)]
mod tests;
