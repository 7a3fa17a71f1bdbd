//! Transforms of 2 to 8 elements in registers.

use crate::Real;
use simd::SimdVector;
use std::f64::consts::FRAC_1_SQRT_2;
use std::marker::PhantomData;

/// A complex number in each lane.
#[derive(Clone, Copy)]
pub(super) struct ComplexLanes<V, T> {
    pub re: V,
    pub im: V,
    real: PhantomData<T>,
}

impl<T: Real, V: SimdVector<T>> ComplexLanes<V, T> {
    #[inline(always)]
    pub fn new(re: V, im: V) -> Self {
        Self { re, im, real: PhantomData }
    }

    /// Reads a vector of real parts and one of imaginary parts.
    ///
    /// # Safety
    /// Both can be read.
    #[inline(always)]
    pub unsafe fn load(from: *const T, [re, im]: [usize; 2]) -> Self {
        // SAFETY: guaranteed by the caller.
        unsafe { Self::new(V::load(from.add(re)), V::load(from.add(im))) }
    }

    /// Writes a vector of real parts and one of imaginary parts.
    ///
    /// # Safety
    /// Both can be written.
    #[inline(always)]
    pub unsafe fn store(self, to: *mut T, [re, im]: [usize; 2]) {
        // SAFETY: guaranteed by the caller.
        unsafe {
            self.re.store(to.add(re));
            self.im.store(to.add(im));
        }
    }

    #[inline(always)]
    pub fn add(self, other: Self) -> Self {
        Self::new(self.re.add(other.re), self.im.add(other.im))
    }

    #[inline(always)]
    pub fn sub(self, other: Self) -> Self {
        Self::new(self.re.sub(other.re), self.im.sub(other.im))
    }

    #[inline(always)]
    pub fn mul(self, other: Self) -> Self {
        Self::new(
            self.im.mul_sub_from(other.im, self.re.mul(other.re)),
            self.im.mul_add(other.re, self.re.mul(other.im)),
        )
    }

    /// `self + factor other` for a real factor.
    #[inline(always)]
    fn add_scaled(self, factor: f64, other: Self) -> Self {
        let factor = V::splat(T::from_f64(factor));
        Self::new(other.re.mul_add(factor, self.re), other.im.mul_add(factor, self.im))
    }

    /// `self + (-i other)`
    #[inline(always)]
    fn add_turned(self, other: Self) -> Self {
        Self::new(self.re.add(other.im), self.im.sub(other.re))
    }

    /// `self - (-i other)`
    #[inline(always)]
    fn sub_turned(self, other: Self) -> Self {
        Self::new(self.re.sub(other.im), self.im.add(other.re))
    }

    #[inline(always)]
    fn scale(self, factor: f64) -> Self {
        let factor = V::splat(T::from_f64(factor));
        Self::new(self.re.mul(factor), self.im.mul(factor))
    }
}

/// Discrete Fourier transform `y_j = sum_k x_k exp(-2 pi i j k / R)` of a few elements.
pub(super) trait Butterfly {
    fn transform(self) -> Self;
}

impl<T: Real, V: SimdVector<T>> Butterfly for [ComplexLanes<V, T>; 2] {
    #[inline(always)]
    fn transform(self) -> Self {
        let [a, b] = self;
        [a.add(b), a.sub(b)]
    }
}

impl<T: Real, V: SimdVector<T>> Butterfly for [ComplexLanes<V, T>; 4] {
    #[inline(always)]
    fn transform(self) -> Self {
        let [a, b, c, d] = self;
        let [[even, even_less], [odd, odd_less]] = [[a, c].transform(), [b, d].transform()];
        [even.add(odd), even_less.add_turned(odd_less), even.sub(odd), even_less.sub_turned(odd_less)]
    }
}

impl<T: Real, V: SimdVector<T>> Butterfly for [ComplexLanes<V, T>; 8] {
    #[inline(always)]
    fn transform(self) -> Self {
        let [a, b, c, d, e, f, g, h] = self;
        let [p, q, r, s] = [a, c, e, g].transform();
        let [t, u, v, w] = [b, d, f, h].transform();
        // u exp(-i pi/4) and w exp(-3 i pi/4), times sqrt 2.
        let u = u.add_turned(u);
        let w = w.sub_turned(w);
        [
            p.add(t),
            q.add_scaled(FRAC_1_SQRT_2, u),
            r.add_turned(v),
            s.add_scaled(-FRAC_1_SQRT_2, w),
            p.sub(t),
            q.add_scaled(-FRAC_1_SQRT_2, u),
            r.sub_turned(v),
            s.add_scaled(FRAC_1_SQRT_2, w),
        ]
    }
}

/// Transform of an odd number of elements from the sums and differences of opposite ones, with the cosines and sines
/// of `2 pi k / R`, `0 < k < R/2`.
macro_rules! odd_butterfly {
    ($radix:literal, $cosines:expr, $sines:expr) => {
        impl<T: Real, V: SimdVector<T>> Butterfly for [ComplexLanes<V, T>; $radix] {
            #[inline(always)]
            fn transform(self) -> Self {
                const HALF: usize = $radix / 2;
                const COSINES: [f64; HALF] = $cosines;
                const SINES: [f64; HALF] = $sines;
                let mut sums = [self[0]; HALF];
                let mut differences = [self[0]; HALF];
                let mut result = self;
                for k in 0..HALF {
                    sums[k] = self[k + 1].add(self[$radix - 1 - k]);
                    differences[k] = self[k + 1].sub(self[$radix - 1 - k]);
                    result[0] = result[0].add(sums[k]);
                }
                for j in 1..=HALF {
                    let mut even = self[0].add_scaled(COSINES[j - 1], sums[0]);
                    let mut odd = differences[0].scale(SINES[j - 1]);
                    for k in (0..HALF).skip(1) {
                        let turns = (j * (k + 1)) % $radix;
                        let (turns, sign) = if turns > HALF { ($radix - turns, -1.0) } else { (turns, 1.0) };
                        even = even.add_scaled(COSINES[turns - 1], sums[k]);
                        odd = odd.add_scaled(sign * SINES[turns - 1], differences[k]);
                    }
                    result[j] = even.add_turned(odd);
                    result[$radix - j] = even.sub_turned(odd);
                }
                result
            }
        }
    };
}

odd_butterfly!(3, [-0.5], [0.8660254037844386]);
odd_butterfly!(5, [0.30901699437494745, -0.8090169943749475], [0.9510565162951535, 0.5877852522924731]);
odd_butterfly!(
    7,
    [0.6234898018587336, -0.2225209339563144, -0.9009688679024191],
    [0.7818314824680298, 0.9749279121818236, 0.4338837391175581]
);
