//! State of the disks in the memory layout of the time step.

use super::stage::Law;
use super::{DiskModel, for_each_part};
use domain::parallel::change;
use domain::{Particles, PeriodicBox, Vector};
use glam::DVec2;

/// Number of disks that are advanced together, one per SIMD lane.
pub(super) const LANES: usize = 32;
/// Disks of one chunk are processed by one thread. The division into chunks does not depend on the number of threads.
pub(super) const CHUNK: usize = 256 * LANES;

/// One number for each disk of a block.
pub(super) type LaneValues = [f64; LANES];

/// The part of a disk's state that pair forces need. The position may be slightly outside the cell: it is wrapped
/// when the neighbour list is built.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[repr(C, align(32))]
pub(super) struct Body {
    pub(super) position: DVec2,
    pub(super) velocity: DVec2,
}

/// The rest of the state of a block of disks: higher derivatives, reference positions and response factors.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[repr(C, align(64))]
pub(super) struct DiskBlock {
    /// `q_k = dt^k x^(k) / k!` for k = 2, 3, 4, along x.
    pub(super) qx: [LaneValues; 3],
    /// The same along y.
    pub(super) qy: [LaneValues; 3],
    /// Position when the list was built.
    pub(super) x0: LaneValues,
    pub(super) y0: LaneValues,
    /// `dt^2 / 2` over the mass.
    pub(super) kick: LaneValues,
    /// The kick times the drag per unit of velocity.
    pub(super) drag: LaneValues,
}

/// Properties of a disk that do not change during a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Identity {
    pub(super) id: u64,
    pub(super) species: u32,
    pub(super) radius: f64,
    /// Rank of its radius among all disks.
    pub(super) rank: u32,
    pub(super) is_large: bool,
    pub(super) inverse_mass: f64,
}

/// Complete state of motion of a disk.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct DiskMotion {
    pub(super) body: Body,
    pub(super) higher: [DVec2; 3],
    /// Position when the list was built.
    pub(super) reference: DVec2,
    /// Lattice steps removed from the position by wrapping.
    pub(super) steps: [i32; 2],
}

/// All disks, one row each. The last block may have unused lanes.
#[derive(Debug, Clone, Default)]
pub(super) struct DiskState {
    pub(super) identities: Vec<Identity>,
    pub(super) steps: Vec<[i32; 2]>,
    pub(super) bodies: Vec<Body>,
    pub(super) blocks: Vec<DiskBlock>,
    /// Contact forces; zero between steps.
    pub(super) forces: Vec<DVec2>,
}

impl DiskState {
    pub(super) fn new(identities: Vec<Identity>, motions: &[DiskMotion]) -> Self {
        let count = identities.len();
        let (blocks, lanes) = (count.div_ceil(LANES), count.next_multiple_of(LANES));
        let mut state = Self {
            identities,
            steps: vec![[0; 2]; count],
            bodies: vec![Body::default(); lanes],
            blocks: vec![DiskBlock::default(); blocks],
            forces: vec![DVec2::ZERO; lanes],
        };
        for (row, motion) in motions.iter().enumerate() {
            state.set_motion(row, motion);
        }
        state
    }

    pub(super) fn len(&self) -> usize {
        self.identities.len()
    }

    pub(super) fn motion(&self, row: usize) -> DiskMotion {
        let (block, lane) = (&self.blocks[row / LANES], row % LANES);
        DiskMotion {
            body: self.bodies[row],
            higher: std::array::from_fn(|k| DVec2::new(block.qx[k][lane], block.qy[k][lane])),
            reference: self.reference(row),
            steps: self.steps[row],
        }
    }

    /// Position of a disk when the list was built.
    pub(super) fn reference(&self, row: usize) -> DVec2 {
        let (block, lane) = (&self.blocks[row / LANES], row % LANES);
        DVec2::new(block.x0[lane], block.y0[lane])
    }

