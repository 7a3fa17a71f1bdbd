//! Near pairs and their resistance.

use crate::ambient::StrainRate;
use crate::pairs::assembly::{Assembled, Assembly, PairArrangement};
use crate::pairs::lubrication::PairLubrication;
use crate::pairs::matrix::diagonal_block::DiagonalBlock;
use crate::pairs::matrix::lanes::StoredLanes;
use crate::pairs::matrix::sparse::{Padded, PairMatrix, ROWS, Resistance};
use crate::pairs::walls::{self, AtWall};
use crate::six_vector::{SixVector, SixVectors};
use crate::springs::Springs;
use domain::parallel::{MeasuredLoop, stage};
use domain::{DomainView, Halo, LocalAndGhosts, Particles, Partition, PeriodicBox, Traceless, Vector, VerletList};
use fcm::Precision;
use lubrication::WallForce;
use rayon::prelude::*;

/// Short-range interactions and the neighbour lists for them.
pub struct NearField {
    pub lubrication: Option<PairLubrication>,
    /// Lubrication at walls, if there are any.
    pub at_walls: Option<WallForce>,
    pub lists: VerletList,
    /// Precision in which soft pairs are stored: that of the grid.
    pub precision: Precision,
    /// Radii by species.
    pub radii: Vec<f64>,
    /// Largest centre distance of a near pair.
    pub reach: f64,
}

/// Number of motions that one thread copies at a time.
const BATCH: usize = 1024;

/// A rank's particles and the ghosts in their reach.
pub struct Present {
    pub halo: Halo,
    pub positions: Vec<Vector>,
    pub ids: Vec<u64>,
    pub species: Vec<u32>,
}

impl NearField {
    /// Collects particles and ghosts, and updates the neighbour lists. Collective.
    pub fn present(&mut self, particles: &Particles, view: DomainView) -> Present {
        let _stage = stage("lists of near pairs");
        let DomainView { cell, partition } = view;
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

/// Selection of near pairs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pairs {
    /// Stiff pairs, and spheres at walls and in traps.
    Stiff,
    /// Soft pairs.
    Soft,
}

/// Resistance of the near pairs of a rank's particles, with the halo for their ghosts.
pub struct NearPairs {
    halo: Halo,
    /// Includes the resistance of walls. In double precision: near contact, the resistances of both spheres almost
    /// cancel.
    stiff: PairMatrix<f64>,
    soft: Box<dyn Resistance>,
    at_walls: Vec<AtWall>,
    /// Loads and first moments in the ambient flow on particles at rest relative to it.
    loads: SixVectors,
    moments: Vec<Traceless>,
    /// Whether any particle is in a trap.
    has_traps: bool,
}

/// Resistance matrices of stiff and of soft pairs.
struct Resisting {
    stiff: PairMatrix<f64>,
    soft: Box<dyn Resistance>,
}

impl Resisting {
    fn of<T: StoredLanes + 'static>(parts: Vec<Assembled<T>>) -> Self {
        let (stiff, soft) = parts.into_iter().map(|part| (part.stiff, part.soft)).unzip();
        Self { stiff: PairMatrix::new(stiff), soft: Box::new(PairMatrix::new(soft)) }
    }
}

impl NearPairs {
    /// Finds the pairs within the range of lubrication or springs, in a flow with a strain rate. Collective.
    pub fn find(
        field: &mut NearField,
        springs: Option<&Springs>,
        particles: &Particles,
        view: DomainView,
        strain_rate: StrainRate,
    ) -> Self {
        let _stage = stage("assembly of near pairs");
        let cell = view.cell;
        let owned = particles.len();
        let Present { halo, positions, ids, species } = field.present(particles, view);
        let NearField { lubrication, at_walls, lists, radii, .. } = &*field;
        let neighbours = lists.neighbours();
        let lubrication = lubrication.as_ref();
        let (positions, species) = (&positions, &species);
        let ids = &ids;
        let arrangement =
            PairArrangement { lubrication, springs, radii, cell, positions, ids, species, neighbours, strain_rate };
        let (mut loads, mut moments) = (SixVectors::zero(owned), vec![Traceless::ZERO; owned]);
        let Resisting { mut stiff, soft } = match field.precision {
            Precision::Single => Resisting::of(Assembly::<f32>::of_all(&arrangement, &mut loads.0, &mut moments)),
            Precision::Double => Resisting::of(Assembly::<f64>::of_all(&arrangement, &mut loads.0, &mut moments)),
        };
        let at_walls = walls::find(at_walls.as_ref(), springs, particles, cell, strain_rate);
        for at_wall in &at_walls {
            let (load, moment) = at_wall.in_flow;
            stiff.add_own(at_wall.row, &at_wall.own());
            loads.0[at_wall.row] += load;
            moments[at_wall.row] += moment;
        }
        let trap = |row: usize| Some((row, springs?.trap(row)?));
        let traps: Vec<(usize, f64)> = (0..owned).filter_map(trap).collect();
        for &(row, resistance) in &traps {
            stiff.add_own(row, &DiagonalBlock::against_velocity(resistance));
        }
        Self { halo, stiff, soft, at_walls, loads, moments, has_traps: !traps.is_empty() }
    }

