//! Tables of a plan for a device.

use super::by_rows;
use crate::envelope::{Common, Envelope};
use crate::grid::window::{KaiserBessel, Pieces, WindowLattice};
use crate::mobility::far_field::grid::operator;
use crate::pairs::table::{PairFunctions, PairTable};
use crate::plan::Plan;
use crate::plan::problem::Precision;
use domain::parallel::mapped;
use domain::{Boundaries, PeriodicBox, Vector};
use gpu::{
    COLUMN_NUMBERS, ChannelColumns, DevicePairTable, GridShare, GridSolve, LatticeShape, NumberFormat, Orders,
    SplitTables, WindowPolynomials,
};
use solver::{ChannelTables, ColumnKernel, Grid, Real, Stokes};

/// Functions of a plan of the split method, in internal units.
pub(super) struct PlanTables {
    envelopes: Vec<Envelope>,
    common: Common,
    window: KaiserBessel,
    grid: Grid,
    lattice: WindowLattice<f64>,
    boundaries: Boundaries,
    /// Position of the first grid point relative to the origin of the box.
    first_point: Vector,
}

/// Lattice of the grid's periodic copies, and the position of its first point.
pub(super) struct GridFrame {
    pub lattice: PeriodicBox,
    first: Vector,
}

impl GridFrame {
    /// Lattice coordinates of positions as fractions of the edges.
    pub fn all_fractions(&self, positions: &[Vector]) -> Vec<[f64; 3]> {
        let of_one = |position| self.lattice.lattice_coordinates(position - self.first) / self.lattice.edges();
        mapped(positions, |&position| of_one(position).to_array())
    }
}

impl PlanTables {
    /// For a plan in internal units.
    pub fn new(plan: &Plan) -> Self {
        let (Some(common), Some(window)) = (plan.common(), plan.window()) else {
            panic!("a plan for a device has the split method");
        };
        let envelopes: Vec<Envelope> = plan.radii.iter().map(|&radius| Envelope::of_sphere(radius)).collect();
        let cell = operator::lattice(plan, &plan.cell());
        let grid = Grid::new(plan.grid, cell).expect("a plan has a grid that can be transformed");
        let lattice = WindowLattice::new(&grid, window, common, &envelopes);
        let (boundaries, first_point) = (plan.boundaries, plan.first_point());
        Self { envelopes, common, window, grid, lattice, boundaries, first_point }
    }

    /// Frame of the grid in a box.
    pub fn frame(&self, cell: &PeriodicBox) -> GridFrame {
        if self.boundaries == Boundaries::Periodic {
            return GridFrame { lattice: *cell, first: Vector::ZERO };
        }
        GridFrame { lattice: *self.grid.cell(), first: cell.origin() + self.first_point }
    }

    /// Solve on the grid, with the volume by which the host's interpolation multiplies.
    fn solve<T: Real>(&self, plan: &Plan) -> GridSolve {
        let Self { grid, window, common, .. } = self;
        match self.boundaries {
            Boundaries::Periodic => GridSolve::Periodic,
            Boundaries::Open => {
                let stokes: Stokes<T> = operator::split(plan, grid, *window, *common);
                let kernel = stokes.open_space().expect("a kernel of unbounded fluid").by_modes();
                let volume = operator::interpolated_volume(plan, grid);
                GridSolve::Unbounded(mapped(&kernel, |&value| value.to_f64() * volume))
            }
            _ => GridSolve::Channel(channel_columns(operator::channel_tables(plan, grid, *window, *common), grid)),
        }
    }

    /// Tables that do not depend on the shape of the box, for a device that has a part of the grid.
    pub fn split(&self, plan: &Plan, share: GridShare) -> SplitTables {
        match plan.precision {
            Precision::Single => self.split_in::<f32>(plan, NumberFormat::Single, share),
            Precision::Double => self.split_in::<f64>(plan, NumberFormat::Double, share),
        }
    }

