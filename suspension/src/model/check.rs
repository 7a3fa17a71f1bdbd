//! Checks that all parameters are in their ranges and fit together.

use super::species::check_species;
use super::{
    Axis, Extension, Flow, Integrator, MultipoleOrder, Parameters, Protocol, Repulsion, ShearRates, Species, bodies,
    bonds, dipoles, displacement, filaments, swimming, traps,
};
use domain::{Boundaries, Number, ParameterError};
use fcm::Method;
use hydrodynamics::lengths::check_lubricated;
use statistics::FEWEST_SAMPLES;
use std::f64::consts::TAU;

/// Largest strain of a run: beyond it the offset of the sheared box has lost more than half of its digits.
const MAX_STRAIN: f64 = 1e9;

/// Checks that all parameters are in their ranges and fit together.
pub fn check(parameters: &Parameters) -> Result<(), ParameterError> {
    let p = parameters;
    ParameterError::require_positive("time.step", p.time_step)?;
    filaments::check(p)?;
    bodies::check(p)?;
    check_species(p, p.shortest_vector())?;
    ParameterError::require_positive("fluid.viscosity", p.viscosity)?;
    check_heat(p)?;
    ParameterError::require_finite_vector("gravity.acceleration", p.user_axes().vector(p.gravity))?;
    p.start.check(p)?;
    check_boundaries(p)?;
    check_strain(p)?;
    check_flow(p)?;
    p.repulsion.as_ref().map_or(Ok(()), |repulsion| check_repulsion(repulsion, p))?;
    p.attraction.as_ref().map_or(Ok(()), |attraction| attraction.check(p))?;
    p.hydrodynamics.check(&p.user_axes())?;
    check_ratio(p)?;
    p.contacts.as_ref().map_or(Ok(()), |contacts| contacts.check(p))?;
    bonds::check(p)?;
    traps::check(p)?;
    swimming::check(p)?;
    dipoles::check(p)?;
    p.statistics.as_ref().map_or(Ok(()), |statistics| statistics.check(&p.cell))?;
    displacement::check(p)?;
    p.integrator.check(p.contacts.is_some())
}

/// Brownian motion needs an integrator made for it, and a box whose images move with the flow.
fn check_heat(p: &Parameters) -> Result<(), ParameterError> {
    let is_brownian = matches!(p.integrator, Integrator::Brownian(_));
    let Some(energy) = p.thermal_energy else {
        let message = "is missing; time.integrator = \"brownian\" needs it";
        return if is_brownian { Err(ParameterError::new("fluid.thermal_energy", message)) } else { Ok(()) };
    };
    ParameterError::require_positive("fluid.thermal_energy", energy)?;
    if !is_brownian {
        let message = "leaves Brownian motion out; with fluid.thermal_energy steps need to be \"brownian\", which is \
            the default then";
        return Err(ParameterError::new("time.integrator", message));
    }
    if p.contacts.is_some() {
        let message = "can't be with fluid.thermal_energy: steps of Brownian motion have no springs; use [repulsion]";
        return Err(ParameterError::new("contacts", message));
    }
    if p.shear_rates().stress().is_some() {
        let message = "is \"stress\", which can't be with fluid.thermal_energy: random stresses would drive the flow; \
            give flow.rate";
        return Err(ParameterError::new("flow.control", message));
    }
    let is_periodic = p.cell.boundaries() == Boundaries::Periodic;
    if let (Flow::Shear { lees_edwards: false, .. }, true) = (p.flow, is_periodic) {
        let message = "is false, but Brownian motion moves spheres across the faces of the box, beyond which images \
            that do not move with the flow are no places of equilibrium; leave it out";
        return Err(ParameterError::new("flow.lees_edwards", message));
    }
    Ok(())
}

