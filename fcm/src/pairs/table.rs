//! Pair functions of two radii, exact or tabulated in the square of the distance.

use crate::envelope::{Common, Envelope};
use crate::pairs::pair_functions::EnvelopeDifference;
use solver::Real;

/// Functions of one pair of radii at one distance: `f_1, f_2` of two forces, `f_2, f_3` of the first's force and the
/// second's dipole, `f_2, f_3` the other way round, and `f_2, f_3, f_4` of two dipoles.
pub(crate) type PairValues = [f64; 9];

/// Differences between two envelopes and two common Gaussians, for the four combinations of force and dipole.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PairFunctions {
    forces: EnvelopeDifference,
    force_dipole: EnvelopeDifference,
    dipole_force: EnvelopeDifference,
    dipoles: EnvelopeDifference,
}

/// Functions of the squared distance that can be tabulated: those of [`PairValues`], or fewer and zeros.
pub(crate) trait TabulatedFunctions {
    /// Derivatives of the functions by `r^2` of the given order at `r^2 = square`.
    fn derivative(&self, square: f64, order: usize) -> PairValues;
}

impl PairFunctions {
    /// Functions between envelopes `i` and `j`.
    pub fn new(i: Envelope, j: Envelope, common: Common) -> Self {
        Self {
            forces: EnvelopeDifference::new([i.monopole, j.monopole], common),
            force_dipole: EnvelopeDifference::new([i.monopole, j.dipole], common),
            dipole_force: EnvelopeDifference::new([i.dipole, j.monopole], common),
            dipoles: EnvelopeDifference::new([i.dipole, j.dipole], common),
        }
    }

    /// Functions from the degenerate quadrupole of `j`, in place of its force, to envelope `i`; those of a dipole of
    /// `j` have no meaning.
    pub fn of_quadrupole(i: Envelope, j: Envelope, common: Common) -> Self {
        let [velocity, gradient] =
            [i.monopole, i.dipole].map(|sigma| EnvelopeDifference::of_quadrupole(sigma, &j.quadrupole(), common));
        Self { forces: velocity, force_dipole: velocity, dipole_force: gradient, dipoles: gradient }
    }

    /// Functions at `r^2 = square`.
    pub fn exact(&self, square: f64) -> PairValues {
        self.derivative(square, 0)
    }
}

impl TabulatedFunctions for PairFunctions {
    /// `d f_n / d(r^2) = f_(n+1)/2`.
    fn derivative(&self, square: f64, order: usize) -> PairValues {
        let [forces, mixed, other, dipoles] =
            [&self.forces, &self.force_dipole, &self.dipole_force, &self.dipoles].map(|d| d.evaluate(square));
        let half = 0.5_f64.powi(order as i32);
        let [a, b, c, d] = [1, 2, 3, 4].map(|n| n + order);
        [forces[a], forces[b], mixed[b], mixed[c], other[b], other[c], dipoles[b], dipoles[c], dipoles[d]]
            .map(|f| f * half)
    }
}

const DEGREE: usize = 5;
/// Eight megabytes.
const MOST_INTERVALS: usize = 1 << 14;

/// [`PairFunctions`] as Taylor polynomials about the middles of equal intervals of the squared distance.
#[derive(Debug, Clone)]
pub(crate) struct PairTable<T> {
    per_interval: f64,
    intervals: Vec<Interval<T>>,
}

/// Coefficients of an interval by order: of the first eight functions, and of the last.
#[derive(Debug, Clone, Copy, Default)]
#[repr(align(64))]
struct Interval<T> {
    first: [[T; 8]; DEGREE + 1],
    last: [T; DEGREE + 1],
}

impl<T: Real> PairTable<T> {
    /// Tabulates up to a cutoff, with an error below `tolerance` of each function's value at distance 0 between
    /// points; `None` if that takes too many intervals, as for a cutoff of hundreds of radii.
    pub fn new(functions: &impl TabulatedFunctions, cutoff: f64, tolerance: f64) -> Option<Self> {
        let count = Self::intervals(functions, cutoff, tolerance)?;
        let width = cutoff * cutoff / count as f64;
        let interval = |i: usize| {
            let middle = (i as f64 + 0.5) * width;
            let (mut interval, mut factor) = (Interval::default(), 1.0);
            for order in 0..=DEGREE {
                let [first @ .., last] = functions.derivative(middle, order).map(|f| T::from_f64(f * factor));
                (interval.first[order], interval.last[order]) = (first, last);
                factor *= 0.5 * width / (order + 1) as f64;
            }
            interval
        };
        Some(Self { per_interval: 1.0 / width, intervals: (0..count).map(interval).collect() })
    }

