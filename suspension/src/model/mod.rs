//! Parameters of a suspension, and the model: parameters that have been checked.

mod attraction;
mod beam;
mod bodies;
mod bonds;
pub mod box_axes;
mod card;
mod check;
mod contacts;
mod cubic_field;
mod dipoles;
mod displacement;
mod extension;
mod filaments;
mod hydrodynamics;
mod integrator;
mod orientation;
mod protocol;
pub mod radii;
mod reduced_copy;
mod sizes;
mod species;
mod statistics;
mod swimming;
mod traps;
mod turned;

use crate::columns::{BEAM_END_NUMBERS, BOND_NUMBERS};
use crate::model::box_axes::UserAxes;
use ::hydrodynamics::Poiseuille;
pub use attraction::Attraction;
pub(crate) use beam::without_orientation;
pub use beam::{Beam, RestShape};
pub use bodies::{Bodies, BodyOrientation};
pub use bonds::Bonds;
pub(crate) use bonds::check_ids;
pub use contacts::Contacts;
pub(crate) use cubic_field::CubicField;
pub(crate) use dipoles::MomentKind;
pub use dipoles::{AppliedField, FieldVariation, SphereMoment};
use domain::{AxisRotation, Boundaries, ParameterError, PeriodicBox, Tensor, Vector};
pub use extension::Extension;
#[cfg(test)]
pub(crate) use extension::Extremes;
pub use filaments::Filaments;
pub use hydrodynamics::{Hydrodynamics, MultipoleOrder};
pub use integrator::{Adaptive, BrownianScheme, Integrator};
pub use orientation::Orientation;
pub use protocol::{Protocol, RateChange, ShearRates};
pub use sizes::{SizeClass, SizeDistribution};
use solver::BackgroundFlow;
pub use species::{Lattice, MAX_FRACTION, MAX_SPHERES, Species, Start};
pub use statistics::{Axis, StatisticsParameters};
use std::ops::Deref;
pub use swimming::{ActiveDipole, Swimming};
pub use traps::{Centres, Trapped, Traps};

/// Parameters of a suspension. The keys in the messages of [`Model::new`] are those of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    /// Seed of the random numbers.
    pub seed: u64,
    /// The box at its initial strain; in an extension one made by [`Extension::cell`], unless the fluid is open.
    pub cell: PeriodicBox,
    /// Rotation from the user's axes, in which parameters are given and results are shown, to the axes of the box, in
    /// which all vectors of this struct are; see [`Parameters::turned`].
    pub turn: AxisRotation,
    /// Viscosity of the fluid.
    pub viscosity: f64,
    /// Thermal energy `kT`; `None` for no Brownian motion.
    pub thermal_energy: Option<f64>,
    /// Acceleration of gravity.
    pub gravity: Vector,
    /// The species of spheres; those of [`Self::bodies`] come last.
    pub species: Vec<Species>,
    /// Rigid bodies, which [`Parameters::with_bodies`] adds together with the species of their spheres.
    pub bodies: Vec<Bodies>,
    /// Filaments, which [`Parameters::with_filaments`] adds together with the species of their spheres and their bonds.
    pub filaments: Vec<Filaments>,
    /// Initial positions.
    pub start: Start,
    /// Background flow.
    pub flow: Flow,
    /// Rate of the flow as a function of time.
    pub protocol: Protocol,
    /// Repulsion between spheres.
    pub repulsion: Option<Repulsion>,
    /// Attraction between spheres.
    pub attraction: Option<Attraction>,
    /// Contacts of rough spheres; `None` for smooth spheres.
    pub contacts: Option<Contacts>,
    /// Bonds between listed spheres.
    pub bonds: Vec<Bonds>,
    /// Harmonic traps.
    pub traps: Vec<Traps>,
    /// Magnetic field in which spheres with magnetic moments are.
    pub magnetic: Option<AppliedField>,
    /// Electric field in which spheres with electric moments are.
    pub electric: Option<AppliedField>,
    /// Parameters of the hydrodynamic interactions.
    pub hydrodynamics: Hydrodynamics,
    /// Time step.
    pub time_step: f64,
    /// Number of the last step, up to which memory is planned.
    pub steps: u64,
    /// Strain at which a run under a given stress ends, if it is reached before the last step.
    pub last_strain: Option<f64>,
    /// Time integrator.
    pub integrator: Integrator,
    /// Averages to be taken.
    pub statistics: Option<StatisticsParameters>,
    /// Whether velocity fields will be asked for during the run.
    pub fields: bool,
}

