//! Keys of forces between spheres, bonds and traps.

use super::{BodyOrientationName, Elasticity};
use crate::document::{Alternative, NumberOr};
use schemars::JsonSchema;
use serde::Deserialize;

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::suspension) struct RepulsionSection {
    /// Force at contact.
    pub(in crate::suspension) strength: f64,
    /// Gap at which it begins, over the mean radius of the two spheres.
    pub(in crate::suspension) range: Option<f64>,
    /// Debye length of charged spheres, with a repulsion that decays exponentially with the gap; a barrier by default.
    pub(in crate::suspension) screening_length: Option<f64>,
    /// The strength is proportional to this power, 0, 1 or 2, of the harmonic mean radius of the two spheres.
    #[serde(default)]
    pub(in crate::suspension) radius_power: u8,
    /// Whether to search for the smallest strength that prevents overlap, starting from the given one.
    #[serde(default)]
    pub(in crate::suspension) calibrate: bool,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::suspension) struct AttractionSection {
    /// Kind of attraction: van der Waals, or depletion by small spheres that are excluded from between large ones.
    pub(in crate::suspension) kind: AttractionKind,
    /// Hamaker constant, an energy, for "van-der-waals".
    pub(in crate::suspension) hamaker: Option<f64>,
    /// Smallest gap in the force law, which bounds the force at contact, over the mean radius of the two spheres, for
    /// "van-der-waals"; 0.01 by default.
    pub(in crate::suspension) regularisation_length: Option<f64>,
    /// Gap at which it ends, over the mean radius of the two spheres, for "van-der-waals"; 1 by default.
    pub(in crate::suspension) range: Option<f64>,
    /// Osmotic pressure of the small spheres, for "depletion".
    pub(in crate::suspension) osmotic_pressure: Option<f64>,
    /// Radius of the small spheres, for "depletion".
    pub(in crate::suspension) depletant_radius: Option<f64>,
}

#[derive(Deserialize, JsonSchema, Clone, Copy, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub(in crate::suspension) enum AttractionKind {
    VanDerWaals,
    Depletion,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::suspension) struct ContactsSection {
    /// Coefficient of friction.
    pub(in crate::suspension) friction: f64,
    /// Gap at which spheres are in contact, over the mean radius of the two; 0.005 by default.
    pub(in crate::suspension) roughness: Option<f64>,
    /// Normal force over overlap and mean radius; by default "auto", which adapts it to the target overlap.
    pub(in crate::suspension) stiffness: Option<StiffnessKey>,
    /// Strain over which "auto" adapts the stiffness from an estimate, in a steady flow; by default 2, or under a
    /// given stress 0, which keeps the estimate.
    pub(in crate::suspension) adaptation_strain: Option<f64>,
    /// Stiffness found by "auto", which a run adds to the scene in its folder: the stiffness from the start.
    pub(in crate::suspension) adapted_stiffness: Option<f64>,
    /// Target of the largest overlap, over the roughness; 0.3 by default.
    pub(in crate::suspension) target_overlap: Option<f64>,
    /// Tangential stiffness over normal stiffness; 0.4 by default.
    pub(in crate::suspension) tangential_ratio: Option<f64>,
    /// Largest force of rolling resistance over the normal force; 0 by default.
    pub(in crate::suspension) rolling_friction: Option<f64>,
    /// Normal force below which there is no friction; 0 by default.
    pub(in crate::suspension) critical_load: Option<f64>,
    /// Law of the normal force as a function of the overlap; "linear" by default.
    pub(in crate::suspension) law: Option<Elasticity>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::suspension) struct BondsSection {
    /// Pairs of spheres by their ids, which count from 0.
    pub(in crate::suspension) pairs: Vec<[u64; 2]>,
    /// Rest length between centres; by default the initial distance.
    pub(in crate::suspension) length: Option<f64>,
    /// Force over the elongation from the rest length.
    pub(in crate::suspension) stiffness: f64,
    /// Tension at which a bond breaks; by default it never breaks.
    pub(in crate::suspension) breaking_force: Option<f64>,
    /// Bending stiffness EI, a force times a squared length, of spheres with orientations; by default they rotate
    /// freely.
    pub(in crate::suspension) bending_stiffness: Option<f64>,
    /// Twisting stiffness GJ, for bonds with a bending stiffness; 0 by default.
    pub(in crate::suspension) twisting_stiffness: Option<f64>,
    /// Shape without load of bonds with a bending stiffness: that at the start (default), or straight chains.
    pub(in crate::suspension) rest_shape: Option<RestShapeName>,
}

