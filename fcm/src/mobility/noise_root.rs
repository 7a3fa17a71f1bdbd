//! Square roots of mobilities, applied to random numbers of particles.

use crate::lanczos::{DrawDiagnostics, LanczosLimits, square_root_times};
use crate::mobility::loads::{Loads, Motion, Output};
use crate::mobility::noise::{self, NoiseRequest, ParticleComponents};
use crate::plan::Plan;
use crate::plan::problem::Multipoles;
use domain::parallel::{FusedLoops, mapped, of_rows};
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
    mapped(draw.ids, of_particle)
}

/// Sum of random motions of a number of particles by two parts, the first by a function of the row, of which the second
/// may be absent, from units of length and viscosity: the variance of a velocity has the unit of the mobility.
pub(crate) fn sum_in_units(
    count: usize,
    first: impl Fn(usize) -> ParticleComponents + Sync + Send,
    second: &[ParticleComponents],
    multipoles: Multipoles,
    units: &Units,
) -> Motion {
    let sum = of_rows(count, |row| {
        let mut sum = first(row);
        if let Some(other) = second.get(row) {
            sum.iter_mut().zip(other).for_each(|(sum, other)| *sum += other);
        }
        sum[components(multipoles)..].fill(0.0);
        sum
    });
    in_units(noise::motion(&sum), multipoles, units)
}

/// Factors of random velocities, and of angular velocities and rates of strain, from units of length and viscosity.
pub(crate) fn factors_of_units(units: &Units) -> [f64; 2] {
    [units.length, units.length.powi(3)].map(|size| (size * units.viscosity).sqrt().recip())
}

/// Random motions from units of length and viscosity.
pub(crate) fn in_units(mut motion: Motion, multipoles: Multipoles, units: &Units) -> Motion {
    let [velocity, rate] = factors_of_units(units);
    let Motion { velocities, angular_velocities, strain_rates } = &mut motion;
    let mut loops = FusedLoops::default();
    loops.change_rows(velocities, move |_, v| *v *= velocity);
    loops.change_rows(angular_velocities, move |_, w| *w *= rate);
    loops.change_rows(strain_rates, move |_, e| *e = *e * rate);
    loops.run();
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
        let found = apply(&scales.loads(scaled, has_dipoles));
        let components = of_motion(&found, has_dipoles);
        Ok::<_, Infallible>(of_rows(scaled.len(), |row| scales.divide(row, &components(row))))
    };
    let limits = LanczosLimits { tolerance: draw.tolerance, iterations: MOST_ITERATIONS };
    let Ok((root, drawn)) = square_root_times(comm, &numbers(draw, multipoles), limits, apply);
    (scales.all_times(&root), drawn)
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
    (noise::motion(&root).of(multipoles), drawn)
}

/// Components of a row of a motion; those of gradients are zero without dipoles.
pub(crate) fn of_motion(motion: &Motion, has_dipoles: bool) -> impl Fn(usize) -> ParticleComponents + Sync + Send {
    move |row| {
        let mut components = [0.0; WITH_DIPOLES];
        components[..WITHOUT].copy_from_slice(&motion.velocities[row].to_array());
        if has_dipoles {
            components[3..6].copy_from_slice(&motion.angular_velocities[row].to_array());
            components[6..].copy_from_slice(&noise::orthonormal(motion.strain_rates[row]));
        }
        components
    }
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
        Self(mapped(classes, |&class| of_classes[class as usize]))
    }

    /// Products of all components and scales.
    pub(crate) fn all_times(&self, list: &[ParticleComponents]) -> Vec<ParticleComponents> {
        of_rows(list.len(), |row| self.scaled(row, &list[row], |component, scale| component * scale))
    }

    /// Components of a row over its scales.
    pub(crate) fn divide(&self, row: usize, components: &ParticleComponents) -> ParticleComponents {
        self.scaled(row, components, |component, scale| component / scale)
    }

    /// Components over scales as loads, with torques and stresslets if there are dipoles.
    fn loads(&self, list: &[ParticleComponents], has_dipoles: bool) -> Loads {
        let (mut loads, mut loops) = (Loads::default(), FusedLoops::default());
        let (load, dipoles) = (|row: usize| self.divide(row, &list[row]), if has_dipoles { list.len() } else { 0 });
        loops.of_rows(&mut loads.forces, list.len(), move |row| Vector::from_slice(&load(row)));
        loops.of_rows(&mut loads.torques, dipoles, move |row| Vector::from_slice(&load(row)[3..]));
        loops.of_rows(&mut loads.stresslets, dipoles, move |row| {
            let [_, _, _, _, _, _, strain @ ..] = load(row);
            -noise::tensor(strain)
        });
        loops.run();
        loads
    }

    #[inline]
    fn scaled(&self, row: usize, components: &ParticleComponents, by: impl Fn(f64, f64) -> f64) -> ParticleComponents {
        let scales = self.0[row];
        std::array::from_fn(|k| by(components[k], scales[[0, 0, 0, 1, 1, 1, 2, 2, 2, 2, 2][k]]))
    }
}