    /// Number of intervals of the table of [`Self::new`], if it makes one.
    pub fn intervals(functions: &impl TabulatedFunctions, cutoff: f64, tolerance: f64) -> Option<usize> {
        let first = functions.derivative(0.0, 0);
        let bound = functions.derivative(0.0, DEGREE + 1);
        let factorial = 720.0;
        // Half-width of an interval from the first neglected term, which is largest at r = 0.
        let half = (0..9)
            .filter(|&f| bound[f] != 0.0)
            .map(|f| (tolerance * factorial * (first[f] / bound[f]).abs()).powf(1.0 / (DEGREE + 1) as f64))
            .fold(f64::INFINITY, f64::min);
        let count = ((cutoff * cutoff / (2.0 * half)).ceil() as usize).max(8);
        (count <= MOST_INTERVALS).then_some(count)
    }

    /// Number of intervals per unit of the squared distance, and the coefficients of each by order and function.
    pub fn coefficients(&self) -> (f64, Vec<[PairValues; DEGREE + 1]>) {
        let of_interval = |interval: &Interval<T>| {
            std::array::from_fn(|order| {
                let function = |f: usize| interval.first[order].get(f).unwrap_or(&interval.last[order]).to_f64();
                std::array::from_fn(function)
            })
        };
        (self.per_interval, self.intervals.iter().map(of_interval).collect())
    }

    /// Bytes of the table of [`Self::new`], if it makes one.
    pub fn bytes(functions: &impl TabulatedFunctions, cutoff: f64, tolerance: f64) -> Option<f64> {
        Self::intervals(functions, cutoff, tolerance).map(|count| (count * size_of::<Interval<T>>()) as f64)
    }

    /// Functions at `r^2 = square`, below the cutoff.
    #[inline(always)]
    pub fn evaluate(&self, square: f64) -> [T; 9] {
        let place = square * self.per_interval;
        let index = (place as usize).min(self.intervals.len() - 1);
        let t = T::from_f64(2.0 * (place - index as f64) - 1.0);
        let Interval { first, last } = &self.intervals[index];
        let (mut values, mut ninth) = (first[DEGREE], last[DEGREE]);
        for order in (0..DEGREE).rev() {
            for f in 0..8 {
                values[f] = values[f].mul_add(t, first[order][f]);
            }
            ninth = ninth.mul_add(t, last[order]);
        }
        let [a, b, c, d, e, f, g, h] = values;
        [a, b, c, d, e, f, g, h, ninth]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_table_cannot_hold_is_not_tabulated() {
        let sphere = Envelope::of_sphere(1.0);
        assert!(
            PairTable::<f64>::new(
                &PairFunctions::new(sphere, sphere, Common::new(33.0, [sphere.dipole].into_iter())),
                275.0,
                1e-6
            )
            .is_none()
        );
    }

    #[test]
    fn tables_keep_their_tolerance() {
        for (i, j) in [(1.0, 1.0), (1.0, 2.0), (1.0, 4.0)] {
            let [i, j] = [i, j].map(Envelope::of_sphere);
            let functions = PairFunctions::new(i, j, Common::new(2.5, [i.dipole, j.dipole].into_iter()));
            let first = functions.exact(0.0);
            for tolerance in [1e-4, 1e-8, 1e-12] {
                let table = PairTable::<f64>::new(&functions, 9.0, tolerance).unwrap();
                for n in 0..400 {
                    let square = f64::from(n) * 0.2017;
                    let (found, exact) = (table.evaluate(square), functions.exact(square));
                    for f in 0..9 {
                        let error = (found[f] - exact[f]).abs() / first[f].abs();
                        assert!(error < 2.0 * tolerance + 1e-14, "function {f} at {square}: error {error}");
                    }
                }
            }
        }
    }
}
