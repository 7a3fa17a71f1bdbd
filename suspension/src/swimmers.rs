//! Swimmers of a suspension: slip, intrinsic rotation, and random changes of direction.

use crate::model::box_axes::UserAxes;
use crate::model::{Model, Swimming};
use crate::rotation;
use domain::parallel::{change_rows, copied, of_rows};
use domain::{Particles, Quaternion, Random, Tensor, Traceless, Vector};
use hydrodynamics::Squirming;

/// Added to the seed for the random numbers of directions, which are independent of all others then.
const STREAM: u64 = 0x7475_6d62_6c65_7321;

/// Swimmers of a suspension.
pub struct Swimmers {
    /// Swimming of each species.
    species: Vec<Option<Swimming>>,
    viscosity: f64,
    /// Seed of the random directions.
    seed: u64,
    time_step: f64,
    axes: UserAxes,
}

impl Swimmers {
    /// The swimmers of a model, if it has some.
    pub fn of(model: &Model) -> Option<Self> {
        let swimmers = || Self {
            species: model.species.iter().map(|species| species.swimming.clone()).collect(),
            viscosity: model.viscosity,
            seed: model.seed.wrapping_add(STREAM),
            time_step: model.time_step,
            axes: model.user_axes(),
        };
        model.has_swimmers().then(swimmers)
    }

    fn of_species(&self, species: u32) -> Option<&Swimming> {
        self.species[species as usize].as_ref()
    }

    /// Whether spheres move fluid by their slip.
    pub fn have_slip(&self) -> bool {
        self.species.iter().flatten().any(Swimming::has_slip)
    }

    /// Slip modes of this rank's particles at their orientations.
    pub fn squirming(&self, particles: &Particles) -> Squirming {
        let orientations = rotation::known(particles);
        let first = |row: usize| {
            let swimming = self.of_species(particles.species[row]);
            swimming.map_or(Vector::ZERO, |swimming| swimming.first_mode() * orientations[row].axis())
        };
        let second = |row: usize| {
            let Some(swimming) = self.of_species(particles.species[row]) else { return Traceless::ZERO };
            nematic(orientations[row].axis()) * swimming.second_mode(particles.radii[row], self.viscosity)
        };
        Squirming { first: of_rows(particles.len(), first), second: of_rows(particles.len(), second) }
    }

    /// Stresslets of this rank's particles by their activity: those of each alone in unbounded fluid.
    pub fn active_stresslets(&self, particles: &Particles) -> Vec<Traceless> {
        self.squirming(particles).stresslets(self.viscosity, &particles.radii)
    }

    /// Adds the intrinsic angular velocities. A sphere that rotates without the surface that the fluid sees disturbs no
    /// fluid: this is exact, whatever is near the sphere.
    pub fn add_own_rotation(&self, particles: &Particles, angular_velocities: &mut [Vector]) {
        if self.species.iter().flatten().all(|swimming| swimming.angular_velocity == Vector::ZERO) {
            return;
        }
        let orientations = rotation::known(particles);
        change_rows(angular_velocities, |row, angular_velocity| {
            if let Some(swimming) = self.of_species(particles.species[row]) {
                *angular_velocity += orientations[row].rotate(swimming.angular_velocity);
            }
        });
    }

    /// Changes directions by the noise of a step, by random numbers of the step and of each sphere's id.
    pub fn reorient(&self, particles: &mut Particles, step: u64) {
        if !self.species.iter().flatten().any(Swimming::is_random) {
            return;
        }
        let of_step = Random::new(self.seed, step).bits();
        let (ids, kinds) = (copied(&particles.ids), copied(&particles.species));
        change_rows(rotation::orientations(particles), |row, orientation| {
            if let Some(swimming) = self.of_species(kinds[row]) {
                *orientation = self.reoriented(*orientation, swimming, Random::new(of_step, ids[row]));
            }
        });
    }

    /// An orientation after the noise of a step: any one with the probability `1 - exp(-rate dt)`, or otherwise rotated
    /// by a vector whose components have the variance `2 D dt`.
    fn reoriented(&self, before: Quaternion, swimming: &Swimming, mut random: Random) -> Quaternion {
        if random.uniform() < -(-swimming.tumbling_rate * self.time_step).exp_m1() {
            return self.axes.orientation_in(Quaternion::random(&mut random));
        }
        if swimming.rotational_diffusion == 0.0 {
            return before;
        }
        let ([x, y], [z, _]) = (random.normal(), random.normal());
        let deviation = (2.0 * swimming.rotational_diffusion * self.time_step).sqrt();
        (Quaternion::exp(self.axes.vector_in(Vector::new(x, y, z) * deviation)) * before).normalized()
    }
}