    pub(super) fn set_motion(&mut self, row: usize, motion: &DiskMotion) {
        let (block, lane) = (&mut self.blocks[row / LANES], row % LANES);
        self.bodies[row] = motion.body;
        self.steps[row] = motion.steps;
        for (k, q) in motion.higher.iter().enumerate() {
            (block.qx[k][lane], block.qy[k][lane]) = (q.x, q.y);
        }
        (block.x0[lane], block.y0[lane]) = (motion.reference.x, motion.reference.y);
    }

    /// Sets the response of the disks to forces and drag in a stage. Unused lanes stay at a height at
    /// which the liquid is at rest.
    pub(super) fn set_response(&mut self, law: &Law, model: &DiskModel) {
        for lane in self.len()..self.bodies.len() {
            let (block, lane_of) = (&mut self.blocks[lane / LANES], lane % LANES);
            self.bodies[lane].position.y = law.profile.rest_height();
            (block.y0[lane_of], block.kick[lane_of]) = (law.profile.rest_height(), 1.0);
        }
        for (row, disk) in self.identities.iter().enumerate() {
            let (kick, drag) = law.response(disk.radius, model.mass(disk.radius));
            let (block, lane) = (&mut self.blocks[row / LANES], row % LANES);
            (block.kick[lane], block.drag[lane]) = (kick, drag);
        }
    }

    /// Sets the reference positions of the drift to the present ones.
    pub(super) fn set_references(&mut self) {
        change(&mut self.blocks, self.bodies.as_chunks::<LANES>().0, |block, bodies| {
            (block.x0, block.y0) = (bodies.map(|body| body.position.x), bodies.map(|body| body.position.y));
        });
    }

    /// Wraps all positions into the cell; the velocity of a disk that crosses into another row of images changes by
    /// that row's velocity. The lattice's strain has been reduced by `lattice_shifts` periods since the last time.
    pub(super) fn wrap(&mut self, cell: &PeriodicBox, law: &Law, lattice_shifts: i32) {
        let jump = law.profile.lattice_rate * cell.edges().y;
        let mut parts: Vec<_> = self.bodies.chunks_mut(CHUNK).zip(self.steps.chunks_mut(CHUNK)).collect();
        for_each_part(&mut parts, |(bodies, steps)| {
            for (body, steps) in bodies.iter_mut().zip(steps.iter_mut()) {
                steps[0] += lattice_shifts * steps[1];
                let xi = body.position.x - cell.strain() * body.position.y;
                if !(0.0..cell.edges().x).contains(&xi) || !(0.0..cell.edges().y).contains(&body.position.y) {
                    let (wrapped, taken) = cell.wrap(Vector::new(body.position.x, body.position.y, 0.0));
                    body.position = wrapped.truncate();
                    body.velocity.x -= jump * f64::from(taken[1]);
                    *steps = [steps[0] + taken[0], steps[1] + taken[1]];
                }
            }
        });
    }

    pub(super) fn reorder(&mut self, order: &[u32], law: &Law, model: &DiskModel) {
        let motions: Vec<DiskMotion> = order.iter().map(|&row| self.motion(row as usize)).collect();
        let identities = order.iter().map(|&row| self.identities[row as usize]).collect();
        *self = Self::new(identities, &motions);
        self.set_response(law, model);
    }
}

impl Identity {
    pub(super) fn all(particles: &Particles, model: &DiskModel) -> Vec<Self> {
        let of = |row: usize| {
            let (id, species, radius) = (particles.ids[row], particles.species[row], particles.radii[row]);
            let (is_large, inverse_mass) = (model.is_large(radius), 1.0 / model.mass(radius));
            Self { id, species, radius, rank: 0, is_large, inverse_mass }
        };
        let mut all: Vec<Self> = (0..particles.len()).map(of).collect();
        let mut order: Vec<usize> = (0..all.len()).collect();
        order.sort_by(|&a, &b| all[a].radius.total_cmp(&all[b].radius).then(all[a].id.cmp(&all[b].id)));
        for (rank, &row) in order.iter().enumerate() {
            all[row].rank = rank as u32;
        }
        all
    }
}
