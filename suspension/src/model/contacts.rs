//! Contacts of rough spheres.

use super::species::volume;
use super::{Integrator, Parameters, Start};
use domain::{Number, ParameterError};
use lubrication::{Contact, Elasticity};
use std::f64::consts::PI;

/// Contacts of rough spheres; parameters that are `None` are chosen for the suspension.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contacts {
    /// Coefficient of sliding friction.
    pub friction: f64,
    /// Sum of the heights of the asperities of both spheres, over their mean radius.
    pub roughness: f64,
    /// Normal stiffness: force over overlap and mean radius. `None` for a stiffness that keeps overlaps near `overlap`.
    pub stiffness: Option<f64>,
    /// Strain, as of a shear flow, in which an automatic stiffness adapts from its first estimate. Default:
    /// [`Self::SETTLING`], or 0 under a given stress, which keeps the estimate.
    pub settling: Option<f64>,
    /// Value to which an automatic stiffness adapted in a similar run. It is used from the start, without adaptation.
    pub settled: Option<f64>,
    /// Target of the largest overlap, over the roughness.
    pub overlap: f64,
    /// Tangential over normal stiffness.
    pub tangential_ratio: f64,
    /// Coefficient of rolling friction: largest rolling resistance over the normal force.
    pub rolling_friction: f64,
    /// Normal force below which there is no friction.
    pub critical_load: f64,
    /// Normal force law.
    pub law: Elasticity,
}

/// Default target of the largest overlap, over the roughness.
const OVERLAP: f64 = 0.3;

/// Prefactor of the largest overlap over the mean radius, about `DEPTH` times the relative viscosity estimated from
/// [`jamming_fraction`], over the stiffness in units of `6 pi` times viscosity times shear rate. Measured with 100
/// spheres at 40 to 50%.
const DEPTH: f64 = 2.0;

/// Stress at which shear thickening sets in, over the stress that corresponds to the critical load.
const THICKENING: f64 = 0.5;

/// Lower bound of `1 - phi / phi_J` in the estimate of the stiffness.
const LEAST_ROOM: f64 = 0.07;

impl Contacts {
    /// Default strain of the stiffness adaptation: enough for contacts to form and for the mean of the largest overlap
    /// to converge to about 10%.
    pub const SETTLING: f64 = 2.0;

    /// Contacts with a coefficient of friction and defaults for all else.
    pub fn new(friction: f64) -> Self {
        Self {
            friction,
            roughness: Contact::ROUGHNESS,
            stiffness: None,
            settling: None,
            settled: None,
            overlap: OVERLAP,
            tangential_ratio: Contact::TANGENTIAL_RATIO,
            rolling_friction: 0.0,
            critical_load: 0.0,
            law: Elasticity::Linear,
        }
    }

    /// Contact law for the spheres of a suspension.
    pub fn contact(&self, parameters: &Parameters) -> Contact {
        Contact {
            friction: self.friction,
            roughness: self.roughness,
            stiffness: self.stiffness.or(self.settled).unwrap_or_else(|| self.sufficient_stiffness(parameters)),
            tangential_ratio: self.tangential_ratio,
            rolling_friction: self.rolling_friction,
            critical_load: self.critical_load,
            elasticity: self.law,
        }
    }

    /// Whether the stiffness starts out adapting to the overlaps: it does in a steady flow at a given rate, and under a
    /// given stress if `settling` asks for it.
    pub(crate) fn settles(&self, parameters: &Parameters) -> bool {
        self.stiffness.is_none()
            && self.settled.is_none()
            && self.settling.map_or(parameters.shear_rates().stress().is_none(), |strain| strain > 0.0)
            && goes_on(parameters)
    }

    /// Estimate of the stiffness at which the largest overlaps are near their target, from the forces by which the flow
    /// and the weight press spheres of the mean radius together.
    pub(crate) fn sufficient_stiffness(&self, p: &Parameters) -> f64 {
        let spheres: f64 = p.species.iter().map(|s| s.count.unwrap_or(1) as f64).sum();
        let radius = p.species.iter().map(|s| s.count.unwrap_or(1) as f64 * s.radius).sum::<f64>() / spheres;
        let filled = p.species.iter().map(|s| s.count.unwrap_or(0) as f64 * volume(s.radius)).sum::<f64>();
        let viscosity = |friction: f64| {
            let room = 1.0 - filled / p.cell.volume() / jamming_fraction(friction);
            room.max(LEAST_ROOM).powi(-2)
        };
        let rate = p.flow.as_shear(p.shear_rates().largest());
        // Below the onset of shear thickening hardly any contact bears the critical load.
        let pressed = 6.0 * PI * p.viscosity * rate * radius * radius * viscosity(0.0);
        let friction = if pressed < THICKENING * self.critical_load { 0.0 } else { self.friction };
        let depth = DEPTH * viscosity(friction);
        let weight = p.species.iter().map(|s| s.force_on(s.radius, p.gravity).length()).fold(0.0, f64::max);
        // A given stress presses the spheres together directly; a given rate does so through the viscosity, which is
        // part of `depth`.
        let (rate, stress) = p.shear_rates().stress().map_or((rate, 0.0), |stress| (0.0, stress));
        let load = depth * (6.0 * PI * p.viscosity * rate * radius * radius + weight);
        let by_stress = DEPTH * 6.0 * PI * stress * radius * radius;
        let target = self.overlap * self.roughness;
        let linear = (load + by_stress) / (target * radius * radius);
        let stiffness = match self.law {
            Elasticity::Linear => linear,
            Elasticity::Hertz => linear / target.sqrt(),
        };
        // Without any load, any stiffness will do.
        if stiffness > 0.0 { stiffness } else { p.viscosity / p.time_step }
    }

