//! Keys of the file as serde reads them.

use crate::answers::AnswersSection;
use crate::time_and_output::{OutputSection, output_section};
use granular::disks::{Gear, LengthUnit};
use schemars::JsonSchema;
use serde::Deserialize;
use std::path::PathBuf;

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct DisksSections {
    /// Kind of the scene.
    #[serde(rename = "kind")]
    _kind: String,
    /// Title.
    pub(super) title: Option<String>,
    /// Seed of the random numbers: the same seed gives the same run.
    pub(super) seed: Option<u64>,
    /// The periodic box.
    #[serde(rename = "box")]
    pub(super) cell: DiskBoxSection,
    /// The liquid.
    pub(super) fluid: DiskFluidSection,
    /// The background flow.
    pub(super) flow: DiskFlowSection,
    /// Species of disks; or particles.spread.
    #[serde(default)]
    pub(super) species: Vec<DiskSpeciesSection>,
    /// The disks.
    pub(super) particles: DiskParticlesSection,
    /// Contacts between disks.
    #[serde(default)]
    pub(super) contact: DiskContactSection,
    /// Preparation of a random start, before step 0.
    #[serde(default)]
    pub(super) preparation: PreparationSection,
    /// Time steps.
    pub(super) time: DiskTimeSection,
    /// Output.
    #[serde(default)]
    pub(super) output: DiskOutputSection,
    /// Means over the run.
    pub(super) answers: Option<AnswersSection>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct DiskBoxSection {
    /// Edges along the flow (x) and the gradient (y).
    pub(super) edges: [f64; 2],
    /// Strain of the box at the start, for disks that come from a sheared box; by default that of the file's box.
    pub(super) strain: Option<f64>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct DiskFluidSection {
    /// Viscosity in the Stokes drag 6 pi r viscosity.
    pub(super) viscosity: f64,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct DiskFlowSection {
    /// Flow of the liquid.
    pub(super) kind: DiskFlowKind,
    /// Shear rate, for "shear".
    pub(super) rate: Option<f64>,
    /// Largest velocity, for "poiseuille".
    pub(super) peak: Option<f64>,
}

#[derive(Deserialize, JsonSchema, Clone, Copy, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub(super) enum DiskFlowKind {
    None,
    Shear,
    Poiseuille,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct DiskSpeciesSection {
    /// Radius, relative to those of the other species.
    pub(super) radius: f64,
    /// Number, relative to those of the other species.
    pub(super) number_fraction: f64,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct DiskParticlesSection {
    /// Area of the disks over that of the box.
    pub(super) area_fraction: Option<f64>,
    /// Radii by a power law, instead of species.
    pub(super) spread: Option<RadiusSpreadSection>,
    /// The radius that is 1.
    pub(super) length_unit: Option<Unit>,
    /// Power of the radius to which mass is proportional: 2 for disks, 3 for spheres.
    pub(super) mass_exponent: Option<i32>,
    /// Disks from a file, instead of `area_fraction`.
    pub(super) path: Option<PathBuf>,
    /// Number of the frame of the file, from 0, or from the end if negative; the last one by default.
    pub(super) frame: Option<i64>,
    /// Group of particles of an H5MD file; the only one by default.
    pub(super) group: Option<String>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct RadiusSpreadSection {
    /// Smallest radius.
    pub(super) smallest: f64,
    /// Largest radius.
    pub(super) largest: f64,
    /// Exponent of the density of radii.
    #[serde(default)]
    pub(super) exponent: f64,
}

#[derive(Deserialize, JsonSchema, Clone, Copy)]
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

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct DiskContactSection {
    /// Coefficient of restitution of a contact without flow.
    pub(super) restitution: Option<f64>,
    /// Whether a contact that is about to end may not attract.
    pub(super) suppress_attraction: bool,
}

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct PreparationSection {
    /// Coefficient of restitution while overlaps are removed.
    pub(super) restitution: Option<f64>,
    /// Time until which overlaps are removed.
    pub(super) inelastic_until: Option<f64>,
    /// Time until which contacts are elastic after that.
    pub(super) elastic_until: Option<f64>,
    /// Integrator of the preparation.
    pub(super) integrator: Option<DiskIntegratorKind>,
    /// Time step of the preparation.
    pub(super) time_step: Option<f64>,
}

#[derive(Deserialize, JsonSchema, Clone, Copy)]
pub(super) enum DiskIntegratorKind {
    #[serde(rename = "gear-four")]
    Four,
    #[serde(rename = "gear-five")]
    Five,
    #[serde(rename = "gear-five-positional")]
    FivePositional,
}

impl From<DiskIntegratorKind> for Gear {
    fn from(integrator: DiskIntegratorKind) -> Self {
        match integrator {
            DiskIntegratorKind::Four => Self::FourValue,
            DiskIntegratorKind::Five => Self::FiveValue,
            DiskIntegratorKind::FivePositional => Self::FiveValuePositional,
        }
    }
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct DiskTimeSection {
    /// Time step.
    pub(super) step: Option<f64>,
    /// Number of steps; or duration, or strain.
    pub(super) steps: Option<u64>,
    /// Time at the end; or steps, or strain.
    pub(super) duration: Option<f64>,
    /// Strain at the end; or steps, or duration.
    pub(super) strain: Option<f64>,
    /// Gear's predictor-corrector with four or five values.
    pub(super) integrator: Option<DiskIntegratorKind>,
}

output_section! {
    DiskOutputSection {
        /// Steps between measurements of energies and stresses, which rows of the time series average.
        pub(super) measure_every: Option<u64>,
        /// Strips of the profiles across the flow.
        pub(super) profile_strips: Option<usize>,
    }
}

impl DiskOutputSection {
    pub(super) fn schedules(&self) -> OutputSection {
        OutputSection {
            folder: self.folder.clone(),
            trajectory_every: self.trajectory_every,
            observables_every: self.observables_every,
            checkpoint_every: self.checkpoint_every,
        }
    }
}
