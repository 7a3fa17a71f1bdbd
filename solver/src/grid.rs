//! Points of the periodic box, and their wavevectors.

use domain::{PeriodicBox, Vector};

/// Reason why a grid is invalid.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum GridError {
    /// The number of points along an axis is not even or is zero.
    #[error("the grid has {points} points along {axis}; it needs an even number; the next one is {next}")]
    Points {
        /// Axis: x, y or z.
        axis: char,
        /// Number given.
        points: usize,
        /// Next number of points that is allowed.
        next: usize,
    },
    /// More points along an axis than supported.
    #[error("the grid has {points} points along {axis}; the most that are counted are {most}")]
    Axis {
        /// Axis: x, y or z.
        axis: char,
        /// Number given.
        points: usize,
        /// Largest number allowed.
        most: usize,
    },
    /// More points in total than supported.
    #[error("the grid has {0:.1e} points in all; the most that are counted are {most:.1e}", most = Grid::MOST_IN_ALL)]
    InAll(f64),
}

/// `nx x ny x nz` points of a periodic box of any lattice. Along the axes of the box, see [`PeriodicBox`], the point
/// `(i, j, k)` lies at `z = zeta, y = eta + r zeta, x = xi + s eta + t zeta` with
/// `(xi, eta, zeta) = (i Lx/nx, j Ly/ny, k Lz/nz)`, and wavevectors are
/// `k = (k1, k2 - s k1, k3 - r k2 - (t - s r) k1)` with `k1 = 2 pi m1 / Lx` and so on, `-n/2 <= m < n/2`.
///
/// If the strain `s` is larger than the ratio of the spacings `hx = Lx/nx` and `hy = Ly/ny`, the same points belong
/// to a lattice that is sheared less: for an integer `q` the point `(i, j, k)` is `(i + q j, j, k)` of the strain
/// `s - q hx/hy`. A [reduced](Grid::reduced) grid uses the `q` nearest to `s hy/hx`. Wavevectors `m2 + ny l` are the
/// same on its points; each mode is the one within half a grid, `-ny/2 <= m2 - q m1 ny/nx < ny/2`: the shortest along
/// the less sheared lattice. Points and transforms are those of the grid that is not reduced.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    points: [usize; 3],
    cell: PeriodicBox,
    is_reduced: bool,
}

impl Grid {
    /// Largest number of points along an axis.
    pub const MOST: usize = 1 << 30;

    /// Largest number of points in total: thousands of terabytes.
    pub const MOST_IN_ALL: f64 = 1e15;

    /// Grid with even numbers of points. Transforms are fast if their prime factors are 2, 3, 5 and 7.
    pub fn new(points: [usize; 3], cell: PeriodicBox) -> Result<Self, GridError> {
        for (axis, points) in "xyz".chars().zip(points) {
            if points > Self::MOST {
                return Err(GridError::Axis { axis, points, most: Self::MOST });
            }
            if points == 0 || !points.is_multiple_of(2) {
                return Err(GridError::Points { axis, points, next: points.next_multiple_of(2).max(2) });
            }
        }
        let all = points.iter().map(|&n| n as f64).product();
        if all > Self::MOST_IN_ALL { Err(GridError::InAll(all)) } else { Ok(Self { points, cell, is_reduced: false }) }
    }

    /// Efficient number of points, at least `at_least` and at most [`Grid::MOST`]: the next even number with factors
    /// 2 and 3, unless one with a factor 5 or 7, which takes slightly more time per point, is smaller by more than
    /// 4%.
    pub fn good_size(at_least: usize) -> usize {
        let any = next_fast(at_least);
        let fast = least_product(any, &[3]);
        if fast * 100 > any * 104 { any } else { fast }
    }

    /// The same points in another box, for example after a step of shear.
    #[must_use]
    pub fn in_cell(&self, cell: PeriodicBox) -> Self {
        Self { cell, ..*self }
    }

    /// The same points with the wavevectors of the least sheared lattice, in a box whose third lattice vector is not
    /// tilted.
    #[must_use]
    pub fn reduced(&self) -> Self {
        Self { is_reduced: true, ..*self }
    }

    /// `q`: shift in points along x from a row to the next of the least sheared lattice; 0 unless the grid is
    /// reduced.
    pub fn row_shift(&self) -> i64 {
        let spacing = self.spacing();
        if self.is_reduced { (self.cell.strain() * spacing.y / spacing.x).round() as i64 } else { 0 }
    }

    /// Strain `s - q hx/hy` of the lattice to which the rows belong.
    pub fn strain(&self) -> f64 {
        let spacing = self.spacing();
        self.cell.strain() - self.row_shift() as f64 * spacing.x / spacing.y
    }

    /// Points along x, y and z.
    pub fn points(&self) -> [usize; 3] {
        self.points
    }

