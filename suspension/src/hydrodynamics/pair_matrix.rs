//! The lubrication resistance of many pairs as a sparse matrix.

use super::block::Block;
use super::lanes::{LANES, Lanes, turn};
use super::screw::Screw;
use bytemuck::Zeroable;
use domain::Traceless;
use lubrication::Arithmetic;
use rayon::prelude::*;
use solver::Real;
use solver::simd::{Vector as Width, Work};

/// Rows that one thread works through at a time.
pub const ROWS: usize = 64;

/// What particles resist to their rigid motions by some of their near pairs: with the unit vector `z` along each pair,
/// the loads of [`lubrication::Coefficients`]. Each row of a particle that the rank owns has all of its pairs, so that a
/// pair stands in the rows of both and rows are worked out one by one, a pair a lane.
#[derive(Default)]
pub struct PairMatrix {
    parts: Vec<Part>,
}

/// The rows of some particles.
#[derive(Default)]
pub struct Part {
    /// What is on the diagonal.
    own: Vec<Own>,
    /// Where the groups of each row end.
    ends: Vec<u32>,
    groups: Vec<Group>,
    moments: Vec<MomentGroup>,
}

/// The block on the diagonal: forces by velocities, torques by angular velocities, each a symmetric matrix by its
/// components xx, xy, xz, yy, yz, zz; and the vector `c` of `F = Omega x c` and `L = c x U`.
#[derive(Debug, Clone, Copy, Default)]
pub struct Own {
    pub force: [f64; 6],
    pub torque: [f64; 6],
    pub coupling: [f64; 3],
}

/// Pairs of one row, a lane each, by what the motion of the other particle makes of loads; empty lanes have zeros.
#[derive(Clone, Copy, Zeroable)]
#[repr(C, align(64))]
pub struct Group {
    pub axis: [[f64; LANES]; 3],
    pub across: [f64; LANES],
    /// `along - across`
    pub along: [f64; LANES],
    pub roll: [f64; LANES],
    /// `spin - roll`
    pub spin: [f64; LANES],
    /// Force by the angular velocity of the other, and torque by its velocity.
    pub coupling: [[f64; LANES]; 2],
    /// Rows of the others.
    pub others: [u32; LANES],
}

/// First moments of a row's particle by motions, of itself and of the other.
#[derive(Clone, Copy, Zeroable)]
#[repr(C, align(64))]
pub struct MomentGroup {
    pub pull: [[f64; LANES]; 2],
    pub drag: [[f64; LANES]; 2],
    pub turn: [[f64; LANES]; 2],
}

impl Part {
    /// No rows yet, and room for so many groups of theirs.
    pub fn with_room(groups: usize) -> Self {
        let (groups, moments) = (Vec::with_capacity(groups), Vec::with_capacity(groups));
        Self { own: Vec::with_capacity(ROWS), ends: Vec::with_capacity(ROWS), groups, moments }
    }

    /// Appends an empty group to the row that is being made.
    #[inline(always)]
    pub fn group(&mut self) -> (&mut Group, &mut MomentGroup) {
        self.groups.push(Group::zeroed());
        self.moments.push(MomentGroup::zeroed());
        let last = self.groups.len() - 1;
        (&mut self.groups[last], &mut self.moments[last])
    }

    /// Ends a row.
    pub fn end_row(&mut self, own: Own) {
        self.own.push(own);
        self.ends.push(self.groups.len() as u32);
    }

    fn groups_of(&self, row: usize) -> std::ops::Range<usize> {
        let start = if row == 0 { 0 } else { self.ends[row - 1] };
        start as usize..self.ends[row] as usize
    }
}

impl PairMatrix {
    /// Of parts of [`ROWS`] rows each, but for the last.
    pub fn new(parts: Vec<Part>) -> Self {
        Self { parts }
    }

    /// Whether there is no pair.
    pub fn is_empty(&self) -> bool {
        self.parts.iter().all(|part| part.groups.is_empty())
    }

    /// The block on the diagonal of a row.
    pub fn block(&self, row: usize) -> Block {
        self.parts[row / ROWS].own[row % ROWS].block()
    }

