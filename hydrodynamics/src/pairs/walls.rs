//! Near-field resistance of spheres at walls.

use crate::ambient::StrainRate;
use crate::pairs::matrix::diagonal_block::DiagonalBlock;
use crate::six_vector::{SixVector, SixVectors};
use crate::springs::Springs;
use domain::parallel::{MeasuredLoop, concat};
use domain::{Particles, PeriodicBox, ToWall, Traceless, Vector};
use fcm::WALL_NUMBERS;
use lubrication::{PairKind, SphereLoads, SurfaceSlip, WallCoefficients, WallForce};
use rayon::prelude::*;

/// A sphere near a wall. Its resistance is like that of a pair one of which is at rest relative to the flow.
#[derive(Debug, Clone, Copy)]
pub struct AtWall {
    /// Row of the sphere.
    pub row: usize,
    /// Unit vector towards the wall, and distance of the centre from it.
    axis: Vector,
    distance: f64,
    resistance: WallCoefficients,
    /// Load and first moment by lubrication on a sphere that moves with the ambient flow at its centre.
    pub in_flow: (SixVector, Traceless),
}

/// Spheres that one thread compares with the walls at a time.
const BATCH: usize = 1024;

/// The spheres of a rank within the range of lubrication or springs at walls, by rows, in an ambient flow with a strain
/// rate.
pub fn find(
    lubrication: Option<&WallForce>,
    springs: Option<&Springs>,
    particles: &Particles,
    cell: &PeriodicBox,
    strain_rate: StrainRate,
) -> Vec<AtWall> {
    let of_row = |row: usize| {
        let (place, radius) = (particles.positions[row], particles.radii[row]);
        let at_wall = move |to: ToWall| {
            let lubricated = lubrication.and_then(|force| force.factor(to.axis, to.distance, radius));
            let mut resistance = lubricated.map(|factor| factor.coefficients()).unwrap_or_default();
            let in_flow = in_flow(&resistance, place, to, strain_rate);
            let held = springs.map_or([0.0; 3], |springs| springs.at_wall(row, to.wall, to.distance, radius));
            add_springs(&mut resistance, held, to.distance, radius);
            let acts = lubricated.is_some() || held[0] > 0.0;
            acts.then_some(AtWall { row, axis: to.axis, distance: to.distance, resistance, in_flow })
        };
        cell.to_walls(place).filter_map(at_wall)
    };
    let count = if cell.boundaries().walls() == 0 { 0 } else { particles.len() };
    let of_batch = |batch: usize| (batch * BATCH..count.min((batch + 1) * BATCH)).flat_map(of_row).collect();
    concat((0..count.div_ceil(BATCH)).into_par_iter().map(of_batch).measured().collect())
}

/// Adds the loads of spheres at walls on the fluid by their own slip, by rows.
pub fn add_slip_loads(
    loads: &mut [SphereLoads],
    at_walls: &[AtWall],
    force: &WallForce,
    radius: impl Fn(usize) -> f64,
    slips: &[SurfaceSlip],
) {
    let lubrication = force.slip();
    for &AtWall { row, axis, distance, .. } in at_walls {
        // Springs reach farther than lubrication.
        if let Some(by_slip) = lubrication.loads(axis, distance, radius(row), &slips[row]) {
            loads[row] = loads[row] + by_slip;
        }
    }
}

/// Load and first moment on a sphere that moves with the velocity of a parabolic flow at its centre. The reference is
/// the linear flow that has the same strain rate there and vanishes at the wall, as the parabolic flow does. The linear
/// flow that agrees in velocity at the centre would slip at the wall by `distance^2 u'' / 2`, and the resistance to
/// that slip diverges as the gap closes.
fn in_flow(
    resistance: &WallCoefficients,
    place: Vector,
    to: ToWall,
    strain_rate: StrainRate,
) -> (SixVector, Traceless) {
    let strained = resistance.by_strain(to.axis, strain_rate.at(place.z));
    let beyond = strain_rate.half_curvature() * -to.distance.powi(2);
    let passed = resistance.by_motion(to.axis, [beyond, Vector::ZERO]);
    let load = SixVector::new(strained.force - passed.force, strained.torque - passed.torque);
    (load, strained.moment - passed.moment)
}

