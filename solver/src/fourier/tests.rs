use super::columns::ColumnPlan;
use super::*;
use crate::memory::AlignedMemory;
use simd::StridedRows;
use std::f64::consts::TAU;

/// Reproducible pseudo-random number between -1 and 1: mixed bits of a product.
pub(crate) fn noise(index: usize) -> f64 {
    let mut bits = (index as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (bits >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// The defining sum of the transform, in `f64`.
fn slow(values: &[Complex<f64>], sign: f64) -> Vec<Complex<f64>> {
    let n = values.len();
    let root = |turns: usize| Complex::from_polar(1.0, sign * TAU * (turns % n) as f64 / n as f64);
    (0..n).map(|k| (0..n).map(|j| values[j] * root(j * k)).sum()).collect()
}

fn difference(a: &[Complex<f64>], b: &[Complex<f64>]) -> f64 {
    let norm = |v: &mut dyn Iterator<Item = Complex<f64>>| v.map(|c| c.norm_sqr()).sum::<f64>().sqrt();
    norm(&mut a.iter().zip(b).map(|(a, b)| a - b)) / norm(&mut b.iter().copied())
}

const LENGTHS: [usize; 21] = [1, 2, 3, 4, 5, 6, 7, 8, 9, 12, 14, 15, 16, 21, 32, 48, 64, 72, 105, 128, 256];

/// Lengths and half-lengths with factors for which there is no lane kernel: single ones, products, and large primes.
const OTHER_LENGTHS: [usize; 14] = [11, 13, 17, 22, 23, 26, 33, 34, 46, 53, 97, 106, 143, 194];

/// Noise in each lane before and after its transform.
fn transformed<T: Real>(plan: &AnyLength<T>, direction: Direction, in_place: bool) -> Vec<[Vec<Complex<f64>>; 2]> {
    let (length, stride) = (plan.length(), 6 * T::LANES);
    let element = |memory: &AlignedMemory<T>, i: usize, lane: usize| {
        let at = i * stride + lane;
        Complex::new(memory.values()[at].to_f64(), memory.values()[at + T::LANES].to_f64())
    };
    let mut from = AlignedMemory::<T>::zero(length * stride);
    from.values_mut().iter_mut().enumerate().for_each(|(i, v)| *v = T::from_f64(noise(i)));
    let before = from.clone();
    let mut to = AlignedMemory::<T>::zero(length * stride);
    let mut buffers = [(); 2].map(|()| AlignedMemory::<T>::zero(plan.room()));
    let source = StridedPointer { first: from.values_mut().as_mut_ptr(), stride };
    let target = if in_place { source } else { StridedPointer { first: to.values_mut().as_mut_ptr(), stride } };
    let buffers = buffers.each_mut().map(|b| b.values_mut().as_mut_ptr());
    unsafe { plan.run(direction, source, target, buffers) };
    let after = if in_place { from } else { to };
    (0..T::LANES).map(|lane| [&before, &after].map(|m| (0..length).map(|i| element(m, i, lane)).collect())).collect()
}

/// Relative error of the columns' transform in the 2-norm, the largest over the lanes.
fn column_error<T: Real>(plan: &AnyLength<T>, direction: Direction, in_place: bool) -> f64 {
    let sign = if direction == Direction::Forward { -1.0 } else { 1.0 };
    let error = |[before, after]: [Vec<_>; 2]| difference(&after, &slow(&before, sign));
    transformed(plan, direction, in_place).into_iter().map(error).fold(0.0, f64::max)
}

#[test]
fn columns_are_the_sums_that_define_them() {
    for length in LENGTHS.into_iter().chain(OTHER_LENGTHS) {
        for direction in [Direction::Forward, Direction::Backward] {
            for in_place in [false, true] {
                // Fast transforms have a few roundings per factor; the slow sum has more.
                assert!(
                    column_error::<f64>(&AnyLength::new(length), direction, in_place)
                        < 1e-15 * (2.0 + length as f64).sqrt(),
                    "{length}"
                );
                let error = column_error::<f32>(&AnyLength::new(length), direction, in_place);
                assert!(error < 3e-7, "{length}: {error}");
            }
        }
    }
}

/// Largest relative difference between the lane kernels and rustfft.
fn from_rustfft<T: Real>(length: usize, direction: Direction) -> f64 {
    let lanes = transformed::<T>(&AnyLength::Lanes(ColumnPlan::new(length)), direction, true);
    let rustfft = transformed::<T>(&AnyLength::by_rustfft(length), direction, true);
    lanes.iter().zip(&rustfft).map(|([_, a], [_, b])| difference(a, b)).fold(0.0, f64::max)
}

#[test]
fn lane_kernels_agree_with_rustfft() {
    for length in (1..=1024).filter(|&n| is_product_of(&[2, 3, 5, 7], n)) {
        assert!(matches!(AnyLength::<f64>::new(length), AnyLength::Lanes(_)), "{length} has lane kernels");
        for direction in [Direction::Forward, Direction::Backward] {
            let errors = [from_rustfft::<f64>(length, direction), from_rustfft::<f32>(length, direction)];
            // A few roundings of each.
            assert!(errors[0] < 1e-15 && errors[1] < 5e-7, "{length}: {errors:?}");
        }
    }
}

#[test]
fn other_factors_are_for_rustfft() {
    for length in OTHER_LENGTHS {
        assert!(matches!(AnyLength::<f32>::new(length), AnyLength::Gathered(_)), "{length} has no lane kernels");
    }
}

/// Rows of `length` noisy values with noise in their halos: before, and after each direction.
fn rows<T: Real>(length: usize, halo: usize) -> [AlignedMemory<T>; 3] {
    let stride = stride::<T>(length, halo);
    let mut memory = AlignedMemory::<T>::zero(T::LANES * stride);
    memory.values_mut().iter_mut().enumerate().for_each(|(i, v)| *v = T::from_f64(noise(i)));
    let before = memory.clone();
    let plan = RowPlan::<T>::new(AnyLength::new(length / 2), halo);
    let mut buffers = [(); 3].map(|()| AlignedMemory::<T>::zero(plan.room()));
    let buffers = buffers.each_mut().map(|b| b.values_mut().as_mut_ptr());
    let batch = StridedRows { first: memory.values_mut().as_mut_ptr(), stride };
    unsafe { plan.run(Direction::Forward, batch, buffers) };
    let spectrum = memory.clone();
    let batch = StridedRows { first: memory.values_mut().as_mut_ptr(), stride };
    unsafe { plan.run(Direction::Backward, batch, buffers) };
    [before, spectrum, memory]
}

fn stride<T: Real>(length: usize, halo: usize) -> usize {
    (length + halo).next_multiple_of(T::LANES).max((length / 2).next_multiple_of(T::LANES) * 2)
}

fn check_rows<T: Real>(length: usize, halo: usize, tolerance: f64) {
    let [before, spectrum, after] = rows::<T>(length, halo);
    let stride = stride::<T>(length, halo);
    for r in 0..T::LANES {
        let row = |memory: &AlignedMemory<T>| -> Vec<f64> {
            memory.values()[r * stride..(r + 1) * stride].iter().map(|v| v.to_f64()).collect()
        };
        let [before, spectrum, after] = [&before, &spectrum, &after].map(row);
        let folded = |i: usize| before[i] + if i < halo { before[length + i] } else { 0.0 };
        let values: Vec<_> = (0..length).map(|i| Complex::new(folded(i), 0.0)).collect();
        let exact = slow(&values, -1.0);
        let coefficient = |k: usize| {
            let at = k / T::LANES * 2 * T::LANES + k % T::LANES;
            Complex::new(spectrum[at], spectrum[at + T::LANES])
        };
        let found: Vec<_> = (0..length / 2).map(coefficient).collect();
        assert!(difference(&found, &exact[..length / 2]) < tolerance, "{length} {halo}");
        let filled_up = length / 2..(length / 2).next_multiple_of(T::LANES);
        assert!(filled_up.into_iter().all(|k| coefficient(k) == Complex::ZERO));

        let mut without_highest = exact;
        without_highest[length / 2] = Complex::ZERO;
        let back = slow(&without_highest, 1.0);
        let found: Vec<_> = (0..length + halo).map(|i| Complex::new(after[i], 0.0)).collect();
        let expected: Vec<_> = (0..length + halo).map(|i| back[i % length]).collect();
        assert!(difference(&found, &expected) < tolerance, "{length} {halo}");
    }
}

#[test]
fn rows_are_the_sums_that_define_them_with_halos_folded_and_filled() {
    let fast = [(2, 0), (4, 3), (6, 6), (8, 2), (10, 1), (14, 9), (18, 7), (36, 11), (64, 2), (96, 17), (100, 8)];
    let others = [(22, 0), (26, 20), (34, 5), (46, 8), (106, 11), (194, 16)];
    for (length, halo) in fast.into_iter().chain(others) {
        check_rows::<f64>(length, halo, 3e-15);
        check_rows::<f32>(length, halo, 1e-6);
    }
}

#[test]
fn roots_of_unity_have_their_symmetries() {
    for n in [1, 2, 3, 8, 12, 100, 128, 210] {
        for k in 0..2 * n {
            let root: Complex<f64> = root_of_unity(k, n);
            // The angle of the reference is accurate to a rounding of a whole turn.
            let angle = -TAU * ((k % n) as f64 / n as f64);
            let error = (root - Complex::from_polar(1.0, angle)).norm();
            assert!(error < 1e-15, "{k}/{n}: {error}");
            let mirrored: Complex<f64> = root_of_unity((2 * n - k) % n, n);
            assert!((root - mirrored.conj()).norm() < 2e-16, "{k}/{n}");
        }
    }
}
