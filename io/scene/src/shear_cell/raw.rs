//! Keys of the file as serde reads them.

use crate::answers::AnswersSection;
use crate::time_and_output::OutputSection;
use schemars::JsonSchema;
use serde::Deserialize;

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ShearCellSections {
    /// Kind of the scene.
    #[serde(rename = "kind")]
    _kind: String,
    /// Title.
    pub(super) title: Option<String>,
    /// Seed of the random numbers: the same seed gives the same run.
    #[serde(default)]
    pub(super) seed: u64,
    /// Collisions at their exact times, or detected with a time step.
    pub(super) collisions: Collisions,
    /// The cell.
    pub(super) cell: CellSection,
    /// The top wall.
    #[serde(default)]
    pub(super) top: TopSection,
    /// The grains.
    pub(super) grains: GrainsSection,
    /// The walls.
    pub(super) walls: WallsSection,
    /// Observations of the cell.
    pub(super) time: ShearCellTimeSection,
    /// Averages.
    #[serde(default)]
    pub(super) measure: MeasureSection,
    /// Output.
    #[serde(default)]
    pub(super) output: OutputSection,
    /// Means over the run.
    pub(super) answers: Option<AnswersSection>,
}

#[derive(Deserialize, JsonSchema, Clone, Copy, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Collisions {
    TimeStepped,
    EventDriven,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct CellSection {
    /// Length along the flow (x), periodic.
    pub(super) length: f64,
    /// Distance between bottom and top (y).
    pub(super) height: f64,
    /// Distance between the side walls (z).
    pub(super) width: f64,
    /// Speed of the bottom and side walls along x.
    pub(super) speed: f64,
    /// Gravity along -y.
    #[serde(default)]
    pub(super) gravity: f64,
    /// Circumference of the trough at mid-width; straight by default.
    pub(super) circumference: Option<f64>,
    /// Whether the curved path also turns velocity along z into velocity along x.
    #[serde(default)]
    pub(super) coriolis: bool,
}

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct TopSection {
    /// Fixed at the height of the cell, or free under a load.
    pub(super) kind: TopKind,
    /// Normal stress of the load on a free top wall.
    pub(super) pressure: Option<f64>,
    /// Mass of a free top wall per area.
    pub(super) mass_per_area: Option<f64>,
}

#[derive(Deserialize, JsonSchema, Clone, Copy, PartialEq, Default)]
#[serde(rename_all = "kebab-case")]
pub(super) enum TopKind {
    #[default]
    Fixed,
    Free,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct GrainsSection {
    /// Diameter.
    pub(super) diameter: f64,
    /// Density.
    pub(super) density: f64,
    /// Volume of the grains over that of the cell; or count.
    pub(super) solid_fraction: Option<f64>,
    /// Number of grains; or `solid_fraction`.
    pub(super) count: Option<u64>,
    /// Coefficient of restitution between grains.
    pub(super) restitution: f64,
    /// Friction coefficient between grains.
    #[serde(default)]
    pub(super) friction: f64,
    /// Standard deviation of each component of the initial velocities.
    pub(super) initial_velocity_deviation: Option<f64>,
    /// Two collisions within this time are one contact, for "event-driven".
    pub(super) contact_time: Option<f64>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct WallsSection {
    /// Coefficient of restitution at walls.
    pub(super) restitution: f64,
    /// Friction coefficient at walls.
    #[serde(default)]
    pub(super) friction: f64,
    /// Coulomb's bound on each component separately, or on both together.
    #[serde(default)]
    pub(super) friction_law: FrictionLawKind,
}

#[derive(Deserialize, JsonSchema, Clone, Copy, Default)]
#[serde(rename_all = "kebab-case")]
pub(super) enum FrictionLawKind {
    #[default]
    Box,
    Cone,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ShearCellTimeSection {
    /// Time between observations of the grains.
    pub(super) step: f64,
    /// Number of observations; or duration.
    pub(super) steps: Option<u64>,
    /// Time at the end; or steps.
    pub(super) duration: Option<f64>,
    /// Time at the start that is not measured.
    #[serde(default)]
    pub(super) transient: f64,
    /// Time step of collisions, for "time-stepped".
    pub(super) collision_step: Option<f64>,
}

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct MeasureSection {
    /// Time over which wall stresses are averaged; time.step by default.
    pub(super) window: Option<f64>,
    /// Layers of the profiles across the gap.
    pub(super) layers: Option<usize>,
    /// Pixels of the map across width and height.
    pub(super) pixels: Option<[usize; 2]>,
}
