//! The pairs that feel lubrication, and their resistance.

use super::screw::{Screw, Screws};
use domain::{Exchange, Pairs, Particles, Partition, PeriodicBox, Traceless, Vector};
use lubrication::{PairFactor, PairForce, PairLoads, PairMotion};
use rayon::prelude::*;

/// Amplitudes of the modes of one pair.
pub type Modes = [f64; PairFactor::MODES];

/// A pair and its resistance.
pub struct NearPair {
    /// Rows of the two particles among those present.
    pub rows: [usize; 2],
    /// Its part of `B`, and what comes besides.
    pub factor: PairFactor,
}

/// The pairs that this rank keeps, with what is needed of images that other ranks own.
pub struct NearPairs {
    exchange: Exchange,
    list: Vec<NearPair>,
}

impl NearPairs {
    /// Finds the pairs within reach of lubrication between particles whose radii are among `radii`, in ascending order.
    /// Collective.
    pub fn find(
        force: &PairForce,
        radii: &[f64],
        particles: &Particles,
        cell: &PeriodicBox,
        partition: &Partition,
    ) -> Self {
        let reach = force.reach();
        let exchange = Exchange::plan(partition, cell, &particles.positions, [reach; 2]);
        let class = |a: &f64| radii.partition_point(|radius| radius < a) as u32;
        let (mut positions, mut ids) = (particles.positions.clone(), particles.ids.clone());
        let mut classes: Vec<u32> = particles.radii.iter().map(class).collect();
        exchange.extend(&mut positions);
        exchange.extend(&mut ids);
        exchange.extend(&mut classes);
        let pairs = Pairs::find(cell, &positions, &ids, particles.len(), reach);
        let near = pairs.list().par_iter().filter_map(|pair| {
            let rows = [pair.i as usize, pair.j as usize];
            let factor = force.factor(pair.separation(cell, &positions), rows.map(|row| classes[row]))?;
            Some(NearPair { rows, factor })
        });
        let list = near.collect();
        Self { exchange, list }
    }

    /// The pairs.
    pub fn list(&self) -> &[NearPair] {
        &self.list
    }

    /// Who has images of whom.
    pub fn exchange(&self) -> &Exchange {
        &self.exchange
    }

    /// `B^T` times motions relative to the ambient flow, whose rate of strain is `ambient`. Collective.
    pub fn modes(&self, motions: &Screws, ambient: Traceless) -> Vec<Modes> {
        let mut present = motions.0.clone();
        self.exchange.extend(&mut present);
        self.list
            .par_iter()
            .map(|pair| pair.factor.modes(&motion(pair.rows.map(|row| present[row]), ambient)))
            .collect()
    }

    /// `B^T` times motions in an ambient flow without strain. Collective.
    pub fn rigid_modes(&self, motions: &Screws) -> Vec<Modes> {
        let mut present = motions.0.clone();
        self.exchange.extend(&mut present);
        let modes = |pair: &NearPair| {
            let spheres = pair.rows.map(|row| present[row]);
            pair.factor.rigid_modes(spheres.map(Screw::linear), spheres.map(Screw::angular))
        };
        self.list.par_iter().map(modes).collect()
    }

    /// Forces and torques of `B` times amplitudes. Collective.
    pub fn loads(&self, modes: &[Modes]) -> Screws {
        let loads: Vec<_> =
            self.list.par_iter().zip(modes).map(|(pair, modes)| pair.factor.rigid_loads(modes)).collect();
        self.summed(&loads)
    }

    /// Forces and torques of lubrication in a flow whose rate of strain is `ambient`, besides those of the modes. Collective.
    pub fn loads_in(&self, ambient: Traceless) -> Screws {
        let resting = motion([Screw::default(); 2], ambient);
        let on = |pair: &NearPair| {
            let PairLoads { force, torque, .. } = pair.factor.strain_loads(&resting);
            [force, torque]
        };
        let loads: Vec<_> = self.list.par_iter().map(on).collect();
        let mut sums = self.summed(&loads);
        sums.0.iter_mut().for_each(|sum| *sum = -*sum);
        sums
    }

    /// The stresslets that lubrication adds to those of the far field. Collective.
    pub fn stresslets(&self, motions: &Screws, ambient: Traceless) -> Vec<Traceless> {
        let mut present = motions.0.clone();
        self.exchange.extend(&mut present);
        let moments =
            |pair: &NearPair| pair.factor.resistance(&motion(pair.rows.map(|row| present[row]), ambient)).moment;
        let moments: Vec<_> = self.list.par_iter().map(moments).collect();
        let mut sums = vec![Traceless::ZERO; self.exchange.present()];
        for (pair, moments) in self.list.iter().zip(&moments) {
            for (row, &moment) in pair.rows.into_iter().zip(moments) {
                sums[row] += -moment;
            }
        }
        self.exchange.collect(&mut sums);
        sums
    }

    /// Forces and torques of all pairs, by particle.
    fn summed(&self, loads: &[[[Vector; 2]; 2]]) -> Screws {
        let mut sums = vec![Screw::default(); self.exchange.present()];
        for (pair, [forces, torques]) in self.list.iter().zip(loads) {
            for (k, row) in pair.rows.into_iter().enumerate() {
                sums[row] += Screw::new(forces[k], torques[k]);
            }
        }
        self.exchange.collect(&mut sums);
        Screws(sums)
    }
}

/// The motion of two rigid spheres relative to a flow.
fn motion(spheres: [Screw; 2], ambient: Traceless) -> PairMotion {
    PairMotion {
        velocity: spheres.map(Screw::linear),
        angular_velocity: spheres.map(Screw::angular),
        strain_rate: [-ambient; 2],
    }
}
