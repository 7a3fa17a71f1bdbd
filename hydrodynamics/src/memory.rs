//! Memory of a solve with lubrication.

use crate::pairs::matrix::diagonal_block::DiagonalBlock;
use crate::pairs::matrix::inverse_block::Block;
use crate::pairs::matrix::lanes::LANES;
use crate::pairs::matrix::sparse::{LaneGroup, MomentGroup, Padded};
use crate::six_vector::SixVector;
use domain::{Bytes, ExpectedCounts, Halo, MemoryNeed, Particles, Process, Traceless, Vector, VerletList};
use fcm::{CardMemory, CardRanks, CardSteps, Footprint, NearKind, NearPairCounts, PlanError, Precision};
use lubrication::{LubricationRange, PairForce};

/// Parallel layout: number of ranks and of threads per rank.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ranks {
    /// Number of ranks.
    pub count: usize,
    /// Threads per rank.
    pub threads: usize,
}

/// Memory of a rank from the peak of its allocations and the far field of a plan.
pub fn of_peak(peak: Bytes, far: &Footprint, rank: usize, ranks: usize) -> MemoryNeed {
    let remote = far.remote_resident_bytes();
    let resident = Process::of(rank, ranks).resident(peak.most) + remote;
    MemoryNeed { resident, remote, mapped: far.mapped_bytes(ranks) - remote }
}

/// Gap up to which pairs are stiff, over the smaller radius; an estimate of the gaps in
/// [`crate::pairs::lubrication::PairLubrication`].
const STIFF: f64 = 0.5;

/// Excess of the longest row of a slice over the mean number of pairs, in standard deviations; the rows of a block are
/// sorted.
const SPREAD: f64 = 0.28;

/// Numbers per particle in the unknowns and in a residual.
type UnknownsOfOne = ([SixVector; 4], Traceless);
type ResidualOfOne = ([SixVector; 2], Traceless);

/// Tables of lubrication between spheres of the given radii.
pub fn table_bytes(radii: &[f64]) -> Bytes {
    PairForce::bytes(radii)
}

/// Memory of [`crate::CoupledSolver::solve`] with lubrication at the gaps of a range.
pub fn solve_bytes(far: &Footprint, expected: &ExpectedCounts, range: LubricationRange) -> Bytes {
    let owned = expected.owned();
    // Particles in scaled units, known loads, resistances of single spheres and inverses of the diagonal blocks.
    let given = Particles::bytes(owned, 0).then(Bytes::list::<([SixVector; 2], f64, Block)>(owned));
    let residual = Bytes::list::<(ResidualOfOne, Traceless)>(owned);
    // Solution and direction; the preconditioned residual, and the loads of the direction as its flow is evaluated; or
    // solution, residual, preconditioned residual, direction and its image in a solve for stiff pairs.
    let unknowns = Bytes::list::<[UnknownsOfOne; 2]>(owned);
    let loads = Bytes::list::<(UnknownsOfOne, SixVector, Traceless)>(owned);
    let inner = Bytes::list::<([SixVector; 5], Padded)>(owned);
    let passes = loads.then(far.evaluation()).freed().or(inner.freed());
    let (lists, pairs) = near_pairs(expected, range, far.precision());
    lists.then(pairs.then(given).then(residual).then(unknowns).then(passes).freed())
}

/// Memory that a solve takes of a card, with lubrication at the gaps of a range if there is one, and that steps take
/// there; none if the plan is for the host. Without lubrication the
/// iteration has the same vectors, and no pairs. Collective.
pub fn card(
    far: &Footprint,
    expected: &ExpectedCounts,
    range: Option<LubricationRange>,
    steps: &CardSteps,
    ranks: CardRanks,
) -> Result<Option<CardMemory>, PlanError> {
    let near = |range| NearPairCounts {
        tables: PairForce::series_bytes(far.radii(), range, STIFF),
        ..pair_counts(expected, range)
    };
    // Pairs of radii without series.
    let kinds = (far.radii().len().pow(2) * size_of::<NearKind>()) as f64;
    let without = || NearPairCounts { tables: kinds, ..NearPairCounts::default() };
    far.card(range.map_or_else(without, near), steps, ranks)
}

/// Mean numbers of near pairs of a particle.
fn pair_counts(expected: &ExpectedCounts, range: LubricationRange) -> NearPairCounts {
    let cutoff = range.cutoff();
    let all = expected.neighbours((2.0 + cutoff) * expected.largest_radius());
    let stiff = expected.neighbours_of_pairs(|a, b| a + b + STIFF.min(cutoff) * a.min(b));
    NearPairCounts { stiff, soft: all - stiff, tables: 0.0 }
}

/// Neighbour lists, and the near pairs of a rank's particles.
fn near_pairs(expected: &ExpectedCounts, range: LubricationRange, precision: Precision) -> (Bytes, Bytes) {
    let cutoff = range.cutoff();
    let reach = (2.0 + cutoff) * expected.largest_radius();
    let (owned, present) = (expected.owned(), expected.present(reach));
    let numbers = [reach, reach * VerletList::REACH].map(|reach| expected.neighbours(reach));
    let lists = VerletList::bytes([owned, present, expected.total()], numbers);
    let NearPairCounts { stiff, soft, .. } = pair_counts(expected, range);
    let rows = Bytes::list::<([DiagonalBlock<f64>; 2], [u32; 2], SixVector, Traceless)>(owned);
    let copies = Bytes::list::<(Vector, u64, u32)>(present);
    let [stiff, soft] = [stiff, soft].map(|pairs| groups(pairs) * owned);
    let soft = match precision {
        Precision::Single => Bytes::list::<(LaneGroup<f32>, MomentGroup<f32>)>(soft),
        Precision::Double => Bytes::list::<(LaneGroup<f64>, MomentGroup<f64>)>(soft),
    };
    let pairs = Bytes::list::<(LaneGroup<f64>, MomentGroup<f64>)>(stiff).then(soft);
    (lists.then(copies), Halo::bytes(owned, present).then(rows).then(pairs))
}

/// Groups per row for a mean number of pairs per row: a slice is as long as its longest row, which exceeds the mean by
/// a part of the standard deviation of a Poisson distribution.
fn groups(pairs: f64) -> f64 {
    let pairs = pairs.max(0.0);
    (pairs + SPREAD * pairs.sqrt()) / LANES as f64
}