impl Parameters {
    /// Spheres at random positions in a fluid at rest, with a tolerance of 1e-3; `steps` steps by the fourth-order
    /// Adams-Bashforth method.
    pub fn new(cell: PeriodicBox, viscosity: f64, species: Vec<Species>, time_step: f64, steps: u64) -> Self {
        Self {
            seed: 0,
            cell,
            turn: AxisRotation::default(),
            viscosity,
            thermal_energy: None,
            gravity: Vector::ZERO,
            species,
            bodies: Vec::new(),
            filaments: Vec::new(),
            start: Start::Random { minimum_gap: 0.0 },
            flow: Flow::None,
            last_strain: None,
            protocol: Protocol::STEADY,
            repulsion: None,
            attraction: None,
            contacts: None,
            bonds: Vec::new(),
            traps: Vec::new(),
            magnetic: None,
            electric: None,
            hydrodynamics: Hydrodynamics::default(),
            time_step,
            steps,
            integrator: Integrator::AdamsBashforth { order: 4 },
            statistics: None,
            fields: false,
        }
    }

    /// The user's axes.
    pub fn user_axes(&self) -> UserAxes {
        UserAxes::of(self)
    }

    /// Rate of shear or extension as a function of time; 0 without a flow.
    pub fn shear_rates(&self) -> ShearRates {
        ShearRates::new(self.flow.rate(), self.protocol.clone(), self.time_step)
    }

    /// The extension by which the box is stretched; `None` if there is none or the box is not fully periodic.
    pub fn stretched_box(&self) -> Option<Extension> {
        self.flow.extension().filter(|_| self.cell.boundaries() == Boundaries::Periodic)
    }

    /// Length of the shortest edge vector of the box at any time.
    pub fn shortest_vector(&self) -> f64 {
        self.stretched_box()
            .map_or_else(|| self.cell.edges().min_element(), |extension| extension.shortest_vector(&self.cell))
    }

    /// Time at the end of the last step.
    pub fn end(&self) -> f64 {
        self.steps as f64 * self.time_step
    }
}

/// Background flow, undisturbed by the spheres.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Flow {
    /// Fluid at rest.
    None,
    /// `u = rate y e_x`, or `u = rate z e_x` between walls.
    Shear {
        /// Shear rate (1/time); the initial one, if it changes.
        rate: f64,
        /// Whether the box shears with the flow, so that images of spheres move with it (Lees-Edwards).
        lees_edwards: bool,
    },
    /// Between walls, `u = pressure_gradient z (Lz - z) / (2 viscosity) e_x`.
    Poiseuille {
        /// Pressure drop per length along x.
        pressure_gradient: f64,
    },
    /// Between walls, `u = 6 mean_velocity z (Lz - z) / Lz^2 e_x` without the spheres. The pressure gradient along x
    /// adjusts to keep the mean velocity along x of fluid and spheres together.
    ConstantFlux {
        /// Flux over the area of the cross-section.
        mean_velocity: f64,
    },
    /// Extensional flow: in a box that stretches with it, or in unbounded fluid.
    Extension {
        /// Kind of extension.
        kind: Extension,
        /// Rate of extension (1/time); the initial one, if it changes.
        rate: f64,
    },
}

impl Flow {
    /// Rate of shear or extension, the initial one if it changes; 0 for all other flows.
    pub fn rate(&self) -> f64 {
        match *self {
            Self::None | Self::Poiseuille { .. } | Self::ConstantFlux { .. } => 0.0,
            Self::Shear { rate, .. } | Self::Extension { rate, .. } => rate,
        }
    }

    /// Curvature `-u''` of a parabolic profile between walls at a distance `height`; `None` for other flows.
    pub fn curvature(&self, viscosity: f64, height: f64) -> Option<f64> {
        match *self {
            Self::Poiseuille { pressure_gradient } => Some(pressure_gradient / viscosity),
            Self::ConstantFlux { mean_velocity } => Some(12.0 * mean_velocity / (height * height)),
            Self::None | Self::Shear { .. } | Self::Extension { .. } => None,
        }
    }

    /// Whether the flux is given rather than the pressure gradient.
    pub fn keeps_flux(&self) -> bool {
        matches!(self, Self::ConstantFlux { .. })
    }

    /// The kind of extension, if the flow is one.
    pub fn extension(&self) -> Option<Extension> {
        if let Self::Extension { kind, .. } = *self { Some(kind) } else { None }
    }

