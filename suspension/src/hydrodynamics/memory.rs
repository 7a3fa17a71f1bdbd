//! What a solve with lubrication takes.

use super::block::Block;
use super::near_pairs::{Modes, NearPair};
use super::screw::Screw;
use domain::{Bytes, ExpectedCounts, Halo, Pairs, Traceless, Vector};
use fcm::Footprint;
use lubrication::{PairForce, Range};

/// Gaps up to which pairs are stiff, in radii of the smaller sphere: what [`super::Stiffness`] finds, about.
const STIFF: f64 = 0.5;

/// Lists of unknowns that conjugate gradients have at once: solution, residual, direction, its image, preconditioned
/// residuals of now and before, and the next direction.
const VECTORS: f64 = 7.0;

/// Tables of lubrication between spheres of some radii.
pub fn table_bytes(radii: &[f64]) -> Bytes {
    PairForce::bytes(radii)
}

/// [`super::Hydrodynamics::solve`] with lubrication at gaps up to the end of a range.
pub fn solve_bytes(far: &Footprint, expected: &ExpectedCounts, range: Range) -> Bytes {
    let pairs = NearbyPairs::of(expected, range);
    let owned = expected.owned();
    let single = Bytes::list::<(Screw, f64)>(owned);
    let unknowns = pairs.unknowns(owned, VECTORS);
    let loads = Bytes::list::<Screw>(6.0 * owned).then(Bytes::list::<(Vector, Vector, Traceless)>(3.0 * owned));
    let inner = Bytes::list::<Screw>(6.0 * owned);
    let evaluation = far.evaluation().or(inner);
    pairs.found.then(single).then(pairs.matrix(owned)).then(unknowns).then(loads).then(evaluation).freed()
}

/// The pairs within reach of lubrication that a rank keeps.
struct NearbyPairs {
    count: f64,
    stiff: f64,
    present: f64,
    /// What finding them takes, and they themselves.
    found: Bytes,
}

impl NearbyPairs {
    fn of(expected: &ExpectedCounts, range: Range) -> Self {
        let cutoff = range.cutoff();
        let largest = expected.largest_radius();
        let reach = (2.0 + cutoff) * largest;
        let (owned, present) = (expected.owned(), expected.present(reach));
        let count = 0.5 * owned * expected.neighbours_of_pairs(|a, b| a + b + cutoff * a.max(b));
        let stiff = 0.5 * owned * expected.neighbours_of_pairs(|a, b| a + b + STIFF.min(cutoff) * a.min(b));
        let searched = expected.neighbours(reach);
        let copies = Bytes::list::<(Vector, u64, u32)>(present);
        let search = copies.then(Pairs::bytes(owned, present, searched));
        let order = Bytes::list::<(u8, usize)>(0.5 * owned * searched);
        let finding = search.then(order).then(Bytes::list::<NearPair>(count)).freed();
        let found = Halo::bytes(owned, present).then(finding).then(Bytes::list::<NearPair>(count));
        Self { count, stiff, present, found }
    }

    /// [`super::ParticleMatrix`]: diagonal blocks of all present, inverse ones, and two entries a stiff pair.
    fn matrix(&self, owned: f64) -> Bytes {
        let diagonal = Bytes::list::<Block>(self.present + owned).then(Bytes::list::<[usize; 2]>(self.present));
        diagonal.then(Bytes::list::<(u32, Block)>(2.0 * self.stiff))
    }

    fn unknowns(&self, owned: f64, vectors: f64) -> Bytes {
        Bytes::list::<Modes>(vectors * self.count).then(Bytes::list::<Traceless>(vectors * owned))
    }
}
