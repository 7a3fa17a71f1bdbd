//! What a suspension consists of and how it moves: parameters, and the model that they make once they are checked.

mod attraction;
mod bonds;
mod check;
mod contacts;
mod copy;
mod cubic_field;
mod extension;
mod hydrodynamics;
mod integrator;
mod rates;
mod sizes;
mod spheres;
mod statistics;
mod traps;
mod travel;
mod turned;

use crate::tethers::BOND_NUMBERS;
use crate::user_axes::UserAxes;
pub use attraction::Attraction;
pub use bonds::Bonds;
pub(crate) use bonds::check_ids;
pub use contacts::Contacts;
pub(crate) use cubic_field::CubicField;
use domain::{Boundaries, ParameterError, PeriodicBox, Tensor, Turn, Vector};
pub use extension::Extension;
#[cfg(test)]
pub(crate) use extension::Extremes;
pub use hydrodynamics::{Evaluation, Hydrodynamics, Multipoles};
pub use integrator::{Adaptive, BrownianScheme, Integrator};
pub use rates::{Protocol, RateChange, ShearRates};
pub use sizes::{SizeClass, SizeDistribution};
use solver::BackgroundFlow;
pub use spheres::{Lattice, MAX_FRACTION, MAX_SPHERES, Species, Start};
pub use statistics::{Axis, Statistics};
use std::ops::Deref;
pub use traps::{Centres, Trapped, Traps};

/// What a suspension consists of and how it moves. Keys in the messages of [`Model::new`] are those of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    /// Where random numbers start.
    pub seed: u64,
    /// The box, at the strain with which it starts; in an extension that of [`Extension::cell`], unless the fluid is open.
    pub cell: PeriodicBox,
    /// From the axes of whoever gave the parameters, and looks at the run, to those of the box, in which all vectors here are; see
    /// [`Parameters::turned`].
    pub turn: Turn,
    /// Viscosity of the fluid.
    pub viscosity: f64,
    /// The thermal energy `kT`, by which spheres diffuse; without, they do not.
    pub thermal_energy: Option<f64>,
    /// Acceleration of gravity.
    pub gravity: Vector,
    /// The kinds of spheres.
    pub species: Vec<Species>,
    /// Where the spheres are at first.
    pub start: Start,
    /// The background flow.
    pub flow: Flow,
    /// How the rate of the flow changes.
    pub protocol: Protocol,
    /// What keeps spheres apart.
    pub repulsion: Option<Repulsion>,
    /// How spheres attract each other.
    pub attraction: Option<Attraction>,
    /// How rough spheres touch; without, they are smooth.
    pub contacts: Option<Contacts>,
    /// Bonds between listed spheres.
    pub bonds: Vec<Bonds>,
    /// Harmonic traps.
    pub traps: Vec<Traps>,
    /// How the fluid is computed.
    pub hydrodynamics: Hydrodynamics,
    /// The time step.
    pub time_step: f64,
    /// The last step, up to which memory is planned.
    pub steps: u64,
    /// The strain at which a run under a given stress ends, if that is before its last step.
    pub last_strain: Option<f64>,
    /// How a step is taken.
    pub integrator: Integrator,
    /// What is averaged.
    pub statistics: Option<Statistics>,
    /// Whether velocity fields are wanted in the course of the run.
    pub fields: bool,
}

impl Parameters {
    /// Spheres at random in a fluid at rest, with the tolerance of 1e-3; `steps` steps by the Adams-Bashforth method of
    /// order 4.
    pub fn new(cell: PeriodicBox, viscosity: f64, species: Vec<Species>, (time_step, steps): (f64, u64)) -> Self {
        Self {
            seed: 0,
            cell,
            turn: Turn::default(),
            viscosity,
            thermal_energy: None,
            gravity: Vector::ZERO,
            species,
            start: Start::Random { minimum_gap: 0.0 },
            flow: Flow::None,
            last_strain: None,
            protocol: Protocol::STEADY,
            repulsion: None,
            attraction: None,
            contacts: None,
            bonds: Vec::new(),
            traps: Vec::new(),
            hydrodynamics: Hydrodynamics::default(),
            time_step,
            steps,
            integrator: Integrator::AdamsBashforth { order: 4 },
            statistics: None,
            fields: false,
        }
    }

    /// The axes of the user.
    pub fn user_axes(&self) -> UserAxes {
        UserAxes::of(self)
    }

    /// The rate of shear or of extension in time; 0 without a flow.
    pub fn shear_rates(&self) -> ShearRates {
        ShearRates::new(self.flow.rate(), self.protocol.clone(), self.time_step)
    }

    /// The extension with which the box is stretched, if it is: one that repeats along all axes.
    pub fn stretched_box(&self) -> Option<Extension> {
        self.flow.extension().filter(|_| self.cell.boundaries() == Boundaries::Periodic)
    }

    /// The shortest lattice vector of the box at any time, of those along its edges.
    pub fn shortest_vector(&self) -> f64 {
        self.stretched_box()
            .map_or_else(|| self.cell.edges().min_element(), |extension| extension.shortest_vector(&self.cell))
    }

    /// The time at the end of the last step.
    pub fn end(&self) -> f64 {
        self.steps as f64 * self.time_step
    }
}