/// Refuses features that are not available with walls or in unbounded fluid.
fn check_boundaries(p: &Parameters) -> Result<(), ParameterError> {
    let refused = |key: &str, message: &str| Err(ParameterError::new(key, message));
    let boundaries = p.cell.boundaries();
    if matches!(p.flow, Flow::Poiseuille { .. } | Flow::ConstantFlux { .. }) && boundaries != Boundaries::Walls {
        return refused("flow.kind", "is \"poiseuille\", which needs two walls: \"walls\" in box.boundaries");
    }
    if boundaries == Boundaries::Periodic {
        return Ok(());
    }
    if let Flow::Shear { lees_edwards: true, .. } = p.flow {
        let message = "is true, but only a box that repeats along all axes shears with the flow; leave it out";
        return refused("flow.lees_edwards", message);
    }
    if let Protocol::Stress(_) = p.protocol {
        let message = "is \"stress\", which only a periodic box can follow; give flow.rate, between walls the speed \
            of the upper one over its height";
        return refused("flow.control", message);
    }
    if p.thermal_energy.is_some() && p.flow.keeps_flux() {
        let message = "is set with fluid.thermal_energy, but Brownian motion has no part in what keeps the flux; give \
            flow.pressure_gradient";
        return refused("flow.mean_velocity", message);
    }
    if p.statistics.is_some() && boundaries == Boundaries::Open {
        let message = "are those of a box that repeats along two axes or all; leave them out in unbounded fluid";
        return refused("statistics", message);
    }
    if boundaries == Boundaries::OpenAlongZ { check_layer(p) } else { Ok(()) }
}

/// Checks a layer of spheres in fluid that is open on both sides: the far fluid has no velocity to which a flow, or the
/// motion due to forces along the layer, could be relative.
fn check_layer(p: &Parameters) -> Result<(), ParameterError> {
    if p.thermal_energy.is_some() {
        let message = "can't be in a layer in fluid that is open on both sides: Brownian motion moves spheres along \
            it, and all fluid with them; make box.boundaries periodic, open along all axes, or with walls";
        return Err(ParameterError::new("fluid.thermal_energy", message));
    }
    if !matches!(p.flow, Flow::None) {
        let message = "is a flow, but a layer in fluid that is open on both sides has none; leave it out";
        return Err(ParameterError::new("flow.kind", message));
    }
    if !p.traps.is_empty() {
        let message = "hold spheres of a layer in fluid that is open on both sides, all of which forces along it \
            move; leave them out";
        return Err(ParameterError::new("traps", message));
    }
    let is_along = |s: &Species| {
        let force = s.force_on(s.radius, p.gravity);
        force.x != 0.0 || force.y != 0.0
    };
    match p.species.iter().position(is_along) {
        Some(index) => {
            let message = "has a force along a layer in fluid that is open on both sides, all of which it would move; \
                only forces across the layer, along its open axis, are possible";
            Err(ParameterError::new(format!("species[{index}]"), message))
        }
        None => Ok(()),
    }
}

/// Only a fully periodic box may start with a strain; if there is a flow, the box has to shear with it.
fn check_strain(p: &Parameters) -> Result<(), ParameterError> {
    let strain = if p.cell.axes().is_none() { p.cell.strain() } else { 0.0 };
    let is_possible = matches!(p.flow, Flow::None | Flow::Shear { lees_edwards: true, .. });
    if strain == 0.0 || is_possible {
        return Ok(());
    }
    let message = format!(
        "is {}, but a box with a strain stays as it is without a flow, or shears with it; this one can't",
        Number(strain)
    );
    Err(ParameterError::new("box.strain", message))
}

