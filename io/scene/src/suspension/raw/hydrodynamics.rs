//! Keys of the hydrodynamic interactions.

use super::Multipoles;
use crate::{CaseDevice, CaseMethod};
use schemars::JsonSchema;
use serde::Deserialize;

/// Keys that are absent take the defaults of the suspension.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields)]
pub(in crate::suspension) struct HydrodynamicsSection {
    /// Terms of the multipole expansion: forces alone, or torques and stresslets as well.
    pub(in crate::suspension) multipoles: Option<Multipoles>,
    /// Relative error of velocities, angular velocities and stresslets.
    pub(in crate::suspension) tolerance: Option<f64>,
    /// Evaluation method of the far field; the fastest by default.
    pub(in crate::suspension) method: Option<CaseMethod>,
    /// Device that evaluates the far field; the processors of the host by default.
    pub(in crate::suspension) device: Option<CaseDevice>,
    /// Grid points along x, y and z, which are even numbers; chosen from the tolerance by default.
    pub(in crate::suspension) grid: Option<[usize; 3]>,
    /// Grid points across the support of an envelope; chosen from the tolerance by default.
    pub(in crate::suspension) support: Option<usize>,
    /// Relative residual of the solve for the stresslets; chosen from the tolerance by default.
    pub(in crate::suspension) iteration_tolerance: Option<f64>,
    /// Costs of the parts of an evaluation on this machine, as measured by `fcm-solve calibrate`.
    pub(in crate::suspension) costs: Option<CostsSection>,
    /// Ranks and the network between them that the plan is made for; without it the plan is that of one machine.
    pub(in crate::suspension) network: Option<NetworkSection>,
    /// Whether near pairs have exact lubrication forces.
    pub(in crate::suspension) lubrication: Option<bool>,
    /// Gap at which lubrication ends, over the radius of the larger sphere; 2.5 by default.
    pub(in crate::suspension) lubrication_cutoff: Option<f64>,
    /// Whether the solve with lubrication is preconditioned.
    pub(in crate::suspension) preconditioner: Option<bool>,
}

#[derive(Deserialize, JsonSchema, Clone, Copy)]
#[serde(deny_unknown_fields)]
pub(in crate::suspension) struct CostsSection {
    /// Spreading and interpolation.
    pub(in crate::suspension) stencils: f64,
    /// Fourier transforms.
    pub(in crate::suspension) transforms: f64,
    /// Pair corrections.
    pub(in crate::suspension) pairs: f64,
}

#[derive(Deserialize, JsonSchema, Clone, Copy)]
#[serde(deny_unknown_fields)]
pub(in crate::suspension) struct NetworkSection {
    /// Number of ranks.
    pub(in crate::suspension) ranks: usize,
    /// Threads of each rank; 1 by default.
    pub(in crate::suspension) threads: Option<usize>,
    /// Bytes that a rank sends in a second while all ranks send.
    pub(in crate::suspension) bandwidth: f64,
    /// Seconds of a message; 0 by default.
    pub(in crate::suspension) latency: Option<f64>,
}
