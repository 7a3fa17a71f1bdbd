//! The pairs that feel lubrication, and their resistance.

use crate::ambient::StrainRate;
use crate::pairs::assembly::{Arrangement, Assembled, Assembly};
use crate::pairs::lubrication::PairLubrication;
use crate::pairs::matrix::diagonal_block::Own;
use crate::pairs::matrix::lanes::Stored;
use crate::pairs::matrix::sparse::{Padded, PairMatrix, ROWS, Resistance};
use crate::pairs::walls::{self, AtWall};
use crate::six_vector::{Screw, Screws};
use crate::springs::Springs;
use domain::{Halo, LocalAndGhosts, Particles, Partition, PeriodicBox, Traceless, Vector, VerletList};
use fcm::Precision;
use lubrication::WallForce;
use rayon::prelude::*;

/// Forces between near particles, and the lists of who is near.
pub struct NearField {
    pub lubrication: Option<PairLubrication>,
    /// Lubrication at walls, if there are any.
    pub at_walls: Option<WallForce>,
    pub lists: VerletList,
    /// That in which the numbers of soft pairs are kept: the grid's.
    pub precision: Precision,
    /// Radii by species.
    pub radii: Vec<f64>,
    /// Largest distance of the centres of a near pair.
    pub reach: f64,
}

/// Motions that one thread copies at a time.
const BATCH: usize = 1024;

/// Particles of a rank and those of others that are near, in place.
pub struct Present {
    pub halo: Halo,
    pub positions: Vec<Vector>,
    pub ids: Vec<u64>,
    pub species: Vec<u32>,
}

impl NearField {
    /// All that are present, and their lists. Collective.
    pub fn present(&mut self, particles: &Particles, (cell, partition): (&PeriodicBox, &Partition)) -> Present {
        let halo = Halo::plan(partition, cell, &particles.positions, [self.reach; 2]);
        let class = |a: &f64| self.radii.partition_point(|radius| radius < a) as u32;
        let (mut positions, mut ids) = (particles.positions.clone(), particles.ids.clone());
        let mut species: Vec<u32> = particles.radii.iter().map(class).collect();
        halo.extend(&mut positions);
        halo.extend(&mut ids);
        halo.extend(&mut species);
        self.lists.update(cell, &LocalAndGhosts { owned: particles.len(), ids: &ids, positions: &positions });
        Present { halo, positions, ids, species }
    }
}

/// Which pairs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pairs {
    /// Stiff ones, and spheres at walls and in traps.
    Stiff,
    /// The others.
    Soft,
}

/// The resistance of the near pairs of the particles that a rank owns, with what is needed of ghosts.
pub struct NearPairs {
    halo: Halo,
    /// With what walls resist. In double precision: near contact, the resistances of both spheres all but cancel.
    stiff: PairMatrix<f64>,
    soft: Box<dyn Resistance>,
    at_walls: Vec<AtWall>,
    /// Loads and moments in the ambient flow of particles that do not move relative to it.
    loads: Screws,
    moments: Vec<Traceless>,
    /// Whether a particle is in a trap.
    has_traps: bool,
}

/// Stiff pairs, and the others.
struct Resisting {
    stiff: PairMatrix<f64>,
    soft: Box<dyn Resistance>,
}

impl Resisting {
    fn of<T: Stored + 'static>(parts: Vec<Assembled<T>>) -> Self {
        let (stiff, soft) = parts.into_iter().map(|part| (part.stiff, part.soft)).unzip();
        Self { stiff: PairMatrix::new(stiff), soft: Box::new(PairMatrix::new(soft)) }
    }
}

impl NearPairs {
    /// Finds the pairs within reach of lubrication or of springs, in a flow of a rate of strain, by lists that reach as far. Collective.
    pub fn find(
        (field, springs): (&mut NearField, Option<&Springs>),
        particles: &Particles,
        (cell, strain_rate): (&PeriodicBox, StrainRate),
        partition: &Partition,
    ) -> Self {
        let owned = particles.len();
        let Present { halo, positions, ids, species } = field.present(particles, (cell, partition));
        let NearField { lubrication, at_walls, lists, radii, .. } = &*field;
        let neighbours = lists.neighbours();
        let lubrication = lubrication.as_ref();
        let (positions, species) = (&positions, &species);
        let ids = &ids;
        let arrangement =
            Arrangement { lubrication, springs, radii, cell, positions, ids, species, neighbours, strain_rate };
        let (mut loads, mut moments) = (Screws::zero(owned), vec![Traceless::ZERO; owned]);
        let sums = (&mut loads.0[..], &mut moments[..]);
        let Resisting { mut stiff, soft } = match field.precision {
            Precision::Single => Resisting::of(Assembly::<f32>::of_all(&arrangement, sums)),
            Precision::Double => Resisting::of(Assembly::<f64>::of_all(&arrangement, sums)),
        };
        let at_walls = walls::find((at_walls.as_ref(), springs), particles, (cell, strain_rate));
        for at_wall in &at_walls {
            let (load, moment) = at_wall.in_flow;
            stiff.add_own(at_wall.row, &at_wall.own());
            loads.0[at_wall.row] += load;
            moments[at_wall.row] += moment;
        }
        let trap = |row: usize| Some((row, springs?.trap(row)?));
        let traps: Vec<(usize, f64)> = (0..owned).filter_map(trap).collect();
        for &(row, resistance) in &traps {
            stiff.add_own(row, &Own::against_velocity(resistance));
        }
        Self { halo, stiff, soft, at_walls, loads, moments, has_traps: !traps.is_empty() }
    }

