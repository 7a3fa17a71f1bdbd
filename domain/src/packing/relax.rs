//! Removal of overlaps by minimisation of the elastic energy.

use crate::{Pairs, PeriodicBox, Vector};

/// Iterations before the minimisation gives up.
const STEPS: usize = 20_000;
/// Skin of the pair list over the largest diameter.
const SKIN: f64 = 0.2;

/// Moves the spheres until none overlaps: minimises the energy `sum (contact - r)^2 / 2` of spheres enlarged by the
/// factor `1 + margin` until every overlap is below that margin, by the fast inertial relaxation engine (Bitzek et
/// al., Phys. Rev. Lett. 97, 170201, 2006). `None` if it does not converge.
pub(super) fn relax(cell: &PeriodicBox, sizes: &[f64], margin: f64, positions: &mut [Vector]) -> Option<()> {
    let ids: Vec<u64> = (0..sizes.len() as u64).collect();
    let diameter = 2.0 * sizes.iter().copied().fold(0.0, f64::max) * (1.0 + margin);
    let find = |positions: &[Vector]| Pairs::find(cell, positions, &ids, ids.len(), diameter * (1.0 + SKIN));
    let enlarged = Enlarged { cell, sizes, margin };
    let mut pairs = find(positions);
    let mut seen = positions.to_vec();
    let mut descent = Descent::new(sizes.len());
    for _ in 0..STEPS {
        if seen.iter().zip(&*positions).any(|(a, b)| a.distance(*b) > 0.5 * SKIN * diameter) {
            wrap(cell, positions);
            pairs = find(positions);
            seen.copy_from_slice(positions);
        }
        let worst = enlarged.push_apart(&pairs, positions, &mut descent.forces);
        if worst < 0.5 * margin {
            wrap(cell, positions);
            return Some(());
        }
        descent.step(positions, 0.1 * diameter);
    }
    None
}

fn wrap(cell: &PeriodicBox, positions: &mut [Vector]) {
    for position in positions {
        *position = cell.wrap(*position).0;
    }
}

/// Spheres in a box, enlarged by the factor `1 + margin`.
struct Enlarged<'a> {
    cell: &'a PeriodicBox,
    sizes: &'a [f64],
    margin: f64,
}

impl Enlarged<'_> {
    /// Forces of the overlapping pairs, in their order; returns the largest overlap over the distance at contact.
    fn push_apart(&self, pairs: &Pairs, positions: &[Vector], forces: &mut [Vector]) -> f64 {
        let &Self { cell, sizes, margin } = self;
        forces.fill(Vector::ZERO);
        let mut worst = 0.0_f64;
        for pair in pairs.list() {
            let (i, j) = (pair.i as usize, pair.j as usize);
            let contact = (sizes[i] + sizes[j]) * (1.0 + margin);
            let separation = pair.separation(cell, positions);
            let distance = separation.length();
            if distance < contact {
                let push = separation * ((contact - distance) / distance.max(1e-3 * contact));
                forces[j] += push;
                forces[i] -= push;
                worst = worst.max(1.0 - distance / contact);
            }
        }
        for (i, &place) in positions.iter().enumerate() {
            let contact = sizes[i] * (1.0 + margin);
            for to in cell.to_walls(place).filter(|to| to.distance < contact) {
                forces[i] -= to.axis * (contact - to.distance);
                worst = worst.max(1.0 - to.distance / contact);
            }
        }
        worst
    }
}

/// State of the minimisation: Newtonian motion with unit masses, steered along the force and stopped when the energy
/// rises.
struct Descent {
    forces: Vec<Vector>,
    velocities: Vec<Vector>,
    dt: f64,
    steering: f64,
    downhill: usize,
}

impl Descent {
    /// For unit stiffness and mass a pair's period is `pi sqrt(2)`; a dozen neighbours shorten it by `sqrt(12)`.
    const LARGEST_DT: f64 = 0.5;

    fn new(count: usize) -> Self {
        let zero = vec![Vector::ZERO; count];
        Self { forces: zero.clone(), velocities: zero, dt: 0.1, steering: 0.1, downhill: 0 }
    }

    fn step(&mut self, positions: &mut [Vector], longest: f64) {
        let power: f64 = self.forces.iter().zip(&self.velocities).map(|(f, v)| f.dot(*v)).sum();
        if power > 0.0 {
            self.downhill += 1;
            if self.downhill > 5 {
                self.dt = (1.1 * self.dt).min(Self::LARGEST_DT);
                self.steering *= 0.99;
            }
        } else {
            self.velocities.fill(Vector::ZERO);
            (self.dt, self.steering, self.downhill) = (0.5 * self.dt.max(0.02), 0.1, 0);
        }
        let norm = |list: &[Vector]| list.iter().map(|v| v.length_squared()).sum::<f64>().sqrt();
        let ratio = norm(&self.velocities) / norm(&self.forces).max(f64::MIN_POSITIVE);
        for ((position, velocity), force) in positions.iter_mut().zip(&mut self.velocities).zip(&self.forces) {
            *velocity = *velocity * (1.0 - self.steering) + *force * (self.steering * ratio + self.dt);
            *position += (*velocity * self.dt).clamp_length_max(longest);
        }
    }
}
