//! Channel update of one column of the grid, by its wavevector along the walls.

use super::kernel::{ChannelKernel, FUNCTIONS};
use super::mean::Mean;
use super::{ChannelFaces, ChannelWeights, Faces};
use crate::Grid;

/// Number of entries of a symmetric matrix for the functions of two components, and for a third that has half of
/// them.
pub(crate) const ALONG: usize = FUNCTIONS * (2 * FUNCTIONS + 1);
pub(crate) const ACROSS: usize = 3;

/// Update of a column. In the index `i` of a plane, counted from either end of the grid, the functions are `s^i` and `i
/// s^i`, `s = exp(-k h)`; the matrices include the conversion to functions of the distance from the walls.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnKernel {
    /// `k h`, with the distance `h` between planes.
    pub decay: f64,
    /// Direction of the wavevector.
    pub direction: [f64; 2],
    /// Lower triangle by rows of the matrix for the components along the wavevector and, over `i`, along z, of four
    /// functions each: two from the lower end, two from the upper one.
    pub along: [f64; ALONG],
    /// Entries of the matrix for the component normal to both, in the first function of each end.
    pub across: [f64; ACROSS],
}

/// Updates of all columns of a grid, and that of the mean.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelTables {
    /// Columns `[m2][m1]` with `m1 < nx/2`; those without an update are `None`.
    pub columns: Vec<Option<ColumnKernel>>,
    /// Weights of the planes for the functions 1, `z` and `z^2` of the mean.
    pub mean_planes: Vec<[f64; 3]>,
    /// Matrix between the moments and the amplitudes of these functions, for forces and velocities along x and y.
    pub mean_kernel: [[f64; 3]; 3],
}

impl ChannelTables {
    /// Updates of [`super::Channel`].
    pub fn new<P, A>(grid: &Grid, faces: &ChannelFaces, viscosity: f64, weights: &ChannelWeights<P, A>) -> Self
    where
        P: Fn(f64, f64) -> f64,
        A: Fn(f64) -> [f64; 2],
    {
        let ([nx, ny, _], scale) = (grid.points(), scale(grid, viscosity));
        let half = nx / 2;
        let column = |at: usize| ColumnKernel::new(grid, [at % half, at / half], faces, scale, weights);
        let Mean { planes, kernel } = Mean::new(grid, faces, scale, weights);
        Self { columns: (0..half * ny).map(column).collect(), mean_planes: planes, mean_kernel: kernel }
    }
}

/// Factor of the kernel of unit viscosity.
pub(super) fn scale(grid: &Grid, viscosity: f64) -> f64 {
    let [nx, ny, _] = grid.points();
    grid.spacing().z / (viscosity * (nx * ny) as f64)
}

impl ColumnKernel {
    /// Update of the column of two modes, if there is one.
    pub(crate) fn new<P, A>(
        grid: &Grid,
        [m1, m2]: [usize; 2],
        faces: &ChannelFaces,
        scale: f64,
        weights: &ChannelWeights<P, A>,
    ) -> Option<Self>
    where
        P: Fn(f64, f64) -> f64,
        A: Fn(f64) -> [f64; 2],
    {
        let wavevector = grid.wavevector([m1, m2, 0]);
        let k = wavevector.x.hypot(wavevector.y);
        let is_nyquist = m1 >= grid.points()[0] / 2 || grid.is_nyquist(1, [m1, m2, 0]);
        if k == 0.0 || k > weights.highest || is_nyquist {
            return None;
        }
        let kernel = kernel_of_planes(grid, faces, k, weights);
        let factor = scale * (weights.plane)(wavevector.x, wavevector.y);
        let (mut along, mut across) = ([0.0; ALONG], [0.0; ACROSS]);
        for (p, q) in (0..2 * FUNCTIONS).flat_map(|p| (0..=p).map(move |q| (p, q))) {
            along[p * (p + 1) / 2 + q] = factor * kernel.along[p][q];
        }
        for (entry, (p, q)) in [(0, 0), (1, 0), (1, 1)].into_iter().enumerate() {
            across[entry] = factor * kernel.across[p][q];
        }
        Some(Self { decay: k * grid.spacing().z, direction: [wavevector.x / k, wavevector.y / k], along, across })
    }
}

/// Kernel in the functions `s^i` and `i s^i` of the planes' indices from either end.
///
/// The sum over planes of the window times `exp(-k z)/Phi`, where `Phi` is its transform at `i k`, is `exp(-k z)` at
/// the particle; with `(k z + k Phi'/Phi) exp(-k z)/Phi` it is `k z exp(-k z)`, which `1 + c/2 lap` turns into
/// `(k z - c k^2) exp(-k z)`.
fn kernel_of_planes<P, A: Fn(f64) -> [f64; 2]>(
    grid: &Grid,
    faces: &ChannelFaces,
    k: f64,
    weights: &ChannelWeights<P, A>,
) -> ChannelKernel {
    let (spacing, period) = (grid.spacing().z, grid.cell().edges().z);
    let last = faces.first + (grid.points()[2] - 1) as f64 * spacing;
    let kernel = Faces { walls: faces.walls, height: faces.height, period }.kernel(k);
    let [transform, growth] = (weights.axis)(k);
    let level = |distance: f64| ((-k * distance).exp() / transform, k * distance + growth - weights.smoothing * k * k);
    let ends = [level(faces.first), level(faces.height - last)];
    // The functions are these rows times s^i and i s^i.
    let rows = |p: usize| {
        let (scale, level) = ends[p / 2];
        if p.is_multiple_of(2) { [scale, 0.0] } else { [scale * level, scale * k * spacing] }
    };
    let mut of_planes = ChannelKernel { along: [[0.0; 2 * FUNCTIONS]; 2 * FUNCTIONS], across: [[0.0; 2]; 2] };
    for (p, q) in (0..2 * FUNCTIONS).flat_map(|p| (0..2 * FUNCTIONS).map(move |q| (p, q))) {
        let [of_p, of_q] = [p, q].map(|p| rows(p % FUNCTIONS));
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            of_planes.along[p - p % 2 + i][q - q % 2 + j] += of_p[i] * kernel.along[p][q] * of_q[j];
        }
    }
    for (p, q) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        of_planes.across[p][q] = ends[p].0 * kernel.across[p][q] * ends[q].0;
    }
    of_planes
}
