//! Rigid bodies of a mobility's spheres.

use super::columns::fill;
use super::{Mobility, MobilityError};
use crate::bodies::{GivenMotion, RigidBodies};
use domain::{Comm, Particles, Vector};
use fcm::{Loads, Motion};

/// Bodies to which spheres belong, and where they are placed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BodySpheres {
    /// Number of the body of each sphere; empty without bodies.
    of: Vec<Option<u32>>,
    /// Number of bodies.
    count: usize,
    /// Positions of the spheres minus the mean of those of their body.
    arms: Vec<Vector>,
    /// Given components of the motions of the bodies, on the first rank.
    given: Vec<GivenMotion>,
    /// Whether any component is given, on all ranks.
    has_given: bool,
}

/// Names of the columns with the body, its number plus one, the arm, and the motion of the body.
const BODY: &str = "body";
const ARM: &str = "arm";
const VELOCITY: &str = "body velocity";
const ANGULAR_VELOCITY: &str = "body angular velocity";

/// Column of the six components of the given motion of a sphere's body; those that are free are not numbers.
const GIVEN: &str = "given motion of the body";

/// Columns of the loads that given motions take.
const DRIVING: [&str; 2] = ["driving force", "driving torque"];

impl Mobility {
    /// Joins spheres into rigid bodies with these numbers, from 0, `None` for a free sphere; for rigid spheres with
    /// dipoles. The centre of a body is the mean of the centres of its spheres. Their positions are given next to each
    /// other, even if some are outside the box.
    pub fn join(&mut self, bodies: Vec<Option<u32>>) {
        self.bodies = BodySpheres::new(bodies);
    }

    /// Sets components of the motions of the bodies in later evaluations of [`Self::apply`], an entry for each body on
    /// the first rank, or none with an empty list. They are relative to the background flow at the centres.
    /// [`super::Motions::driving`] has the loads that they take. Collective.
    ///
    /// # Errors
    /// If there is another number of bodies.
    pub fn move_bodies(&mut self, given: &[GivenMotion]) -> Result<(), MobilityError> {
        let count = self.bodies.count;
        if ![0, count].contains(&given.len()) {
            return Err(MobilityError::GivenMotions { found: given.len(), count });
        }
        let turn = self.turn;
        let turned = |motion: &GivenMotion| GivenMotion {
            velocity: turn.components(motion.velocity),
            angular_velocity: turn.components(motion.angular_velocity),
        };
        self.bodies.given = given.iter().map(turned).collect();
        self.bodies.has_given = self.partition.comm().any(given.iter().any(|motion| !motion.is_none()));
        Ok(())
    }
}

impl BodySpheres {
    /// Bodies of spheres with these numbers, `None` for free spheres.
    pub fn new(of: Vec<Option<u32>>) -> Self {
        let count = of.iter().flatten().max().map_or(0, |&last| last as usize + 1);
        Self { of: if count == 0 { Vec::new() } else { of }, count, ..Self::default() }
    }

    /// Whether there are any bodies.
    pub fn is_any(&self) -> bool {
        self.count > 0
    }

    /// Whether two spheres are parts of one body.
    pub fn are_of_one(&self, [first, second]: [u32; 2]) -> bool {
        let of = |sphere: u32| self.of.get(sphere as usize).copied().flatten();
        of(first).is_some() && of(first) == of(second)
    }

    /// Places the spheres at positions that are not wrapped into a box.
    pub fn place(&mut self, positions: &[Vector]) {
        let mut sums = vec![(Vector::ZERO, 0.0); self.count];
        for (&position, &body) in positions.iter().zip(&self.of) {
            if let Some(body) = body {
                let (sum, count) = &mut sums[body as usize];
                *sum += position;
                *count += 1.0;
            }
        }
        let arm = |(&position, &body): (&Vector, &Option<u32>)| {
            body.map_or(Vector::ZERO, |body| position - sums[body as usize].0 / sums[body as usize].1)
        };
        self.arms = positions.iter().zip(&self.of).map(arm).collect();
    }

    /// Writes the bodies and the arms into columns of the particles, which are in the order of the spheres.
    pub fn store(&self, particles: &mut Particles) {
        if self.is_any() {
            let number = |body: &Option<u32>| body.map_or(0.0, |body| f64::from(body) + 1.0);
            let numbers: Vec<f64> = self.of.iter().map(number).collect();
            fill(&mut particles.column(BODY, 1).values, &numbers);
            fill(particles.vectors(ARM), &self.arms);
        }
        if self.has_given {
            let of_body = |body: u32| self.given.get(body as usize).copied().unwrap_or_default();
            let of_sphere = |body: &Option<u32>| body.map(of_body).unwrap_or_default().components();
            let rows: Vec<_> =
                self.of.iter().map(|body| of_sphere(body).map(|given| given.unwrap_or(f64::NAN))).collect();
            fill(&mut particles.column(GIVEN, 6).values, rows.as_flattened());
        }
    }

