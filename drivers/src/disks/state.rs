//! The state of the disks in the layout that the time step needs.

use super::stage::Law;
use super::{Model, for_each_part};
use domain::{PeriodicBox, Vector};
use glam::DVec2;

/// Disks that are moved together, with a lane of the processor's vectors each.
pub(super) const LANES: usize = 32;
/// Disks of one chunk move and collide on one thread. The number of threads does not change what a chunk is.
pub(super) const CHUNK: usize = 256 * LANES;

/// A number for each disk of a block.
pub(super) type Lanes = [f64; LANES];

/// What pairs see of a disk. Its place may lie a little outside the cell: it is wrapped when the list of neighbours is
/// made.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[repr(C, align(32))]
pub(super) struct Body {
    pub(super) place: DVec2,
    pub(super) velocity: DVec2,
}

/// The rest of a block's motion: higher derivatives, reference positions and response.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub(super) struct Block {
    /// `q_k = dt^k x^(k) / k!` for k = 2, 3, 4, along x.
    pub(super) qx: [Lanes; 3],
    /// The same along y.
    pub(super) qy: [Lanes; 3],
    /// Place when the list was made.
    pub(super) x0: Lanes,
    pub(super) y0: Lanes,
    /// `dt^2 / 2` over the mass.
    pub(super) kick: Lanes,
    /// The kick times the drag for a unit of velocity.
    pub(super) drag: Lanes,
}

/// A disk's identity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Identity {
    pub(super) id: u64,
    pub(super) species: u32,
    pub(super) radius: f64,
    /// Its place among all disks by radius.
    pub(super) rank: u32,
    pub(super) is_large: bool,
    pub(super) lightness: f64,
}

/// The whole motion of a disk.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Motion {
    pub(super) body: Body,
    pub(super) higher: [DVec2; 3],
    /// Place when the list was made.
    pub(super) reference: DVec2,
    /// Lattice steps taken out of the place.
    pub(super) steps: [i32; 2],
}

/// All disks, one row each. Lanes of the last block may be left over.
#[derive(Debug, Clone, Default)]
pub(super) struct State {
    pub(super) identities: Vec<Identity>,
    pub(super) steps: Vec<[i32; 2]>,
    pub(super) bodies: Vec<Body>,
    pub(super) blocks: Vec<Block>,
    /// Contact forces; zero between steps.
    pub(super) forces: Vec<DVec2>,
}