/// `p p - I/3`
fn nematic(p: Vector) -> Traceless {
    Traceless::part_of(&Tensor::from_cols(p * p.x, p * p.y, p * p.z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{ActiveDipole, Orientation, Parameters, Species};
    use domain::PeriodicBox;
    use std::f64::consts::PI;

    const COUNT: u64 = 20_000;
    const STEP: f64 = 0.05;

    fn swimmers(swimming: Swimming) -> Swimmers {
        let cell = PeriodicBox::new(Vector::splat(20.0)).unwrap();
        let species =
            Species { orientation: Some(Orientation::Random), swimming: Some(swimming), ..Species::new("one", 1.0, 1) };
        Swimmers::of(&Model::new(Parameters::new(cell, 0.7, vec![species], STEP, 1)).unwrap()).unwrap()
    }

    /// Mean of the cosine between axes at the start and after a number of steps.
    fn correlation(swimming: Swimming, steps: u64) -> f64 {
        let swimmers = swimmers(swimming);
        let mut particles = Particles::default();
        for id in 0..COUNT {
            particles.push(id, Vector::ZERO, 1.0, 0);
        }
        rotation::orientations(&mut particles).fill(Quaternion::between(Vector::Z, Vector::X));
        for step in 0..steps {
            swimmers.reorient(&mut particles, step);
        }
        rotation::known(&particles).iter().map(|q| q.axis().x).sum::<f64>() / COUNT as f64
    }

    /// Rotational diffusion gives `exp(-2 D t)` and tumbling `exp(-rate t)`, both together the product. A cosine
    /// scatters by 1 at most; a step of diffusion is wrong by the fraction `(2 D dt)^2 / 12` of the correlation.
    #[test]
    fn directions_are_lost_at_their_rates() {
        let error = 4.0 / (COUNT as f64).sqrt();
        for (diffusion, rate) in [(0.6, 0.0), (0.0, 0.8), (0.3, 0.5)] {
            let swimming = Swimming { rotational_diffusion: diffusion, tumbling_rate: rate, ..Swimming::new(1.0) };
            for steps in [1, 20] {
                let time = steps as f64 * STEP;
                let (found, expected) =
                    (correlation(swimming.clone(), steps), (-(2.0 * diffusion + rate) * time).exp());
                assert!((found - expected).abs() < error, "{diffusion} {rate} after {time}: {found}, not {expected}");
            }
        }
        assert!(correlation(Swimming::new(1.0), 20) > 1.0 - 1e-12, "without noise directions stay");
    }

    /// Random numbers belong to the step and the id: another order of the spheres, or other ranks, change nothing.
    #[test]
    fn noise_is_that_of_the_sphere() {
        let swimmers = swimmers(Swimming { rotational_diffusion: 0.6, tumbling_rate: 5.0, ..Swimming::new(1.0) });
        let of_ids = |ids: &[u64], step: u64| {
            let mut particles = Particles::default();
            for &id in ids {
                particles.push(id, Vector::ZERO, 1.0, 0);
            }
            rotation::orientations(&mut particles).fill(Quaternion::IDENTITY);
            swimmers.reorient(&mut particles, step);
            rotation::known(&particles).to_vec()
        };
        let all = of_ids(&[0, 1, 2, 3], 7);
        assert_eq!(of_ids(&[2, 0], 7), [all[2], all[0]]);
        assert!(all.iter().zip(of_ids(&[0, 1, 2, 3], 8)).all(|(one, other)| *one != other));
        assert!(all.windows(2).all(|two| two[0] != two[1]));
    }

    /// The modes of one of a speed 2/3 B1, and its stresslet by either key.
    #[test]
    fn modes_are_along_the_axis() {
        let (speed, stresslet, radius) = (0.8, -3.0, 1.3);
        let axis = Vector::new(1.0, -2.0, 2.0) / 3.0;
        let of = |dipole| {
            let swimmers = swimmers(Swimming { dipole, ..Swimming::new(speed) });
            let mut particles = Particles::default();
            particles.push(0, Vector::ZERO, radius, 0);
            rotation::orientations(&mut particles).fill(Quaternion::between(Vector::Z, axis));
            (swimmers.squirming(&particles), swimmers.active_stresslets(&particles)[0].tensor())
        };
        let (given, tensor) = of(ActiveDipole::Stresslet(stresslet));
        assert!((given.first[0] - axis * 1.5 * speed).length() < 1e-14);
        assert!((axis.dot(tensor * axis) - stresslet * 2.0 / 3.0).abs() < 1e-13);
        let ratio = stresslet / (4.0 * PI * 0.7 * radius * radius) / (1.5 * speed);
        let (by_ratio, _) = of(ActiveDipole::Ratio(ratio));
        let apart = (by_ratio.second[0] - given.second[0]).0.map(f64::abs);
        assert!(apart.iter().all(|part| *part < 1e-14), "{apart:?}");
    }
}
