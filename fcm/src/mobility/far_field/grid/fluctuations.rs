//! Random motions whose covariance is the mobility.

use super::GridFarField;
use crate::lanczos::{DrawDiagnostics, LanczosLimits, square_root_times};
use crate::mobility::far_field::FarField;
use crate::mobility::loads::{Motion, Output, dipole};
use crate::mobility::noise::{self, NoiseRequest, ParticleComponents};
use crate::mobility::noise_root::{MOST_ITERATIONS, Scales, numbers, root_of_whole, sum_in_units};
use crate::plan::problem::Multipoles;
use domain::parallel::of_rows;
use domain::{Boundaries, Tensor, Vector};
use std::convert::Infallible;

impl GridFarField {
    /// Random motions as of [`FarField::noise`].
    ///
    /// In a box that is periodic along all axes the square root of the far field is taken mode by mode, see
    /// [`solver::Transform::noise`], and interpolation is the adjoint of spreading; the square root of the near
    /// field, if there is one, is applied by Lanczos' iteration, to a tolerance. In all other boxes Lanczos'
    /// iteration applies the square root of the whole mobility, with one evaluation per iteration.
    pub(super) fn random_motion(&mut self, draw: &NoiseRequest) -> (Motion, DrawDiagnostics) {
        let &NoiseRequest { ids, stream, .. } = draw;
        if self.plan.boundaries != Boundaries::Periodic {
            return self.whole_noise(draw);
        }
        let output = if self.has_dipoles() { Output::All } else { Output::Velocities };
        let mut far = self.grid.noise(&self.arrangement.classes, output, stream);
        self.arrangement.collect(&mut far);
        self.work.transforms += 1;
        let (near, drawn) = self.near_noise(draw);
        let of_field = |row: usize| noise::components(&far[row]);
        (sum_in_units(ids.len(), of_field, &near, self.plan.multipoles, &self.units), drawn)
    }

    /// Near-field part. Collective.
    fn near_noise(&mut self, draw: &NoiseRequest) -> (Vec<ParticleComponents>, DrawDiagnostics) {
        let ids = draw.ids;
        let Some(near) = &self.near else { return (Vec::new(), DrawDiagnostics::default()) };
        let (arrangement, neighbours) = (&self.arrangement, self.verlet_list.neighbours());
        let has_dipoles = self.has_dipoles();
        let own = self.plan.in_units(&self.units);
        let scales = Scales::new(&own.radii, own.viscosity, &arrangement.classes[..ids.len()]);
        let apply = |scaled: &[ParticleComponents]| {
            let load = |row: usize| scales.divide(row, &scaled[row]);
            let mut forces = of_rows(ids.len(), |row| Vector::from_slice(&load(row)));
            arrangement.halo.extend(&mut forces);
            let mut dipoles = Vec::new();
            if has_dipoles {
                dipoles = of_rows(ids.len(), |row| {
                    let [_, _, _, x, y, z, strain @ ..] = load(row);
                    dipole(-noise::tensor(strain), Vector::new(x, y, z))
                });
                arrangement.halo.extend(&mut dipoles);
            }
            let mut motions = of_rows(ids.len(), |_| (Vector::ZERO, Tensor::ZERO));
            near.add(&arrangement.loaded(&forces, &dipoles), neighbours, has_dipoles, &mut motions);
            Ok::<_, Infallible>(of_rows(ids.len(), |row| scales.divide(row, &noise::components(&motions[row]))))
        };
        let start = numbers(draw, self.plan.multipoles);
        let limits = LanczosLimits { tolerance: draw.tolerance, iterations: MOST_ITERATIONS };
        let Ok((root, drawn)) = square_root_times(self.partition.comm(), &start, limits, apply);
        self.work.neighbours += (neighbours.count() * drawn.iterations) as u64;
        (scales.all_times(&root), drawn)
    }

    /// Random motions by the square root of the whole mobility. Collective.
    fn whole_noise(&mut self, draw: &NoiseRequest) -> (Motion, DrawDiagnostics) {
        let (comm, plan) = (self.partition.comm().clone(), self.plan.clone());
        let classes = self.arrangement.classes[..draw.ids.len()].to_vec();
        root_of_whole(&comm, &plan, &classes, draw, |loads, output| self.apply(loads, output))
    }

    fn has_dipoles(&self) -> bool {
        self.plan.multipoles == Multipoles::Dipole
    }
}