    /// Numbers of rows along y and along z, which a partition distributes.
    pub fn lines(&self) -> [usize; 2] {
        [self.points[1], self.points[2]]
    }

    /// Total number of points.
    pub fn count(&self) -> usize {
        self.points.iter().product()
    }

    /// The box.
    pub fn cell(&self) -> &PeriodicBox {
        &self.cell
    }

    /// Distances between neighbours along each lattice coordinate.
    pub fn spacing(&self) -> Vector {
        self.cell.edges() / Vector::from_array(self.points.map(|n| n as f64))
    }

    /// Position of a point.
    pub fn position(&self, point: [usize; 3]) -> Vector {
        self.cell.position(Vector::from_array(point.map(|i| i as f64)) * self.spacing())
    }

    /// Lattice wavenumber `2 pi m / L` along an axis, with `m = mode` below half the points and `mode - n` from
    /// there.
    pub fn wavenumber(&self, axis: usize, mode: usize) -> f64 {
        let points = self.points[axis];
        let order = if 2 * mode < points { mode as f64 } else { mode as f64 - points as f64 };
        std::f64::consts::TAU * order / self.cell.edges()[axis]
    }

    /// Wavevector `(k1, k2 - s k1, k3 - r k2 - (t - s r) k1)` of a mode, along the box's axes.
    #[inline(always)]
    pub fn wavevector(&self, mode: [usize; 3]) -> Vector {
        let [k1, mut k2, k3] = std::array::from_fn(|axis| self.wavenumber(axis, mode[axis]));
        if self.is_reduced {
            k2 = std::f64::consts::TAU * self.order_along_y(mode) as f64 / self.cell.edges().y;
        }
        let (strain, [t, r]) = (self.cell.strain(), self.cell.tilts());
        Vector::new(k1, k2 - strain * k1, k3 - r * k2 - (t - strain * r) * k1)
    }

    /// Whether a mode is the Nyquist mode of an axis, `m = -n/2`. It stands for `n/2` as well, so its derivative is
    /// undefined: operators set such modes to zero.
    #[inline(always)]
    pub fn is_nyquist(&self, axis: usize, mode: [usize; 3]) -> bool {
        if axis == 1 && self.is_reduced {
            let (all, twice) = self.along_reduced(mode);
            return twice.rem_euclid(2 * all) == all;
        }
        2 * mode[axis] == self.points[axis]
    }

    /// `m2` of a mode of a reduced grid.
    fn order_along_y(&self, mode: [usize; 3]) -> i64 {
        let (all, twice) = self.along_reduced(mode);
        mode[1] as i64 - (twice + all).div_euclid(2 * all) * self.points[1] as i64
    }

    /// `nx ny`, and twice `m2 - q m1 ny/nx` times `nx`.
    fn along_reduced(&self, [m1, m2, _]: [usize; 3]) -> (i64, i64) {
        let [nx, ny, _] = self.points.map(|n| n as i64);
        let m1 = if 2 * (m1 as i64) < nx { m1 as i64 } else { m1 as i64 - nx };
        (nx * ny, 2 * (m2 as i64 * nx - self.row_shift() * m1 * ny))
    }
}

/// Next number of points with the factors of the lane kernels.
fn next_fast(at_least: usize) -> usize {
    least_product(at_least, &[3, 5, 7])
}

/// Least even number, at least `at_least`, whose prime factors are 2 and some of the given odd ones.
fn least_product(at_least: usize, odd: &[usize]) -> usize {
    least_multiple(1, at_least.clamp(2, Grid::MOST), odd)
}