    /// None, where nothing acts between near particles. Collective.
    pub fn none(particles: &Particles, cell: &PeriodicBox, partition: &Partition) -> Self {
        let halo = Halo::plan(partition, cell, &particles.positions, [0.0; 2]);
        let (loads, moments) = (Screws::zero(particles.len()), vec![Traceless::ZERO; particles.len()]);
        Self {
            halo,
            stiff: PairMatrix::new(Vec::new()),
            soft: Box::new(PairMatrix::<f64>::new(Vec::new())),
            at_walls: Vec::new(),
            loads,
            moments,
            has_traps: false,
        }
    }

    /// Whether no particle of this rank is near another or a wall, or in a trap.
    pub fn is_empty(&self) -> bool {
        self.stiff.is_empty() && self.soft.is_empty() && self.at_walls.is_empty() && !self.has_traps
    }

    /// What resists motions of stiff pairs, and of spheres at walls and in traps.
    pub fn stiff(&self) -> &PairMatrix<f64> {
        &self.stiff
    }

    /// What some pairs resist to the motions of the particles that this rank owns. Collective.
    pub fn times(&self, pairs: &[Pairs], motions: &Screws) -> Screws {
        self.times_and(pairs, motions, |_, _| 0.0).0
    }

    /// As [`Self::times`], changed then by a function of the first row and the loads of some rows, and the sum of what that
    /// is, the same on any number of threads. Collective.
    pub fn times_and(
        &self,
        pairs: &[Pairs],
        motions: &Screws,
        change: impl Fn(usize, &mut [Screw]) -> f64 + Sync,
    ) -> (Screws, f64) {
        let present = self.present(motions);
        let mut loads = Screws::zero(motions.0.len());
        let (stiff, soft) = (&self.stiff, &self.soft);
        let of_part = |(part, loads): (usize, &mut [Screw])| {
            for which in pairs {
                match which {
                    Pairs::Stiff => stiff.add_loads(part, &present, loads),
                    Pairs::Soft => soft.add_loads(part, &present, loads),
                }
            }
            change(part * ROWS, loads)
        };
        let sums: Vec<f64> = loads.0.par_chunks_mut(ROWS).enumerate().map(of_part).collect();
        (loads, sums.iter().sum())
    }

    /// Loads of lubrication on the fluid in the ambient flow, with the particles not moving relative to it.
    pub fn ambient_loads(&self) -> &Screws {
        &self.loads
    }

    /// The sum over this rank's spheres at walls of [`AtWall::lever`].
    pub fn levers(&self, passed: &Screws) -> Vector {
        self.at_walls.iter().map(|at_wall| at_wall.lever(passed)).sum()
    }

    /// The stresslets that lubrication adds to those of the far field for motions relative to the ambient flow.
    /// Collective.
    pub fn stresslets(&self, motions: &Screws) -> Vec<Traceless> {
        let present = self.present(motions);
        let mut by_motions = vec![Traceless::ZERO; self.moments.len()];
        self.stiff.add_moments(&present, &mut by_motions);
        self.soft.add_moments(&present, &mut by_motions);
        self.at_walls.iter().for_each(|at_wall| by_motions[at_wall.row] += at_wall.moment(motions));
        let moments = self.moments.par_iter().with_min_len(BATCH).zip(by_motions);
        moments.map(|(&by_strain, by_motion)| by_strain - by_motion).collect()
    }

    fn present(&self, motions: &Screws) -> Vec<Padded> {
        let mut present: Vec<Padded> = motions.0.par_iter().with_min_len(BATCH).map(Padded::from).collect();
        self.halo.extend(&mut present);
        present
    }
}