/// Checks that the final strain is small enough to locate the images, and that with lubrication the images of a sphere
/// move with the flow.
fn check_flow(p: &Parameters) -> Result<(), ParameterError> {
    if let Flow::Poiseuille { pressure_gradient } = p.flow {
        ParameterError::require_finite("flow.pressure_gradient", pressure_gradient)?;
    }
    if let Flow::ConstantFlux { mean_velocity } = p.flow {
        ParameterError::require_finite("flow.mean_velocity", mean_velocity)?;
    }
    let (rate, lees_edwards) = match p.flow {
        Flow::Shear { rate, lees_edwards } => (rate, lees_edwards),
        Flow::Extension { kind, rate } => {
            check_extension(p, kind)?;
            (rate, true)
        }
        Flow::None | Flow::Poiseuille { .. } | Flow::ConstantFlux { .. } if p.protocol == Protocol::STEADY => {
            return Ok(());
        }
        Flow::None | Flow::Poiseuille { .. } | Flow::ConstantFlux { .. } => {
            let message = "changes, but flow.kind is \"none\"; set flow.kind = \"shear\"";
            return Err(ParameterError::new("flow.rate", message));
        }
    };
    let (rates, end) = (p.shear_rates(), p.end());
    let is_straight = !lees_edwards && p.cell.boundaries() == Boundaries::Periodic;
    rates.check()?;
    if rates.largest_strain(end) > MAX_STRAIN {
        let (rate, end, largest) = (Number(rate), Number(end), Number(MAX_STRAIN));
        let message =
            format!("is {rate}; until time {end:.6} that is a strain above {largest}, the most that a run can have");
        return Err(ParameterError::new("flow.rate", message));
    }
    check_changing_rate(p, &rates, is_straight)?;
    if p.hydrodynamics.lubrication && is_straight {
        let message = "is true, but with flow.lees_edwards = false the box stays rectangular, and spheres on either \
            side of its y boundary would rub against images that do not move with the flow; set flow.lees_edwards = \
            true, or lubrication = false";
        return Err(ParameterError::new("hydrodynamics.lubrication", message));
    }
    Ok(())
}

/// Checks a rate that oscillates or is solved for; `is_straight` tells whether the box stays rectangular in the flow.
fn check_changing_rate(p: &Parameters, rates: &ShearRates, is_straight: bool) -> Result<(), ParameterError> {
    let carried = [("flow.oscillation", rates.frequency().is_some()), ("flow.control", rates.stress().is_some())];
    if let Some((key, _)) = carried.into_iter().find(|(_, is_set)| *is_set && is_straight) {
        let message =
            "is set, but with flow.lees_edwards = false the box stays rectangular; leave flow.lees_edwards out";
        return Err(ParameterError::new(key, message));
    }
    if rates.stress().is_some() && p.hydrodynamics.multipoles == MultipoleOrder::Monopole {
        let message = "is \"stress\", of which spheres without stresslets have no part; set hydrodynamics.multipoles \
            = \"dipole\"";
        return Err(ParameterError::new("flow.control", message));
    }
    if rates.stress().is_some() && !matches!(p.integrator, Integrator::Implicit(_)) {
        let message = "can't follow a rate that is solved for; flow.control = \"stress\" needs \"implicit\", which is \
            its default";
        return Err(ParameterError::new("time.integrator", message));
    }
    if let (Some(frequency), Some(wanted)) = (rates.frequency(), p.statistics) {
        let interval = wanted.samples.next_after(0).map_or(0.0, |steps| steps as f64 * p.time_step);
        let samples = TAU / (frequency * interval);
        if samples < FEWEST_SAMPLES * (1.0 - 1e-9) {
            let (samples, fewest) = (Number(samples), Number(FEWEST_SAMPLES));
            let message = format!(
                "leaves {samples:.3} samples in a period of flow.oscillation; moduli and harmonics need {fewest} or \
                 more"
            );
            return Err(ParameterError::new("statistics.every", message));
        }
    }
    Ok(())
}

