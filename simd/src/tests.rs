use super::*;

/// Every function of a vector on the same numbers.
struct Everything;

impl<T: Real> VectorKernel<T> for Everything {
    type Output = Vec<T>;

    #[inline(always)]
    fn run<V: SimdVector<T>>(self) -> Vec<T> {
        let lanes = T::LANES;
        let numbers = |seed: usize| -> Vec<T> {
            (0..lanes * lanes).map(|i| T::from_f64(((i * 7 + seed) as f64 * 0.731).sin() + 2.0)).collect()
        };
        let [a, b, c] = [numbers(1), numbers(2), numbers(3)];
        let mut results = vec![T::default(); 10 * lanes + lanes * lanes];
        // SAFETY: all have room for a vector, and the squares for a vector of vectors.
        unsafe {
            let (from, to) = ([a.as_ptr(), b.as_ptr(), c.as_ptr()], results.as_mut_ptr());
            every::<T, V>(from, to);
            // Both halves again, with the same results.
            for first in [0, V::Half::LANES] {
                every::<T, V::Half>(from.map(|p| p.add(first)), to.add(first));
            }
            let rows = StridedRows { first: a.as_ptr(), stride: lanes };
            V::transpose(rows, StridedRows { first: to.add(10 * lanes), stride: lanes });
        }
        results
    }
}

/// Result of each function, a cache line apart.
#[inline(always)]
unsafe fn every<T: Real, V: SimdVector<T>>([a, b, c]: [*const T; 3], to: *mut T) {
    unsafe {
        let [x, y, z] = [V::load(a), V::load(b), V::load(c)];
        let exponent = V::splat(T::from_f64(-17.0));
        let all = [
            V::splat(T::from_f64(2.5)),
            x.add(y),
            x.sub(y),
            x.mul(y),
            x.div(y),
            x.mul_add(y, z),
            x.mul_sub_from(y, z),
            x.max(y),
            x.times_power_of_two(exponent),
            z,
        ];
        for (i, value) in all.into_iter().enumerate() {
            value.store(to.add(i * T::LANES));
        }
    }
}

fn all_levels() -> Vec<InstructionSet> {
    let mut levels = vec![InstructionSet::Portable];
    #[cfg(target_arch = "x86_64")]
    levels.extend([InstructionSet::Avx2, InstructionSet::Avx512].into_iter().filter(|&level| match level {
        InstructionSet::Avx512 => x86::has_avx512(),
        _ => x86::has_avx2(),
    }));
    levels
}

#[test]
#[cfg(target_arch = "x86_64")]
fn a_name_limits_the_instructions() {
    let levels = all_levels();
    let within = |name| levels.iter().copied().rfind(|&level| level == InstructionSet::Portable || level == name);
    assert_eq!(InstructionSet::widest_up_to(Some("portable")), InstructionSet::Portable);
    assert_eq!(Some(InstructionSet::widest_up_to(Some("avx2"))), within(InstructionSet::Avx2));
    assert_eq!(Some(&InstructionSet::widest_up_to(None)), levels.last());
}

fn same_bits_on_all_levels<T: Real>() {
    let lanes = T::LANES;
    for level in all_levels() {
        // SAFETY: the machine has this level.
        let found = unsafe { T::dispatch_at(level, Everything) };
        // SAFETY: every machine has this level.
        let expected = unsafe { T::dispatch_at(InstructionSet::Portable, Everything) };
        assert_eq!(found, expected, "{level:?}");
        let a = |i: usize| T::from_f64(((i * 7 + 1) as f64 * 0.731).sin() + 2.0);
        for (i, j) in (0..lanes).flat_map(|i| (0..lanes).map(move |j| (i, j))) {
            assert_eq!(found[10 * lanes + j * lanes + i], a(i * lanes + j));
        }
    }
}

#[test]
fn all_instructions_give_the_same_bits() {
    same_bits_on_all_levels::<f32>();
    same_bits_on_all_levels::<f64>();
}

#[test]
fn vectorised_returns_what_the_closure_does() {
    let values: Vec<f64> = (0..100).map(f64::from).collect();
    let mut sums = vec![1.0; 100];
    let count = vectorised(
        #[inline(always)]
        || {
            for (sum, value) in sums.iter_mut().zip(&values) {
                *sum = value.mul_add(2.0, *sum);
            }
            sums.len()
        },
    );
    assert_eq!((count, sums[7]), (100, 15.0));
}