    /// A flow of this kind at a given rate.
    pub fn at_rate(&self, rate: f64) -> BackgroundFlow {
        self.extension().map_or_else(|| BackgroundFlow::shear(rate), |kind| kind.flow(rate))
    }

    /// Rate of the simple shear with equal dissipation, `sqrt(2 E : E)`, for this flow at a rate.
    pub fn as_shear(&self, rate: f64) -> f64 {
        self.extension().map_or(rate, |kind| kind.as_shear() * rate)
    }

    /// Component of a stress along the rate of strain, viscosity times rate in pure fluid: with `e` the rate of strain
    /// over the rate, `s : e / (2 e : e)`. In a shear flow along x it is `s_xy`, or `s_xz` if `gradient` is the z axis.
    pub fn driving_stress(&self, stress: &Tensor, gradient: usize) -> f64 {
        let diagonal = || [stress.x_axis.x, stress.y_axis.y, stress.z_axis.z];
        self.extension().map_or(stress.col(gradient).x, |kind| kind.driving_stress(diagonal()))
    }
}

/// Repulsion by a short-range barrier or by screened charges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Repulsion {
    /// Force at contact, over the `radius_power`-th power of the pair's harmonic mean radius.
    pub strength: f64,
    /// Exponent, 0, 1 or 2, with which the force grows with the harmonic mean radius.
    pub radius_power: u8,
    /// Gap at which a barrier starts, over the pair's mean radius; `None` for the default, which depends on
    /// lubrication.
    pub range: Option<f64>,
    /// Debye length of charged spheres, whose repulsion decays exponentially with the gap; `None` for a barrier.
    pub screening_length: Option<f64>,
    /// Whether `strength` is only the start of a search for the least sufficient strength.
    pub calibrate: bool,
}

impl Repulsion {
    /// A barrier with the same force at contact for all pairs and the default range.
    pub fn new(strength: f64) -> Self {
        Self { strength, radius_power: 0, range: None, screening_length: None, calibrate: false }
    }
}

/// Parameters that have been checked. They are read through `Deref`; to change them, change a copy of the
/// [`Parameters`] and check it again.
#[derive(Debug, Clone, PartialEq)]
pub struct Model(Parameters);

impl Model {
    /// Pressure-driven flow of the model without particles, if there is one.
    pub fn poiseuille(&self) -> Option<Poiseuille> {
        let height = self.cell.edges().z;
        self.flow.curvature(self.viscosity, height).map(|curvature| Poiseuille { curvature, height })
    }

    /// Checks the parameters.
    pub fn new(parameters: Parameters) -> Result<Self, ParameterError> {
        check::check(&parameters)?;
        Ok(Self(parameters))
    }

    /// Whether the solve is for motions of spheres as well as for stresslets: with forces between near spheres, or with
    /// rigid bodies.
    pub(crate) fn is_coupled(&self) -> bool {
        let is_implicit = matches!(self.integrator, Integrator::Implicit(_));
        self.hydrodynamics.lubrication || is_implicit || !self.bodies.is_empty()
    }

    /// Width of the column of bonds: room for the largest number of bonds that any sphere has.
    pub(crate) fn bond_numbers(&self) -> usize {
        BOND_NUMBERS * self.most_bonds()
    }

    /// Width of the column of the ends of beams; 0 without bonds that resist bending.
    pub(crate) fn beam_end_numbers(&self) -> usize {
        if self.has_beams() { BEAM_END_NUMBERS * self.most_bonds() } else { 0 }
    }

    /// Largest number of bonds that any sphere has.
    pub(crate) fn most_bonds(&self) -> usize {
        let mut ids: Vec<u64> = self.bonds.iter().flat_map(|bonds| bonds.pairs.as_flattened()).copied().collect();
        ids.sort_unstable();
        ids.chunk_by(|a, b| a == b).map(<[u64]>::len).max().unwrap_or(0)
    }

    /// Axis with the largest component of the steady forces, summed over the species; `None` without forces.
    pub fn force_axis(&self) -> Option<usize> {
        let sum: Vector = self.species.iter().map(|s| s.force_on(s.radius, self.gravity).abs()).sum();
        let most = (0..3).max_by(|&a, &b| sum[a].total_cmp(&sum[b]));
        most.filter(|_| sum != Vector::ZERO)
    }
}

impl Deref for Model {
    type Target = Parameters;

    fn deref(&self) -> &Parameters {
        &self.0
    }
}
