//! Keys of the file as serde reads them.

use crate::answers::AnswersSection;
use crate::document::{Alternative, NumberOr};
use crate::time_and_output::output_section;
use schemars::JsonSchema;
use serde::Deserialize;
use std::path::PathBuf;

mod bodies;
mod distribution;
mod hydrodynamics;
mod interactions;
mod swimming;

pub(super) use bodies::{BodiesSection, BodyOrientationName, BodyShapeName, BodySphereSection, Free};
pub(super) use distribution::{DistributionKind, DistributionSection};
pub(super) use hydrodynamics::HydrodynamicsSection;
pub(super) use interactions::{
    AttractionKind, AttractionSection, Auto, BondsSection, ContactsSection, ElectricSection, FilamentsSection,
    MagneticSection, RepulsionSection, RestShapeName, TrapsSection,
};
pub(super) use swimming::SwimmingSection;

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SuspensionSections {
    /// Kind of the scene.
    #[serde(rename = "kind")]
    _kind: Option<String>,
    /// Title.
    pub(super) title: Option<String>,
    /// Seed of the random numbers: the same seed gives the same run.
    #[serde(default)]
    pub(super) seed: u64,
    /// The periodic box.
    #[serde(rename = "box")]
    pub(super) cell: BoxSection,
    /// The fluid.
    pub(super) fluid: FluidSection,
    /// Species of spheres; with bodies or filaments there may be none.
    #[serde(default)]
    pub(super) species: Vec<SpeciesSection>,
    /// Rigid bodies made of spheres; none without such sections.
    #[serde(default)]
    pub(super) bodies: Vec<BodiesSection>,
    /// Flexible filaments, chains of bonded spheres; none without such sections.
    #[serde(default)]
    pub(super) filaments: Vec<FilamentsSection>,
    /// Gravity.
    pub(super) gravity: Option<GravitySection>,
    /// Initial positions of the spheres.
    #[serde(default)]
    pub(super) particles: ParticlesSection,
    /// The background flow.
    pub(super) flow: Option<FlowSection>,
    /// A short-range repulsion between near spheres; none without this section.
    pub(super) repulsion: Option<RepulsionSection>,
    /// An attraction between near spheres; none without this section.
    pub(super) attraction: Option<AttractionSection>,
    /// Contacts of rough spheres; none without this section.
    pub(super) contacts: Option<ContactsSection>,
    /// Bonds between listed spheres; none without such sections.
    #[serde(default)]
    pub(super) bonds: Vec<BondsSection>,
    /// Harmonic traps; none without such sections.
    #[serde(default)]
    pub(super) traps: Vec<TrapsSection>,
    /// A magnetic field, in which spheres have magnetic moments; none without this section.
    pub(super) magnetic: Option<MagneticSection>,
    /// An electric field, in which spheres have electric moments; none without this section.
    pub(super) electric: Option<ElectricSection>,
    /// Evaluation of the hydrodynamics.
    #[serde(default)]
    pub(super) hydrodynamics: HydrodynamicsSection,
    /// Time steps.
    pub(super) time: TimeSection,
    /// Output.
    #[serde(default)]
    pub(super) output: SuspensionOutputSection,
    /// Averages over the run; none without this section.
    pub(super) statistics: Option<StatisticsSection>,
    /// Means over the run.
    pub(super) answers: Option<AnswersSection>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct BoxSection {
    /// Edges along x, y and z; between walls, the distance between them. In unbounded fluid the box follows the
    /// spheres: there they are the initial edges for a random start or a lattice, and otherwise absent.
    pub(super) edges: Option<[f64; 3]>,
    /// Strain of the box at the start, for spheres that come from a sheared box; by default that of the file's box.
    pub(super) strain: Option<f64>,
    /// Boundary condition along each axis: "periodic" (default) along all axes or along two of them; then the third may
    /// have "walls" at 0 and at the edge, a "wall" at 0 with unbounded fluid above it, or be "open"; or all are "open".
    pub(super) boundaries: Option<[Boundary; 3]>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FluidSection {
    /// Dynamic viscosity.
    pub(super) viscosity: f64,
    /// Thermal energy kT of Brownian motion; none by default.
    pub(super) thermal_energy: Option<f64>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SpeciesSection {
    /// Name in the results.
    pub(super) name: Option<String>,
    /// Radius of the spheres; or distribution.
    pub(super) radius: Option<f64>,
    /// Distribution of the radii, represented by a few classes with the same moments; or radius.
    pub(super) distribution: Option<DistributionSection>,
    /// Number of spheres; or `volume_fraction`.
    pub(super) count: Option<u64>,
    /// Volume of the spheres over that of the box; or count.
    pub(super) volume_fraction: Option<f64>,
    /// Density minus that of the fluid; the buoyant weight is this times volume times gravity.
    pub(super) density_difference: Option<f64>,
    /// Constant force on each sphere, in addition to its weight.
    #[serde(default)]
    pub(super) force: [f64; 3],
    /// Constant torque on each sphere.
    #[serde(default)]
    pub(super) torque: [f64; 3],
    /// Orientations of the spheres at the start, which rotate with them; none by default, "random" for swimmers.
    pub(super) orientation: Option<InitialOrientation>,
    /// Direction of the axes of the spheres at the start, for orientation = "aligned".
    pub(super) orientation_axis: Option<[f64; 3]>,
    /// Swimming along the axes of the orientations; passive spheres without it.
    pub(super) swimming: Option<SwimmingSection>,
    /// Permanent magnetic moment along the axis of each sphere, which needs an orientation; 0 by default.
    pub(super) magnetic_moment: Option<f64>,
    /// Magnetic susceptibility of the material of the spheres in that of the fluid; 0 by default.
    pub(super) magnetic_susceptibility: Option<f64>,
    /// Magnetisation `M_s` of the spheres in the strongest fields, `M = chi H / (1 + chi H / M_s)` in the field `H`
    /// within them; without it they do not saturate.
    pub(super) magnetic_saturation: Option<f64>,
    /// Permanent electric moment, a charge times a length, along the axis of each sphere, which needs an orientation; 0
    /// by default.
    pub(super) electric_moment: Option<f64>,
    /// Permittivity of the spheres, in the units of that of the fluid; that of the fluid by default.
    pub(super) permittivity: Option<f64>,
}

/// Orientations at the start: all equally likely, along an axis, or those of the file with the positions.
#[derive(Deserialize, JsonSchema, Clone, Copy, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub(super) enum InitialOrientation {
    Random,
    Aligned,
    File,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct GravitySection {
    /// Acceleration of gravity along x, y and z.
    pub(super) acceleration: [f64; 3],
}

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct ParticlesSection {
    /// Initial placement of the spheres.
    #[serde(default)]
    pub(super) initial: Initial,
    /// Radius of the ball in which the centres are, for "cloud".
    pub(super) radius: Option<f64>,
    /// Smallest gap between surfaces at the start, for "random" and "cloud".
    pub(super) minimum_gap: Option<f64>,
    /// Kind of lattice, for "lattice".
    pub(super) lattice: Option<Lattice>,
    /// A .csv, .xyz or .h5 file, a LAMMPS dump, or the folder of a former run, for "file".
    pub(super) path: Option<PathBuf>,
    /// Number of the frame of the file, from 0, or from the end if negative; the last one by default.
    pub(super) frame: Option<i64>,
    /// Group of particles of an H5MD file; the only one by default.
    pub(super) group: Option<String>,
    /// Centres, species by species, for "positions".
    pub(super) positions: Option<Vec<[f64; 3]>>,
}

#[derive(Deserialize, JsonSchema, Default, Clone, Copy, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Initial {
    #[default]
    Random,
    Cloud,
    Lattice,
    File,
    Positions,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FlowSection {
    /// Kind of flow: none; shear along x, u = rate y, or with walls across z, u = rate z, with walls across y, u =
    /// rate y along x, and with walls across x, u = rate x along y; Poiseuille flow between walls; or extension:
    /// planar, u = rate (x, -y, 0), uniaxial, u = rate (x, -y/2, -z/2), or biaxial, u = rate (x, y, -2 z).
    pub(super) kind: FlowKind,
    /// Rate of shear or extension; or a table of times, starting at 0, and of the rates from these times on.
    pub(super) rate: Option<Rate>,
    /// Accumulated strains since the start at which the rate changes its sign.
    pub(super) reversal_at: Option<Vec<f64>>,
    /// An oscillating strain, instead of a rate.
    pub(super) oscillation: Option<OscillationSection>,
    /// The controlled quantity: the rate (default), or the stress, which determines the rate.
    pub(super) control: Option<Control>,
    /// Shear stress, for control = "stress".
    pub(super) stress: Option<f64>,
    /// Decrease of the pressure per length along the flow, for "poiseuille".
    pub(super) pressure_gradient: Option<f64>,
    /// Mean velocity of fluid and spheres along the flow, for "poiseuille", instead of the pressure
    /// gradient, which then follows.
    pub(super) mean_velocity: Option<f64>,
    /// Whether the box deforms with the flow (default), or stays orthogonal, which is possible in shear flow only.
    pub(super) lees_edwards: Option<bool>,
}

#[derive(Deserialize, JsonSchema, Clone, Copy, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Control {
    Rate,
    Stress,
}

/// The strain amplitude sin(frequency t).
#[derive(Deserialize, JsonSchema, Clone, Copy)]
#[serde(deny_unknown_fields)]
pub(super) struct OscillationSection {
    /// Largest strain.
    pub(super) amplitude: f64,
    /// Angular frequency, in radians per time.
    pub(super) frequency: f64,
}

/// A rate, or a table of times and rates.
pub(super) type Rate = NumberOr<Vec<[f64; 2]>>;

impl Alternative for Vec<[f64; 2]> {
    const WORDS: &'static str = "a number or a table of times and rates, as [[0.0, 1.0], [5.0, -1.0]]";
}

#[derive(Deserialize, JsonSchema, Clone, Copy, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub(super) enum FlowKind {
    None,
    Shear,
    Poiseuille,
    PlanarExtension,
    UniaxialExtension,
    BiaxialExtension,
}

/// Declares the names of a library type's values in scenes.
macro_rules! names {
    ($raw:ident for $library:ty: $($name:ident)*) => {
        #[derive(Deserialize, JsonSchema, Clone, Copy)]
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

names! { Boundary for crate::CaseBoundary: Periodic Walls Wall Open }
names! { Multipoles for suspension::MultipoleOrder: Monopole Dipole }
names! { Lattice for suspension::Lattice: SimpleCubic FaceCentredCubic }
names! { Elasticity for suspension::Elasticity: Linear Hertz }
names! { Axis for suspension::Axis: X Y Z }

#[derive(Deserialize, JsonSchema, Clone, Copy)]
#[serde(rename_all = "kebab-case")]
pub(super) enum BrownianMethod {
    DrifterCorrector,
    RandomFiniteDifference,
}

impl From<BrownianMethod> for suspension::BrownianScheme {
    fn from(scheme: BrownianMethod) -> Self {
        match scheme {
            BrownianMethod::DrifterCorrector => Self::Midpoint,
            BrownianMethod::RandomFiniteDifference => Self::TwoEvaluations,
        }
    }
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct TimeSection {
    /// Time step.
    pub(super) step: f64,
    /// Number of steps; or duration, or strain.
    pub(super) steps: Option<u64>,
    /// Time at the end; or steps, or strain.
    pub(super) duration: Option<f64>,
    /// Strain at the end, in flows with a given rate; or steps, or duration. Under a given stress the run ends at
    /// this strain, or after the duration or steps if these are set as well.
    pub(super) strain: Option<f64>,
    /// Fixed steps, or steps divided into as many substeps as needed; "implicit" evaluates short-range forces at the
    /// end of a substep, so that their stiffness does not limit it, and is the default with contacts; "brownian" is
    /// the default with thermal energy.
    pub(super) integrator: Option<IntegratorKind>,
    /// Computation of the drift in "brownian" steps: by one solve at the midpoint, "drifter-corrector"
    /// (default), or by "random-finite-difference", for dense suspensions and for stresses.
    pub(super) brownian: Option<BrownianMethod>,
    /// Order of the steps, 2 to 4, for "adams-bashforth"; 4 by default.
    pub(super) order: Option<u8>,
    /// Error of a substep in any position, over the radius, for "adaptive" and "implicit".
    pub(super) tolerance: Option<f64>,
    /// Largest fraction of any gap by which a substep may reduce it, for "adaptive" and "implicit".
    pub(super) gap_fraction: Option<f64>,
}

#[derive(Deserialize, JsonSchema, Clone, Copy, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub(super) enum IntegratorKind {
    AdamsBashforth,
    Adaptive,
    Implicit,
    Brownian,
}

output_section! {
    SuspensionOutputSection {
        /// Steps between velocity fields of the fluid at points of the box; 0 for none.
        pub(super) fields_every: u64,
        /// Steps between files of contact and bond forces; 0 for none.
        pub(super) contacts_every: u64,
    }
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct StatisticsSection {
    /// Steps between samples.
    pub(super) every: u64,
    /// Time of the first sample.
    #[serde(default)]
    pub(super) from: f64,
    /// Largest distance of pairs; 8 times the largest radius by default.
    pub(super) distance: Option<f64>,
    /// Axis of concentration and segregation; by default that of the forces, or y.
    pub(super) axis: Option<Axis>,
    /// Bins across a channel; four per smallest radius by default.
    pub(super) bins: Option<usize>,
    /// Time lag from which motion is diffusive; a quarter of the run by default.
    pub(super) diffusive_from: Option<f64>,
}
