//! State of a simulation between two steps, as stored in a checkpoint.

use domain::Particles;

/// All data that a simulation needs to continue as if it had not stopped.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Number of steps taken so far.
    pub step: u64,
    /// Lees-Edwards strain of the box.
    pub strain: f64,
    /// Description of how the fluid was computed; a run continues bit for bit if it is computed in the same way.
    pub plan: String,
    /// Particles with all their columns: those of this rank, in any order.
    pub particles: Particles,
    /// Counts and averages of the run so far, in the simulation's own format, in pieces; piece `k` of all ranks is on
    /// rank `k mod ranks`, in this order. Empty if there are none.
    pub statistics: Vec<Vec<u8>>,
}