    pub(super) fn check(&self, p: &Parameters) -> Result<(), ParameterError> {
        let error = |key: &str, message: String| Err(ParameterError::new(key, message));
        if !p.hydrodynamics.lubrication {
            let message = "need hydrodynamics.lubrication = true and multipoles = \"dipole\": spheres in contact roll \
                and slide by torques, and lubrication is what their springs are damped by";
            return error("contacts", message.to_owned());
        }
        if !matches!(p.integrator, Integrator::Implicit(_)) {
            let message = "can't hold contacts; their springs need \"implicit\", which is the default with [contacts]";
            return error("time.integrator", message.to_owned());
        }
        if !(self.overlap > 0.0 && self.overlap < 1.0) {
            let overlap = Number(self.overlap);
            let message = format!("is {overlap}; spheres would touch bare: give more than 0 and less than 1");
            return error("contacts.target_overlap", message);
        }
        self.check_settling(p)?;
        self.contact(p).check()?;
        let range = p.repulsion.and_then(|repulsion| repulsion.range).unwrap_or(f64::INFINITY);
        if range <= self.roughness {
            let (range, roughness) = (Number(range), Number(self.roughness));
            let message = format!("is {range}, which ends inside the roughness: give more than {roughness}");
            return error("repulsion.range", message);
        }
        self.check_images(p)
    }

    fn check_settling(&self, p: &Parameters) -> Result<(), ParameterError> {
        let keys = [("contacts.adaptation_strain", self.settling), ("contacts.adapted_stiffness", self.settled)];
        if let Some((key, _)) = keys.into_iter().find(|(_, given)| given.is_some() && self.stiffness.is_some()) {
            let message = "is set, but contacts.stiffness is a number, which stays what it is; set that to \"auto\", \
                or leave one of them out";
            return Err(ParameterError::new(key, message));
        }
        if let Some(settled) = self.settled {
            ParameterError::require_positive("contacts.adapted_stiffness", settled)?;
        }
        let Some(settling) = self.settling else { return Ok(()) };
        let message = if !(settling >= 0.0 && settling.is_finite()) {
            format!(
                "is {}; the strain in which the stiffness settles needs to be 0 or more, and finite",
                Number(settling)
            )
        } else if settling > 0.0 && !goes_on(p) {
            "is set, but the stiffness settles only in a shear flow or an extension that goes on at its rate or by a \
             stress, and is an estimate without; leave it out"
                .to_owned()
        } else {
            return Ok(());
        };
        Err(ParameterError::new("contacts.adaptation_strain", message))
    }

    /// Contacts are identified by the ids of their two spheres, so a sphere must not touch two images of another.
    fn check_images(&self, p: &Parameters) -> Result<(), ParameterError> {
        let largest = p.species.iter().map(|s| s.radius).fold(0.0, f64::max);
        let repeating = (0..3).filter(|&axis| p.cell.is_periodic(axis)).map(|axis| p.cell.edges()[axis]);
        let of_edges = || repeating.fold(f64::INFINITY, f64::min);
        let shortest = p.stretched_box().map_or_else(of_edges, |extension| extension.shortest_vector(&p.cell));
        let least = 4.0 * largest * (1.0 + 0.5 * self.roughness);
        if shortest < least {
            let [shortest, least] = [shortest, least].map(Number);
            let message = format!(
                "has an edge of {shortest}, along which a sphere could touch two images of another; with [contacts] \
                 give {least:.5} or more"
            );
            return Err(ParameterError::new("box.edges", message));
        }
        Ok(())
    }

    /// Smallest gap at which random starts have no contacts.
    pub fn minimum_gap(&self, largest_radius: f64) -> f64 {
        self.roughness * largest_radius
    }
}

/// Whether there is a steady flow, at a rate or under a stress, rather than an oscillation or none.
fn goes_on(p: &Parameters) -> bool {
    let rates = p.shear_rates();
    rates.frequency().is_none() && rates.before(0).0 != 0.0
}

/// Volume fraction at which a sheared suspension jams, by Lobry et al., J. Fluid Mech. 860, 682 (2019).
fn jamming_fraction(friction: f64) -> f64 {
    let strongest = (-1.25 * PI).exp();
    0.546 + 0.094 * ((-2.5 * friction.atan()).exp() - strongest) / (1.0 - strongest)
}

impl Parameters {
    /// These parameters with random starts whose gaps are at least the roughness.
    #[must_use]
    pub fn apart_by_roughness(mut self) -> Self {
        let largest = self.species.iter().map(|s| s.radius).fold(0.0, f64::max);
        let gap = match &mut self.start {
            Start::Random { minimum_gap } | Start::Cloud { minimum_gap, .. } => Some(minimum_gap),
            Start::Lattice(_) | Start::Positions(_) | Start::Given => None,
        };
        if let (Some(minimum_gap), Some(contacts)) = (gap, &self.contacts) {
            *minimum_gap = minimum_gap.max(contacts.minimum_gap(largest));
        }
        self
    }
}
