//! The file's keys, as serde finds them.

use crate::scene::course::RawOutput;
use serde::Deserialize;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct Raw {
    #[serde(rename = "kind")]
    _kind: String,
    pub(super) title: Option<String>,
    #[serde(default)]
    pub(super) seed: u64,
    pub(super) collisions: Collisions,
    pub(super) cell: Cell,
    #[serde(default)]
    pub(super) top: Top,
    pub(super) grains: Grains,
    pub(super) walls: Walls,
    pub(super) time: Time,
    #[serde(default)]
    pub(super) measure: Measure,
    #[serde(default)]
    pub(super) output: RawOutput,
}

#[derive(Deserialize, Clone, Copy, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Collisions {
    TimeStepped,
    EventDriven,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Cell {
    pub(super) length: f64,
    pub(super) height: f64,
    pub(super) width: f64,
    pub(super) speed: f64,
    #[serde(default)]
    pub(super) gravity: f64,
    pub(super) circumference: Option<f64>,
    #[serde(default)]
    pub(super) coriolis: bool,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Top {
    pub(super) kind: TopKind,
    pub(super) pressure: Option<f64>,
    pub(super) mass_per_area: Option<f64>,
}

#[derive(Deserialize, Clone, Copy, PartialEq, Default)]
#[serde(rename_all = "kebab-case")]
pub(super) enum TopKind {
    #[default]
    Fixed,
    Free,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Grains {
    pub(super) diameter: f64,
    pub(super) density: f64,
    pub(super) solid_fraction: Option<f64>,
    pub(super) count: Option<u64>,
    pub(super) restitution: f64,
    #[serde(default)]
    pub(super) friction: f64,
    pub(super) agitation: Option<f64>,
    pub(super) contact_time: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Walls {
    pub(super) restitution: f64,
    #[serde(default)]
    pub(super) friction: f64,
    #[serde(default)]
    pub(super) friction_law: FrictionLaw,
}

#[derive(Deserialize, Clone, Copy, Default)]
#[serde(rename_all = "kebab-case")]
pub(super) enum FrictionLaw {
    #[default]
    Box,
    Cone,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Time {
    pub(super) step: f64,
    pub(super) steps: Option<u64>,
    pub(super) duration: Option<f64>,
    #[serde(default)]
    pub(super) settle: f64,
    pub(super) collision_step: Option<f64>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Measure {
    pub(super) window: Option<f64>,
    pub(super) layers: Option<usize>,
    pub(super) pixels: Option<[usize; 2]>,
}