    /// The bodies of a rank's particles, from their columns; `None` without bodies. Collective.
    pub fn load(&self, particles: &mut Particles, comm: &Comm) -> Option<RigidBodies> {
        self.is_any().then(|| {
            let number = |&value: &f64| (value > 0.0).then(|| value as u32 - 1);
            let bodies: Vec<Option<u32>> = particles.column(BODY, 1).values.iter().map(number).collect();
            RigidBodies::new(comm, &bodies, particles.vectors(ARM))
        })
    }

    /// The same with the given components of their motions. Collective.
    pub fn load_moved(&self, particles: &mut Particles, comm: &Comm) -> Option<RigidBodies> {
        let bodies = self.load(particles, comm)?;
        if !self.has_given {
            return Some(bodies);
        }
        let rows = particles.rows::<6>(GIVEN).unwrap_or_default();
        let given = |place: usize| {
            let known = rows[bodies.members().rows(place)[0] as usize];
            Some(GivenMotion::of_components(known.map(|value| (!value.is_nan()).then_some(value))))
        };
        let given = (0..bodies.numbers().len()).map(given).collect();
        Some(bodies.with_given_motions(given))
    }

    /// Writes the loads that given motions take into columns of the members of bodies. Collective.
    pub fn record_driving(&self, particles: &mut Particles, bodies: &RigidBodies, constraint: &Loads) {
        if self.has_given {
            let Loads { forces, torques, .. } = bodies.total_loads(constraint);
            DRIVING.into_iter().zip([forces, torques]).for_each(|(name, list)| record(particles, bodies, name, &list));
        }
    }

    /// The motions of the bodies from columns of all particles in the order of the spheres.
    pub fn motions(&self, all: &mut Particles) -> Motion {
        let [velocities, angular_velocities] = [VELOCITY, ANGULAR_VELOCITY].map(|name| self.of_bodies(all, name));
        Motion { velocities, angular_velocities, strain_rates: Vec::new() }
    }

    /// The loads that given motions take, in the same way; empty if none is given.
    pub fn driving(&self, all: &mut Particles) -> Loads {
        if !self.has_given {
            return Loads::default();
        }
        let [forces, torques] = DRIVING.map(|name| self.of_bodies(all, name));
        Loads { forces, torques, stresslets: Vec::new() }
    }

    /// Vectors of the bodies from a column of all particles in the order of the spheres.
    fn of_bodies(&self, all: &mut Particles, name: &str) -> Vec<Vector> {
        let mut found = vec![Vector::ZERO; self.count];
        for (&value, body) in all.vectors(name).iter().zip(&self.of) {
            if let Some(body) = *body {
                found[body as usize] = value;
            }
        }
        found
    }
}

/// Writes the motions of the bodies into columns of their members.
pub fn record_bodies(particles: &mut Particles, bodies: &RigidBodies, motions: &Motion) {
    record(particles, bodies, VELOCITY, &motions.velocities);
    record(particles, bodies, ANGULAR_VELOCITY, &motions.angular_velocities);
}

