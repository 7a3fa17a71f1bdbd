//! Interpolation: velocity field to motions, or potential to fields.

use crate::grid::kernel::{Kernel, Slab, SphereStencil};
use crate::grid::stencil::Stencil;
use domain::parallel::{FusedLoops, MeasuredLoop, ScatteredWrites};
use domain::{Tensor, Vector};
use rayon::prelude::*;
use simd::{SimdVector as Lanes, VectorKernel};
use solver::{Field, Physical, Real};

/// Targets of the interpolation: stencils, and the class of each particle present.
pub(crate) struct Interpolation<'a> {
    pub stencils: &'a [Stencil],
    pub classes: &'a [u32],
    /// Volume of a grid point.
    pub volume: f64,
}

/// Velocities and velocity gradients of particles.
pub(crate) type GridMotions = Vec<(Vector, Tensor)>;

/// Particles in a batch of one thread.
const BATCH: usize = 64;

impl Interpolation<'_> {
    /// Velocity and velocity gradient `D_ij = d_j u_i` of each particle present: the contributions of this rank's
    /// rows, in the memory of a list. Of a potential, `-grad` of it and the gradient of that.
    pub fn run<T: Real, const C: usize, K: Kernel<T, C>>(
        &self,
        kernel: &K,
        field: &Field<T, Physical, C>,
        motions: &mut GridMotions,
    ) {
        let [lines, planes] = field.rows();
        let strides = [field.row_stride(), field.plane_stride()];
        let slab = &Slab { components: field.components(), lines, planes, strides };
        let mut loops = FusedLoops::default();
        loops.of_rows(motions, self.stencils.len(), |_| (Vector::ZERO, Tensor::ZERO));
        loops.run();
        let bytes = C * size_of_val(slab.components[0]) + size_of_val(&motions[..]);
        let by_row = &ScatteredWrites::into(motions);
        self.stencils.par_chunks(BATCH).moving(bytes).for_each(|stencils| {
            T::dispatch(Weigh { to: self, kernel, stencils, slab, by_row });
        });
    }
}

/// One batch of stencils.
struct Weigh<'a, T, K, const C: usize> {
    to: &'a Interpolation<'a>,
    kernel: &'a K,
    stencils: &'a [Stencil],
    slab: &'a Slab<&'a [T], C>,
    by_row: &'a ScatteredWrites<'a, (Vector, Tensor)>,
}

impl<T: Real, const C: usize, K: Kernel<T, C>> VectorKernel<T> for Weigh<'_, T, K, C> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes<T>>(self) {
        let Interpolation { classes, volume, .. } = self.to;
        let mut scratch = K::Scratch::default();
        for stencil in self.stencils {
            let sphere = SphereStencil { stencil, class: classes[stencil.row as usize] };
            let weighed = self.kernel.collect::<V>(&mut scratch, sphere, self.slab);
            let (mut velocity, mut gradient) = (Vector::ZERO, [Vector::ZERO; 3]);
            for c in 0..3 {
                velocity[c] = weighed.velocity[c].to_f64();
                for j in 0..3 {
                    gradient[j][c] = weighed.gradient[c][j].to_f64();
                }
            }
            let [x, y, z] = gradient;
            let motion = (velocity * *volume, Tensor::from_cols(x, y, z) * -*volume);
            // SAFETY: each particle has one stencil, and each stencil is in one batch.
            unsafe { self.by_row.set(stencil.row as usize, motion) };
        }
    }
}
