//! Fields and stresses of moments by the grid and pairs.

use super::potential_grid::PotentialGrid;
use super::spectral_grid::{GridLoads, GridPart};
use super::{DynPairCorrection, GridFarField};
use crate::mobility::loads::{Loads, Output};
use crate::mobility::work::Work;
use crate::pairs::moment_correction::MomentCorrection;
use crate::plan::Plan;
use crate::plan::problem::Precision;
use domain::parallel::{change_rows, mapped};
use domain::{Boundaries, Partition, Tensor, Vector};

/// Grid with the potential of moments.
pub(crate) trait MomentGrid: GridPart {
    /// Part of [`crate::DipoleField::first_moments`] on a periodic grid, for the moments of the particles present: the
    /// sum over this rank's modes, without the forces' part.
    fn stress_of_modes(&mut self, loads: &GridLoads, work: &mut Work) -> Tensor;
}

/// Field of moments, which are the forces of its loads.
pub(crate) type MomentFarField = GridFarField<dyn MomentGrid>;

impl MomentFarField {
    /// Sets up the field of a plan of moments, on ranks that share the grid by `partition`.
    pub fn of_moments(plan: &Plan, partition: &Partition) -> Self {
        let own = plan.in_units(&plan.units());
        let grid: Box<dyn MomentGrid> = match plan.precision {
            Precision::Single => Box::new(PotentialGrid::<f32>::new(&own, partition)),
            Precision::Double => Box::new(PotentialGrid::<f64>::new(&own, partition)),
        };
        let near: Box<dyn DynPairCorrection> = Box::new(moment_correction(&own));
        Self::of_parts(plan, partition, grid, Some(near))
    }

    /// Fields of moments at the spheres, and their gradients if requested. Collective.
    pub fn fields(&mut self, moments: &[Vector], gradients: bool) -> Vec<(Vector, Tensor)> {
        let loads = Loads { forces: moments.to_vec(), ..Loads::default() };
        let fields = self.motions(&loads, None, if gradients { Output::All } else { Output::Velocities });
        let unit = self.units.force / self.units.length.powi(3);
        let of_gradient = unit / self.units.length;
        mapped(&fields, |&(field, gradient)| (field * unit, gradient * of_gradient))
    }

    /// Contributions of this rank's spheres to [`crate::DipoleField::first_moments`]: the part of the grid is divided
    /// equally among all spheres. Collective.
    pub fn first_moments(&mut self, moments: &[Vector]) -> Vec<Tensor> {
        let loads = Loads { forces: moments.to_vec(), ..Loads::default() };
        let kinds = self.kinds_of(&loads, &[]);
        let (present, _) = self.present(&loads, kinds);
        let owned = self.arrangement.halo.owned();
        let mut sums = [0.0; 10];
        sums[..9].copy_from_slice(&self.stress_on_grid(&present).to_cols_array());
        sums[9] = owned as f64;
        self.partition.comm().sum(&mut sums);
        let all: [f64; 9] = std::array::from_fn(|entry| sums[entry] / sums[9]);
        let mut tensors = vec![Tensor::from_cols_array(&all); owned];
        if let Some(near) = &self.near {
            let loaded = self.arrangement.loaded(&present, &[]);
            near.add_first_moments(&loaded, self.verlet_list.neighbours(), &mut tensors);
        }
        let unit = self.units.force.powi(2) / self.units.length.powi(3);
        change_rows(&mut tensors, |_, tensor| *tensor *= unit);
        tensors
    }

    /// Derivative of the energy of the moments on the grid with respect to a deformation, the contributions of this
    /// rank's share of the grid: in open space the first moments of the forces; in a periodic box the part of the
    /// modes, and that of the charges, whose distances change with the positions: with the field `H` on the grid, `H
    /// m`.
    fn stress_on_grid(&mut self, moments: &[Vector]) -> Tensor {
        let loads = self.arrangement.grid_loads(moments, &[]);
        let fields = self.grid.motions(&loads, Output::All, &mut self.work);
        let is_open = self.plan.boundaries == Boundaries::Open;
        let (cell, positions) = (&self.arrangement.cell, &self.arrangement.positions);
        // Forces add up to zero only within the tolerance.
        let middle = cell.origin() + cell.edges() * 0.5;
        let of_row = |row: usize| {
            let ((field, gradient), moment) = (fields[row], moments[row]);
            if is_open { outer(gradient * moment, middle - positions[row]) } else { outer(field, moment) }
        };
        let of_charges = (0..moments.len()).fold(Tensor::ZERO, |sum, row| sum + of_row(row));
        if is_open { of_charges } else { of_charges + self.grid.stress_of_modes(&loads, &mut self.work) }
    }
}

/// Pair correction of a plan of moments.
fn moment_correction(plan: &Plan) -> MomentCorrection {
    let width = plan.common().expect("moments have a Gaussian").width;
    MomentCorrection::new(&plan.radii, width, plan.cutoff(), plan.table_tolerance())
}

/// The tensor `a b`.
fn outer(a: Vector, b: Vector) -> Tensor {
    Tensor::from_cols(a * b.x, a * b.y, a * b.z)
}
