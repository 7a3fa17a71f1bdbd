//! A single configuration given by the user.

mod boundaries;
mod bounded_box;
mod check;
mod device;
mod method;

pub(crate) use boundaries::boundaries_of;
pub use boundaries::{BoundariesError, CaseBoundary, UnknownBoundary};
pub use bounded_box::{CaseBox, CaseBoxError};
pub use device::CaseDevice;
pub use method::{CaseMethod, UnknownMethod};

use crate::document::{Alternative, Node, NumberOr, TypeMismatch, bounded};
use domain::{AxisRotation, PeriodicBox};
use serde::{Deserialize, Serialize};

/// Particles in a box, the loads on them, and the requested results. Lists of `N` have one entry per particle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Edges of the box, or its lattice vectors; may be absent only for spheres in unbounded fluid.
    #[serde(rename = "box", default, skip_serializing_if = "Option::is_none")]
    pub cell: Option<CaseBox>,
    /// Boundary condition along each axis.
    #[serde(default = "periodic")]
    pub boundaries: [CaseBoundary; 3],
    /// Lees-Edwards strain of the box.
    #[serde(default)]
    pub strain: f64,
    /// Viscosity of the fluid.
    pub viscosity: f64,
    /// Centres of the `N` particles.
    pub positions: Vec<[f64; 3]>,
    /// Radii of the particles.
    pub radii: OneOrAll,
    /// Forces; zero if absent.
    #[serde(default)]
    pub forces: Vec<[f64; 3]>,
    /// Torques; zero if absent.
    #[serde(default)]
    pub torques: Vec<[f64; 3]>,
    /// Stresslets (xx, xy, xz, yy, yz) of particles that are not rigid; zero if absent.
    #[serde(default)]
    pub stresslets: Vec<[f64; 5]>,
    /// Number of the rigid body of each particle, from 0, with -1 for free particles; no bodies if absent.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bodies: Vec<i64>,
    /// Whether to solve for the stresslets that keep the particles rigid.
    #[serde(default = "yes")]
    pub rigid: bool,
    /// `"monopole"` or `"dipole"`.
    #[serde(default)]
    pub multipoles: CaseTerms,
    /// Whether near pairs of rigid particles have lubrication forces.
    #[serde(default)]
    pub lubrication: bool,
    /// Gap at which lubrication ends, over the larger radius of the pair; the program's default if absent.
    #[serde(default)]
    pub lubrication_cutoff: Option<f64>,
    /// Evaluation method of the far field.
    #[serde(default)]
    pub method: CaseMethod,
    /// Device that evaluates the far field.
    #[serde(default)]
    pub device: CaseDevice,
    /// The background flow.
    #[serde(default)]
    pub background: CaseBackground,
    /// Random motions, in addition, with a covariance given by the mobility.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise: Option<CaseNoise>,
}

/// Requested random motions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CaseNoise {
    /// Number of draws.
    pub draws: u64,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Whether to compute the random part of the drift of rigid particles, too.
    #[serde(default)]
    pub drift: bool,
}

/// Largest number of values per particle of the random motions of one draw; the same holds for the drift.
pub const NOISE_NUMBERS: usize = 11;

/// One number for all particles, or one per particle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged, from = "NumberOr<Vec<f64>>")]
pub enum OneOrAll {
    /// The same number for all.
    One(f64),
    /// One number per particle.
    All(Vec<f64>),
}

impl Alternative for Vec<f64> {
    const WORDS: &'static str = "a number for all or a list of one for each";
}

impl From<NumberOr<Vec<f64>>> for OneOrAll {
    fn from(given: NumberOr<Vec<f64>>) -> Self {
        match given {
            NumberOr::Number(number) => Self::One(number),
            NumberOr::Other(list) => Self::All(list),
        }
    }
}

/// Terms of the multipole expansion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CaseTerms {
    /// Forces alone.
    Monopole,
    /// Forces, torques and stresslets.
    #[default]
    Dipole,
}

/// A linear flow.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CaseBackground {
    /// `G[i][j] = du_i / dx_j`.
    #[serde(default)]
    pub velocity_gradient: [[f64; 3]; 3],
    /// `dp / dx_i`, which drives a flow between walls.
    #[serde(default)]
    pub pressure_gradient: [f64; 3],
}

/// Largest number of draws of a case.
const MOST_DRAWS: u64 = 1_000_000;

fn yes() -> bool {
    true
}

fn periodic() -> [CaseBoundary; 3] {
    [CaseBoundary::Periodic; 3]
}

impl Case {
    /// Name of such a document in messages.
    pub const DOCUMENT: &str = "a case";

    /// Checks a case in JSON.
    pub fn parse(text: &str) -> Result<Self, String> {
        let document = Node::of_json(text).map_err(|e| bounded(&e.to_string()))?;
        Self::of_document(&document, &|mismatch| mismatch.in_words(Self::DOCUMENT))
    }

    /// Checks a document of any format; `in_words` is the message about a value of the wrong form.
    pub fn of_document(document: &Node, in_words: &dyn Fn(&TypeMismatch) -> String) -> Result<Self, String> {
        let case: Self = document.read().map_err(|mismatch| bounded(&in_words(&mismatch)))?;
        case.check()?;
        Ok(case)
    }

    /// The case as JSON, for other ranks.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).expect("finite numbers and text can be written as JSON")
    }

    /// A case sent by another rank.
    ///
    /// # Panics
    /// If the text is not from [`Case::to_json`].
    pub fn from_json(text: &str) -> Self {
        serde_json::from_str(text).expect("a case that was checked on the first rank")
    }

    /// The radius of each particle.
    pub fn radii(&self) -> Vec<f64> {
        match &self.radii {
            OneOrAll::One(radius) => vec![*radius; self.positions.len()],
            OneOrAll::All(radii) => radii.clone(),
        }
    }

    /// The rigid body of each particle, `None` for free ones; empty without bodies.
    pub fn rigid_bodies(&self) -> Vec<Option<u32>> {
        self.bodies.iter().map(|&body| u32::try_from(body).ok()).collect()
    }

    /// The box with its non-periodic axis last, and the rotation of axes to it.
    pub fn bounded_box(&self) -> Result<(PeriodicBox, AxisRotation), CaseBoxError> {
        CaseBox::bounded(self.cell, self.strain, self.boundaries, (&self.positions, &self.radii()))
    }
}
