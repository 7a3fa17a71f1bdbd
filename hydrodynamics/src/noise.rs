//! Brownian forces between near pairs.

use crate::bodies::RigidBodies;
use crate::bodies::present::PresentBodies;
use crate::pairs::lists::Present;
use crate::pairs::lubrication::PairLubrication;
use crate::pairs::matrix::lanes::SimdLanes;
use crate::pairs::search::NearField;
use domain::parallel::{MeasuredLoop, mapped, stage};
use domain::{DomainView, Neighbours, Particles, PeriodicBox, Random, Vector};
use fcm::{Loads, Stream};
use lubrication::{PairFactor, PairForce, WallFactor, WallForce};
use rayon::prelude::*;
use simd::{SimdVector as Width, VectorKernel};
use solver::Real;

/// Keys of the random streams for pairs and for spheres at walls.
pub const OF_PAIR: u64 = 3;
const OF_WALL: u64 = 4;

/// Number of rows that a thread processes at a time.
const BATCH: usize = 64;

/// Random forces and torques of pairs `B zeta` on a rank's particles, with `B` the factor of the lubrication resistance
/// `B B^T` and `zeta` one standard normal number per mode of each pair. The numbers are keyed by the ids and the
/// periodic image of a pair, so that all ranks draw the same. Collective.
pub fn loads_of_pairs(
    field: &mut NearField,
    particles: &Particles,
    bodies: Option<&RigidBodies>,
    view: DomainView,
    stream: Stream,
) -> Loads {
    let _stage = stage("random loads of near pairs");
    let cell = view.cell;
    let present = field.present(particles, view);
    let bodies = bodies.map(|bodies| PresentBodies::new(bodies, &particles.radii, &present.halo));
    let bodies = bodies.as_ref();
    let Present { halo, positions, ids, species, .. } = &*present;
    let mut steps = mapped(&particles.steps, |&[x, y, z]| [x, y, z, 0]);
    halo.extend(&mut steps);
    let Some(PairLubrication { force, .. }) = &field.lubrication else { return Loads::default() };
    let (owned, neighbours) = (particles.len(), field.lists.neighbours());
    let (positions, ids, species, steps) = (&positions[..], &ids[..], &species[..], &steps[..]);
    let of_batch = |batch: usize| {
        let rows = [batch * BATCH, owned.min((batch + 1) * BATCH)];
        f64::dispatch(NoisePairs {
            force,
            cell,
            positions,
            ids,
            species,
            steps,
            bodies,
            neighbours,
            stream,
            owned,
            rows,
        })
    };
    let parts: Vec<Vec<(usize, [Vector; 2])>> =
        (0..owned.div_ceil(BATCH)).into_par_iter().map(of_batch).measured().collect();
    let mut sums = vec![[Vector::ZERO; 2]; owned];
    for (row, [force, torque]) in parts.into_iter().flatten() {
        sums[row][0] += force;
        sums[row][1] += torque;
    }
    let of = |k: usize| mapped(&sums, |sum| sum[k]);
    Loads { forces: of(0), torques: of(1), stresslets: Vec::new() }
}

/// The pairs of a range of rows. A pair within the rank is visited once, from the sphere of the lower id; a pair with a
/// ghost is visited from the rank's own sphere.
struct NoisePairs<'a> {
    force: &'a PairForce,
    cell: &'a PeriodicBox,
    positions: &'a [Vector],
    ids: &'a [u64],
    species: &'a [u32],
    steps: &'a [[i32; 4]],
    bodies: Option<&'a PresentBodies>,
    neighbours: &'a Neighbours,
    stream: Stream,
    owned: usize,
    rows: [usize; 2],
}

impl VectorKernel<f64> for NoisePairs<'_> {
    type Output = Vec<(usize, [Vector; 2])>;

    #[inline(always)]
    fn run<V: Width<f64>>(self) -> Self::Output {
        let Self { force, cell, positions, ids, species, steps, bodies, neighbours, stream, owned, rows } = self;
        let mut sums = Vec::new();
        for row in rows[0]..rows[1] {
            for neighbour in neighbours.of(row).iter() {
                let (other, between) = (neighbour.row as usize, neighbour.steps.map(i32::from));
                // Orientation of the pair: from the sphere of the lower id to the other; between two images of one
                // sphere, by the image.
                let image: [i32; 3] = std::array::from_fn(|d| between[d] + steps[other][d] - steps[row][d]);
                let is_first = (ids[row], image) < (ids[other], image.map(|step| -step));
                if !is_first && other < owned {
                    continue;
                }
                let mut separation = positions[other] - positions[row];
                if between != [0; 3] {
                    separation += cell.lattice(between);
                }
                let (sign, pair) = if is_first { (1, [row, other]) } else { (-1, [other, row]) };
                let kinds = pair.map(|row| species[row]);
                let sizes = kinds.map(|kind| force.radii()[kind as usize]);
                let share = bodies.and_then(|bodies| bodies.share([row, other], separation, sizes));
                if share == Some(0.0) {
                    continue;
                }
                let Some(factor) = force.factor_by::<SimdLanes<V>>(separation * f64::from(sign), kinds) else {
                    continue;
                };
                let modes = numbers(stream, pair.map(|row| ids[row]), image.map(|step| sign * step));
                let loads = factor.loads(&modes);
                let root = share.map_or(1.0, f64::sqrt);
                let of = |k: usize| (pair[k], [loads.force[k] * root, loads.torque[k] * root]);
                sums.extend([of(0), of(1)].into_iter().filter(|(row, _)| *row < owned));
            }
        }
        sums
    }
}

/// Adds the random loads due to walls, one of each particle.
pub fn add_at_walls(loads: &mut Loads, force: &WallForce, particles: &Particles, cell: &PeriodicBox, stream: Stream) {
    for (row, (total_force, total_torque)) in loads.forces.iter_mut().zip(&mut loads.torques).enumerate() {
        for to in cell.to_walls(particles.positions[row]) {
            let Some(factor) = force.factor(to.axis, to.distance, particles.radii[row]) else { continue };
            let mut random = stream.of(OF_WALL, 2 * particles.ids[row] + to.wall as u64);
            let mut modes = [0.0; WallFactor::MODES];
            modes.chunks_exact_mut(2).for_each(|pair| pair.copy_from_slice(&random.normal()));
            let loads = factor.loads(&modes);
            *total_force += loads.force;
            *total_torque += loads.torque;
        }
    }
}

fn numbers(stream: Stream, [first, second]: [u64; 2], image: [i32; 3]) -> [f64; PairFactor::MODES] {
    let mut name = Random::new(first, second);
    let image = image.into_iter().fold(0_u64, |key, step| (key << 21) ^ (i64::from(step) + (1 << 20)) as u64);
    let mut random = stream.of(OF_PAIR, name.bits() ^ image);
    let mut numbers = [0.0; PairFactor::MODES];
    for pair in numbers.chunks_exact_mut(2) {
        pair.copy_from_slice(&random.normal());
    }
    numbers
}