    /// The matrix times the motions of all particles present: the loads of those that the rank owns.
    pub fn times(&self, present: &[Screw]) -> Vec<Screw> {
        let mut loads = vec![Screw::default(); self.parts.iter().map(|part| part.own.len()).sum()];
        loads.par_chunks_mut(ROWS).zip(&self.parts).enumerate().for_each(|(k, (loads, part))| {
            f64::dispatch(Product { part, first: k * ROWS, present, loads });
        });
        loads
    }

    /// Adds the first moments by the motions of all particles present to those of the particles that the rank owns.
    pub fn add_moments(&self, present: &[Screw], moments: &mut [Traceless]) {
        moments.par_chunks_mut(ROWS).zip(&self.parts).enumerate().for_each(|(k, (moments, part))| {
            f64::dispatch(MomentRows { part, first: k * ROWS, present, sums: moments });
        });
    }
}

impl Own {
    /// Adds what resists to all velocities alike.
    #[inline(always)]
    pub fn resist(&mut self, resistance: f64) {
        for diagonal in [0, 3, 5] {
            self.force[diagonal] += resistance;
        }
    }

    /// All of its numbers.
    fn block(&self) -> Block {
        let mut rows = [[0.0; 6]; 6];
        for (corner, [xx, xy, xz, yy, yz, zz]) in [(0, self.force), (3, self.torque)] {
            for (i, row) in [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]].into_iter().enumerate() {
                rows[corner + i][corner..corner + 3].copy_from_slice(&row);
            }
        }
        for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
            // Omega x c, and c x U.
            rows[i][3 + j] = self.coupling[k];
            rows[j][3 + i] = -self.coupling[k];
            rows[3 + i][j] = -self.coupling[k];
            rows[3 + j][i] = self.coupling[k];
        }
        Block(rows)
    }

    #[inline(always)]
    fn times(&self, motion: &Screw) -> [f64; 6] {
        let [ux, uy, uz, ox, oy, oz] = motion.0;
        let ([a, b, c, d, e, f], [p, q, r, s, t, u]) = (self.force, self.torque);
        let [x, y, z] = self.coupling;
        [
            a * ux + b * uy + c * uz + oy * z - oz * y,
            b * ux + d * uy + e * uz + oz * x - ox * z,
            c * ux + e * uy + f * uz + ox * y - oy * x,
            p * ox + q * oy + r * oz + y * uz - z * uy,
            q * ox + s * oy + t * oz + z * ux - x * uz,
            r * ox + t * oy + u * oz + x * uy - y * ux,
        ]
    }
}

/// Velocities and angular velocities of the others of a group, lane by lane.
#[inline(always)]
fn gathered<V: Width<f64>>(present: &[Screw], others: &[u32; LANES]) -> [[Lanes<V>; 3]; 2] {
    let mut records = [[0.0; LANES]; LANES];
    for lane in 0..LANES {
        records[lane][..6].copy_from_slice(&present[others[lane] as usize].0);
    }
    let mut lanes = [[0.0; LANES]; LANES];
    turn::<V, LANES>(&records, 0, &mut lanes);
    let mut motions = [[Lanes::constant(0.0); 3]; 2];
    for k in 0..3 {
        motions[0][k] = Lanes::read(&lanes[k]);
        motions[1][k] = Lanes::read(&lanes[3 + k]);
    }
    motions
}

#[inline(always)]
fn dot<V: Width<f64>>(a: [Lanes<V>; 3], b: [Lanes<V>; 3]) -> Lanes<V> {
    (a[0] * b[0]).plus(a[1], b[1]).plus(a[2], b[2])
}

#[inline(always)]
fn cross<V: Width<f64>>(a: [Lanes<V>; 3], b: [Lanes<V>; 3]) -> [Lanes<V>; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline(always)]
fn axis<V: Width<f64>>(group: &Group) -> [Lanes<V>; 3] {
    [Lanes::read(&group.axis[0]), Lanes::read(&group.axis[1]), Lanes::read(&group.axis[2])]
}

/// Some rows of the matrix times motions.
struct Product<'a> {
    part: &'a Part,
    first: usize,
    present: &'a [Screw],
    loads: &'a mut [Screw],
}

