//! Swimming of the spheres of a species.

use super::{BrownianScheme, Integrator, MultipoleOrder, Parameters, Species};
use domain::{Number, ParameterError, Vector};
use std::f64::consts::PI;

/// Swimming of the spheres of a species, squirmers along the axis `p` of their orientation: their surface moves
/// relative to them by
///
/// ```text
/// u_s = (B1 + B2 n.p) [(n.p) n - p]
/// ```
///
/// with the outward normal `n` (Lighthill 1952; Blake, J. Fluid Mech. 46, 199, 1971). In unbounded fluid one alone has
/// the velocity `2/3 B1 p` and the stresslet `4 pi mu a^2 B2 (p p - I/3)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Swimming {
    /// Speed `2/3 B1` of one alone in unbounded fluid.
    pub speed: f64,
    /// Strength of the flow that swimming spheres exert no force for.
    pub dipole: ActiveDipole,
    /// Intrinsic angular velocity, in the axes of the sphere, whose third is `p`: that of one alone in fluid at rest.
    pub angular_velocity: Vector,
    /// Gyrotactic reorientation time `B` of bottom-heavy spheres, which turn against gravity, with the unit vector `k`,
    /// by `dp/dt = [k - (k.p) p] / (2 B)` (Pedley & Kessler, Annu. Rev. Fluid Mech. 24, 313, 1992); `None` for spheres
    /// whose centre of mass is in the middle.
    pub gyrotactic_time: Option<f64>,
    /// Rotational diffusivity of the swimming itself, in addition to that of Brownian motion: alone it gives
    /// `<p(0).p(t)> = exp(-2 D t)`.
    pub rotational_diffusion: f64,
    /// Number of tumbles per time, after each of which all orientations are equally likely: alone they give
    /// `<p(0).p(t)> = exp(-rate t)`.
    pub tumbling_rate: f64,
}

/// Strength of the second mode of the slip, negative for pushers and positive for pullers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ActiveDipole {
    /// `B2 / B1`
    Ratio(f64),
    /// The stresslet `S` of one alone, `S (p p - I/3)`.
    Stresslet(f64),
}

impl Swimming {
    /// Neutral squirmers of a speed: without stresslet, gravity, rotation of their own, and noise.
    pub fn new(speed: f64) -> Self {
        Self {
            speed,
            dipole: ActiveDipole::Ratio(0.0),
            angular_velocity: Vector::ZERO,
            gyrotactic_time: None,
            rotational_diffusion: 0.0,
            tumbling_rate: 0.0,
        }
    }

    /// `B1`
    pub fn first_mode(&self) -> f64 {
        1.5 * self.speed
    }

    /// `B2` of a sphere in a fluid of a viscosity.
    pub fn second_mode(&self, radius: f64, viscosity: f64) -> f64 {
        match self.dipole {
            ActiveDipole::Ratio(ratio) => ratio * self.first_mode(),
            ActiveDipole::Stresslet(stresslet) => stresslet / (4.0 * PI * viscosity * radius * radius),
        }
    }

    /// Whether the surface moves relative to the sphere in a way that moves fluid.
    pub fn has_slip(&self) -> bool {
        self.speed != 0.0 || matches!(self.dipole, ActiveDipole::Stresslet(stresslet) if stresslet != 0.0)
    }

    /// Whether directions change at random.
    pub fn is_random(&self) -> bool {
        self.rotational_diffusion > 0.0 || self.tumbling_rate > 0.0
    }

