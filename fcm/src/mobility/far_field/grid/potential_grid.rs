//! Part of the field of moments on the grid: spreading of charges, Poisson solve, interpolation of derivatives.

use super::moments::MomentGrid;
use super::operator::{interpolated_volume, lattice, split};
use super::spectral_grid::{GridLoads, GridPart, bounded_stencils};
use crate::envelope::Common;
use crate::grid::interpolate::{GridMotions, Interpolation};
use crate::grid::kernel::Load;
use crate::grid::spread::Spread;
use crate::grid::stencil::{Stencil, sorted_stencils};
use crate::grid::window::{KaiserBessel, WindowLattice, Windowed};
use crate::mobility::loads::Output;
use crate::mobility::work::{Stopwatch, Work};
use crate::plan::Plan;
use domain::parallel::{change_rows, of_rows, stage};
use domain::{Boundaries, Partition, PeriodicBox, Tensor, Vector};
use num_complex::Complex;
use solver::{Field, Grid, Physical, Poisson, Real, Transform};

/// Grid of one precision with the potential of moments: the forces of the loads. A moment is spread as charges by the
/// derivatives of the window along it, so that the grid has one component; fields and their gradients are interpolated
/// by the window's first and second derivatives. Spreading and interpolation are adjoint, so forces are those of an
/// energy.
pub(super) struct PotentialGrid<T: Real> {
    plan: Plan,
    window: KaiserBessel,
    common: Common,
    grid: Grid,
    transform: Transform<T, 1>,
    operator: Poisson<T>,
    field: Field<T, Physical, 1>,
    kernel: WindowLattice<T>,
    stencils: Vec<Stencil>,
    /// Memory for the next fields.
    spare: GridMotions,
}

impl<T: Real> PotentialGrid<T> {
    /// For a plan of moments, which has a window and a common Gaussian.
    pub fn new(plan: &Plan, partition: &Partition) -> Self {
        let grid =
            Grid::new(plan.grid, lattice(plan, &plan.cell())).expect("a plan has a grid that can be transformed");
        let grid = if plan.is_reduced() { grid.reduced() } else { grid };
        let (window, common) = (plan.window().expect("moments have windows"), plan.common().expect("and a Gaussian"));
        let transform = Transform::of_components(grid.points(), partition, plan.support.lanes);
        Self {
            plan: plan.clone(),
            window,
            common,
            operator: split(plan, &grid, window, common),
            field: transform.field(),
            kernel: WindowLattice::new(&grid, window, common, &plan.grid_envelopes()),
            grid,
            transform,
            stencils: Vec::new(),
            spare: GridMotions::default(),
        }
    }

    /// Spreads the charges of moments.
    fn spread(&mut self, loads: &GridLoads, work: &mut Work) {
        let axes = self.grid.cell().axes();
        let moment = |row: usize| loads.forces.get(row).copied().unwrap_or_default();
        let load =
            |row: usize| Load::of_moment(axes.map_or_else(|| moment(row), |axes| axes.transpose() * moment(row)));
        let all: Vec<Load<T, 1>> = of_rows(loads.classes.len(), load);
        work.particles_spread += self.stencils.len() as u64;
        let spread =
            Spread { stencils: &self.stencils, classes: loads.classes, loads: &all, period: self.plan.grid[2] };
        spread.run(&Windowed::<T, 1, 1>(&self.kernel), &mut self.field);
    }

    fn interpolate(&mut self, classes: &[u32], output: Output) -> GridMotions {
        let volume = interpolated_volume(&self.plan, &self.grid);
        let to = Interpolation { stencils: &self.stencils, classes, volume };
        let mut fields = std::mem::take(&mut self.spare);
        match output {
            Output::Velocities => to.run(&Windowed::<T, 1, 1>(&self.kernel), &self.field, &mut fields),
            _ => to.run(&Windowed::<T, 2, 1>(&self.kernel), &self.field, &mut fields),
        }
        if let Some(axes) = self.grid.cell().axes() {
            change_rows(&mut fields, |_, (field, gradient)| {
                *field = *axes * *field;
                *gradient = *axes * *gradient * axes.transpose();
            });
        }
        fields
    }
}

