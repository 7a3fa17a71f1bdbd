//! The file's keys, as serde finds them.

use crate::document::{Alternative, NumberOr};
use crate::scene::answers::RawAnswers;
use schemars::JsonSchema;
use serde::Deserialize;
use std::path::PathBuf;

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct Raw {
    /// What the scene is of.
    #[serde(rename = "kind")]
    _kind: Option<String>,
    /// A title for people.
    pub(super) title: Option<String>,
    /// Where random numbers start: the same seed gives the same run.
    #[serde(default)]
    pub(super) seed: u64,
    /// The periodic box.
    #[serde(rename = "box")]
    pub(super) cell: Box,
    /// The fluid.
    pub(super) fluid: Fluid,
    /// Kinds of spheres.
    pub(super) species: Vec<Species>,
    /// Gravity.
    pub(super) gravity: Option<Gravity>,
    /// Where the spheres start.
    #[serde(default)]
    pub(super) particles: Particles,
    /// The background flow.
    pub(super) flow: Option<Flow>,
    /// A short-range repulsion between near spheres; none without this section.
    pub(super) repulsion: Option<Repulsion>,
    /// An attraction between near spheres; none without this section.
    pub(super) attraction: Option<Attraction>,
    /// Contacts of rough spheres; none without this section.
    pub(super) contacts: Option<Contacts>,
    /// Bonds between listed spheres; none without such sections.
    #[serde(default)]
    pub(super) bonds: Vec<Bonds>,
    /// Harmonic traps; none without such sections.
    #[serde(default)]
    pub(super) traps: Vec<Traps>,
    /// How the fluid is computed.
    #[serde(default)]
    pub(super) hydrodynamics: Hydrodynamics,
    /// Time steps.
    pub(super) time: Time,
    /// What is written, and when.
    #[serde(default)]
    pub(super) output: Output,
    /// Averages over the run; none without this section.
    pub(super) statistics: Option<Statistics>,
    /// Means over the run.
    pub(super) answers: Option<RawAnswers>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Box {
    /// Edges along x, y and z; between walls their distance. In open fluid, in which the box follows the spheres, where they start
    /// if they are at random or on a lattice in it, else none.
    pub(super) edges: Option<[f64; 3]>,
    /// Strain of the box at the start, of spheres that come from a sheared box; that of the file's box by default.
    pub(super) strain: Option<f64>,
    /// What each axis is: "periodic", which is the default, along all or along two of them; then the third may have "walls", two, at
    /// 0 and at the edge, a "wall", at 0 with open fluid above it, or be "open"; or all are "open".
    pub(super) boundaries: Option<[Boundary; 3]>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Fluid {
    /// Dynamic viscosity.
    pub(super) viscosity: f64,
    /// Thermal energy kT, by which spheres diffuse; without, they do not.
    pub(super) thermal_energy: Option<f64>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Species {
    /// Its name in the results.
    pub(super) name: Option<String>,
    /// Radius of its spheres; or distribution.
    pub(super) radius: Option<f64>,
    /// Distribution of their radii, as few classes of the same moments; or radius.
    pub(super) distribution: Option<Distribution>,
    /// How many; or `volume_fraction`.
    pub(super) count: Option<u64>,
    /// Their volume over the box's; or count.
    pub(super) volume_fraction: Option<f64>,
    /// Density above the fluid's; the weight is this times volume times gravity.
    pub(super) density_difference: Option<f64>,
    /// Steady force on each sphere, besides its weight.
    #[serde(default)]
    pub(super) force: [f64; 3],
    /// Steady torque on each sphere.
    #[serde(default)]
    pub(super) torque: [f64; 3],
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Distribution {
    /// Which one.
    pub(super) kind: DistributionKind,
    /// How many classes of spheres stand for it; 4 by default.
    pub(super) classes: Option<usize>,
    /// Mean radius, by number, for "log-normal".
    pub(super) mean: Option<f64>,
    /// Standard deviation of the radius, by number, for "log-normal".
    pub(super) deviation: Option<f64>,
    /// Smallest radius, for "power-law".
    pub(super) smallest: Option<f64>,
    /// Largest radius, for "power-law".
    pub(super) largest: Option<f64>,
    /// Power of the radius in the density by number, for "power-law".
    pub(super) exponent: Option<f64>,
    /// Radii and how many there are of each, for "table".
    pub(super) table: Option<Vec<[f64; 2]>>,
}

#[derive(Deserialize, JsonSchema, Clone, Copy, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub(super) enum DistributionKind {
    LogNormal,
    PowerLaw,
    Table,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Gravity {
    /// Acceleration of gravity along x, y and z.
    pub(super) acceleration: [f64; 3],
}

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct Particles {
    /// How the spheres are placed.
    #[serde(default)]
    pub(super) initial: Initial,
    /// Radius of the ball in which the centres are, for "cloud".
    pub(super) radius: Option<f64>,
    /// Least gap between surfaces at the start, for "random" and "cloud".
    pub(super) minimum_gap: Option<f64>,
    /// Which lattice, for "lattice".
    pub(super) lattice: Option<Lattice>,
    /// A .csv, .xyz or .h5 file, a dump of LAMMPS, or the folder of a former run, for "file".
    pub(super) path: Option<PathBuf>,
    /// Which frame of the file: its number, from 0, or from the end if negative; the last by default.
    pub(super) frame: Option<i64>,
    /// Which group of particles of an H5MD file; the only one by default.
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
pub(super) struct Flow {
    /// The flow: none; along x the shear u = rate y, or between walls u = rate z, or that by a pressure gradient between walls, which
    /// with walls across y is u = rate y along x, and across x u = rate x along y; or an
    /// extension: planar, u = rate (x, -y, 0), uniaxial, u = rate (x, -y/2, -z/2), or biaxial, u = rate (x, y, -2 z).
    pub(super) kind: FlowKind,
    /// Rate of shear or extension; or a table of times, from 0 on, and the rates from then on.
    pub(super) rate: Option<Rate>,
    /// Strains since the start, however sheared, at which the rate changes its sign.
    pub(super) reversal_at: Option<Vec<f64>>,
    /// A strain that oscillates, instead of a rate.
    pub(super) oscillation: Option<Oscillation>,
    /// What is given: the rate (default), or the stress, with the rate that it makes.
    pub(super) control: Option<Control>,
    /// Shear stress, for control = "stress".
    pub(super) stress: Option<f64>,
    /// By how much the pressure falls per length along the flow, for "poiseuille".
    pub(super) pressure_gradient: Option<f64>,
    /// Mean velocity of fluid and spheres along the flow, for "poiseuille", in place of the pressure gradient, which follows then.
    pub(super) mean_velocity: Option<f64>,
    /// Whether the box goes with the flow (default), or stays straight, which it can in a shear flow only.
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
pub(super) struct Oscillation {
    /// Largest strain.
    pub(super) amplitude: f64,
    /// Angular frequency, one over time.
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

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Repulsion {
    /// Force at contact.
    pub(super) strength: f64,
    /// Gap where it starts, in mean radii of the two spheres.
    pub(super) range: Option<f64>,
    /// Debye length of charged spheres, whose repulsion falls exponentially with the gap; without, it is a barrier.
    pub(super) screening_length: Option<f64>,
    /// The strength grows with this power, 0, 1 or 2, of the harmonic mean radius of the two.
    #[serde(default)]
    pub(super) radius_power: u8,
    /// Whether to look for the least strength that prevents overlap, from the one given.
    #[serde(default)]
    pub(super) calibrate: bool,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Attraction {
    /// Which one: of van der Waals, or by small spheres that find no place between large ones.
    pub(super) kind: AttractionKind,
    /// Hamaker constant, an energy, for "van-der-waals".
    pub(super) hamaker: Option<f64>,
    /// Gap that bounds the force at contact, in mean radii of the two spheres, for "van-der-waals"; 0.01 by default.
    pub(super) closest: Option<f64>,
    /// Gap where it ends, in mean radii of the two, for "van-der-waals"; 1 by default.
    pub(super) range: Option<f64>,
    /// Osmotic pressure of the small spheres, for "depletion".
    pub(super) pressure: Option<f64>,
    /// Radius of the small spheres, for "depletion".
    pub(super) depletant_radius: Option<f64>,
}

#[derive(Deserialize, JsonSchema, Clone, Copy, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub(super) enum AttractionKind {
    VanDerWaals,
    Depletion,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Contacts {
    /// Coefficient of friction.
    pub(super) friction: f64,
    /// Gap at which spheres touch, in mean radii of the two; 0.005 by default.
    pub(super) roughness: Option<f64>,
    /// Normal force over overlap and mean radius; by default, "auto", what keeps overlaps at the one aimed at.
    pub(super) stiffness: Option<Stiffness>,
    /// Strain in which "auto" settles from an estimate, in a flow that goes on; 2 by default, or 0, the estimate, by a given stress.
    pub(super) settling: Option<f64>,
    /// What "auto" has settled at, which a run adds to the scene in its folder: the stiffness from the start.
    pub(super) settled_stiffness: Option<f64>,
    /// Largest overlap aimed at, over the roughness; 0.3 by default.
    pub(super) overlap: Option<f64>,
    /// Stiffness against slip over that against overlap; 0.4 by default.
    pub(super) tangential_ratio: Option<f64>,
    /// Largest force of rolling resistance over the normal force; 0 by default.
    pub(super) rolling_friction: Option<f64>,
    /// Normal force up to which there is no friction; 0 by default.
    pub(super) critical_load: Option<f64>,
    /// How the normal force grows with the overlap; "linear" by default.
    pub(super) law: Option<Elasticity>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Bonds {
    /// Pairs of spheres by their ids, which count from 0.
    pub(super) pairs: Vec<[u64; 2]>,
    /// Distance of the centres at rest; by default that at the start.
    pub(super) length: Option<f64>,
    /// Force over the distance from that at rest.
    pub(super) stiffness: f64,
    /// Pull at which a bond breaks; by default none.
    pub(super) breaking_force: Option<f64>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Traps {
    /// Name of the species that is trapped; or particles; all spheres without either.
    pub(super) species: Option<String>,
    /// Ids of the spheres that are trapped, which count from 0.
    pub(super) particles: Option<Vec<u64>>,
    /// One centre for all of them; by default each has its own where it starts.
    pub(super) centre: Option<[f64; 3]>,
    /// A centre for each of the particles listed.
    pub(super) centres: Option<Vec<[f64; 3]>>,
    /// Force over the distance from the centre.
    pub(super) stiffness: f64,
}

/// A stiffness, or "auto".
pub(super) type Stiffness = NumberOr<Auto>;

impl Alternative for Auto {
    const WORDS: &'static str = "a number or \"auto\"";
}

#[derive(Deserialize, JsonSchema, Clone, Copy)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Auto {
    Auto,
}

/// What is left out is as the suspension's own defaults have it.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct Hydrodynamics {
    /// Terms of the expansion: forces alone, or torques and stresslets too.
    pub(super) multipoles: Option<Multipoles>,
    /// Relative error of velocities, angular velocities and stresslets.
    pub(super) tolerance: Option<f64>,
    /// How the far field is evaluated; the fastest by default.
    pub(super) method: Option<Evaluation>,
    /// Grid points along x, y and z, even numbers; chosen from the tolerance by default.
    pub(super) grid: Option<[usize; 3]>,
    /// Grid points across a stencil; chosen from the tolerance by default.
    pub(super) support: Option<usize>,
    /// Relative residual of the stresslets; chosen from the tolerance by default.
    pub(super) iteration_tolerance: Option<f64>,
    /// What parts of an evaluation cost on this machine, as `fcm-solve calibrate` measures.
    pub(super) costs: Option<Costs>,
    /// Whether near pairs feel their exact lubrication.
    pub(super) lubrication: Option<bool>,
    /// Gap where lubrication ends, in radii of the larger sphere; 2.5 by default.
    pub(super) lubrication_cutoff: Option<f64>,
    /// Whether the solve with lubrication is preconditioned.
    pub(super) preconditioner: Option<bool>,
}

#[derive(Deserialize, JsonSchema, Clone, Copy)]
#[serde(deny_unknown_fields)]
pub(super) struct Costs {
    /// Spreading and interpolating.
    pub(super) stencils: f64,
    /// Fourier transforms.
    pub(super) transforms: f64,
    /// Near pairs.
    pub(super) pairs: f64,
}

/// Declares the names that a scene has for the values of a library's type.
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
names! { Multipoles for suspension::Multipoles: Monopole Dipole }
names! { Evaluation for suspension::Evaluation: Auto Direct Split }
names! { Lattice for suspension::Lattice: SimpleCubic FaceCentredCubic }
names! { Elasticity for suspension::Elasticity: Linear Hertz }
names! { Axis for suspension::Axis: X Y Z }
names! { BrownianScheme for suspension::BrownianScheme: Midpoint TwoEvaluations }

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Time {
    /// Time step.
    pub(super) step: f64,
    /// How many steps; or duration, or strain.
    pub(super) steps: Option<u64>,
    /// Time at the end; or steps, or strain.
    pub(super) duration: Option<f64>,
    /// Strain at the end, of flows of given rates; or steps, or duration. Under a given stress the run ends at this strain, or after
    /// the duration or steps that are set besides.
    pub(super) strain: Option<f64>,
    /// Steps all alike, or each in as many parts as needed; "implicit" takes short-range forces at the end of a part, so that
    /// their stiffness does not limit it, and is the default with contacts; "brownian" is that with heat.
    pub(super) integrator: Option<Integrator>,
    /// How a step of "brownian" has its drift: by one solve half a step on, "midpoint", which is the default, or by
    /// "two-evaluations", for dense suspensions and for stresses.
    pub(super) brownian: Option<BrownianScheme>,
    /// Order of the steps, 2 to 4, for "adams-bashforth"; 4 by default.
    pub(super) order: Option<u8>,
    /// Error of a part of a step in any position, over the radius, for "adaptive" and "implicit".
    pub(super) tolerance: Option<f64>,
    /// Part of any gap that a part of a step may take away, for "adaptive" and "implicit".
    pub(super) gap_fraction: Option<f64>,
}

#[derive(Deserialize, JsonSchema, Clone, Copy, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Integrator {
    AdamsBashforth,
    Adaptive,
    Implicit,
    Brownian,
}

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Output {
    /// Folder of the results.
    pub(super) folder: Option<PathBuf>,
    /// Steps between frames of the trajectory; 0 is never.
    pub(super) trajectory_every: Option<u64>,
    /// Steps between rows of the time series; 0 is never.
    pub(super) observables_every: Option<u64>,
    /// Steps between checkpoints; 0 is never but at start and end.
    pub(super) checkpoint_every: Option<u64>,
    /// Steps between velocity fields of the fluid at points of the box; 0 is never.
    pub(super) fields_every: u64,
    /// Steps between files of the forces of contacts and bonds; 0 is never.
    pub(super) contacts_every: u64,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Statistics {
    /// Steps between samples.
    pub(super) every: u64,
    /// Time of the first sample.
    #[serde(default)]
    pub(super) from: f64,
    /// Largest distance of pairs; 8 of the largest radius by default.
    pub(super) distance: Option<f64>,
    /// Axis of concentration and segregation; that of the forces, or y, by default.
    pub(super) axis: Option<Axis>,
    /// Bins across a channel; four to the smallest radius by default.
    pub(super) bins: Option<usize>,
    /// Time lag from which motion is diffusive; a quarter of the run by default.
    pub(super) diffusive_from: Option<f64>,
}