    pub(super) fn check(&self, index: usize, p: &Parameters) -> Result<(), ParameterError> {
        let key = |name: &str| format!("species[{index}].swimming.{name}");
        for (name, value) in [
            ("speed", self.speed),
            ("rotational_diffusion", self.rotational_diffusion),
            ("tumbling_rate", self.tumbling_rate),
        ] {
            if !(value >= 0.0 && value.is_finite()) {
                let message = format!("is {}; it needs to be 0 or more", Number(value));
                return Err(ParameterError::new(key(name), message));
            }
        }
        match self.dipole {
            ActiveDipole::Ratio(ratio) => ParameterError::require_finite(&key("beta"), ratio)?,
            ActiveDipole::Stresslet(stresslet) => ParameterError::require_finite(&key("stresslet"), stresslet)?,
        };
        ParameterError::require_finite_vector(&key("angular_velocity"), self.angular_velocity)?;
        if let Some(time) = self.gyrotactic_time {
            ParameterError::require_positive(&key("gyrotactic_time"), time)?;
            if p.gravity == Vector::ZERO {
                let message =
                    "is set, but there is no gravity to turn against; write [gravity] acceleration = [x, y, z]";
                return Err(ParameterError::new(key("gyrotactic_time"), message));
            }
        }
        check_axis(index, p)
    }
}

impl Species {
    /// Rate `1 / (2 B)` at which bottom-heavy spheres reorient; `None` for others.
    pub fn reorientation_rate(&self) -> Option<f64> {
        self.swimming.as_ref()?.gyrotactic_time.map(|time| 0.5 / time)
    }
}

impl Parameters {
    /// Whether some species swims.
    pub fn has_swimmers(&self) -> bool {
        self.species.iter().any(|species| species.swimming.is_some())
    }

    /// Whether spheres move fluid by their slip.
    pub fn has_slip(&self) -> bool {
        self.species.iter().any(|species| species.swimming.as_ref().is_some_and(Swimming::has_slip))
    }
}

/// Refuses swimmers that have no axis, or do not rotate.
fn check_axis(index: usize, p: &Parameters) -> Result<(), ParameterError> {
    let message = if p.hydrodynamics.multipoles == MultipoleOrder::Monopole {
        "needs spheres that rotate; take hydrodynamics.multipoles = \"dipole\", or leave it out"
    } else if p.species[index].orientation.is_none() {
        "needs an orientation, along whose axis the spheres swim; set one"
    } else {
        return Ok(());
    };
    Err(ParameterError::new(format!("species[{index}].swimming"), message))
}

/// Refuses what swimmers can't be together with.
pub(super) fn check(p: &Parameters) -> Result<(), ParameterError> {
    let refusals = [(p.has_swimmers(), of_swimmers(p)), (p.has_slip(), of_slip(p))];
    let all = refusals.into_iter().filter(|(is_asked, _)| *is_asked).flat_map(|(_, list)| list);
    match all.into_iter().find(|refusal| refusal.is_refused) {
        Some(Refusal { key, words, .. }) => {
            let message = format!("{words}, which can't be with species.swimming yet; leave one of them out");
            Err(ParameterError::new(key, message))
        }
        None => Ok(()),
    }
}

/// A feature that swimmers can't be together with.
struct Refusal {
    is_refused: bool,
    key: &'static str,
    words: &'static str,
}

fn refusal(is_refused: bool, key: &'static str, words: &'static str) -> Refusal {
    Refusal { is_refused, key, words }
}

/// Refused with any swimmers.
fn of_swimmers(p: &Parameters) -> Vec<Refusal> {
    let two_evaluations = Integrator::Brownian(BrownianScheme::TwoEvaluations);
    vec![
        refusal(p.contacts.is_some(), "contacts", "is set"),
        refusal(p.integrator == two_evaluations, "time.brownian", "is \"random-finite-difference\""),
    ]
}

/// Refused with spheres that move fluid by their slip.
fn of_slip(p: &Parameters) -> Vec<Refusal> {
    let is_calibrated = p.repulsion.is_some_and(|repulsion| repulsion.calibrate);
    vec![
        refusal(p.flow.keeps_flux(), "flow.mean_velocity", "is set"),
        refusal(is_calibrated, "repulsion.calibrate", "is true"),
    ]
}
