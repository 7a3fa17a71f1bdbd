//! Flow between walls, above a wall, or in a layer that is open on both sides: the grid's periodic solve and an exact
//! update of few terms for each wavevector in the plane of the walls.
//!
//! The velocity that walls add to that of unbounded fluid, and what the grid's copies along z drive too much, are sums of
//! `exp(-k z)`, `k z exp(-k z)` and the same of the distance from the other wall, for each wavevector of length `k` in the
//! plane. So are, by symmetry, the weights of the forces. On columns along z, before they are transformed, forces are
//! weighed with these functions; a small symmetric matrix makes amplitudes of the weights, and what they stand for is added
//! to the velocities when the columns have been transformed back.

mod kernel;
mod mean;
mod update;

pub(crate) use kernel::Faces;
pub use kernel::across_walls;
pub(crate) use update::Update;

use crate::fourier::At;
use crate::layout::Layout;
use crate::{Grid, Real};
use domain::Place;
use mean::Mean;
use update::Amplitudes;

/// The faces of a grid along z, whose points there begin below the first wall and end above the second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelFaces {
    /// Walls: none, one at `z = 0`, or another one at `z = height`.
    pub walls: usize,
    /// The extent along z of what is in the fluid, from wall to wall if there are two.
    pub height: f64,
    /// `z` of the grid's first plane.
    pub first: f64,
}

/// What stands for a force on the grid, for which the update is: a window as of [`crate::Multiplier`], whose Gaussian and
/// brackets act on the flow of walls, on which the Laplacian of the Laplacian is zero, as `1 + smoothing/2 lap`.
#[derive(Debug, Clone, Copy)]
pub struct ChannelWeights<P, A> {
    /// The factor of `k1` and `k2`, as that of a multiplier but for the Gaussian.
    pub plane: P,
    /// The transform of the window along z at the imaginary wavenumber `i k` and `k` times its logarithmic derivative by `k`.
    pub axis: A,
    /// The window's second moment along z.
    pub second_moment: f64,
    /// `smoothing`.
    pub smoothing: f64,
    /// The wavenumber from which on there is no update: windows have nothing there that makes them exact.
    pub highest: f64,
}

/// The update of a grid in `T`.
pub struct Channel<T> {
    update: Update<T>,
    mean: Option<Mean>,
}

impl<T: Real> Channel<T> {
    /// The update for a rank's share of the spectrum.
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
        let [nx, ny, _] = grid.points();
        let scale = grid.spacing().z / (viscosity * (nx * ny) as f64);
        let layout = Layout::new::<T>(grid.points(), place, 0);
        let has_mean = layout.blocks.start == 0 && layout.modes.start == 0 && !layout.blocks.is_empty();
        Self {
            update: Update::new(grid, &layout, faces, scale, weights),
            mean: has_mean.then(|| Mean::new(grid, faces, scale, weights)),
        }
    }

    /// The amplitudes of what is to be added to columns whose forces these are.
    ///
    /// # Safety
    /// The columns can be read.
    pub(crate) unsafe fn amplitudes(
        &self,
        place: [usize; 2],
        components: [At<T>; 3],
    ) -> Option<(Amplitudes, [[f64; 3]; 2])> {
        // SAFETY: the caller's promise.
        unsafe {
            let mean = match &self.mean {
                Some(mean) if place == [0, 0] => mean.amplitudes(components),
                _ => [[0.0; 3]; 2],
            };
            Some((self.update.amplitudes(place, components)?, mean))
        }
    }

    /// Adds what the amplitudes stand for.
    ///
    /// # Safety
    /// The columns can be read and written.
    pub(crate) unsafe fn add(
        &self,
        place: [usize; 2],
        (amplitudes, mean): &(Amplitudes, [[f64; 3]; 2]),
        components: [At<T>; 3],
    ) {
        // SAFETY: the caller's promise.
        unsafe {
            self.update.add(place, amplitudes, components);
            if place == [0, 0]
                && let Some(of) = &self.mean
            {
                of.add(mean, components);
            }
        }
    }
}
