//! Square roots of mobilities, applied to random numbers of particles.

use crate::lanczos::{DrawDiagnostics, LanczosLimits, square_root_times};
use crate::mobility::loads::{Loads, Motion, Output};
use crate::mobility::noise::{self, NoiseRequest, ParticleComponents};
use crate::plan::Plan;
use crate::plan::problem::Multipoles;
use domain::{Comm, Units, Vector, sphere};
use std::convert::Infallible;

/// Largest number of iterations for a square root. The near field is well conditioned and takes ten or twenty, and so
/// does the whole mobility if there are not many spheres or walls absorb momentum.
pub(crate) const MOST_ITERATIONS: usize = 100;

/// Number of components of a motion with dipoles, and without.
const WITH_DIPOLES: usize = 11;
const WITHOUT: usize = 3;

/// Number of components of a motion.
fn components(multipoles: Multipoles) -> usize {
    if multipoles == Multipoles::Dipole { WITH_DIPOLES } else { WITHOUT }
}

/// Random numbers to which a square root is applied.
pub(crate) fn numbers(draw: &NoiseRequest, multipoles: Multipoles) -> Vec<ParticleComponents> {
    let of_particle = |&id: &u64| {
        let mut numbers = draw.stream.of_particle(id);
        numbers[components(multipoles)..].fill(0.0);
        numbers
    };
    draw.ids.iter().map(of_particle).collect()
}

/// Sum of random motions of particles by two parts, of which the second may be absent, from units of length and
/// viscosity: the variance of a velocity has the unit of the mobility.
pub(crate) fn sum_in_units(
    first: impl Iterator<Item = ParticleComponents>,
    second: &[ParticleComponents],
    multipoles: Multipoles,
    units: &Units,
) -> Motion {
    let sum = first.enumerate().map(|(row, mut sum)| {
        if let Some(other) = second.get(row) {
            sum.iter_mut().zip(other).for_each(|(sum, other)| *sum += other);
        }
        sum[components(multipoles)..].fill(0.0);
        sum
    });
    in_units(noise::motion(sum), multipoles, units)
}

/// Random motions from units of length and viscosity.
pub(crate) fn in_units(mut motion: Motion, multipoles: Multipoles, units: &Units) -> Motion {
    let [velocity, rate] = [units.length, units.length.powi(3)].map(|size| (size * units.viscosity).sqrt().recip());
    motion.velocities.iter_mut().for_each(|v| *v *= velocity);
    motion.angular_velocities.iter_mut().for_each(|w| *w *= rate);
    motion.strain_rates.iter_mut().for_each(|e| *e = *e * rate);
    motion.of(multipoles)
}

/// Square root of an operator from loads to motions, times the numbers of a draw. Collective.
pub(crate) fn root_by_loads(
    comm: &Comm,
    scales: &Scales,
    draw: &NoiseRequest,
    multipoles: Multipoles,
    mut apply: impl FnMut(&Loads) -> Motion,
) -> (Vec<ParticleComponents>, DrawDiagnostics) {
    let has_dipoles = multipoles == Multipoles::Dipole;
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
        Ok::<_, Infallible>(scales.divide(&of_motion(&apply(&loads), has_dipoles)))
    };
    let limits = LanczosLimits { tolerance: draw.tolerance, iterations: MOST_ITERATIONS };
    let Ok((root, drawn)) = square_root_times(comm, &numbers(draw, multipoles), limits, apply);
    (scales.times(&root), drawn)
}

/// Random motions, of particles of some classes of radius, by the square root of a whole mobility, which `apply` is.
/// Collective.
pub(crate) fn root_of_whole(
    comm: &Comm,
    plan: &Plan,
    classes: &[u32],
    draw: &NoiseRequest,
    mut apply: impl FnMut(&Loads, Output) -> Motion,
) -> (Motion, DrawDiagnostics) {
    let multipoles = plan.multipoles;
    let output = if multipoles == Multipoles::Dipole { Output::All } else { Output::Velocities };
    let scales = Scales::new(&plan.radii, plan.viscosity, classes);
    let (root, drawn) = root_by_loads(comm, &scales, draw, multipoles, |loads| apply(loads, output));
    (noise::motion(root.into_iter()).of(multipoles), drawn)
}

/// Components of a motion; those of gradients are zero without dipoles.
pub(crate) fn of_motion(motion: &Motion, has_dipoles: bool) -> Vec<ParticleComponents> {
    let components = |(row, velocity): (usize, &Vector)| {
        let mut components = [0.0; WITH_DIPOLES];
        components[..WITHOUT].copy_from_slice(&velocity.to_array());
        if has_dipoles {
            components[3..6].copy_from_slice(&motion.angular_velocities[row].to_array());
            components[6..].copy_from_slice(&noise::orthonormal(motion.strain_rates[row]));
        }
        components
    };
    motion.velocities.iter().enumerate().map(components).collect()
}

/// Square roots of the mobilities of single spheres for forces, torques and stresslets, by class of radius.
pub(crate) fn scales_of_classes(radii: &[f64], viscosity: f64) -> Vec<[f64; 3]> {
    let of_one = |&a: &f64| {
        let [force, torque, strain] =
            [sphere::drag(1.0, a), sphere::rotational_drag(1.0, a), sphere::strain_resistance(1.0, a)];
        [force, torque, strain].map(|resistance| (resistance * viscosity).sqrt().recip())
    };
    radii.iter().map(of_one).collect()
}

/// Square roots of the mobilities of single spheres, by which components are scaled to similar size.
pub(crate) struct Scales(Vec<[f64; 3]>);

impl Scales {
    /// For particles of some classes of radius.
    pub(crate) fn new(radii: &[f64], viscosity: f64, classes: &[u32]) -> Self {
        let of_classes = scales_of_classes(radii, viscosity);
        Self(classes.iter().map(|&class| of_classes[class as usize]).collect())
    }

    /// Products of components and scales.
    pub(crate) fn times(&self, list: &[ParticleComponents]) -> Vec<ParticleComponents> {
        self.scaled(list, |component, scale| component * scale)
    }

    /// Components over scales.
    pub(crate) fn divide(&self, list: &[ParticleComponents]) -> Vec<ParticleComponents> {
        self.scaled(list, |component, scale| component / scale)
    }

    fn scaled(&self, list: &[ParticleComponents], by: impl Fn(f64, f64) -> f64) -> Vec<ParticleComponents> {
        let scaled = |(components, scales): (&ParticleComponents, &[f64; 3])| {
            std::array::from_fn(|k| by(components[k], scales[[0, 0, 0, 1, 1, 1, 2, 2, 2, 2, 2][k]]))
        };
        list.iter().zip(&self.0).map(scaled).collect()
    }
}
