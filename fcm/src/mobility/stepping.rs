//! Measures of displacements of particles that move where the far field is evaluated, and of their near pairs.

use domain::{RemoteList, Tensor};
use gpu::STEP_COLUMNS;
use solver::BackgroundFlow;

/// Columns of velocities of which a displacement is a weighted sum, at most.
pub const DISPLACED: usize = STEP_COLUMNS;

/// Weights of columns of velocities in displacements; those of missing columns are ignored.
pub type DisplacementWeights = [f64; DISPLACED];

/// Columns of velocities of the arranged particles, which move in a flow.
#[derive(Clone, Copy)]
pub struct HeldVelocities<'a> {
    /// Positions to which the velocities belong.
    pub positions: &'a RemoteList,
    /// Velocities with that of the flow, up to [`DISPLACED`] columns.
    pub columns: &'a [RemoteList],
    /// The flow by which periodic images move relative to their particles.
    pub flow: &'a BackgroundFlow,
    /// Deformation, by the flow, of separations after displacements.
    pub deformation: Tensor,
}

/// Displacements by methods of several orders, whose differences estimate the error.
#[derive(Debug, Clone, Copy)]
pub enum DisplacementOrders<'a> {
    /// A displacement, and another from which its difference is the error.
    Two(&'a [DisplacementWeights; 2]),
    /// Displacements by four orders, the highest first, of which the second one is taken. With the differences `a`, `b`
    /// and `c` between one order and the next, the error is `max(b, a / 4)` and there is no roughness, if
    /// `a <= max(s0 b, s1 c)`; otherwise the error is `b` and the roughness `a`.
    Four {
        /// Weights of each order.
        weights: &'a [DisplacementWeights; 4],
        /// `s0` and `s1`.
        smooth: [f64; 2],
    },
}

/// Largest error and roughness of displacements, see [`DisplacementOrders`]; infinite if one is NaN.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplacementError {
    /// Error.
    pub error: f64,
    /// Roughness; 0 for two displacements.
    pub roughness: f64,
}

/// Changes of gaps between the surfaces of near pairs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GapChanges {
    /// Smallest gap before; infinite without pairs.
    pub gap: f64,
    /// Largest relative loss of a gap.
    pub loss: f64,
    /// Largest relative error of a gap.
    pub error: f64,
    /// Largest relative roughness of a gap.
    pub roughness: f64,
}

/// Limits of an iteration that moves near pairs apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeparationLimits {
    /// Smallest gap over the mean radius.
    pub closest: f64,
    /// Its relative tolerance.
    pub slack: f64,
    /// Number of iterations after which it fails.
    pub rounds: usize,
    /// Largest distance of centres of the pairs.
    pub reach: f64,
}

/// Displacements that separate near pairs.
#[derive(Debug, Clone, PartialEq)]
pub enum Separation {
    /// No pair is too close.
    Apart,
    /// Displacements of all particles.
    By(RemoteList),
    /// The iteration does not converge.
    Fails,
}

/// A far field that measures displacements of particles that move where it is evaluated. All lists are in the order of
/// the particles' ids and all numbers in the original units; the particles are arranged at their present positions.
/// Equal calls have the same bits.
pub trait HeldSteps {
    /// Weighted sum of columns of as many numbers, at least one.
    fn combined(&self, terms: &[(RemoteList, f64)]) -> RemoteList;

    /// Velocities plus `times` those of a flow at positions.
    fn with_flow(
        &self,
        velocities: &RemoteList,
        positions: &RemoteList,
        flow: &BackgroundFlow,
        times: f64,
    ) -> RemoteList;

    /// Vectors of a column, of which none is longer than `most` times the radius of its particle.
    fn limited(&self, column: &RemoteList, most: f64) -> RemoteList;

    /// Error of displacements over the radius of each particle.
    fn displacement_error(&self, columns: &[RemoteList], orders: &DisplacementOrders) -> DisplacementError;

    /// Change of the gaps of all pairs whose centres are within a distance `reach`, by displacements. Losses are
    /// relative to gaps of at least `least[0]` mean radii, errors and roughness to gaps of at least `least[1]`: smaller
    /// gaps count as that large. Pairs whose gap counts as zero or less in losses are ignored, except for
    /// [`GapChanges::gap`].
    fn gap_changes(
        &self,
        velocities: &HeldVelocities,
        orders: &DisplacementOrders,
        least: [f64; 2],
        reach: f64,
    ) -> GapChanges;

    /// Displacements, besides the weighted sum of velocities, that give every pair within reach the smallest gap, up to
    /// its tolerance. Iteratively, pairs that are closer are moved apart along their lines of centres, the smaller
    /// sphere farther; a sphere of several such pairs moves by their mean.
    fn moved_apart(
        &self,
        velocities: &HeldVelocities,
        weights: &DisplacementWeights,
        limits: &SeparationLimits,
    ) -> Separation;

    /// Smallest gap of pairs within `reach`, over their mean radius; infinite without pairs.
    fn smallest_relative_gap(&self, reach: f64) -> f64;
}