/// The flow that would be there without the spheres.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Flow {
    /// None.
    None,
    /// `u = rate y e_x`, or `u = rate z e_x` between walls.
    Shear {
        /// One over time; at the start, where it changes.
        rate: f64,
        /// Whether the box shears with the flow, so that images of spheres move with it.
        lees_edwards: bool,
    },
    /// Between walls, `u = pressure_gradient z (Lz - z) / (2 viscosity) e_x`.
    Poiseuille {
        /// By how much the pressure falls per length along x.
        pressure_gradient: f64,
    },
    /// Between walls, with `u = 6 mean_velocity z (Lz - z) / Lz^2 e_x` without the spheres: whatever pressure gradient along x is
    /// needed keeps the mean velocity along x, of fluid and spheres together.
    ConstantFlux {
        /// Flux over the area that it goes through.
        mean_velocity: f64,
    },
    /// One that stretches: in a box that is stretched with it, or in open fluid.
    Extension {
        /// Which one.
        kind: Extension,
        /// One over time; at the start, where it changes.
        rate: f64,
    },
}

impl Flow {
    /// Its rate, at the start where it changes; 0 without a flow, and in those by pressure gradients.
    pub fn rate(&self) -> f64 {
        match *self {
            Self::None | Self::Poiseuille { .. } | Self::ConstantFlux { .. } => 0.0,
            Self::Shear { rate, .. } | Self::Extension { rate, .. } => rate,
        }
    }

    /// The curvature `-u''` of the parabola that it is between walls at a distance `height`, if it is one.
    pub fn curvature(&self, viscosity: f64, height: f64) -> Option<f64> {
        match *self {
            Self::Poiseuille { pressure_gradient } => Some(pressure_gradient / viscosity),
            Self::ConstantFlux { mean_velocity } => Some(12.0 * mean_velocity / (height * height)),
            Self::None | Self::Shear { .. } | Self::Extension { .. } => None,
        }
    }

    /// Whether its flux is given, and the pressure gradient follows.
    pub fn keeps_flux(&self) -> bool {
        matches!(self, Self::ConstantFlux { .. })
    }

    /// The extension, if it is one.
    pub fn extension(&self) -> Option<Extension> {
        if let Self::Extension { kind, .. } = *self { Some(kind) } else { None }
    }

    /// The flow of this kind at a rate.
    pub fn at_rate(&self, rate: f64) -> BackgroundFlow {
        self.extension().map_or_else(|| BackgroundFlow::shear(rate), |kind| kind.flow(rate))
    }

    /// The rate of the shear that dissipates as much as this flow at a rate, `sqrt(2 E : E)`.
    pub fn as_shear(&self, rate: f64) -> f64 {
        self.extension().map_or(rate, |kind| kind.as_shear() * rate)
    }

    /// The part of a stress that drives it, viscosity times rate in a fluid alone: with `e` the rate of strain over the rate,
    /// `s : e / (2 e : e)`, which in a shear flow along x is the component `s_xy`, or `s_xz` where z is its gradient axis.
    pub fn driving_stress(&self, stress: &Tensor, gradient: usize) -> f64 {
        let diagonal = || [stress.x_axis.x, stress.y_axis.y, stress.z_axis.z];
        self.extension().map_or(stress.col(gradient).x, |kind| kind.driving_stress(diagonal()))
    }
}

/// Repulsion, by a barrier or of charged spheres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Repulsion {
    /// Force at contact, over the `radius_power`-th power of the harmonic mean radius of the two.
    pub strength: f64,
    /// The power, 0, 1 or 2, of the harmonic mean radius with which the force grows.
    pub radius_power: u8,
    /// The gap where it starts over the mean radius of the two; what suits the hydrodynamics where there is none.
    pub range: Option<f64>,
    /// The Debye length of charged spheres, whose repulsion falls exponentially with the gap; `None` for a barrier.
    pub screening_length: Option<f64>,
    /// Whether the strength is only where the search for the least sufficient one starts.
    pub calibrate: bool,
}

impl Repulsion {
    /// The same force at contact for all, over the range that suits the hydrodynamics.
    pub fn new(strength: f64) -> Self {
        Self { strength, radius_power: 0, range: None, screening_length: None, calibrate: false }
    }
}

/// Parameters that have been checked: every number is in its range. They can be read, and changed in a copy of the
/// [`Parameters`] that is checked again.
#[derive(Debug, Clone, PartialEq)]
pub struct Model(Parameters);

impl Model {
    /// The model of parameters in their ranges.
    pub fn new(parameters: Parameters) -> Result<Self, ParameterError> {
        check::check(&parameters)?;
        Ok(Self(parameters))
    }

    /// Whether forces between near spheres are part of the solve.
    pub(crate) fn is_coupled(&self) -> bool {
        self.hydrodynamics.lubrication || matches!(self.integrator, Integrator::Implicit(_))
    }

    /// Numbers of a particle in the column of bonds: slots for as many as any sphere has.
    pub(crate) fn bond_numbers(&self) -> usize {
        let mut ids: Vec<u64> = self.bonds.iter().flat_map(|bonds| bonds.pairs.as_flattened()).copied().collect();
        ids.sort_unstable();
        BOND_NUMBERS * ids.chunk_by(|a, b| a == b).map(<[u64]>::len).max().unwrap_or(0)
    }

    /// The axis along which the species' steady forces, added up by their sizes, act most; `None` without forces.
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