impl<T: Real> GridPart for PotentialGrid<T> {
    fn arrange(&mut self, cell: &PeriodicBox, positions: &[Vector]) {
        let extent = [self.plan.support.support; 3];
        if cell.boundaries() != Boundaries::Periodic {
            self.stencils = bounded_stencils(&self.plan, &self.grid, extent, cell, positions);
            return;
        }
        if cell != self.grid.cell() {
            self.grid = self.grid.in_cell(*cell);
            self.operator = split(&self.plan, &self.grid, self.window, self.common);
            self.kernel = self.kernel.with_envelopes(&self.grid, self.common, &self.plan.grid_envelopes());
        }
        self.stencils = sorted_stencils(&self.grid, extent, positions);
    }

    fn motions(&mut self, loads: &GridLoads, output: Output, work: &mut Work) -> GridMotions {
        let (mut clock, mut stage) = (Stopwatch::start(), stage("spreading"));
        self.spread(loads, work);
        clock.stop(&mut work.seconds.spread);
        stage.next("transforms");
        self.transform.apply(&mut self.field, &self.operator);
        clock.stop(&mut work.seconds.fft);
        work.transforms += 1;
        stage.next("interpolation");
        let fields = self.interpolate(loads.classes, output);
        clock.stop(&mut work.seconds.interpolate);
        fields
    }

    fn reuse(&mut self, motions: GridMotions) {
        self.spare = motions;
    }
}

impl<T: Real> MomentGrid for PotentialGrid<T> {
    /// With `q = k . M(k)` and the common Gaussian's width `Sigma`, the energy of the spread moments is
    ///
    /// ```text
    /// U = 1/(2V) sum_k exp(-k^2 Sigma^2) |q|^2 / k^2,
    /// ```
    ///
    /// and this is the part of its derivative by a deformation `e` that depends on the wavevectors,
    ///
    /// ```text
    /// 1/V sum_k exp(-k^2 Sigma^2) / k^2 |q|^2 [(Sigma^2 + 1/k^2) k_a k_b - delta_ab / 2].
    /// ```
    ///
    /// Of each pair of opposite wavevectors one is kept. The field is overwritten.
    fn stress_of_modes(&mut self, loads: &GridLoads, work: &mut Work) -> Tensor {
        self.spread(loads, work);
        let Self { window, common, grid, transform, field, .. } = self;
        let (spacing, strain, width) = (grid.spacing(), grid.strain(), common.width);
        let visit = |sum: Tensor, mode: [usize; 3], [charge]: [Complex<T>; 1]| {
            let k = grid.wavevector(mode);
            let square = k.length_squared();
            if square == 0.0 || (0..3).any(|axis| grid.is_nyquist(axis, mode)) {
                return sum;
            }
            let [along_x, along_y] = [k.x * spacing.x, (k.y + strain * k.x) * spacing.y];
            let along_z = grid.wavenumber(2, mode[2]) * spacing.z;
            let windows = window.transform(along_x) * window.transform(along_y) * window.transform(along_z);
            let weight = if mode[0] == 0 { 1.0 } else { 2.0 } / (windows * windows);
            let intensity = charge.re.to_f64().powi(2) + charge.im.to_f64().powi(2);
            let density = weight * intensity * (-square * width * width).exp() / square;
            sum + (outer(k) * (width * width + 1.0 / square) - Tensor::IDENTITY * 0.5) * density
        };
        let parts = transform.fold_modes(field, || Tensor::ZERO, visit);
        let sum = parts.into_iter().fold(Tensor::ZERO, |sum, part| sum + part) * (1.0 / grid.cell().volume());
        grid.cell().axes().map_or(sum, |axes| *axes * sum * axes.transpose())
    }
}

/// `k k`
fn outer(k: Vector) -> Tensor {
    Tensor::from_cols(k * k.x, k * k.y, k * k.z)
}
