//! The pairs that feel lubrication, and their resistance.

use super::screw::{Screw, Screws};
use super::stiffness::Stiffness;
use bytemuck::Pod;
use domain::{Halo, Pair, Pairs, Particles, Partition, PeriodicBox, Traceless, Vector};
use lubrication::{PairFactor, PairForce, PairLoads, PairMotion};
use rayon::prelude::*;
use std::ops::AddAssign;

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
    halo: Halo,
    /// The stiff ones come first.
    list: Vec<NearPair>,
    stiff: usize,
}

/// Pairs whose loads are computed before they are added up.
const BATCH: usize = 4096;

impl NearPairs {
    /// Finds the pairs within reach of lubrication. Collective.
    pub fn find(
        (force, stiffness): (&PairForce, &Stiffness),
        particles: &Particles,
        cell: &PeriodicBox,
        partition: &Partition,
    ) -> Self {
        let reach = force.reach();
        let halo = Halo::plan(partition, cell, &particles.positions, [reach; 2]);
        let class = |a: &f64| force.radii().partition_point(|radius| radius < a) as u32;
        let (mut positions, mut ids) = (particles.positions.clone(), particles.ids.clone());
        let mut classes: Vec<u32> = particles.radii.iter().map(class).collect();
        halo.extend(&mut positions);
        halo.extend(&mut ids);
        halo.extend(&mut classes);
        let pairs = Pairs::find(cell, &positions, &ids, particles.len(), reach);
        let species = |pair: &Pair| [classes[pair.i as usize], classes[pair.j as usize]];
        let kind = |pair: &Pair| {
            let gap = force.gap(pair.separation(cell, &positions).length(), species(pair))?;
            Some(stiffness.holds(species(pair), gap))
        };
        let kinds: Vec<Option<bool>> = pairs.list().par_iter().map(kind).collect();
        let kinds = kinds.as_slice();
        let of = |is_stiff| (0..kinds.len()).filter(move |&k| kinds[k] == Some(is_stiff));
        let mut order: Vec<usize> = of(true).collect();
        let stiff = order.len();
        order.extend(of(false));
        let near = |&k: &usize| {
            let pair = &pairs.list()[k];
            let factor = force.factor(pair.separation(cell, &positions), species(pair));
            NearPair { rows: [pair.i as usize, pair.j as usize], factor: factor.expect("a pair within the cutoff") }
        };
        let list = order.par_iter().map(near).collect();
        Self { halo, list, stiff }
    }

    /// The pairs.
    pub fn list(&self) -> &[NearPair] {
        &self.list
    }

    /// How many of them are stiff: the first ones.
    pub fn stiff(&self) -> usize {
        self.stiff
    }

    /// Who has images of whom.
    pub fn halo(&self) -> &Halo {
        &self.halo
    }

    /// `B^T` times motions relative to the ambient flow, whose rate of strain is `ambient`. Collective.
    pub fn modes(&self, motions: &Screws, ambient: Traceless) -> Vec<Modes> {
        let mut present = motions.0.clone();
        self.halo.extend(&mut present);
        self.list
            .par_iter()
            .map(|pair| pair.factor.modes(&motion(pair.rows.map(|row| present[row]), ambient)))
            .collect()
    }

    /// `B^T` times motions in an ambient flow without strain, of the first pairs. Collective.
    pub fn rigid_modes(&self, motions: &Screws, pairs: usize) -> Vec<Modes> {
        let mut present = motions.0.clone();
        self.halo.extend(&mut present);
        let modes = |pair: &NearPair| {
            let spheres = pair.rows.map(|row| present[row]);
            pair.factor.rigid_modes(spheres.map(Screw::linear), spheres.map(Screw::angular))
        };
        self.list[..pairs].par_iter().map(modes).collect()
    }

    /// Forces and torques of `B` times the amplitudes of the first pairs. Collective.
    pub fn loads(&self, modes: &[Modes]) -> Screws {
        Screws(self.summed(modes.len(), |i, pair| screws(pair.factor.rigid_loads(&modes[i]))))
    }

    /// Forces and torques of lubrication in a flow whose rate of strain is `ambient`, besides those of the modes.
    /// Collective.
    pub fn loads_in(&self, ambient: Traceless) -> Screws {
        let resting = motion([Screw::default(); 2], -ambient);
        let on = |_: usize, pair: &NearPair| {
            let PairLoads { force, torque, .. } = pair.factor.strain_loads(&resting);
            screws([force, torque])
        };
        Screws(self.summed(self.list.len(), on))
    }

    /// The stresslets that lubrication adds to those of the far field, for motions and their amplitudes `g`, which are
    /// minus `B^T` times them. Collective.
    pub fn stresslets(&self, motions: &Screws, ambient: Traceless, amplitudes: &[Modes]) -> Vec<Traceless> {
        let mut present = motions.0.clone();
        self.halo.extend(&mut present);
        let on = |i: usize, NearPair { rows, factor }: &NearPair| {
            let modes = amplitudes[i].map(|g| -g);
            factor.moments_on(&motion(rows.map(|row| present[row]), ambient), &modes).map(|moment| -moment)
        };
        self.summed(self.list.len(), on)
    }

    /// What the first pairs give their two particles, added up by particle in the order of the pairs.
    fn summed<T: Pod + AddAssign + Send>(
        &self,
        pairs: usize,
        of: impl Fn(usize, &NearPair) -> [T; 2] + Sync,
    ) -> Vec<T> {
        let mut sums = vec![T::zeroed(); self.halo.present()];
        let mut batch = Vec::with_capacity(BATCH.min(pairs));
        for (number, list) in self.list[..pairs].chunks(BATCH).enumerate() {
            list.par_iter().enumerate().map(|(i, pair)| of(number * BATCH + i, pair)).collect_into_vec(&mut batch);
            for (pair, both) in list.iter().zip(&batch) {
                for (row, &one) in pair.rows.into_iter().zip(both) {
                    sums[row] += one;
                }
            }
        }
        self.halo.collect(&mut sums);
        sums
    }
}

/// Forces and torques, by sphere.
fn screws([forces, torques]: [[Vector; 2]; 2]) -> [Screw; 2] {
    [0, 1].map(|sphere| Screw::new(forces[sphere], torques[sphere]))
}

/// The motion of two rigid spheres relative to a flow.
fn motion(spheres: [Screw; 2], ambient: Traceless) -> PairMotion {
    PairMotion {
        velocity: spheres.map(Screw::linear),
        angular_velocity: spheres.map(Screw::angular),
        strain_rate: [-ambient; 2],
    }
}