/// Least even multiple of `product`, at least `at_least`, by factors of 2 and some of the given odd primes.
fn least_multiple(product: usize, at_least: usize, odd: &[usize]) -> usize {
    let Some((&prime, others)) = odd.split_first() else {
        return product * at_least.div_ceil(product).max(2).next_power_of_two();
    };
    let powers = std::iter::successors(Some(product * prime), |p| Some(p * prime)).take_while(|&p| p < at_least);
    let without = least_multiple(product, at_least, others);
    powers.map(|power| least_multiple(power, at_least, others)).fold(without, usize::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fourier::is_product_of;

    fn cell(strain: f64) -> PeriodicBox {
        PeriodicBox::sheared(Vector::new(6.0, 4.0, 10.0), strain).unwrap()
    }

    #[test]
    fn sizes_the_transform_takes() {
        assert!(Grid::new([2, 210, 128], cell(0.0)).is_ok());
        assert!(Grid::new([22, 106, 2 * 97], cell(0.0)).is_ok(), "any even numbers");
        let error = Grid::new([16, 33, 16], cell(0.0)).unwrap_err();
        assert_eq!(error, GridError::Points { axis: 'y', points: 33, next: 34 });
        assert!(error.to_string().contains("33 points along y"));
        assert_eq!(Grid::new([0, 16, 16], cell(0.0)).unwrap_err(), GridError::Points { axis: 'x', points: 0, next: 2 });
    }

    #[test]
    fn grids_beyond_all_bounds_are_refused() {
        let most = Grid::MOST;
        assert_eq!([most - 1, most, most + 1, usize::MAX].map(next_fast), [most; 4]);
        let error = |points| Grid::new(points, cell(0.0)).unwrap_err().to_string();
        assert!(error([16, 16, usize::MAX]).contains("points along z; the most that are counted are 1073741824"));
        assert!(error([1 << 20; 3]).contains("1.2e18 points in all; the most that are counted are 1.0e15"));
        assert!(error([(1 << 29) + 1, 16, 16]).contains("the next one is 536870914"));
    }

    #[test]
    fn good_sizes_are_near_and_fast() {
        assert_eq!([1, 16, 17, 33, 47, 97, 127].map(Grid::good_size), [2, 16, 18, 36, 48, 98, 128]);
        for at_least in 2..400 {
            let size = Grid::good_size(at_least);
            assert!(size >= at_least && Grid::new([size; 3], cell(0.0)).is_ok());
            let next =
                (at_least..2 * at_least + 2).find(|&n| n.is_multiple_of(2) && is_product_of(&[2, 3, 5, 7], n)).unwrap();
            assert_eq!(next_fast(at_least), next);
            assert_eq!(
                least_product(next, &[3]),
                (next..4 * next).step_by(2).find(|&n| is_product_of(&[2, 3], n)).unwrap()
            );
        }
    }

    #[test]
    fn every_mode_is_periodic_on_the_lattice() {
        let turns = |phase: f64| (phase / std::f64::consts::TAU - (phase / std::f64::consts::TAU).round()).abs();
        let any = [Vector::new(5.0, 1.0, -1.0), Vector::new(0.5, 4.0, 2.0), Vector::new(-2.0, 1.5, 7.0)];
        for cell in [cell(0.3), PeriodicBox::of_lattice(any).unwrap()] {
            let grid = Grid::new([6, 4, 10], cell).unwrap();
            let along_axes = |place: Vector| cell.axes().map_or(place, |axes| axes.transpose() * place);
            for mode in [[1, 0, 0], [2, 1, 3], [5, 3, 9], [1, 2, 5]] {
                for lattice in cell.lattice_vectors() {
                    assert!(turns(grid.wavevector(mode).dot(along_axes(lattice))) < 1e-14);
                }
                let k = grid.wavevector(mode).dot(along_axes(grid.position([1, 2, 3])));
                let on_the_grid = (0..3).map(|a| (mode[a] * (a + 1)) as f64 / grid.points()[a] as f64).sum::<f64>();
                assert!(turns(k - std::f64::consts::TAU * on_the_grid) < 1e-14);
            }
        }
    }

    /// On its points each mode is that of the grid that is not reduced, and no equivalent wavevector is shorter along
    /// the less sheared lattice.
    #[test]
    fn reduced_grids_have_the_same_modes_by_shorter_wavevectors() {
        let edges = Vector::new(40.0, 4.0, 10.0);
        for strain in [-5.0, -3.3, -0.4, 0.0, 0.7, 2.5, 4.9] {
            for points in [[40, 6, 2], [30, 10, 2], [16, 4, 4]] {
                let grid = Grid::new(points, PeriodicBox::sheared(edges, strain).unwrap()).unwrap();
                let (reduced, spacing) = (grid.reduced(), grid.spacing());
                assert!(reduced.strain().abs() <= 0.5 * spacing.x / spacing.y + 1e-12);
                let shifted = reduced.strain() + reduced.row_shift() as f64 * spacing.x / spacing.y;
                assert!((shifted - grid.cell().strain()).abs() < 1e-12);
                for mode in (0..points[0]).flat_map(|m1| (0..points[1]).map(move |m2| [m1, m2, 1])) {
                    let (k, short) = (grid.wavevector(mode), reduced.wavevector(mode));
                    let apart = (k.y - short.y) * spacing.y / std::f64::consts::TAU;
                    assert!((apart - apart.round()).abs() < 1e-12 && (k.x, k.z) == (short.x, short.z));
                    let along = (short.y + reduced.strain() * short.x) * spacing.y / std::f64::consts::PI;
                    assert!(along.abs() < 1.0 + 1e-12, "{along} at {mode:?} of {points:?}, strain {strain}");
                    let is_highest = (along.abs() - 1.0).abs() < 1e-12;
                    assert_eq!(reduced.is_nyquist(1, mode), is_highest, "{mode:?} of {points:?}, strain {strain}");
                }
            }
        }
    }
}
