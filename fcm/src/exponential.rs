//! An exponential that vectorises.

/// `exp(x)` for `x <= 0`, to 2e-16 relative down to -690, where it is cut off.
///
/// `x = n ln 2 + r`, a polynomial for `exp(r)`, and `n` put into the exponent's bits: no branch and no call.
#[inline(always)]
pub(crate) fn exponential(x: f64) -> f64 {
    const TO_WHOLE: f64 = 6_755_399_441_055_744.0; // 1.5 * 2^52: adding it leaves the nearest whole number in the low bits
    const LN2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];
    let x = if x > -690.0 { x } else { -690.0 };
    let shifted = x.mul_add(std::f64::consts::LOG2_E, TO_WHOLE);
    let n = shifted - TO_WHOLE;
    let r = n.mul_add(-LN2[1], n.mul_add(-LN2[0], x));
    let mut p: f64 = 1.0 / 6_227_020_800.0;
    for inverse in COEFFICIENTS {
        p = p.mul_add(r, inverse);
    }
    let power = f64::from_bits((shifted.to_bits() << 52).wrapping_add(1023 << 52));
    p * power
}

/// 1/12!, 1/11!, ..., 1/0!.
const COEFFICIENTS: [f64; 13] = [
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

    #[test]
    fn it_is_the_exponential_to_the_last_bits() {
        for i in 0..200_000 {
            let x = -f64::from(i) * 0.003_4;
            let (ours, exact) = (exponential(x), x.exp());
            assert!((ours - exact).abs() <= 4.5e-16 * exact, "{x}: {ours} {exact}");
        }
        assert!(exponential(-1e6) < 1e-290);
    }
}