/// Writes vectors of the bodies into a column of their members.
fn record(particles: &mut Particles, bodies: &RigidBodies, name: &str, of_bodies: &[Vector]) {
    let of_row = |row: usize| bodies.members().place(row).map_or(Vector::ZERO, |place| of_bodies[place]);
    let values: Vec<Vector> = (0..particles.len()).map(of_row).collect();
    fill(particles.vectors(name), &values);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MobilityParameters, Motions};
    use domain::{AxisRotation, Bytes, PeriodicBox, Tensor};
    use lubrication::LubricationRange;
    use solver::BackgroundFlow;

    const NUMBERS: [Option<u32>; 6] = [Some(0), Some(0), Some(1), None, Some(1), Some(2)];

    /// Two doublets, one of which reaches beyond the box, a single sphere as a body, and a free sphere.
    fn mobility(comm: &Comm) -> Mobility {
        let cell = PeriodicBox::new(Vector::splat(12.0)).unwrap();
        let lubrication = Some(LubricationRange::new(2.5, LubricationRange::MINIMUM_GAP).unwrap());
        let radii = vec![1.0, 0.8, 1.0, 1.0, 1.0, 1.0];
        let parameters =
            MobilityParameters { tolerance: 1e-8, lubrication, ..MobilityParameters::new(cell, 1.0, radii) };
        let made = Mobility::new(parameters, Bytes::default(), comm).unwrap();
        let mut made = made.turned(AxisRotation::to_last(1));
        made.join(NUMBERS.to_vec());
        let at =
            [[2.0, 2.0, 2.0], [3.9, 2.0, 2.0], [7.0, 11.5, 6.0], [5.0, 8.0, 3.0], [7.0, 13.5, 6.3], [4.0, 4.3, 2.5]];
        made.place(&if comm.is_first() { at.map(Vector::from_array).to_vec() } else { Vec::new() }).unwrap();
        made
    }

    fn shear() -> BackgroundFlow {
        BackgroundFlow::with_gradient(Tensor::from_cols(Vector::ZERO, Vector::X * 0.3, Vector::ZERO)).unwrap()
    }

    fn loads() -> Loads {
        let force = |k: usize| Vector::new(1.0, 0.5 * k as f64, -0.3 * (k * k) as f64);
        Loads {
            forces: (0..6).map(force).collect(),
            torques: (0..6).map(|k| force(5 - k) * 0.5).collect(),
            stresslets: Vec::new(),
        }
    }

    /// The given motions of bodies with these motions, without some components.
    fn given(bodies: &Motion, is_free: impl Fn(usize, usize) -> bool) -> Vec<GivenMotion> {
        let of_body = |body: usize| {
            let [v, w] = [bodies.velocities[body].to_array(), bodies.angular_velocities[body].to_array()];
            let component = |k: usize| [v, w].as_flattened()[k];
            GivenMotion::of_components(std::array::from_fn(|k| (!is_free(body, k)).then(|| component(k))))
        };
        (0..bodies.velocities.len()).map(of_body).collect()
    }

    fn distance(a: &[Vector], b: &[Vector]) -> f64 {
        assert_eq!(a.len(), b.len());
        a.iter().zip(b).map(|(a, b)| (*a - *b).length()).fold(0.0, f64::max)
    }

    /// Loads on bodies that give them motions are the loads that these motions take where they are given.
    #[test]
    fn given_motions_take_the_loads_that_cause_them() {
        let mut made = mobility(&Comm::alone());
        let applied = loads();
        let moved = made.apply(&applied, &shear()).unwrap();
        assert!(moved.driving.forces.is_empty());
        made.move_bodies(&given(&moved.bodies, |body, k| (body, k) == (1, 2))).unwrap();
        let on_free = Loads {
            forces: std::array::from_fn::<_, 6, _>(|k| applied.forces[k] * f64::from(NUMBERS[k].is_none())).to_vec(),
            torques: std::array::from_fn::<_, 6, _>(|k| applied.torques[k] * f64::from(NUMBERS[k].is_none())).to_vec(),
            stresslets: Vec::new(),
        };
        let mut along_free = on_free.clone();
        along_free.forces[2].z = applied.forces[2].z + applied.forces[4].z;
        // The load along the free component acts at the centre.
        let arm = Vector::new(0.0, -1.0, -0.15);
        along_free.torques[2] -= arm.cross(Vector::Z * along_free.forces[2].z);
        let driven = made.apply(&along_free, &shear()).unwrap();
        assert!(distance(&driven.bodies.velocities, &moved.bodies.velocities) < 1e-3);
        assert!(distance(&driven.motion.velocities, &moved.motion.velocities) < 1e-3);
        let centres: Vec<Vector> = (0..3).map(|body| centre(&made, body)).collect();
        for body in 0..3 {
            let its = (0..6).filter(|&k| NUMBERS[k] == Some(body as u32));
            let [mut force, mut torque] = [Vector::ZERO; 2];
            for k in its {
                force += applied.forces[k];
                torque += applied.torques[k] + made.turn.inverse().vector(made.bodies.arms[k]).cross(applied.forces[k]);
            }
            if body == 1 {
                force.z = 0.0;
            }
            let found = [driven.driving.forces[body], driven.driving.torques[body]];
            let worst = (found[0] - force).length().max((found[1] - torque).length());
            assert!(worst < 2e-3 * force.length(), "{body} at {}: {found:?}, not {force} {torque}", centres[body]);
        }
        made.move_bodies(&[]).unwrap();
        assert_eq!(made.apply(&applied, &shear()).unwrap(), moved);
        assert!(made.move_bodies(&[GivenMotion::default()]).is_err());
    }

    fn centre(made: &Mobility, body: u32) -> Vector {
        let first = NUMBERS.iter().position(|&number| number == Some(body)).unwrap();
        made.turn.inverse().vector(made.positions[first] - made.bodies.arms[first])
    }

    fn driven_on(ranks: usize) -> Motions {
        let all = Comm::threads(ranks, |comm| {
            let mut made = mobility(&comm);
            let motion = Motion {
                velocities: vec![Vector::X, Vector::Y, Vector::ZERO],
                angular_velocities: vec![Vector::ZERO, Vector::Z, Vector::X],
                strain_rates: Vec::new(),
            };
            let mut list = given(&motion, |body, k| body == k);
            if !comm.is_first() {
                list.clear();
            }
            made.move_bodies(&list).unwrap();
            made.apply(&if comm.is_first() { loads() } else { Loads::default() }, &shear()).unwrap()
        });
        all.into_iter().next().unwrap()
    }

    #[test]
    fn given_motions_are_the_same_on_any_ranks() {
        let one = driven_on(1);
        for ranks in [2, 3, 7] {
            let some = driven_on(ranks);
            let forces = distance(&one.driving.forces, &some.driving.forces);
            let torques = distance(&one.driving.torques, &some.driving.torques);
            let velocities = distance(&one.motion.velocities, &some.motion.velocities);
            assert!(forces.max(torques).max(velocities) < 1e-8, "{ranks} ranks: {forces:e} {torques:e} {velocities:e}");
        }
    }
}
