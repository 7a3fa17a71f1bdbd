//! Fields and stresses of moments by the grid and pairs.

use super::GridFarField;
use crate::mobility::loads::{Loads, Output};
use domain::parallel::{change_rows, mapped};
use domain::{Tensor, Vector};

impl GridFarField {
    /// Fields of moments at the spheres, and their gradients if requested, for a plan of moments. Collective.
    pub(crate) fn fields(&mut self, moments: &[Vector], gradients: bool) -> Vec<(Vector, Tensor)> {
        let loads = Loads { forces: moments.to_vec(), ..Loads::default() };
        let fields = self.motions(&loads, None, if gradients { Output::All } else { Output::Velocities });
        let unit = self.units.force / self.units.length.powi(3);
        let of_gradient = unit / self.units.length;
        mapped(&fields, |&(field, gradient)| (field * unit, gradient * of_gradient))
    }

    /// Contributions of this rank's spheres to [`crate::DipoleField::first_moments`]: the part of the grid is divided
    /// equally among all spheres. Collective.
    pub(crate) fn first_moments(&mut self, moments: &[Vector]) -> Vec<Tensor> {
        let loads = Loads { forces: moments.to_vec(), ..Loads::default() };
        let kinds = self.kinds_of(&loads, &[]);
        let (present, _) = self.present(&loads, kinds);
        let grid_loads = self.arrangement.grid_loads(&present, &[]);
        let of_grid = self.grid.moment_stress(&grid_loads, &mut self.work);
        let owned = self.arrangement.halo.owned();
        let mut sums = [0.0; 10];
        sums[..9].copy_from_slice(&of_grid.to_cols_array());
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
}
