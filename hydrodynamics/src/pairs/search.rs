//! Near pairs and their resistance.

use crate::ambient::StrainRate;
use crate::bodies::RigidBodies;
use crate::bodies::present::PresentBodies;
use crate::pairs::assembly::{Assembled, Assembly, PairArrangement};
use crate::pairs::lists::{NearLists, Present};
use crate::pairs::lubrication::PairLubrication;
use crate::pairs::matrix::diagonal_block::DiagonalBlock;
use crate::pairs::matrix::lanes::StoredLanes;
use crate::pairs::matrix::sparse::{Padded, PairMatrix, ROWS, Resistance};
use crate::pairs::matrix::within_bodies::StiffOfBodies;
use crate::pairs::walls::{self, AtWall};
use crate::six_vector::{SixVector, SixVectors};
use crate::springs::Springs;
use domain::parallel::{FusedLoops, change, in_blocks, mapped, stage};
use domain::{DomainView, Particles, Partition, PeriodicBox, Traceless, Vector};
use fcm::{PairRows, Precision, WALL_NUMBERS};
use lubrication::WallForce;
use std::rc::Rc;

/// Short-range interactions and the neighbour lists for them.
pub struct NearField {
    pub lubrication: Option<PairLubrication>,
    /// Lubrication at walls, if there are any.
    pub at_walls: Option<WallForce>,
    pub lists: NearLists,
    /// Precision in which soft pairs are stored: that of the grid.
    pub precision: Precision,
    /// Radii by species.
    pub radii: Vec<f64>,
}