/// An extension needs its own periodic box and features that support such boxes, or unbounded fluid, for which
/// [`check_boundaries`] is enough.
fn check_extension(p: &Parameters, kind: Extension) -> Result<(), ParameterError> {
    if p.cell.boundaries() == Boundaries::Open {
        return Ok(());
    }
    if !kind.has_box(&p.cell) {
        let message = "are not those of a box that repeats in an extension; take that of Extension::cell";
        return Err(ParameterError::new("box.edges", message));
    }
    if p.shear_rates().stress().is_some() {
        let message = "is \"stress\", which drives a shear only; leave it out, and give flow.rate";
        return Err(ParameterError::new("flow.control", message));
    }
    if p.fields {
        let message =
            "is set, but velocity fields are those of straight and sheared boxes; leave it out in an extension";
        return Err(ParameterError::new("output.fields_every", message));
    }
    if p.hydrodynamics.method == Some(Method::Direct) && kind != Extension::Planar {
        let message = format!(
            "is \"direct\", which is for boxes with a lattice vector at right angles to the other two; that of {} has \
             none: leave it out",
            kind.name()
        );
        return Err(ParameterError::new("hydrodynamics.method", message));
    }
    match (p.statistics.and_then(|statistics| statistics.axis), kind) {
        (Some(Axis::X | Axis::Y), Extension::Planar) => {
            let message = "is x or y, along which the box of planar extension does not repeat; leave it out, for \"z\"";
            Err(ParameterError::new("statistics.axis", message))
        }
        (Some(_), Extension::Uniaxial | Extension::Biaxial) => {
            let message = format!("is set, but the box of {} repeats along no axis; leave it out", kind.name());
            Err(ParameterError::new("statistics.axis", message))
        }
        _ => Ok(()),
    }
}

/// The lubrication functions are available for radius ratios up to a limit.
fn check_ratio(p: &Parameters) -> Result<(), ParameterError> {
    let radii = || p.species.iter().map(|species| species.radius);
    let (smallest, largest) = (radii().fold(f64::INFINITY, f64::min), radii().fold(0.0, f64::max));
    if !p.hydrodynamics.lubrication {
        return Ok(());
    }
    check_lubricated(smallest, largest).map_err(|message| ParameterError::new("hydrodynamics.lubrication", message))
}

fn check_repulsion(repulsion: &Repulsion, p: &Parameters) -> Result<(), ParameterError> {
    let Repulsion { strength, radius_power, range, screening_length, calibrate } = *repulsion;
    if strength < 0.0 || !strength.is_finite() {
        let message = format!("is {}; the force at contact needs to be 0 or more", Number(strength));
        return Err(ParameterError::new("repulsion.strength", message));
    }
    if let Some(range) = range.filter(|r| !(*r > 0.0 && *r <= 1.0)) {
        let range = Number(range);
        let message = format!("is {range}; the gap where the barrier starts needs 0 < range <= 1, in mean radii");
        return Err(ParameterError::new("repulsion.range", message));
    }
    if let Some(length) = screening_length {
        ParameterError::require_positive("repulsion.screening_length", length)?;
        let shortest = p.shortest_vector();
        if length > shortest && p.cell.boundaries() != Boundaries::Open {
            let message = format!(
                "is {}; it needs to be at most the box's shortest edge, {}: spheres would repel many images of each \
                 other; take a larger box, or a shorter length",
                Number(length),
                Number(shortest)
            );
            return Err(ParameterError::new("repulsion.screening_length", message));
        }
        if range.is_some() {
            let message =
                "is that of a barrier; a screened repulsion ends by repulsion.screening_length: leave one of them out";
            return Err(ParameterError::new("repulsion.range", message));
        }
    }
    if radius_power > 2 {
        let message = format!(
            "is {radius_power}; the force at contact grows with the 0th (the same for all, the default), 1st or 2nd \
             power of the harmonic mean radius of the two spheres"
        );
        return Err(ParameterError::new("repulsion.radius_power", message));
    }
    if calibrate && strength == 0.0 {
        let message = "is 0, but repulsion.calibrate is true; give the strength where the search starts";
        return Err(ParameterError::new("repulsion.strength", message));
    }
    Ok(())
}
