//! Exponential function of vectors.

use crate::Real;
use crate::SimdVector as Lanes;

/// `exp(x)` to a few units in the last place, for `x` up to 87 (`f32`) or 700 (`f64`); below the same negative bound
/// it stays constant.
///
/// `x = n ln 2 + r`, a polynomial for `exp(r)`, and `n` added to the exponent: no branch and no call.
#[inline(always)]
pub fn exponential<T: Real, V: Lanes<T>>(x: V) -> V {
    const LN2: [f64; 2] = [0.693_359_375, -2.121_944_400_546_905_8e-4];
    let single = size_of::<T>() == 4;
    // Adding it leaves the nearest integer in the low bits.
    let to_whole = constant::<T, V>(if single { 12_582_912.0 } else { 6_755_399_441_055_744.0 });
    let x = x.max(constant::<T, V>(if single { -87.0 } else { -700.0 }));
    let n = x.mul_add(constant::<T, V>(std::f64::consts::LOG2_E), to_whole).sub(to_whole);
    let r = n.mul_sub_from(constant::<T, V>(LN2[1]), n.mul_sub_from(constant::<T, V>(LN2[0]), x));
    let first = if single { 6 } else { 0 };
    let mut p = constant::<T, V>(COEFFICIENTS[first]);
    for k in first + 1..COEFFICIENTS.len() {
        p = p.mul_add(r, constant::<T, V>(COEFFICIENTS[k]));
    }
    p.times_power_of_two(n)
}

#[inline(always)]
fn constant<T: Real, V: Lanes<T>>(value: f64) -> V {
    V::splat(T::from_f64(value))
}

/// 1/13!, 1/12!, ..., 1/0!.
const COEFFICIENTS: [f64; 14] = [
    1.0 / 6_227_020_800.0,
    1.0 / 479_001_600.0,
    1.0 / 39_916_800.0,
    1.0 / 3_628_800.0,
    1.0 / 362_880.0,
    1.0 / 40_320.0,
    1.0 / 5_040.0,
    1.0 / 720.0,
    1.0 / 120.0,
    1.0 / 24.0,
    1.0 / 6.0,
    0.5,
    1.0,
    1.0,
];

#[cfg(test)]
mod tests {
    use super::exponential;
    use crate::Real;
    use crate::{SimdVector, VectorKernel};

    struct Exponentials<'a, T>(&'a [T]);

    impl<T: Real> VectorKernel<T> for Exponentials<'_, T> {
        type Output = Vec<T>;

        #[inline(always)]
        fn run<V: SimdVector<T>>(self) -> Vec<T> {
            let mut values = self.0.to_vec();
            for chunk in values.chunks_exact_mut(V::LANES) {
                // SAFETY: a chunk has as many values as a vector.
                unsafe { exponential::<T, V>(V::load(chunk.as_ptr())).store(chunk.as_mut_ptr()) };
            }
            values
        }
    }

    fn largest_error<T: Real>(to: f64) -> f64 {
        let xs: Vec<T> = (0..16_384).map(|i| T::from_f64(to * f64::from(i) / 16_384.0)).collect();
        let found = T::dispatch(Exponentials(&xs));
        let errors = xs.iter().zip(found).map(|(x, found)| (found.to_f64() / x.to_f64().exp() - 1.0).abs());
        errors.fold(0.0, f64::max)
    }

    #[test]
    fn it_is_the_exponential_to_the_last_bits() {
        assert!([-690.0, 690.0].map(largest_error::<f64>).iter().all(|&error| error < 5e-16));
        assert!([-86.0, 86.0].map(largest_error::<f32>).iter().all(|&error| error < 3e-7));
        let cut = f64::dispatch(Exponentials(&[-1e6; 8]));
        assert!(cut.iter().all(|&x| (0.0..1e-290).contains(&x)));
    }
}
