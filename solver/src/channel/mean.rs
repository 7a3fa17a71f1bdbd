//! Channel update of the mean over the plane, the mode without a wavevector.

use super::kernel::mean_kernel;
use super::{ChannelFaces, ChannelWeights, Faces};
use crate::fourier::StridedPointer;
use crate::{Grid, Real};

/// Weights of the planes for 1, `z` and `z^2`, and the kernel between them. There is no flow across the plane.
pub(crate) struct Mean {
    pub planes: Vec<[f64; 3]>,
    pub kernel: [[f64; 3]; 3],
}

impl Mean {
    pub fn new<P, A>(grid: &Grid, faces: &ChannelFaces, scale: f64, weights: &ChannelWeights<P, A>) -> Self
    where
        P: Fn(f64, f64) -> f64,
        A: Fn(f64) -> [f64; 2],
    {
        let scale = scale * (weights.plane)(0.0, 0.0);
        let spacing = grid.spacing().z;
        let [transform, _] = (weights.axis)(0.0);
        let at = |plane: usize| {
            let z = faces.first + plane as f64 * spacing;
            [1.0, z, z * z - weights.second_moment + weights.smoothing].map(|value| value / transform)
        };
        let of = Faces { walls: faces.walls, height: faces.height, period: grid.cell().edges().z };
        let kernel = mean_kernel(&of).map(|row| row.map(|entry| entry * scale));
        Self { planes: (0..grid.points()[2]).map(at).collect(), kernel }
    }

    /// Amplitudes for x and y.
    ///
    /// # Safety
    /// The columns can be read.
    pub unsafe fn amplitudes<T: Real>(&self, [x, y, _]: [StridedPointer<T>; 3]) -> [[f64; 3]; 2] {
        [x, y].map(|column| {
            let mut moments = [0.0; 3];
            for (plane, weights) in self.planes.iter().enumerate() {
                // SAFETY: guaranteed by the caller. The mean is the first lane, and real.
                let force = unsafe { (*column.first.add(plane * column.stride)).to_f64() };
                moments.iter_mut().zip(weights).for_each(|(sum, weight)| *sum += weight * force);
            }
            self.kernel.map(|row| row.iter().zip(moments).map(|(entry, moment)| entry * moment).sum())
        })
    }

    /// Adds the flows of these amplitudes.
    ///
    /// # Safety
    /// The columns can be written.
    pub unsafe fn add<T: Real>(&self, amplitudes: &[[f64; 3]; 2], [x, y, _]: [StridedPointer<T>; 3]) {
        for (amplitudes, column) in amplitudes.iter().zip([x, y]) {
            for (plane, weights) in self.planes.iter().enumerate() {
                let more: f64 = amplitudes.iter().zip(weights).map(|(amplitude, weight)| amplitude * weight).sum();
                // SAFETY: guaranteed by the caller.
                unsafe {
                    let place = column.first.add(plane * column.stride);
                    *place = T::from_f64((*place).to_f64() + more);
                }
            }
        }
    }
}
