//! Keys of the file as serde reads them.

use schemars::JsonSchema;
use serde::Deserialize;
use std::path::PathBuf;

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ContinuumSections {
    /// Kind of the scene.
    #[serde(rename = "kind")]
    _kind: String,
    /// Title.
    pub(super) title: Option<String>,
    /// Solid fraction near which to search for the solution, instead of the densest solution.
    pub(super) start: Option<f64>,
    /// The cell.
    pub(super) cell: ContinuumCellSection,
    /// The grains.
    pub(super) grains: ContinuumGrainsSection,
    /// The walls.
    pub(super) walls: ContinuumWallsSection,
    /// Output.
    #[serde(default)]
    pub(super) output: ContinuumOutputSection,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ContinuumCellSection {
    /// Distance between the walls.
    pub(super) gap: f64,
    /// Speeds of the lower wall; each is combined with every pressure.
    pub(super) speeds: Vec<f64>,
    /// Normal stresses on the walls.
    pub(super) pressures: Vec<f64>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ContinuumGrainsSection {
    /// Diameter.
    pub(super) diameter: f64,
    /// Density.
    pub(super) density: f64,
    /// Coefficient of restitution between grains.
    pub(super) restitution: f64,
    /// Radial distribution function at contact.
    #[serde(default)]
    pub(super) radial_distribution: RadialDistributionKind,
}

#[derive(Deserialize, JsonSchema, Clone, Copy, Default)]
#[serde(rename_all = "kebab-case")]
pub(super) enum RadialDistributionKind {
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
pub(super) struct ContinuumWallsSection {
    /// Shape of the bumps.
    #[serde(default)]
    pub(super) shape: WallShapeKind,
    /// Depth to which a grain reaches between two bumps, as an angle in degrees: 90 if one grain just fits.
    pub(super) theta: Option<f64>,
    /// Whether the traction includes a term in the velocity gradient.
    #[serde(default)]
    pub(super) gradient: bool,
    /// Diameter of the bumps; that of the grains by default.
    pub(super) diameter: Option<f64>,
    /// Coefficient of restitution at walls.
    pub(super) restitution: f64,
    /// Factor on the slip law: 0 smooth, 1 rough.
    pub(super) r5: f64,
    /// Factor on the energy lost in collisions with the walls: 0 smooth, 1 rough.
    pub(super) r6: f64,
    /// Factor on the energy supplied by slip: 0 smooth, 1 rough.
    pub(super) r7: f64,
    /// Factor on the energy supplied by slip and gradient together: 0 smooth, 1 rough.
    pub(super) r8: f64,
}

#[derive(Deserialize, JsonSchema, Clone, Copy, Default)]
#[serde(rename_all = "kebab-case")]
pub(super) enum WallShapeKind {
    #[default]
    Disk,
    Sphere,
}

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct ContinuumOutputSection {
    /// Folder of the results.
    pub(super) folder: Option<PathBuf>,
    /// Number of heights in a profile.
    pub(super) points: Option<usize>,
}