    /// No near pairs, for systems without short-range interactions. Collective.
    pub fn none(particles: &Particles, cell: &PeriodicBox, partition: &Partition) -> Self {
        let halo = Halo::plan(partition, cell, &particles.positions, [0.0; 2]);
        let (loads, moments) = (SixVectors::zero(particles.len()), vec![Traceless::ZERO; particles.len()]);
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

    /// Resistance matrix of stiff pairs, walls and traps.
    pub fn stiff(&self) -> &PairMatrix<f64> {
        &self.stiff
    }

    /// Loads of a selection of pairs in the motions of this rank's particles. Collective.
    pub fn times(&self, pairs: &[Pairs], motions: &SixVectors) -> SixVectors {
        self.times_and(pairs, motions, |_, _| 0.0).0
    }

    /// [`Self::times`] followed by a function that changes the loads of a block of rows, given its first row. Also
    /// returns the sum of the function's values, the same on any number of threads. Collective.
    pub fn times_and(
        &self,
        pairs: &[Pairs],
        motions: &SixVectors,
        change: impl Fn(usize, &mut [SixVector]) -> f64 + Sync,
    ) -> (SixVectors, f64) {
        let present = self.present(motions);
        let mut loads = SixVectors::zero(motions.0.len());
        let (stiff, soft) = (&self.stiff, &self.soft);
        let of_part = |(part, loads): (usize, &mut [SixVector])| {
            for which in pairs {
                match which {
                    Pairs::Stiff => stiff.add_loads(part, &present, loads),
                    Pairs::Soft => soft.add_loads(part, &present, loads),
                }
            }
            change(part * ROWS, loads)
        };
        let sums: Vec<f64> = loads.0.par_chunks_mut(ROWS).enumerate().map(of_part).measured().collect();
        (loads, sums.iter().sum())
    }

    /// Lubrication loads in the ambient flow on particles at rest relative to it.
    pub fn ambient_loads(&self) -> &SixVectors {
        &self.loads
    }

    /// Sum of [`AtWall::lever`] over this rank's spheres at walls.
    pub fn levers(&self, passed: &SixVectors) -> Vector {
        self.at_walls.iter().map(|at_wall| at_wall.lever(passed)).sum()
    }

    /// Near-field stresslets of motions relative to the ambient flow, to be added to those of the far field.
    /// Collective.
    pub fn stresslets(&self, motions: &SixVectors) -> Vec<Traceless> {
        let present = self.present(motions);
        let mut by_motions = vec![Traceless::ZERO; self.moments.len()];
        self.stiff.add_moments(&present, &mut by_motions);
        self.soft.add_moments(&present, &mut by_motions);
        self.at_walls.iter().for_each(|at_wall| by_motions[at_wall.row] += at_wall.moment(motions));
        let moments = self.moments.par_iter().with_min_len(BATCH).zip(by_motions);
        moments.map(|(&by_strain, by_motion)| by_strain - by_motion).measured().collect()
    }

    fn present(&self, motions: &SixVectors) -> Vec<Padded> {
        let mut present: Vec<Padded> = motions.0.par_iter().with_min_len(BATCH).map(Padded::from).measured().collect();
        self.halo.extend(&mut present);
        present
    }
}
