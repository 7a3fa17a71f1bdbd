//! Random spheres that are displaced slightly from evaluation to evaluation.

use super::BenchmarkError;
use domain::{
    Bytes, Comm, MemoryNeed, Particles, Partition, PeriodicBox, Process, Random, Traceless, Vector, packing_bytes,
    random_packing, sphere,
};
use fcm::Loads;
use serde::Serialize;

/// Loads that are applied, and motions that are evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BenchmarkKind {
    /// Forces, torques and stresslets; velocities, angular velocities and strain rates.
    All,
    /// Forces; velocities.
    Forces,
    /// Stresslets; angular velocities and strain rates.
    Stresslets,
}

/// A benchmark case.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct BenchmarkCase {
    /// Number of spheres.
    pub particles: usize,
    /// Volume fraction of the spheres.
    pub volume_fraction: f64,
    /// Radius of every second sphere over that of the others.
    pub size_ratio: f64,
}

/// The same spheres on every rank.
pub struct Spheres {
    /// Periodic box.
    pub cell: PeriodicBox,
    /// Radii, alternately 1 and the size ratio.
    pub radii: Vec<f64>,
    positions: Vec<Vector>,
}

const SEED: u64 = 1;

impl Spheres {
    /// Places the spheres of a case without overlap. Collective.
    pub fn random(case: &BenchmarkCase, comm: &Comm) -> Result<Self, BenchmarkError> {
        let count = case.particles as f64;
        let placing =
            Bytes::list::<(Vector, [f64; 4])>(2.0 * count).then(packing_bytes(count, case.volume_fraction > 0.25));
        let need = MemoryNeed {
            resident: Process::of(comm.rank(), comm.size()).resident(placing.most),
            ..MemoryNeed::default()
        };
        comm.agree(
            comm.check_memory(need).map_err(|error| format!("{error}; take fewer than {count:.1e} --particles")),
        )?;
        let radii: Vec<f64> = (0..case.particles).map(|i| if i % 2 == 0 { 1.0 } else { case.size_ratio }).collect();
        let volume: f64 = radii.iter().map(|a| sphere::volume(*a)).sum();
        let cell = PeriodicBox::new(Vector::splat((volume / case.volume_fraction).cbrt()))?;
        let placed = if comm.is_first() { random_packing(&cell, &radii, 0.0, SEED) } else { Ok(Vec::new()) };
        let mut positions = comm.agree(placed).map_err(BenchmarkError::Placing)?;
        comm.broadcast(&mut positions);
        Ok(Self { cell, radii, positions })
    }

    /// This rank's particles after a small random displacement of each, different for each `turn`.
    pub fn displaced(&self, turn: u32, partition: &Partition) -> Particles {
        let mut particles = Particles::default();
        for (id, &position) in self.positions.iter().enumerate() {
            let step = Random::new(SEED + 1 + u64::from(turn), id as u64).point() - Vector::splat(0.5);
            let (place, _) = self.cell.wrap(position + 0.1 * step);
            if partition.owner(&self.cell, place) == partition.comm().rank() {
                particles.push(id as u64, place, self.radii[id], 0);
            }
        }
        particles.migrate(partition, &self.cell);
        particles
    }
}

/// Random loads of a kind, keyed by the particles' ids: forces scale as `a`, torques and stresslets as `a^2`.
pub fn loads(particles: &Particles, kind: BenchmarkKind) -> Loads {
    let mut loads = Loads::default();
    for (&id, &radius) in particles.ids.iter().zip(&particles.radii) {
        // Independent of the random positions: forces that all point away from a corner would hardly move anything.
        let mut random = Random::new(!SEED, id);
        let mut vector = |scale: f64| (random.point() - Vector::splat(0.5)) * scale;
        let (force, torque) = (vector(radius), vector(radius * radius));
        let (p, q) = (vector(radius * radius), vector(radius * radius));
        if kind != BenchmarkKind::Stresslets {
            loads.forces.push(force);
        }
        if kind == BenchmarkKind::All {
            loads.torques.push(torque);
        }
        if kind != BenchmarkKind::Forces {
            loads.stresslets.push(Traceless([p.x, p.y, p.z, q.x, q.y]));
        }
    }
    loads
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loads_of_a_larger_sphere_are_larger() {
        let of_radius = |radius: f64| {
            let mut particles = Particles::default();
            particles.push(7, Vector::ZERO, radius, 0);
            loads(&particles, BenchmarkKind::All)
        };
        let (one, two) = (of_radius(1.0), of_radius(2.0));
        assert!(one.forces[0] != Vector::ZERO && one.torques[0] != Vector::ZERO);
        assert_eq!((two.forces[0], two.torques[0]), (2.0 * one.forces[0], 4.0 * one.torques[0]));
        assert_eq!(two.stresslets[0], one.stresslets[0] * 4.0);
    }
}
