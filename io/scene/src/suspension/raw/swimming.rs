//! Keys of swimmers.

use schemars::JsonSchema;
use serde::Deserialize;

/// Swimming of a species along the axes of its orientations.
#[derive(Deserialize, JsonSchema, Clone)]
#[serde(deny_unknown_fields)]
pub(in super::super) struct SwimmingSection {
    /// Speed of one alone in unbounded fluid, 2/3 of the first mode B1 of its slip; 0 for shakers.
    pub(in super::super) speed: f64,
    /// Second mode of the slip over the first, B2 / B1: negative for pushers, positive for pullers, 0 by default; or
    /// stresslet.
    pub(in super::super) beta: Option<f64>,
    /// Strength S of the stresslet S (p p - I/3) of one alone, negative for pushers and positive for pullers; or beta.
    pub(in super::super) stresslet: Option<f64>,
    /// Angular velocity of one alone in fluid at rest, in the axes of the sphere, the third of which is the one along
    /// which it swims; none by default.
    pub(in super::super) angular_velocity: Option<[f64; 3]>,
    /// Gyrotactic reorientation time B of bottom-heavy spheres, whose axes turn against gravity at the rate 1 / (2 B);
    /// none by default.
    pub(in super::super) gyrotactic_time: Option<f64>,
    /// Rotational diffusivity of the swimming itself, in addition to Brownian rotation; none by default.
    pub(in super::super) rotational_diffusion: Option<f64>,
    /// Number of tumbles per time, after each of which all directions are equally likely; none by default.
    pub(in super::super) tumbling_rate: Option<f64>,
}