/// Adds the resistances of springs along the axis, to slip and to rolling. With the slip velocity
/// `v = U_across + distance Omega x z`, the rate of work is `slip v^2 + rolling |2 a Omega x z|^2`.
fn add_springs(resistance: &mut WallCoefficients, [along, slip, rolling]: [f64; 3], distance: f64, radius: f64) {
    resistance.xa += along;
    resistance.ya += slip;
    resistance.yb += slip * distance;
    resistance.yc += slip * distance * distance + rolling * PairKind::Wall(radius).harmonic_radius().powi(2);
}

impl AtWall {
    /// Contribution to the diagonal block of the row.
    pub fn own(&self) -> DiagonalBlock<f64> {
        let (z, r) = (self.axis.to_array(), &self.resistance);
        let tensor = |along: f64, across: f64| {
            [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|(i, j)| {
                let unit = if i == j { across } else { 0.0 };
                unit + (along - across) * z[i] * z[j]
            })
        };
        DiagonalBlock {
            force: tensor(r.xa, r.ya),
            torque: tensor(r.xc, r.yc),
            coupling: z.map(|component| r.yb * component),
        }
    }

    /// Lubrication force on a sphere that moves with `passed` relative to the flow, times the squared distance from the
    /// wall. Valid without springs.
    pub fn lever(&self, passed: &SixVectors) -> Vector {
        let motion = passed.0[self.row];
        let by_motion = self.resistance.by_motion(self.axis, [motion.linear(), motion.angular()]).force;
        (by_motion + self.in_flow.0.linear()) * self.distance.powi(2)
    }

    /// Numbers of [`Self::moment`] as [`fcm::PairRows::at_walls`] has them.
    pub fn moment_numbers(&self) -> [f64; WALL_NUMBERS] {
        let WallCoefficients { xg, yg, yh, .. } = self.resistance;
        [xg * self.axis.z, yg * self.axis.z, yh]
    }

    /// First moment due to the motions.
    pub fn moment(&self, motions: &SixVectors) -> Traceless {
        let motion = motions.0[self.row];
        self.resistance.by_motion(self.axis, [motion.linear(), motion.angular()]).moment
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ambient::Poiseuille;
    use crate::springs::ContactSprings;
    use crate::springs::TetherResistance;
    use domain::Boundaries;
    use lubrication::LubricationRange;

    fn cell() -> PeriodicBox {
        PeriodicBox::new(Vector::new(10.0, 10.0, 6.0)).unwrap().with_boundaries(Boundaries::Walls).unwrap()
    }

    fn spheres() -> Particles {
        let mut particles = Particles::default();
        for (id, (z, radius)) in [(1.001, 1.0), (3.0, 1.0), (4.55, 1.4)].into_iter().enumerate() {
            particles.push(id as u64, Vector::new(2.0 + 3.0 * id as f64, 5.0, z), radius, 0);
        }
        particles
    }

    /// The diagonal block is the lubrication resistance at the wall.
    #[test]
    fn the_block_of_a_row_is_the_resistance_of_its_walls() {
        let force = WallForce::new(1.0, LubricationRange::default());
        let found = find(Some(&force), None, &spheres(), &cell(), StrainRate::default());
        assert_eq!(found.iter().map(|at| (at.row, at.axis.z)).collect::<Vec<_>>(), [(0, -1.0), (2, 1.0)]);
        for at in &found {
            let motion = [Vector::new(0.3, -0.2, 0.9), Vector::new(-0.4, 0.8, 0.1)];
            let expected = at.resistance.by_motion(at.axis, motion);
            let loads = at.own().times(motion.map(|v| v.to_array()));
            let wanted = SixVector::new(expected.force, expected.torque).0;
            assert!(loads.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-12 * wanted[2].abs()), "{loads:?}");
        }
    }