/// Shape of bonded spheres without load.
#[derive(Deserialize, JsonSchema, Clone, Copy)]
#[serde(rename_all = "kebab-case")]
pub(in crate::suspension) enum RestShapeName {
    Start,
    Straight,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::suspension) struct FilamentsSection {
    /// Name in the results.
    pub(in crate::suspension) name: Option<String>,
    /// Number of spheres of each filament.
    pub(in crate::suspension) spheres: u64,
    /// Radius of the spheres.
    pub(in crate::suspension) radius: f64,
    /// Gap between neighbouring spheres at the start and without load, negative for spheres that overlap; 0 by default.
    pub(in crate::suspension) gap: Option<f64>,
    /// Number of filaments; or positions, or `volume_fraction`.
    pub(in crate::suspension) count: Option<u64>,
    /// Volume of the spheres of the filaments over that of the box; or count, or positions.
    pub(in crate::suspension) volume_fraction: Option<f64>,
    /// Centres of the filaments at the start, when they are straight; random by default.
    pub(in crate::suspension) positions: Option<Vec<[f64; 3]>>,
    /// Directions of the filaments at the start: "random" (default), or "aligned".
    pub(in crate::suspension) orientation: Option<BodyOrientationName>,
    /// Direction of the filaments at the start, for orientation = "aligned".
    pub(in crate::suspension) orientation_axis: Option<[f64; 3]>,
    /// Density of the spheres minus that of the fluid.
    pub(in crate::suspension) density_difference: Option<f64>,
    /// Constant force on each filament, shared by its spheres, in addition to its weight.
    #[serde(default)]
    pub(in crate::suspension) force: [f64; 3],
    /// Force over the elongation of a bond.
    pub(in crate::suspension) stiffness: f64,
    /// Bending stiffness EI, a force times a squared length; by default the spheres are jointed freely.
    pub(in crate::suspension) bending_stiffness: Option<f64>,
    /// Twisting stiffness GJ, for filaments with a bending stiffness; 0 by default.
    pub(in crate::suspension) twisting_stiffness: Option<f64>,
    /// Tension at which a bond breaks; by default it never breaks.
    pub(in crate::suspension) breaking_force: Option<f64>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::suspension) struct TrapsSection {
    /// Name of the trapped species; or particles; all spheres by default.
    pub(in crate::suspension) species: Option<String>,
    /// Ids of the trapped spheres, which count from 0.
    pub(in crate::suspension) particles: Option<Vec<u64>>,
    /// One centre for all of them; by default each sphere is trapped at its initial position.
    pub(in crate::suspension) centre: Option<[f64; 3]>,
    /// A centre for each of the listed particles.
    pub(in crate::suspension) centres: Option<Vec<[f64; 3]>>,
    /// Force over the distance from the centre.
    pub(in crate::suspension) stiffness: f64,
}

#[derive(Deserialize, JsonSchema, Clone, Copy)]
#[serde(deny_unknown_fields)]
pub(in crate::suspension) struct MagneticSection {
    /// Applied field: the average of the magnetic field strength over the box, at time zero.
    pub(in crate::suspension) field: [f64; 3],
    /// Angular frequency with which it alternates, as the cosine, or with a rotation axis rotates; constant by default.
    pub(in crate::suspension) frequency: Option<f64>,
    /// Axis about which the field rotates.
    pub(in crate::suspension) rotation_axis: Option<[f64; 3]>,
    /// Permeability of the vacuum in the units of the scene, 1.25663706e-6 in SI units; 1 by default.
    pub(in crate::suspension) permeability: Option<f64>,
    /// Relative error of the field of the moments; that of the hydrodynamics by default.
    pub(in crate::suspension) tolerance: Option<f64>,
}

#[derive(Deserialize, JsonSchema, Clone, Copy)]
#[serde(deny_unknown_fields)]
pub(in crate::suspension) struct ElectricSection {
    /// Applied field: the average of the electric field over the box, at time zero.
    pub(in crate::suspension) field: [f64; 3],
    /// Angular frequency with which it alternates, as the cosine, or with a rotation axis rotates; constant by default.
    pub(in crate::suspension) frequency: Option<f64>,
    /// Axis about which the field rotates.
    pub(in crate::suspension) rotation_axis: Option<[f64; 3]>,
    /// Permittivity of the fluid; 1 by default.
    pub(in crate::suspension) permittivity: Option<f64>,
    /// Relative error of the field of the moments; that of the hydrodynamics by default.
    pub(in crate::suspension) tolerance: Option<f64>,
}

/// A stiffness, or "auto".
pub(in crate::suspension) type StiffnessKey = NumberOr<Auto>;

impl Alternative for Auto {
    const WORDS: &'static str = "a number or \"auto\"";
}

#[derive(Deserialize, JsonSchema, Clone, Copy)]
#[serde(rename_all = "kebab-case")]
pub(in crate::suspension) enum Auto {
    Auto,
}
