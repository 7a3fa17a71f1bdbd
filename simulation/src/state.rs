//! The state of a simulation between two steps: what a checkpoint keeps.

use domain::Particles;

/// Everything that a simulation needs to continue as if it had not stopped.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Steps taken so far.
    pub step: u64,
    /// The box's Lees-Edwards strain.
    pub strain: f64,
    /// How the fluid was computed, in words; a run continues bit for bit if it is computed in the same way.
    pub plan: String,
    /// Particles with all their columns: those of this rank, in any order.
    pub particles: Particles,
    /// The counts and averages of the run so far, in the simulation's own format, in pieces of which number `k` of all ranks is on
    /// rank `k mod ranks`, in this order; empty if there are none.
    pub statistics: Vec<Vec<u8>>,
}
