//! What a suspension consists of and how it moves: parameters, and the model that they make once they are checked.

mod attraction;
mod check;
mod contacts;
mod copy;
mod hydrodynamics;
mod integrator;
mod rates;
mod sizes;
mod spheres;
mod statistics;

pub use attraction::Attraction;
pub use contacts::Contacts;
use domain::{ParameterError, PeriodicBox, Vector};
pub use hydrodynamics::{Evaluation, Hydrodynamics, Multipoles};
pub use integrator::{Adaptive, BrownianScheme, Integrator};
pub use rates::{Protocol, RateChange, ShearRates};
pub use sizes::{SizeClass, SizeDistribution};
pub use spheres::{Lattice, MAX_FRACTION, MAX_SPHERES, Species, Start};
pub use statistics::{Axis, Statistics};
use std::ops::Deref;

/// What a suspension consists of and how it moves. Keys in the messages of [`Model::new`] are those of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    /// Where random numbers start.
    pub seed: u64,
    /// The box, not sheared yet.
    pub cell: PeriodicBox,
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
    /// How the rate of shear changes.
    pub protocol: Protocol,
    /// What keeps spheres apart.
    pub repulsion: Option<Repulsion>,
    /// How spheres attract each other.
    pub attraction: Option<Attraction>,
    /// How rough spheres touch; without, they are smooth.
    pub contacts: Option<Contacts>,
    /// How the fluid is computed.
    pub hydrodynamics: Hydrodynamics,
    /// The time step.
    pub time_step: f64,
    /// The last step, up to which memory is planned.
    pub steps: u64,
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
            viscosity,
            thermal_energy: None,
            gravity: Vector::ZERO,
            species,
            start: Start::Random { minimum_gap: 0.0 },
            flow: Flow::None,
            protocol: Protocol::STEADY,
            repulsion: None,
            attraction: None,
            contacts: None,
            hydrodynamics: Hydrodynamics::default(),
            time_step,
            steps,
            integrator: Integrator::AdamsBashforth { order: 4 },
            statistics: None,
            fields: false,
        }
    }

    /// The rate of shear in time; 0 without shear.
    pub fn shear_rates(&self) -> ShearRates {
        let first = if let Flow::Shear { rate, .. } = self.flow { rate } else { 0.0 };
        ShearRates::new(first, self.protocol.clone(), self.time_step)
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
    /// `u = rate y e_x`.
    Shear {
        /// One over time; at the start, where it changes.
        rate: f64,
        /// Whether the box shears with the flow, so that images of spheres move with it.
        lees_edwards: bool,
    },
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
