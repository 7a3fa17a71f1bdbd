//! The file's keys, as serde finds them.

use serde::Deserialize;
use std::path::PathBuf;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct Raw {
    #[serde(rename = "kind")]
    _kind: Option<String>,
    pub(super) title: Option<String>,
    #[serde(default)]
    pub(super) seed: u64,
    #[serde(rename = "box")]
    pub(super) cell: Box,
    pub(super) fluid: Fluid,
    pub(super) species: Vec<Species>,
    pub(super) gravity: Option<Gravity>,
    #[serde(default)]
    pub(super) particles: Particles,
    pub(super) flow: Option<Flow>,
    pub(super) repulsion: Option<Repulsion>,
    #[serde(default)]
    pub(super) hydrodynamics: Hydrodynamics,
    pub(super) time: Time,
    #[serde(default)]
    pub(super) output: Output,
    pub(super) statistics: Option<Statistics>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Box {
    pub(super) edges: [f64; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Fluid {
    pub(super) viscosity: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Species {
    pub(super) name: Option<String>,
    pub(super) radius: f64,
    pub(super) count: Option<u64>,
    pub(super) volume_fraction: Option<f64>,
    pub(super) density_difference: Option<f64>,
    #[serde(default)]
    pub(super) force: [f64; 3],
    #[serde(default)]
    pub(super) torque: [f64; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Gravity {
    pub(super) acceleration: [f64; 3],
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct Particles {
    #[serde(default)]
    pub(super) initial: Initial,
    pub(super) minimum_gap: Option<f64>,
    pub(super) lattice: Option<Lattice>,
    pub(super) path: Option<PathBuf>,
    pub(super) positions: Option<Vec<[f64; 3]>>,
}

#[derive(Deserialize, Default, Clone, Copy, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Initial {
    #[default]
    Random,
    Lattice,
    File,
    Positions,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Flow {
    pub(super) kind: FlowKind,
    pub(super) rate: Option<f64>,
    pub(super) lees_edwards: Option<bool>,
}

#[derive(Deserialize, Clone, Copy)]
#[serde(rename_all = "kebab-case")]
pub(super) enum FlowKind {
    None,
    Shear,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Repulsion {
    pub(super) strength: f64,
    pub(super) range: Option<f64>,
    #[serde(default)]
    pub(super) radius_power: u8,
    #[serde(default)]
    pub(super) calibrate: bool,
}

/// What is left out is as the suspension's own defaults have it.
#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct Hydrodynamics {
    pub(super) multipoles: Option<Multipoles>,
    pub(super) tolerance: Option<f64>,
    pub(super) method: Option<Evaluation>,
    pub(super) grid: Option<[usize; 3]>,
    pub(super) support: Option<usize>,
    pub(super) iteration_tolerance: Option<f64>,
    pub(super) costs: Option<Costs>,
    pub(super) lubrication: Option<bool>,
    pub(super) lubrication_cutoff: Option<f64>,
    pub(super) preconditioner: Option<bool>,
}

#[derive(Deserialize, Clone, Copy)]
#[serde(deny_unknown_fields)]
pub(super) struct Costs {
    pub(super) stencils: f64,
    pub(super) transforms: f64,
    pub(super) pairs: f64,
}

/// Declares the names that a scene has for the values of a library's type.
macro_rules! names {
    ($raw:ident for $library:ty: $($name:ident)*) => {
        #[derive(Deserialize, Clone, Copy)]
        #[serde(rename_all = "kebab-case")]
        pub(super) enum $raw {
            $($name,)*
        }

        impl From<$raw> for $library {
            fn from(name: $raw) -> Self {
                match name {
                    $($raw::$name => Self::$name,)*
                }
            }
        }
    };
}

names! { Multipoles for suspension::Multipoles: Monopole Dipole }
names! { Evaluation for suspension::Evaluation: Auto Direct Split }
names! { Lattice for suspension::Lattice: SimpleCubic FaceCentredCubic }
names! { Axis for suspension::Axis: X Y Z }

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Time {
    pub(super) step: f64,
    pub(super) steps: Option<u64>,
    pub(super) duration: Option<f64>,
    #[serde(default)]
    pub(super) integrator: Integrator,
    pub(super) order: Option<u8>,
    pub(super) tolerance: Option<f64>,
    pub(super) gap_fraction: Option<f64>,
}

#[derive(Deserialize, Default, Clone, Copy, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Integrator {
    #[default]
    AdamsBashforth,
    Adaptive,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Output {
    pub(super) folder: Option<PathBuf>,
    pub(super) trajectory_every: Option<u64>,
    pub(super) observables_every: Option<u64>,
    pub(super) checkpoint_every: Option<u64>,
    pub(super) fields_every: u64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Statistics {
    pub(super) every: u64,
    #[serde(default)]
    pub(super) from: f64,
    pub(super) distance: Option<f64>,
    pub(super) axis: Option<Axis>,
    pub(super) diffusive_from: Option<f64>,
}
