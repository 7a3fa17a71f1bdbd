//! The file's keys, as serde finds them.

use serde::Deserialize;
use std::path::PathBuf;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct Raw {
    #[serde(rename = "kind")]
    _kind: String,
    pub(super) title: Option<String>,
    pub(super) start: Option<f64>,
    pub(super) cell: Cell,
    pub(super) grains: Grains,
    pub(super) walls: Walls,
    #[serde(default)]
    pub(super) output: Output,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Cell {
    pub(super) gap: f64,
    pub(super) speeds: Vec<f64>,
    pub(super) pressures: Vec<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Grains {
    pub(super) diameter: f64,
    pub(super) density: f64,
    pub(super) restitution: f64,
    #[serde(default)]
    pub(super) radial_distribution: RadialDistribution,
}

#[derive(Deserialize, Clone, Copy, Default)]
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

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Walls {
    #[serde(default)]
    pub(super) shape: Shape,
    pub(super) theta: Option<f64>,
    #[serde(default)]
    pub(super) gradient: bool,
    pub(super) diameter: Option<f64>,
    pub(super) restitution: f64,
    pub(super) r5: f64,
    pub(super) r6: f64,
    pub(super) r7: f64,
    pub(super) r8: f64,
}

#[derive(Deserialize, Clone, Copy, Default)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Shape {
    #[default]
    Disk,
    Sphere,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Output {
    pub(super) folder: Option<PathBuf>,
    pub(super) points: Option<usize>,
}
