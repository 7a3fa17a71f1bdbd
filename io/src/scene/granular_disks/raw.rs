//! The file's keys, as serde finds them.

use crate::scene::course::RawOutput;
use drivers::disks::{Gear, LengthUnit};
use serde::Deserialize;
use std::path::PathBuf;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct Raw {
    #[serde(rename = "kind")]
    _kind: String,
    pub(super) title: Option<String>,
    pub(super) seed: Option<u64>,
    #[serde(rename = "box")]
    pub(super) cell: Box,
    pub(super) fluid: Fluid,
    pub(super) flow: Flow,
    #[serde(default)]
    pub(super) species: Vec<Species>,
    pub(super) particles: Particles,
    #[serde(default)]
    pub(super) contact: Contact,
    #[serde(default)]
    pub(super) preparation: Preparation,
    pub(super) time: Time,
    #[serde(default)]
    pub(super) output: Output,
    pub(super) sweep: Option<Sweep>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Box {
    pub(super) edges: [f64; 2],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Fluid {
    pub(super) viscosity: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Flow {
    pub(super) kind: FlowKind,
    pub(super) rate: Option<f64>,
    pub(super) peak: Option<f64>,
}

#[derive(Deserialize, Clone, Copy, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub(super) enum FlowKind {
    None,
    Shear,
    Poiseuille,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Species {
    pub(super) radius: f64,
    pub(super) share: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Particles {
    pub(super) area_fraction: Option<f64>,
    pub(super) spread: Option<Spread>,
    pub(super) length_unit: Option<Unit>,
    pub(super) mass_exponent: Option<i32>,
    pub(super) path: Option<PathBuf>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Spread {
    pub(super) smallest: f64,
    pub(super) largest: f64,
    #[serde(default)]
    pub(super) exponent: f64,
}

#[derive(Deserialize, Clone, Copy)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Unit {
    Mean,
    Smallest,
}

impl From<Unit> for LengthUnit {
    fn from(unit: Unit) -> Self {
        match unit {
            Unit::Mean => Self::Mean,
            Unit::Smallest => Self::Smallest,
        }
    }
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Contact {
    pub(super) restitution: Option<f64>,
    pub(super) clip_attraction: bool,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Preparation {
    pub(super) restitution: Option<f64>,
    pub(super) settled: Option<f64>,
    pub(super) mixed: Option<f64>,
    pub(super) integrator: Option<Integrator>,
    pub(super) time_step: Option<f64>,
}

#[derive(Deserialize, Clone, Copy)]
pub(super) enum Integrator {
    #[serde(rename = "gear-four")]
    Four,
    #[serde(rename = "gear-five")]
    Five,
    #[serde(rename = "gear-five-positional")]
    FivePositional,
}

impl From<Integrator> for Gear {
    fn from(integrator: Integrator) -> Self {
        match integrator {
            Integrator::Four => Self::FourValue,
            Integrator::Five => Self::FiveValue,
            Integrator::FivePositional => Self::FiveValuePositional,
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Time {
    pub(super) step: Option<f64>,
    pub(super) steps: Option<u64>,
    pub(super) duration: Option<f64>,
    pub(super) strain: Option<f64>,
    pub(super) integrator: Option<Integrator>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Output {
    pub(super) folder: Option<PathBuf>,
    pub(super) trajectory_every: Option<u64>,
    pub(super) observables_every: Option<u64>,
    pub(super) checkpoint_every: Option<u64>,
    pub(super) measure_every: Option<u64>,
    pub(super) profile_strips: Option<usize>,
}

impl Output {
    pub(super) fn schedules(&self) -> RawOutput {
        RawOutput {
            folder: self.folder.clone(),
            trajectory_every: self.trajectory_every,
            observables_every: self.observables_every,
            checkpoint_every: self.checkpoint_every,
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Sweep {
    pub(super) seeds: Option<Vec<u64>>,
    pub(super) viscosities: Option<Vec<f64>>,
    pub(super) rates: Option<Vec<f64>>,
    pub(super) area_fractions: Option<Vec<f64>>,
}