    /// The numbers of first moments give the moments by any motion.
    #[test]
    fn numbers_give_the_first_moment() {
        let force = WallForce::new(1.0, LubricationRange::default());
        let (velocity, turning) = (Vector::new(0.3, -0.2, 0.9), Vector::new(-0.4, 0.8, 0.1));
        let motions = SixVectors(vec![SixVector::new(velocity, turning); 3]);
        let found = find(Some(&force), None, &spheres(), &cell(), StrainRate::default());
        assert_eq!(found.len(), 2);
        for at in &found {
            let [x, y, h] = at.moment_numbers();
            let (xx, xz, yz) = (-x * velocity.z, y * velocity.x + h * turning.y, y * velocity.y - h * turning.x);
            let expected = at.moment(&motions).0;
            let difference = [xx, 0.0, xz, xx, yz].into_iter().zip(expected).map(|(a, b)| (a - b).abs());
            assert!(difference.fold(0.0, f64::max) < 1e-13 * expected[2].abs(), "{:?} {expected:?}", [xx, xz, yz]);
        }
    }

    /// The load on a sphere held at a wall of a curved flow hardly changes as the gap closes: there is no slip at the
    /// wall, at the lower or the upper one.
    #[test]
    fn a_held_sphere_does_not_slip_in_a_curved_flow() {
        let (force, height) = (WallForce::new(1.0, LubricationRange::default()), 6.0);
        let flow = Poiseuille { curvature: 0.3, height };
        for is_upper in [false, true] {
            let load = |gap: f64| {
                let z = if is_upper { height - 1.0 - gap } else { 1.0 + gap };
                let mut particles = Particles::default();
                particles.push(0, Vector::new(5.0, 5.0, z), 1.0, 0);
                let found = find(Some(&force), None, &particles, &cell(), flow.strain_rate());
                let held = [-flow.velocity(z), -flow.angular_velocity(z)];
                let by_motion = found[0].own().times(held.map(|v| v.to_array()));
                found[0].in_flow.0.0[0] - by_motion[0]
            };
            let [far, near, nearest] = [1e-3, 1e-5, 1e-6].map(load);
            // Increase of the resistance to slip at unit velocity per factor of e in the gap.
            let of_slip = 8.0 / 15.0 * 6.0 * std::f64::consts::PI;
            assert!((near - far).abs() < 0.01 * of_slip * 100.0_f64.ln(), "{far} {near}");
            assert!((nearest - near).abs() < 0.01 * of_slip * 10.0_f64.ln(), "{near} {nearest}");
        }
    }

    /// A sphere that rolls on a wall without slip meets no resistance of the tangential spring.
    #[test]
    fn springs_resist_slip_rolling_and_approach() {
        let contact =
            |other| ContactSprings { other, within: f64::INFINITY, normal: 3.0, tangential: 5.0, rolling: 0.0 };
        let contacts = [vec![contact(ContactSprings::wall(0))], vec![], vec![]].into_iter().collect();
        let tethers = TetherResistance::default();
        let springs = Springs { resistance: &|_, _| 2.0, contacts: &contacts, tethers: &tethers };
        let found = find(None, Some(&springs), &spheres(), &cell(), StrainRate::default());
        let at = found.iter().find(|at| at.row == 0 && at.axis.z < 0.0).unwrap();
        let force = |velocity: Vector, turning: Vector| at.own().times([velocity.to_array(), turning.to_array()]);
        let along = [force(Vector::Z, Vector::ZERO)[2], force(Vector::X, Vector::ZERO)[0]];
        assert!(along.iter().all(|force| (force - 5.0).abs() < 1e-14), "{along:?}");
        // The lowest point of a sphere that rotates about y moves along -x.
        let rolls = force(Vector::X * 1.001, Vector::Y);
        assert!(rolls.iter().all(|load| load.abs() < 1e-14), "{rolls:?}");
    }
}
