//! The file's keys, as serde finds them.

use schemars::JsonSchema;
use serde::Deserialize;
use std::path::PathBuf;

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct Raw {
    /// What the scene is of.
    #[serde(rename = "kind")]
    _kind: String,
    /// A title for people.
    pub(super) title: Option<String>,
    /// Solid fraction near which to look for the solution, instead of the densest.
    pub(super) start: Option<f64>,
    /// The cell.
    pub(super) cell: Cell,
    /// The grains.
    pub(super) grains: Grains,
    /// The walls.
    pub(super) walls: Walls,
    /// What is written.
    #[serde(default)]
    pub(super) output: Output,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Cell {
    /// Distance of the walls.
    pub(super) gap: f64,
    /// Speeds of the lower wall; every speed at every pressure.
    pub(super) speeds: Vec<f64>,
    /// Normal stresses on the walls.
    pub(super) pressures: Vec<f64>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Grains {
    /// Diameter.
    pub(super) diameter: f64,
    /// Density.
    pub(super) density: f64,
    /// Restitution between grains.
    pub(super) restitution: f64,
    /// Radial distribution function at contact.
    #[serde(default)]
    pub(super) radial_distribution: RadialDistribution,
}

#[derive(Deserialize, JsonSchema, Clone, Copy, Default)]
#[serde(rename_all = "kebab-case")]
pub(super) enum RadialDistribution {
    CarnahanStarling,
    LunSavage,
    JohnsonJackson,
    #[default]
    SinclairJackson,
    MaAhmadi,
    Torquato,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Walls {
    /// Shape of the bumps.
    #[serde(default)]
    pub(super) shape: Shape,
    /// How far down a grain reaches between two bumps, in degrees: 90 where one just fits.
    pub(super) theta: Option<f64>,
    /// Whether the traction has a term in the velocity gradient.
    #[serde(default)]
    pub(super) gradient: bool,
    /// Diameter of the bumps; the grains' by default.
    pub(super) diameter: Option<f64>,
    /// Restitution at walls.
    pub(super) restitution: f64,
    /// Factor on a term of the walls' laws: 0 smooth, 1 rough.
    pub(super) r5: f64,
    /// Factor on a term of the walls' laws: 0 smooth, 1 rough.
    pub(super) r6: f64,
    /// Factor on a term of the walls' laws: 0 smooth, 1 rough.
    pub(super) r7: f64,
    /// Factor on a term of the walls' laws: 0 smooth, 1 rough.
    pub(super) r8: f64,
}

#[derive(Deserialize, JsonSchema, Clone, Copy, Default)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Shape {
    #[default]
    Disk,
    Sphere,
}

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Output {
    /// Folder of the results.
    pub(super) folder: Option<PathBuf>,
    /// Heights in a profile.
    pub(super) points: Option<usize>,
}
