//! Unbounded space: convolution with the decaying kernel on a grid that is twice as long along each axis as its
//! occupied part.

use crate::Real;
use simd::{SimdVector, VectorKernel};

/// Number of entries of a symmetric tensor between fields of some components: xx, xy, xz, yy, yz, zz, or one.
pub(crate) const fn entries(components: usize) -> usize {
    components * (components + 1) / 2
}

/// Decaying Stokes kernel, or `1 / (4 pi mu r)` for fields of one component, with a multiplier of the wavenumber,
/// between the points in the first half of a grid along each axis: its transform, with zero padding (Hockney 1970).
pub struct OpenSpace<T, const C: usize = 3> {
    pub(crate) points: [usize; 3],
    /// Table by `|m2|`, block along x, `|m3|`, entry of the tensor, and lane.
    pub(crate) table: Vec<T>,
    pub(crate) blocks: usize,
}

impl<T: Real, const C: usize> OpenSpace<T, C> {
    /// Number of values in the table of a grid.
    pub(crate) fn values(points: [usize; 3]) -> f64 {
        let [columns, modes, last] = points.map(|n| n / 2 + 1);
        let blocks = (columns - 1).div_ceil(T::LANES);
        (modes * blocks * last * entries(C) * T::LANES) as f64
    }

    /// Values of all entries of the tensor, `[entry][m3][m2][m1]` with `m1 < nx/2`, `m2 <= ny/2` and `m3 <= nz/2`.
    pub fn by_modes(&self) -> Vec<T> {
        let [columns, modes, last] = self.points.map(|n| n / 2 + 1);
        let columns = columns - 1;
        let value = |at: usize| {
            let (m1, m2) = (at % columns, at / columns % modes);
            let (m3, entry) = (at / (columns * modes) % last, at / (columns * modes * last));
            let place = ((m2 * self.blocks + m1 / T::LANES) * last + m3) * entries(C) + entry;
            self.table[place * T::LANES + m1 % T::LANES]
        };
        (0..columns * modes * last * entries(C)).map(value).collect()
    }

    /// Multiplies columns along z of one block along x and one mode along y, as [`crate::Stokes`] does.
    ///
    /// # Safety
    /// The columns can be read and written.
    pub(crate) unsafe fn multiply(&self, place: [usize; 2], components: [*mut T; C]) {
        T::dispatch(MultiplyOpenSpace { kernel: self, place, components });
    }
}

struct MultiplyOpenSpace<'a, T, const C: usize> {
    kernel: &'a OpenSpace<T, C>,
    place: [usize; 2],
    components: [*mut T; C],
}

impl<T: Real, const C: usize> VectorKernel<T> for MultiplyOpenSpace<'_, T, C> {
    type Output = ();

    #[inline(always)]
    fn run<V: SimdVector<T>>(self) {
        let OpenSpace { points, table, blocks } = self.kernel;
        let [_, ny, nz] = *points;
        let [block, mode] = self.place;
        let last = nz / 2 + 1;
        let (one, minus) = (V::splat(T::from_f64(1.0)), V::splat(T::from_f64(-1.0)));
        let along_y = if 2 * mode > ny { minus } else { one };
        let panel = mode.min(ny - mode) * blocks + block;
        for m3 in 0..nz {
            let along_z = if 2 * m3 > nz { minus } else { one };
            let first = (panel * last + m3.min(nz - m3)) * entries(C) * T::LANES;
            let entries = &table[first..first + entries(C) * T::LANES];
            // SAFETY: the entries are there.
            let entry = |n: usize| unsafe { V::load(entries.as_ptr().add(n * T::LANES)) };
            if C < 3 {
                let at = m3 * 2 * T::LANES;
                for part in [at, at + T::LANES] {
                    // SAFETY: the columns have nz elements.
                    unsafe {
                        let place = self.components[0].add(part);
                        V::load(place).mul(entry(0)).store(place);
                    }
                }
                continue;
            }
            let [xx, xy, xz] = [entry(0), entry(1).mul(along_y), entry(2).mul(along_z)];
            let [yy, yz, zz] = [entry(3), entry(4).mul(along_y).mul(along_z), entry(5)];
            for part in [0, T::LANES] {
                let at = m3 * 2 * T::LANES + part;
                // SAFETY: the columns have nz elements.
                unsafe {
                    let [x, y, z] =
                        [self.components[0].add(at), self.components[1].add(at), self.components[2].add(at)];
                    let (fx, fy, fz) = (V::load(x), V::load(y), V::load(z));
                    fz.mul_add(xz, fy.mul_add(xy, fx.mul(xx))).store(x);
                    fz.mul_add(yz, fy.mul_add(yy, fx.mul(xy))).store(y);
                    fz.mul_add(zz, fy.mul_add(yz, fx.mul(xz))).store(z);
                }
            }
        }
    }
}