impl NearField {
    /// Collects particles and ghosts, and updates the neighbour lists. Collective.
    pub fn present(&mut self, particles: &Particles, view: DomainView) -> Rc<Present> {
        let radii = &self.radii;
        let species = mapped(&particles.radii, |a| radii.partition_point(|radius| radius < a) as u32);
        self.lists.follow(particles, species, view)
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

/// Resistance of the near pairs of a rank's particles.
pub struct NearPairs {
    /// Particles and ghosts.
    pub(super) around: Rc<Present>,
    /// Includes the resistance of walls. In double precision: near contact, the resistances of both spheres almost
    /// cancel.
    pub(super) stiff: PairMatrix<f64>,
    soft: Box<dyn Resistance>,
    pub(super) at_walls: Vec<AtWall>,
    /// Loads and first moments in the ambient flow on particles at rest relative to it.
    pub(super) loads: SixVectors,
    pub(super) moments: Vec<Traceless>,
    /// Whether any particle is in a trap.
    has_traps: bool,
    /// Whether loads by slip are among those in the ambient flow.
    pub(super) has_slip: bool,
    /// Rigid bodies, if there are any.
    pub(super) bodies: Option<PresentBodies>,
    /// Number of pairs, with these, whose resistance is where the far field is evaluated, if it is there.
    on_device: Option<usize>,
}

/// Springs and rigid bodies of spheres, if there are any, and whether lubrication is left out.
#[derive(Clone, Copy, Default)]
pub struct Connections<'a> {
    pub springs: Option<&'a Springs<'a>>,
    pub bodies: Option<&'a RigidBodies>,
    pub without_lubrication: bool,
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
    /// Finds the pairs within the range of lubrication or springs, in a flow with a strain rate. Springs do not act
    /// within a body, nor does lubrication between its spheres that overlap. Collective.
    pub fn find(
        field: &mut NearField,
        connections: Connections,
        particles: &Particles,
        view: DomainView,
        strain_rate: StrainRate,
    ) -> Self {
        let _stage = stage("assembly of near pairs");
        let cell = view.cell;
        let owned = particles.len();
        let around = field.present(particles, view);
        let Connections { springs, bodies, without_lubrication } = connections;
        let bodies = bodies.map(|bodies| PresentBodies::new(bodies, &particles.radii, &around.halo));
        let Present { positions, ids, species, .. } = &*around;
        let NearField { lubrication, at_walls, lists, radii, .. } = &*field;
        let neighbours = lists.neighbours();
        let lubrication = lubrication.as_ref().filter(|_| !without_lubrication);
        let arrangement = PairArrangement {
            lubrication,
            springs,
            bodies: bodies.as_ref(),
            radii,
            cell,
            positions,
            ids,
            species,
            neighbours,
            strain_rate,
        };
        let (mut loads, mut moments) = (SixVectors::default(), Vec::new());
        let mut loops = FusedLoops::default();
        loops.of_rows(&mut loads.0, owned, |_| SixVector::default());
        loops.of_rows(&mut moments, owned, |_| Traceless::ZERO);
        loops.run();
        let Resisting { stiff, soft } = match field.precision {
            Precision::Single => Resisting::of(Assembly::<f32>::of_all(&arrangement, &mut loads.0, &mut moments)),
            Precision::Double => Resisting::of(Assembly::<f64>::of_all(&arrangement, &mut loads.0, &mut moments)),
        };
        let at_walls = walls::find(at_walls.as_ref(), springs, particles, cell, strain_rate);
        let none = Vec::new();
        let found = Self {
            around,
            stiff,
            soft,
            at_walls: none,
            loads,
            moments,
            has_traps: false,
            has_slip: false,
            bodies,
            on_device: None,
        };
        found.with_spheres_at_walls(at_walls).with_traps(springs)
    }

    /// No near pairs but spheres that are lubricated at walls, in a flow with a strain rate. Collective.
    pub fn at_walls(force: &WallForce, particles: &Particles, view: DomainView, strain_rate: StrainRate) -> Self {
        let _stage = stage("assembly of near pairs");
        let at_walls = walls::find(Some(force), None, particles, view.cell, strain_rate);
        Self::none(particles, view.cell, view.partition).with_spheres_at_walls(at_walls)
    }

    /// The same with spheres at walls.
    fn with_spheres_at_walls(mut self, at_walls: Vec<AtWall>) -> Self {
        for at_wall in &at_walls {
            let (load, moment) = at_wall.in_flow;
            self.stiff.add_own(at_wall.row, &at_wall.own());
            self.loads.0[at_wall.row] += load;
            self.moments[at_wall.row] += moment;
        }
        Self { at_walls, ..self }
    }

    /// The same with spheres in the traps of springs.
    fn with_traps(mut self, springs: Option<&Springs>) -> Self {
        let trapped = springs.map_or(0, |springs| springs.tethers.traps.len());
        for row in 0..trapped {
            if let Some(resistance) = springs.and_then(|springs| springs.trap(row)) {
                self.stiff.add_own(row, &DiagonalBlock::against_velocity(resistance));
                self.has_traps = true;
            }
        }
        self
    }

    /// No near pairs, for systems without short-range interactions. Collective.
    pub fn none(particles: &Particles, cell: &PeriodicBox, partition: &Partition) -> Self {
        let present = Present::new(particles, vec![0; particles.len()], DomainView { cell, partition }, 0.0);
        let (loads, moments) = (SixVectors::zero(particles.len()), vec![Traceless::ZERO; particles.len()]);
        Self {
            around: Rc::new(present),
            stiff: PairMatrix::without_pairs(particles.len()),
            soft: Box::new(PairMatrix::<f64>::new(Vec::new())),
            at_walls: Vec::new(),
            loads,
            moments,
            has_traps: false,
            has_slip: false,
            bodies: None,
            on_device: None,
        }
    }

    /// No near pairs but those that a device finds between a number of particles.
    pub fn elsewhere(count: usize, cell: &PeriodicBox, partition: &Partition) -> Self {
        let (loads, moments) = (SixVectors::zero(count), vec![Traceless::ZERO; count]);
        Self { loads, moments, ..Self::none(&Particles::default(), cell, partition) }
    }

    /// Notes the number of pairs, with these, that a device has found.
    pub fn note_found(&mut self, pairs: usize) {
        self.on_device = Some(pairs);
    }

    /// Whether the resistance of all pairs is where the far field is evaluated.
    pub fn is_on_device(&self) -> bool {
        self.on_device.is_some()
    }

    /// Whether no particle of this rank is near another or a wall, or in a trap.
    pub fn is_empty(&self) -> bool {
        !self.has_own() && self.on_device.is_none_or(|pairs| pairs == 0)
    }

    /// Whether there are loads or a resistance here, besides those on a device.
    pub fn has_own(&self) -> bool {
        self.has_slip || self.has_rows()
    }

    /// Whether there is a resistance here, besides that on a device.
    pub fn has_rows(&self) -> bool {
        let has_pairs = !self.stiff.is_empty() || !self.soft.is_empty();
        has_pairs || !self.at_walls.is_empty() || self.has_traps
    }

    /// Resistance matrix of stiff pairs, walls and traps.
    pub fn stiff(&self) -> &PairMatrix<f64> {
        &self.stiff
    }

    /// Rows of stiff pairs, and spheres at walls, for a device.
    ///
    /// # Panics
    /// On several ranks, whose pairs have ghosts.
    pub fn rows(&self) -> PairRows {
        let count = self.moments.len();
        assert_eq!(self.around.positions.len(), count, "a device serves one rank");
        let mut at_walls = vec![[0.0; WALL_NUMBERS]; if self.at_walls.is_empty() { 0 } else { count }];
        for at_wall in &self.at_walls {
            let numbers = at_walls[at_wall.row].iter_mut().zip(at_wall.moment_numbers());
            numbers.for_each(|(sum, number)| *sum += number);
        }
        PairRows { at_walls: at_walls.into_flattened(), ..self.stiff.rows(count) }
    }

    /// Stiff pairs as parts of the resistance of bodies; `None` without short-range interactions, on all ranks.
    pub fn stiff_of_bodies(&self) -> Option<StiffOfBodies<'_>> {
        self.bodies.as_ref().map(|present| StiffOfBodies { stiff: &self.stiff, present })
    }

