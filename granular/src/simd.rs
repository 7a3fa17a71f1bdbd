//! Loops compiled for the widest SIMD vectors of the processor.

/// A loop to run. Implementations mark `run` as `#[inline(always)]`, so that it is compiled for each vector width.
pub(crate) trait Kernel {
    /// Runs the loop.
    fn run(self);
}

/// Runs a loop. All widths do the same operations in the same order, none of them fused: the result does
/// not depend on the processor.
pub(crate) fn run(kernel: impl Kernel) {
    #[cfg(target_arch = "x86_64")]
    {
        if is_x86_feature_detected!("avx512f") {
            // SAFETY: the processor supports the instructions that the function is compiled for.
            return unsafe { with_avx512(kernel) };
        }
        if is_x86_feature_detected!("avx2") {
            // SAFETY: as above.
            return unsafe { with_avx2(kernel) };
        }
    }
    kernel.run();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
fn with_avx512(kernel: impl Kernel) {
    kernel.run();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn with_avx2(kernel: impl Kernel) {
    kernel.run();
}
