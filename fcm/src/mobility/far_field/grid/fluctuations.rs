//! Random motions whose covariance is the mobility.

use super::GridFarField;
use crate::mobility::far_field::{FarField, NoiseRequest};
use crate::mobility::loads::{Loads, Motion, Output, dipole};
use crate::mobility::noise::{self, DrawDiagnostics, LanczosLimits, ParticleComponents, Stream, square_root_times};
use crate::plan::problem::Multipoles;
use domain::{Boundaries, Tensor, Vector, sphere};
use std::convert::Infallible;

/// Largest number of iterations for a square root. The near field is well conditioned and takes ten or twenty, and so
/// does the whole mobility if there are not many spheres or walls absorb momentum.
const MOST_ITERATIONS: usize = 100;

/// Number of components of a motion with dipoles, and without.
const WITH_DIPOLES: usize = 11;
const WITHOUT: usize = 3;

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
        let kept = self.components();
        let sum = far[..ids.len()].iter().enumerate().map(|(row, motion)| {
            let mut sum = noise::components(motion);
            if let Some(near) = near.get(row) {
                sum.iter_mut().zip(near).for_each(|(sum, near)| *sum += near);
            }
            sum[kept..].fill(0.0);
            sum
        });
        let mut motion = noise::motion(sum);
        // The variance of a velocity has the unit of the mobility.
        let [velocity, rate] =
            [self.units.length, self.units.length.powi(3)].map(|size| (size * self.units.viscosity).sqrt().recip());
        motion.velocities.iter_mut().for_each(|v| *v *= velocity);
        motion.angular_velocities.iter_mut().for_each(|w| *w *= rate);
        motion.strain_rates.iter_mut().for_each(|e| *e = *e * rate);
        (motion.of(self.plan.multipoles), drawn)
    }

    /// Near-field part. Collective.
    fn near_noise(&mut self, draw: &NoiseRequest) -> (Vec<ParticleComponents>, DrawDiagnostics) {
        let &NoiseRequest { ids, tolerance, stream } = draw;
        let Some(near) = &self.near else { return (Vec::new(), DrawDiagnostics::default()) };
        let (arrangement, neighbours) = (&self.arrangement, self.verlet_list.neighbours());
        let has_dipoles = self.has_dipoles();
        let own = self.plan.in_units(&self.units);
        let scales = Scales::new(&own.radii, own.viscosity, &arrangement.classes[..ids.len()]);
        let apply = |scaled: &[ParticleComponents]| {
            let loads = scales.divide(scaled);
            let mut forces: Vec<Vector> = loads.iter().map(|c| Vector::from_slice(c)).collect();
            arrangement.halo.extend(&mut forces);
            let mut dipoles = Vec::new();
            if has_dipoles {
                dipoles = loads
                    .iter()
                    .map(|&[_, _, _, x, y, z, d @ ..]| dipole(-noise::tensor(d), Vector::new(x, y, z)))
                    .collect();
                arrangement.halo.extend(&mut dipoles);
            }
            let mut motions = vec![(Vector::ZERO, Tensor::ZERO); ids.len()];
            near.add(&arrangement.loaded(&forces, &dipoles), neighbours, has_dipoles, &mut motions);
            Ok::<_, Infallible>(scales.divide(&motions.iter().map(noise::components).collect::<Vec<_>>()))
        };
        let start = self.start(ids, stream);
        let limits = LanczosLimits { tolerance, iterations: MOST_ITERATIONS };
        let Ok((root, drawn)) = square_root_times(self.partition.comm(), &start, limits, apply);
        self.work.neighbours += (neighbours.count() * drawn.iterations) as u64;
        (scales.times(&root), drawn)
    }

    /// Random motions by the square root of the whole mobility. Collective.
    fn whole_noise(&mut self, draw: &NoiseRequest) -> (Motion, DrawDiagnostics) {
        let &NoiseRequest { ids, tolerance, stream } = draw;
        let (comm, has_dipoles) = (self.partition.comm().clone(), self.has_dipoles());
        let scales = Scales::new(&self.plan.radii, self.plan.viscosity, &self.arrangement.classes[..ids.len()]);
        let output = if has_dipoles { Output::All } else { Output::Velocities };
        let start = self.start(ids, stream);
        let apply = |scaled: &[ParticleComponents]| {
            let mut loads = Loads::default();
            for components in scales.divide(scaled) {
                loads.forces.push(Vector::from_slice(&components));
                if has_dipoles {
                    let [_, _, _, x, y, z, d @ ..] = components;
                    loads.torques.push(Vector::new(x, y, z));
                    loads.stresslets.push(-noise::tensor(d));
                }
            }
            let motion = self.apply(&loads, output);
            let components = (0..ids.len()).map(|row| {
                let mut components = [0.0; WITH_DIPOLES];
                components[..WITHOUT].copy_from_slice(&motion.velocities[row].to_array());
                if has_dipoles {
                    components[3..6].copy_from_slice(&motion.angular_velocities[row].to_array());
                    components[6..].copy_from_slice(&noise::orthonormal(motion.strain_rates[row]));
                }
                components
            });
            Ok::<_, Infallible>(scales.divide(&components.collect::<Vec<_>>()))
        };
        let limits = LanczosLimits { tolerance, iterations: MOST_ITERATIONS };
        let Ok((root, drawn)) = square_root_times(&comm, &start, limits, apply);
        (noise::motion(scales.times(&root).into_iter()).of(self.plan.multipoles), drawn)
    }

    fn has_dipoles(&self) -> bool {
        self.plan.multipoles == Multipoles::Dipole
    }

    /// Number of components of a motion.
    fn components(&self) -> usize {
        if self.has_dipoles() { WITH_DIPOLES } else { WITHOUT }
    }

    /// Random numbers to which a square root is applied.
    fn start(&self, ids: &[u64], stream: Stream) -> Vec<ParticleComponents> {
        let kept = self.components();
        let numbers = |&id: &u64| {
            let mut numbers = stream.of_particle(id);
            numbers[kept..].fill(0.0);
            numbers
        };
        ids.iter().map(numbers).collect()
    }
}

/// Square roots of the mobilities of single spheres, by which components are scaled to similar size.
struct Scales(Vec<[f64; 3]>);

impl Scales {
    fn new(radii: &[f64], viscosity: f64, classes: &[u32]) -> Self {
        let of_one = |&class: &u32| {
            let a = radii[class as usize];
            let [force, torque, strain] =
                [sphere::drag(1.0, a), sphere::rotational_drag(1.0, a), sphere::strain_resistance(1.0, a)];
            [force, torque, strain].map(|resistance| (resistance * viscosity).sqrt().recip())
        };
        Self(classes.iter().map(of_one).collect())
    }

    fn times(&self, list: &[ParticleComponents]) -> Vec<ParticleComponents> {
        self.scaled(list, |component, scale| component * scale)
    }

    fn divide(&self, list: &[ParticleComponents]) -> Vec<ParticleComponents> {
        self.scaled(list, |component, scale| component / scale)
    }

    fn scaled(&self, list: &[ParticleComponents], by: impl Fn(f64, f64) -> f64) -> Vec<ParticleComponents> {
        let scaled = |(components, scales): (&ParticleComponents, &[f64; 3])| {
            std::array::from_fn(|k| by(components[k], scales[[0, 0, 0, 1, 1, 1, 2, 2, 2, 2, 2][k]]))
        };
        list.iter().zip(&self.0).map(scaled).collect()
    }
}