    /// Loads of a selection of pairs in the motions of this rank's particles. Collective.
    pub fn times(&self, pairs: &[Pairs], motions: &SixVectors) -> SixVectors {
        self.times_present(pairs, mapped(&motions.0, Padded::of), |_, _| 0.0).0
    }

    /// [`Self::times`] for padded motions, followed by a function that changes the loads of a block of rows, given its
    /// first row. Also returns the sum of the function's values, the same on any number of threads. Collective.
    pub fn times_present(
        &self,
        pairs: &[Pairs],
        mut present: Vec<Padded>,
        change: impl Fn(usize, &mut [SixVector]) -> f64 + Sync,
    ) -> (SixVectors, f64) {
        self.around.halo.extend(&mut present);
        let (stiff, soft) = (&self.stiff, &self.soft);
        let (loads, sums) = in_blocks(self.moments.len(), ROWS, |first, loads| {
            for which in pairs {
                match which {
                    Pairs::Stiff => stiff.add_loads(first / ROWS, &present, loads),
                    Pairs::Soft => soft.add_loads(first / ROWS, &present, loads),
                }
            }
            change(first, loads)
        });
        (SixVectors(loads), sums.iter().sum())
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
        let mut by_motions = self.moments_by(motions);
        change(&mut by_motions, &self.moments, |by_motion, &by_strain| *by_motion = by_strain - *by_motion);
        by_motions
    }

    /// First moments by motions of the particles, the negative of [`Self::stresslets`] without the ambient strain.
    /// Collective.
    pub fn moments_by(&self, motions: &SixVectors) -> Vec<Traceless> {
        let mut present = mapped(&motions.0, Padded::of);
        self.around.halo.extend(&mut present);
        let (stiff, soft) = (&self.stiff, &self.soft);
        let (mut by_motions, _) = in_blocks(self.moments.len(), ROWS, |first, moments| {
            stiff.add_moments(first / ROWS, &present, moments);
            soft.add_moments(first / ROWS, &present, moments);
        });
        self.at_walls.iter().for_each(|at_wall| by_motions[at_wall.row] += at_wall.moment(motions));
        by_motions
    }

    /// First moments in the ambient flow on particles at rest relative to it.
    pub fn ambient_moments(&self) -> &[Traceless] {
        &self.moments
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::Comm;

    /// Particles that have not moved are collected once, on any number of ranks; the lists follow those that have.
    #[test]
    fn particles_at_rest_are_collected_once() {
        let cell = PeriodicBox::new(Vector::splat(10.0)).unwrap();
        for ranks in [1, 3] {
            Comm::threads(ranks, |comm| {
                let partition = Partition::new(&comm, [8, 8]);
                let lists = NearLists::new(3.0, &partition);
                let (precision, radii) = (Precision::Double, vec![1.0]);
                let mut field = NearField { lubrication: None, at_walls: None, lists, precision, radii };
                let mut particles = Particles::default();
                for id in (0..2).filter(|_| comm.is_first()) {
                    particles.push(id, Vector::new(1.0 + 2.5 * id as f64, 1.0, 1.0), 1.0, 0);
                }
                particles.migrate(&partition, &cell);
                let view = DomainView { cell: &cell, partition: &partition };
                for near in [1.0, 0.0] {
                    let (first, second) = (field.present(&particles, view), field.present(&particles, view));
                    assert!(Rc::ptr_eq(&first, &second));
                    let mut count = [field.lists.neighbours().count() as f64];
                    comm.sum(&mut count);
                    assert!((count[0] - 2.0 * near).abs() < 0.5, "{count:?}");
                    for (position, id) in particles.positions.iter_mut().zip(&particles.ids) {
                        position.x += *id as f64;
                    }
                }
            });
        }
    }
}
