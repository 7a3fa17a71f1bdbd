//! The state of a simulation between two steps: what a checkpoint keeps.

use domain::Particles;

/// Everything that a simulation needs to go on as if it had not stopped.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Steps taken so far.
    pub step: u64,
    /// The box's Lees-Edwards strain.
    pub strain: f64,
    /// How the fluid was computed, in words: a run goes on bit for bit if it is computed the same way.
    pub plan: String,
    /// All particles in the order of their ids, with all their columns.
    pub particles: Particles,
    /// What the run has counted and averaged so far, as it stores it; empty where there is nothing of the kind.
    pub statistics: Vec<u8>,
}
