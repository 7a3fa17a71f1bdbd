//! Flow between walls, above a wall, or in a layer that is open on both sides: the grid's periodic solve plus an
//! exact low-rank update for each wavevector in the plane of the walls.
//!
//! The difference between the velocity in the channel and that of the periodic grid comes from the walls and from the
//! grid's copies along z. For each wavevector of length `k` in the plane it is a sum of `exp(-k z)`, `k z exp(-k z)`
//! and the same of the distance from the other wall. By symmetry so are the weights of the forces. On columns along
//! z, before they are transformed, forces are summed with these functions as weights; a small symmetric matrix turns
//! the sums into amplitudes, and the corresponding flow is added to the velocities when the columns have been
//! transformed back.

mod column;
mod kernel;
mod mean;
mod update;

pub use column::{ChannelTables, ColumnKernel};
pub(crate) use kernel::Faces;
pub use kernel::across_walls;
pub(crate) use update::Update;

use crate::fourier::StridedPointer;
use crate::layout::Layout;
use crate::{Grid, Real};
use domain::Place;
use mean::Mean;
use update::Amplitudes;

/// Faces of a channel along z. The grid's points begin below the first wall and end above the second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelFaces {
    /// Number of walls: none, one at `z = 0`, or two with the other at `z = height`.
    pub walls: usize,
    /// Extent of the fluid along z: from wall to wall if there are two, otherwise that of its contents.
    pub height: f64,
    /// `z` of the grid's first plane.
    pub first: f64,
}

/// Function that represents a force on the grid, for which the update corrects: a window as of [`crate::Multiplier`].
/// Its Gaussian and brackets act on the flow of walls, which is biharmonic, as `1 + smoothing/2 lap`.
#[derive(Debug, Clone, Copy)]
pub struct ChannelWeights<P, A> {
    /// Factor of `k1` and `k2`, like that of a multiplier but without the Gaussian.
    pub plane: P,
    /// Transform of the window along z at the imaginary wavenumber `i k`, and `k` times its logarithmic derivative by
    /// `k`.
    pub axis: A,
    /// Second moment of the window along z.
    pub second_moment: f64,
    /// Coefficient `smoothing`.
    pub smoothing: f64,
    /// Wavenumber from which on there is no update, since windows are inaccurate there.
    pub highest: f64,
}

/// Channel update of a grid of values of type `T`.
pub struct Channel<T> {
    update: Update<T>,
    mean: Option<Mean>,
}

/// Amplitudes of the flow that a channel adds to a column: of its modes, and of the mean flow.
pub(crate) struct ChannelAmplitudes {
    of_mode: Amplitudes,
    mean: [[f64; 3]; 2],
}

impl<T: Real> Channel<T> {
    /// Update for a rank's share of the spectrum.
    pub fn new<P, A>(
        grid: &Grid,
        place: &Place,
        faces: &ChannelFaces,
        viscosity: f64,
        weights: &ChannelWeights<P, A>,
    ) -> Self
    where
        P: Fn(f64, f64) -> f64,
        A: Fn(f64) -> [f64; 2],
    {
        let scale = column::scale(grid, viscosity);
        let layout = Layout::new::<T>(3, grid.points(), place, 0);
        let has_mean = layout.blocks.start == 0 && layout.modes.start == 0 && !layout.blocks.is_empty();
        Self {
            update: Update::new(grid, &layout, faces, scale, weights),
            mean: has_mean.then(|| Mean::new(grid, faces, scale, weights)),
        }
    }

    /// Amplitudes of the flow to add, from columns that hold forces.
    ///
    /// # Safety
    /// The columns can be read.
    pub(crate) unsafe fn amplitudes(
        &self,
        place: [usize; 2],
        components: [StridedPointer<T>; 3],
    ) -> Option<ChannelAmplitudes> {
        // SAFETY: guaranteed by the caller.
        unsafe {
            let mean = match &self.mean {
                Some(mean) if place == [0, 0] => mean.amplitudes(components),
                _ => [[0.0; 3]; 2],
            };
            Some(ChannelAmplitudes { of_mode: self.update.amplitudes(place, components)?, mean })
        }
    }

    /// Adds the flow of the amplitudes.
    ///
    /// # Safety
    /// The columns can be read and written.
    pub(crate) unsafe fn add(
        &self,
        place: [usize; 2],
        amplitudes: &ChannelAmplitudes,
        components: [StridedPointer<T>; 3],
    ) {
        // SAFETY: guaranteed by the caller.
        unsafe {
            self.update.add(place, &amplitudes.of_mode, components);
            if place == [0, 0]
                && let Some(of) = &self.mean
            {
                of.add(&amplitudes.mean, components);
            }
        }
    }
}
