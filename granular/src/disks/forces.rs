//! Contact forces.

use super::for_each_part;
use super::stage::Law;
use super::state::{Body, CHUNK, DiskState, Identity};
use super::sums::ContactSums;
use super::verlet_list::{DiskPair, ImageBatch, ImageMotion, List, PairChunk};
use domain::Vector;
use glam::DVec2;

/// Input of the pair forces: the disks and the parameters of the contacts.
#[derive(Clone, Copy)]
struct ForceInput<'a> {
    bodies: &'a [Body],
    identities: &'a [Identity],
    damping: f64,
    floor: f64,
    step: u32,
}

/// Work of one thread on a chunk.
struct ForcePart<'a> {
    chunk: &'a mut PairChunk,
    /// Forces on the chunk's own rows.
    forces: &'a mut [DVec2],
    sums: ContactSums,
}

impl List {
    /// Adds the contact forces at a step to those of the state. Measures energies and stresses on request; contacts
    /// that begin are always counted.
    pub(super) fn add_contact_forces(
        &mut self,
        state: &mut DiskState,
        law: &Law,
        step: u64,
        measure: bool,
    ) -> ContactSums {
        self.move_images(law, step);
        let input = ForceInput {
            bodies: &state.bodies,
            identities: &state.identities,
            damping: 2.0 * law.contact.damping(),
            floor: law.contact.floor(),
            step: step as u32,
        };
        let chunks = self.chunks.iter_mut().zip(state.forces.chunks_mut(CHUNK));
        let part = |(chunk, forces)| ForcePart { chunk, forces, sums: ContactSums::default() };
        let mut parts: Vec<ForcePart> = chunks.map(part).collect();
        for_each_part(&mut parts, |part| {
            if measure { part.add_forces::<true>(&input) } else { part.add_forces::<false>(&input) }
        });
        let sums = parts.iter().fold(ContactSums::default(), |sum, part| sum + part.sums);
        for chunk in &mut self.chunks {
            for (pair, force) in chunk.border_forces.drain(..) {
                state.forces[pair.i as usize] -= force;
                state.forces[pair.j as usize] += force;
            }
        }
        sums
    }
}

impl ForcePart<'_> {
    fn add_forces<const MEASURE: bool>(&mut self, input: &ForceInput) {
        let Self { chunk, forces, sums } = self;
        let PairChunk { rows, inner, border, found, border_forces } = chunk;
        let start = rows.start as u32;
        for batch in inner {
            batch.for_each_force::<MEASURE>(input, found, sums, |pair, force| {
                forces[(pair.i - start) as usize] -= force;
                forces[(pair.j - start) as usize] += force;
            });
        }
        for batch in border {
            batch.for_each_force::<MEASURE>(input, found, sums, |pair, force| border_forces.push((pair, force)));
        }
    }
}

impl DiskPair {
    #[inline(always)]
    fn touches(&self, bodies: &[Body], image: &ImageMotion) -> bool {
        let d = bodies[self.j as usize].position - bodies[self.i as usize].position + image.shift;
        d.length_squared() < self.contact_distance * self.contact_distance
    }
}

impl ImageBatch {
    /// Finds the pairs in contact, without a branch, and writes their indices.
    #[inline(always)]
    fn find<'a>(&self, bodies: &[Body], found: &'a mut [u32]) -> &'a [u32] {
        let (image, mut count) = (self.image, 0);
        for (p, pair) in self.pairs.iter().enumerate() {
            found[count] = p as u32;
            count += usize::from(pair.touches(bodies, &image));
        }
        &found[..count]
    }

    /// Passes on the force on the second disk of each pair in contact, `mu (xi + 2 kappa dxi/dt) n`.
    #[inline(always)]
    fn for_each_force<const MEASURE: bool>(
        &mut self,
        input: &ForceInput,
        found: &mut [u32],
        sums: &mut ContactSums,
        mut apply: impl FnMut(DiskPair, DVec2),
    ) {
        for &p in self.find(input.bodies, found) {
            let pair = self.pairs[p as usize];
            let (first, second) = (&input.bodies[pair.i as usize], &input.bodies[pair.j as usize]);
            let d = second.position - first.position + self.image.shift;
            let mut u = second.velocity - first.velocity;
            u.x += self.image.velocity;
            let square = larger(d.length_squared(), f64::MIN_POSITIVE);
            let distance = square.sqrt();
            let separating = d.dot(u);
            // Multiplied by distance over reduced mass.
            let push = larger((pair.contact_distance - distance) * distance - input.damping * separating, input.floor);
            let force = d * (push / (square * pair.inverse_mass_sum));
            apply(pair, force);
            let last = std::mem::replace(&mut self.touched[p as usize], input.step);
            if last != input.step.wrapping_sub(1) {
                let large = [pair.i, pair.j].map(|row| usize::from(input.identities[row as usize].is_large));
                sums.encounters[large[0] + large[1]] += 1.0;
            }
            if MEASURE {
                sums.contacts += 1.0;
                sums.image_work += force.x * self.image.velocity;
                sums.measure(&pair, d, separating / distance, force);
            }
        }
    }
}

impl ContactSums {
    /// Adds a pair with given separation, rate of separation and force.
    fn measure(&mut self, pair: &DiskPair, d: DVec2, separation_rate: f64, force: DVec2) {
        let distance = d.length();
        let overlap = pair.contact_distance - distance;
        let tension = overlap / pair.inverse_mass_sum;
        self.spring += 0.5 * tension * overlap;
        self.loss -= (force.dot(d) / distance - tension) * separation_rate;
        self.virial += Vector::new(d.x * force.x, d.x * force.y, d.y * force.y);
    }
}

/// The larger of two numbers, neither of them NaN.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}