impl State {
    pub(super) fn new(identities: Vec<Identity>, motions: &[Motion]) -> Self {
        let count = identities.len();
        let (blocks, lanes) = (count.div_ceil(LANES), count.next_multiple_of(LANES));
        let mut state = Self {
            identities,
            steps: vec![[0; 2]; count],
            bodies: vec![Body::default(); lanes],
            blocks: vec![Block::default(); blocks],
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

    /// The motion of a disk.
    pub(super) fn motion(&self, row: usize) -> Motion {
        let (block, lane) = (&self.blocks[row / LANES], row % LANES);
        Motion {
            body: self.bodies[row],
            higher: std::array::from_fn(|k| DVec2::new(block.qx[k][lane], block.qy[k][lane])),
            reference: DVec2::new(block.x0[lane], block.y0[lane]),
            steps: self.steps[row],
        }
    }

    /// Where a disk was when the list was made.
    pub(super) fn reference(&self, row: usize) -> DVec2 {
        let (block, lane) = (&self.blocks[row / LANES], row % LANES);
        DVec2::new(block.x0[lane], block.y0[lane])
    }

    pub(super) fn set_motion(&mut self, row: usize, motion: &Motion) {
        let (block, lane) = (&mut self.blocks[row / LANES], row % LANES);
        self.bodies[row] = motion.body;
        self.steps[row] = motion.steps;
        for (k, q) in motion.higher.iter().enumerate() {
            (block.qx[k][lane], block.qy[k][lane]) = (q.x, q.y);
        }
        (block.x0[lane], block.y0[lane]) = (motion.reference.x, motion.reference.y);
    }

    /// Sets how the disks respond to forces and drag in a stage.
    /// The lanes left over float where the liquid is at rest.
    pub(super) fn set_response(&mut self, law: &Law, model: &Model) {
        for lane in self.len()..self.bodies.len() {
            let (block, lane_of) = (&mut self.blocks[lane / LANES], lane % LANES);
            self.bodies[lane].place.y = law.profile.rest_height();
            (block.y0[lane_of], block.kick[lane_of]) = (law.profile.rest_height(), 1.0);
        }
        for (row, disk) in self.identities.iter().enumerate() {
            let (kick, drag) = law.response(disk.radius, model.mass(disk.radius));
            let (block, lane) = (&mut self.blocks[row / LANES], row % LANES);
            (block.kick[lane], block.drag[lane]) = (kick, drag);
        }
    }

    /// Sets the reference positions of drift to the present ones.
    pub(super) fn refer(&mut self) {
        let mut parts: Vec<_> = self.bodies.chunks(CHUNK).zip(self.blocks.chunks_mut(CHUNK / LANES)).collect();
        for_each_part(&mut parts, |(bodies, blocks)| {
            for (bodies, block) in bodies.chunks_exact(LANES).zip(blocks.iter_mut()) {
                for (k, body) in bodies.iter().enumerate() {
                    (block.x0[k], block.y0[k]) = (body.place.x, body.place.y);
                }
            }
        });
    }

    /// Brings all places back into the cell; the velocity of a disk that changes rows changes with its image's. The
    /// lattice's strain has been turned back by `turns` periods since the last time.
    pub(super) fn wrap(&mut self, cell: &PeriodicBox, law: &Law, turns: i32) {
        let jump = law.profile.lattice_rate * cell.edges().y;
        let mut parts: Vec<_> = self.bodies.chunks_mut(CHUNK).zip(self.steps.chunks_mut(CHUNK)).collect();
        for_each_part(&mut parts, |(bodies, steps)| {
            for (body, steps) in bodies.iter_mut().zip(steps.iter_mut()) {
                steps[0] += turns * steps[1];
                let xi = body.place.x - cell.strain() * body.place.y;
                if !(0.0..cell.edges().x).contains(&xi) || !(0.0..cell.edges().y).contains(&body.place.y) {
                    let (wrapped, taken) = cell.wrap(Vector::new(body.place.x, body.place.y, 0.0));
                    body.place = wrapped.truncate();
                    body.velocity.x -= jump * f64::from(taken[1]);
                    *steps = [steps[0] + taken[0], steps[1] + taken[1]];
                }
            }
        });
    }

    /// Puts the rows in a new order.
    pub(super) fn arrange(&mut self, order: &[u32], law: &Law, model: &Model) {
        let motions: Vec<Motion> = order.iter().map(|&row| self.motion(row as usize)).collect();
        let identities = order.iter().map(|&row| self.identities[row as usize]).collect();
        *self = Self::new(identities, &motions);
        self.set_response(law, model);
    }
}

impl Identity {
    /// The identities of disks by id, species and radius.
    pub(super) fn all(disks: impl Iterator<Item = (u64, u32, f64)>, model: &Model) -> Vec<Self> {
        let of = |(id, species, radius): (u64, u32, f64)| Self {
            id,
            species,
            radius,
            rank: 0,
            is_large: model.is_large(radius),
            lightness: 1.0 / model.mass(radius),
        };
        let mut all: Vec<Self> = disks.map(of).collect();
        let mut order: Vec<usize> = (0..all.len()).collect();
        order.sort_by(|&a, &b| all[a].radius.total_cmp(&all[b].radius).then(all[a].id.cmp(&all[b].id)));
        for (rank, &row) in order.iter().enumerate() {
            all[row].rank = rank as u32;
        }
        all
    }
}

impl Default for Block {
    fn default() -> Self {
        let none = [0.0; LANES];
        Self { qx: [none; 3], qy: [none; 3], x0: none, y0: none, kick: none, drag: none }
    }
}
