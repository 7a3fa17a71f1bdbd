//! Operators on the grid of a plan: from force density to velocity, and from charge density to potential.

use crate::envelope::Common;
use crate::grid::window::KaiserBessel;
use crate::plan::Plan;
use crate::plan::method::Method;
use domain::{Boundaries, Partition, PeriodicBox, Vector, power_of_two};
use solver::{Channel, ChannelFaces, ChannelTables, ChannelWeights, Grid, Multiplier, OpenSpace, Real, Stokes};

/// Wavenumbers in units of the inverse width beyond which the Gaussian factor along a sheared lattice direction loses
/// precision or underflows: it is `exp(-684)`, and `f64` ends at `exp(-708)`.
const FARTHEST_FACTOR: f64 = 37.0;

/// The Stokes solve. With the split method it includes the common Gaussian, and is divided by the window's transform
/// once for spreading and once for interpolation. A window on the grid is dimensionless, a force density is not: the
/// difference is the volume of a grid point, here in units of [`unit_volume`].
pub(super) fn operator<T: Real>(plan: &Plan, grid: &Grid, partition: &Partition) -> Stokes<T> {
    let (Some(window), Some(common)) = (plan.window(), plan.common()) else {
        return Stokes::new(grid, plan.viscosity);
    };
    let operator = split(plan, grid, window, common);
    match plan.boundaries {
        Boundaries::Periodic | Boundaries::Open => operator,
        _ => operator.with_channel(channel(plan, grid, partition, window, common)),
    }
}

/// The solve of the split method for a field of one or three components, without walls.
pub(in crate::mobility::far_field) fn split<T: Real, const C: usize>(
    plan: &Plan,
    grid: &Grid,
    window: KaiserBessel,
    common: Common,
) -> Stokes<T, C> {
    let (spacing, strain) = (grid.spacing(), grid.strain());
    let volume = spacing.x * spacing.y * spacing.z;
    let unit = unit_volume(plan, grid);
    // In a tilted lattice the Gaussian is no product of functions along the axes: the solve applies it.
    let width = if grid.cell().is_orthogonal() { 0.0 } else { common.width };
    let width_in_plane = if width > 0.0 { 0.0 } else { common.width };
    let gaussian = |exponent: f64| if width > 0.0 { 1.0 } else { exponent.exp() };
    let factor = |k: f64, spacing: f64| {
        let amplitude = gaussian(-0.5 * (k * common.width).powi(2));
        amplitude / window.transform(k * spacing)
    };
    // The window is a product along the lattice vectors, the Gaussian is not.
    let plane = |k1: f64, k2: f64| {
        let along = k2 + strain * k1;
        if along.abs() * width_in_plane > FARTHEST_FACTOR {
            let exponent = -0.5 * (k1 * k1 + k2 * k2) * width_in_plane.powi(2);
            let windows = window.transform(k1 * spacing.x) * window.transform(along * spacing.y);
            return (exponent.exp() / (windows * volume)).powi(2) * unit.powi(2);
        }
        let tilted = gaussian(-0.5 * (k2 * k2 - along * along) * common.width.powi(2));
        (factor(k1, spacing.x) * factor(along, spacing.y) * tilted / volume).powi(2) * unit.powi(2)
    };
    let axis = |k3: f64| factor(k3, spacing.z).powi(2);
    let widening = 0.5 * common.increment;
    if plan.boundaries == Boundaries::Open {
        let bracket = |k: Vector| (1.0 + widening * k.length_squared()).powi(2);
        let multiplier = |k: Vector| plane(k.x, k.y) * axis(k.z) * bracket(k);
        // Beyond the cutoff the flow of common Gaussians is that of the envelopes.
        let kernel = OpenSpace::new(grid, plan.viscosity, multiplier, plan.cutoff());
        return Stokes::in_open_space(grid, kernel);
    }
    Stokes::with_multiplier(grid, plan.viscosity, &Multiplier { plane, axis, widening, width })
}

/// Flow of walls, or of the fluid beyond open faces, which is added to the periodic solve. The common Gaussian and
/// its bracket act on it as `1 + (Sigma^2 - D)/2 lap`.
fn channel<T: Real>(
    plan: &Plan,
    grid: &Grid,
    partition: &Partition,
    window: KaiserBessel,
    common: Common,
) -> Channel<T> {
    let weights = channel_weights(plan, grid, window, common);
    Channel::new(grid, partition.place(), &channel_faces(plan), plan.viscosity, &weights)
}

/// The same as numbers of columns, with the volume by which interpolation multiplies.
pub(in crate::mobility::far_field) fn channel_tables(
    plan: &Plan,
    grid: &Grid,
    window: KaiserBessel,
    common: Common,
) -> ChannelTables {
    let weights = channel_weights(plan, grid, window, common);
    ChannelTables::new(grid, &channel_faces(plan), plan.viscosity / interpolated_volume(plan, grid), &weights)
}

fn channel_faces(plan: &Plan) -> ChannelFaces {
    ChannelFaces { walls: plan.boundaries.walls(), height: plan.edges.z, first: plan.first_point().z }
}

/// Weights of a force on the grid in the flow of walls.
fn channel_weights(
    plan: &Plan,
    grid: &Grid,
    window: KaiserBessel,
    common: Common,
) -> ChannelWeights<impl Fn(f64, f64) -> f64 + use<>, impl Fn(f64) -> [f64; 2] + use<>> {
    let spacing = grid.spacing();
    let unit = unit_volume(plan, grid) / (spacing.x * spacing.y * spacing.z);
    let cut = plan.wavenumber_split();
    let plane = move |k1: f64, k2: f64| {
        let window = window.transform(k1 * spacing.x) * window.transform(k2 * spacing.y);
        cut.grid_fraction(k1.hypot(k2)) * (unit / window).powi(2)
    };
    ChannelWeights {
        plane,
        axis: move |k: f64| window.growth(k * spacing.z),
        second_moment: window.second_moment() * spacing.z * spacing.z,
        smoothing: common.width * common.width - common.increment,
        highest: cut.grid_cutoff,
    }
}

/// Volume of a grid point by which interpolation multiplies.
pub(in crate::mobility::far_field) fn interpolated_volume(plan: &Plan, grid: &Grid) -> f64 {
    let spacing = grid.spacing();
    spacing.x * spacing.y * spacing.z / unit_volume(plan, grid).powi(2)
}

/// Lattice of the grid's periodic copies: that of the box if it is periodic along all axes.
pub(in crate::mobility::far_field) fn lattice(plan: &Plan, cell: &PeriodicBox) -> PeriodicBox {
    match plan.boundaries {
        Boundaries::Periodic => *cell,
        _ => PeriodicBox::new(plan.period).expect("a plan has a grid"),
    }
}

/// Unit in which the operator measures the volume of a grid point: with the split method that volume rounded to a
/// power of two, since grids may be far coarser than a radius, as in a box of a few particles that are far apart.
/// Results are larger by the square of the unit.
pub(super) fn unit_volume(plan: &Plan, grid: &Grid) -> f64 {
    let spacing = grid.spacing();
    if plan.method == Method::Direct { 1.0 } else { power_of_two(spacing.x * spacing.y * spacing.z) }
}