    fn split_in<T: Real>(&self, plan: &Plan, numbers: NumberFormat, share: GridShare) -> SplitTables {
        let (cutoff, tolerance) = (plan.cutoff(), plan.table_tolerance());
        let all = || self.envelopes.iter().flat_map(|&i| self.envelopes.iter().map(move |&j| [i, j]));
        let pairs = all().map(|[i, j]| {
            let table = PairTable::<f64>::new(&PairFunctions::new(i, j, self.common), cutoff, tolerance);
            let (per_square, coefficients) = table.expect("a plan for a device has tables").coefficients();
            DevicePairTable { per_square, coefficients }
        });
        let isolated = self.envelopes.iter().map(|&e| {
            let functions = PairFunctions::new(e, e, self.common).exact(0.0);
            [functions[0], functions[6]]
        });
        let pieces = Pieces::<T>::new(self.window);
        SplitTables {
            numbers,
            grid: plan.grid,
            share,
            points: self.window.points(),
            window: pieces.series().map(WindowPolynomials),
            pairs: pairs.collect(),
            isolated: isolated.collect(),
            cutoff,
            viscosity: plan.viscosity,
            gaussian: self.common.width * self.common.width,
            widening: 0.5 * self.common.increment,
            is_periodic: [0, 1, 2].map(|axis| self.boundaries.is_periodic(axis)),
            solve: self.solve::<T>(plan),
        }
    }

    /// Shape of a box, and the tables that depend on it.
    pub fn in_box(&mut self, cell: &PeriodicBox) -> LatticeShape {
        self.grid = self.grid.in_cell(*cell);
        self.lattice = self.lattice.with_envelopes(&self.grid, self.common, &self.envelopes);
        let smoothing = |class: usize| [0, 1].map(|multipole| self.lattice.smoothing(class as u32, multipole).factors);
        LatticeShape {
            edges: cell.edges().to_array(),
            strain: cell.strain(),
            tilts: cell.tilts(),
            lowest: self.first_point.z,
            axes: cell.axes().map(by_rows),
            smoothing: (0..self.envelopes.len()).map(smoothing).collect(),
            levels: std::array::from_fn(|axis| self.levels(axis)),
        }
    }

    /// Logarithm of the inverse square of the window's transform, by mode along an axis.
    fn levels(&self, axis: usize) -> Vec<f64> {
        let (points, spacing) = (self.grid.points()[axis], self.grid.spacing()[axis]);
        let modes = if axis == 0 { points / 2 + 1 } else { points };
        let level = |mode: usize| -2.0 * self.window.transform(self.grid.wavenumber(axis, mode) * spacing).ln();
        (0..modes).map(level).collect()
    }

    /// Orders of derivatives that loads of these kinds, forces and dipoles, and motions need.
    pub fn orders(&self, [forces, dipoles]: [bool; 2], [velocities, gradients]: [bool; 2]) -> Orders {
        let spread = self.lattice.order(forces, dipoles);
        Orders { spread, interpolate: self.lattice.order(velocities, gradients), velocities, gradients }
    }
}

/// Numbers of the columns of modes, each number by columns.
fn channel_columns(tables: ChannelTables, grid: &Grid) -> ChannelColumns {
    let [half, modes] = [grid.points()[0] / 2, grid.points()[1]];
    let mut columns = vec![0.0; COLUMN_NUMBERS * (half + 1) * modes];
    for (at, column) in tables.columns.iter().enumerate() {
        let Some(ColumnKernel { decay, direction, along, across }) = column else { continue };
        let numbers = std::iter::once(decay).chain(direction).chain(along).chain(across);
        for (number, &value) in numbers.enumerate() {
            columns[(number * modes + at / half) * (half + 1) + at % half] = value;
        }
    }
    ChannelColumns { columns, mean_planes: tables.mean_planes, mean_kernel: tables.mean_kernel }
}