impl Work<f64> for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Width<f64>>(self) {
        for row in 0..self.loads.len() {
            let mut load = self.part.own[row].times(&self.present[self.first + row]);
            let groups = &self.part.groups[self.part.groups_of(row)];
            if !groups.is_empty() {
                let mut sums = [Lanes::<V>::constant(0.0); 6];
                for group in groups {
                    group.add(self.present, &mut sums);
                }
                for k in 0..6 {
                    load[k] += sums[k].sum();
                }
            }
            self.loads[row] = Screw(load);
        }
    }
}

impl Group {
    /// Adds the loads by the motions of the others.
    #[inline(always)]
    fn add<V: Width<f64>>(&self, present: &[Screw], sums: &mut [Lanes<V>; 6]) {
        let ([u, o], z) = (gathered::<V>(present, &self.others), axis::<V>(self));
        let along = dot(z, u) * Lanes::read(&self.along);
        let spin = dot(z, o) * Lanes::read(&self.spin);
        let (turning, moving) = (cross(o, z), cross(z, u));
        let (across, roll) = (Lanes::read(&self.across), Lanes::read(&self.roll));
        let coupling = [Lanes::read(&self.coupling[0]), Lanes::read(&self.coupling[1])];
        for k in 0..3 {
            sums[k] = sums[k].plus(across, u[k]).plus(along, z[k]).plus(coupling[0], turning[k]);
            sums[3 + k] = sums[3 + k].plus(roll, o[k]).plus(spin, z[k]).plus(coupling[1], moving[k]);
        }
    }
}

/// First moments of some rows.
struct MomentRows<'a> {
    part: &'a Part,
    first: usize,
    present: &'a [Screw],
    sums: &'a mut [Traceless],
}

impl Work<f64> for MomentRows<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Width<f64>>(self) {
        for row in 0..self.sums.len() {
            let own = self.present[self.first + row].0;
            let mut sums = [Lanes::<V>::constant(0.0); 5];
            for k in self.part.groups_of(row) {
                self.part.moments[k].add(&self.part.groups[k], (self.present, &own), &mut sums);
            }
            for k in 0..5 {
                self.sums[row].0[k] += sums[k].sum();
            }
        }
    }
}

impl MomentGroup {
    /// Adds the moments by the motions of one's own and of the others.
    #[inline(always)]
    fn add<V: Width<f64>>(&self, group: &Group, (present, own): (&[Screw], &[f64; 6]), sums: &mut [Lanes<V>; 5]) {
        let z = axis::<V>(group);
        let of_others = gathered::<V>(present, &group.others);
        let mut of_own = [[Lanes::constant(0.0); 3]; 2];
        for k in 0..3 {
            of_own[0][k] = Lanes::constant(own[k]);
            of_own[1][k] = Lanes::constant(own[3 + k]);
        }
        let mut stretch = Lanes::constant(0.0);
        let mut shear = [Lanes::constant(0.0); 3];
        for (k, [u, o]) in [of_own, of_others].into_iter().enumerate() {
            let (along, turning) = (dot(z, u), cross(o, z));
            let (drag, turn) = (Lanes::read(&self.drag[k]), Lanes::read(&self.turn[k]));
            stretch = stretch.plus(along, Lanes::read(&self.pull[k]));
            for i in 0..3 {
                shear[i] = shear[i].plus(drag, u[i] - along * z[i]).plus(turn, turning[i]);
            }
        }
        add_tensor(stretch, shear, z, sums);
    }
}

/// Adds `stretch (3 zz - 1) + z s + s z` to the five components of symmetric traceless tensors.
#[inline(always)]
pub fn add_tensor<V: Width<f64>>(stretch: Lanes<V>, shear: [Lanes<V>; 3], z: [Lanes<V>; 3], sums: &mut [Lanes<V>; 5]) {
    let three = Lanes::constant(3.0) * stretch;
    for (k, (i, j)) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2)].into_iter().enumerate() {
        sums[k] = sums[k].plus(three * z[i], z[j]).plus(z[i], shear[j]).plus(shear[i], z[j]);
    }
    sums[0] = sums[0] - stretch;
    sums[3] = sums[3] - stretch;
}
