//! Scenes of spheres in Stokes flow.

mod attraction;
mod bodies;
mod cell;
mod dipoles;
mod duration;
mod filaments;
mod flow;
mod names;
mod raw;
mod species;
mod swimming;
mod tethers;

use crate::StartSource;
use crate::answers::AnswersSection;
use crate::checks::positive;
use crate::document::NumberOr;
use crate::key_error::KeyError;
use crate::time_and_output::{OutputSchedules, Time, share};
use domain::{AxisRotation, Boundaries, PeriodicBox, Vector, sphere};
use fcm::Network;
pub(super) use raw::SuspensionSections;
use simulation::Schedule;
use std::path::Path;
use suspension::{
    Adaptive, BrownianScheme, Contacts, Hydrodynamics, Integrator, Lattice, Model, Parameters, Repulsion, Start,
    StatisticsParameters,
};

/// A checked scene of spheres in Stokes flow; only [`Scene`](crate::Scene) makes one.
#[derive(Debug)]
#[non_exhaustive]
pub struct SuspensionScene {
    /// Title in plots and files.
    pub title: String,
    /// The suspension.
    pub model: Model,
    /// File or former run with the initial positions, if the model takes them from one.
    pub start: Option<StartSource>,
    /// Strain of the box at the start, if the scene sets it; by default that of the file's box.
    pub strain: Option<f64>,
    /// Time step and number of steps.
    pub time: Time,
    /// The time from which the answers take their means; the transient is left out that is found where there is none.
    pub answers_from: Option<f64>,
    /// Schedules and files of the output.
    pub output: OutputSchedules,
}

impl SuspensionScene {
    pub(super) fn checked(raw: SuspensionSections, folder: &Path) -> Result<Self, KeyError> {
        let (cell, turn) = cell::cell(&raw)?;
        let usual_integrator = usual_integrator(&raw);
        let species = species::species(&raw, room(&raw, &cell))?;
        let bodies = bodies::bodies(&raw, &species, room(&raw, &cell))?;
        let filaments = filaments::filaments(&raw, &species, room(&raw, &cell))?;
        let shears = cell.boundaries() == Boundaries::Periodic;
        let time_step = positive("time.step", raw.time.step)?;
        let (flow, protocol) = flow::flow(raw.flow.as_ref(), raw.fluid.viscosity, time_step, shears)?;
        let (time, last_strain) = duration::time(&raw.time, &flow, &protocol)?;
        check_contacts(&raw)?;
        let output = output(raw.output, time.steps);
        let groups = bodies.iter().chain(filaments.iter().map(|filaments| &filaments.rods));
        let of_bodies = groups.map(|kind| (kind.count * kind.spheres.len() as u64) as f64).sum::<f64>();
        output.check(time.steps, of_bodies + species.iter().map(|s| s.count.unwrap_or(0) as f64).sum::<f64>())?;
        let (start, source) = start(&raw.particles, folder)?;
        let gap_is_given = raw.particles.minimum_gap.is_some();
        let traps = tethers::traps(&raw.traps, &species)?;
        let parameters = Parameters {
            seed: raw.seed,
            cell,
            turn: AxisRotation::default(),
            viscosity: raw.fluid.viscosity,
            thermal_energy: raw.fluid.thermal_energy,
            gravity: raw.gravity.as_ref().map_or(Vector::ZERO, |g| g.acceleration.into()),
            species,
            bodies: Vec::new(),
            filaments: Vec::new(),
            start,
            flow,
            protocol,
            repulsion: raw.repulsion.as_ref().map(repulsion),
            attraction: raw.attraction.as_ref().map(attraction::attraction).transpose()?,
            contacts: raw.contacts.as_ref().map(contacts),
            bonds: tethers::bonds(&raw.bonds)?,
            traps,
            magnetic: raw.magnetic.map(dipoles::magnetic).transpose()?,
            electric: raw.electric.map(dipoles::electric).transpose()?,
            hydrodynamics: hydrodynamics(&raw.hydrodynamics),
            time_step: time.step,
            steps: time.steps,
            last_strain,
            integrator: integrator(&raw.time, usual_integrator, raw.contacts.is_some())?,
            statistics: raw.statistics.as_ref().map(statistics),
            fields: output.fields != Schedule::NEVER,
        }
        .with_bodies(bodies)
        .with_filaments(filaments)
        .turned(turn);
        Ok(Self {
            title: raw.title.unwrap_or_default(),
            model: Model::new(if gap_is_given { parameters } else { parameters.apart_by_roughness() })?,
            start: source,
            strain: raw.cell.strain,
            answers_from: AnswersSection::start(raw.answers, &time)?,
            time,
            output,
        })
    }
}

/// Refuses output of contacts if there can be none.
fn check_contacts(raw: &SuspensionSections) -> Result<(), KeyError> {
    match raw.output.contacts_every {
        every if every > 0 && raw.contacts.is_none() && raw.bonds.is_empty() && raw.filaments.is_empty() => {
            let message =
                format!("is {every}, but there is nothing to write: add [contacts] or [[bonds]], or leave it out");
            Err(KeyError::new("output.contacts_every", message))
        }
        _ => Ok(()),
    }
}

/// Reference volume of volume fractions: that of the box, or of the ball in which the spheres start.
fn room(raw: &SuspensionSections, cell: &PeriodicBox) -> f64 {
    raw.particles.radius.map_or_else(|| cell.volume(), sphere::volume)
}

/// Initial placement of the spheres, and the file with their positions.
fn start(raw: &raw::ParticlesSection, folder: &Path) -> Result<(Start, Option<StartSource>), KeyError> {
    use raw::Initial::{Cloud, File, Lattice, Positions, Random};
    let of_gap = if raw.initial == Cloud { Cloud } else { Random };
    let belongs = [
        ("minimum_gap", raw.minimum_gap.is_some(), of_gap, "random"),
        ("radius", raw.radius.is_some(), Cloud, "cloud"),
        ("lattice", raw.lattice.is_some(), Lattice, "lattice"),
        ("path", raw.path.is_some(), File, "file"),
        ("frame", raw.frame.is_some(), File, "file"),
        ("group", raw.group.is_some(), File, "file"),
        ("positions", raw.positions.is_some(), Positions, "positions"),
    ];
    for (name, is_set, initial, with) in belongs {
        if is_set && raw.initial != initial {
            let message = format!("goes with particles.initial = \"{with}\" only; leave it out or change that");
            return Err(KeyError::new(format!("particles.{name}"), message));
        }
    }
    let missing = |name: &str, what: &str| KeyError::new(format!("particles.{name}"), format!("is missing; {what}"));
    match raw.initial {
        Random => Ok((Start::Random { minimum_gap: raw.minimum_gap.unwrap_or(0.0) }, None)),
        Cloud => {
            let radius =
                raw.radius.ok_or_else(|| missing("radius", "say how large the ball is in which the centres are"))?;
            Ok((Start::Cloud { radius, minimum_gap: raw.minimum_gap.unwrap_or(0.0) }, None))
        }
        Lattice => Ok((Start::Lattice(raw.lattice.map_or(self::Lattice::SimpleCubic, Into::into)), None)),
        File => {
            let path = raw.path.as_ref().ok_or_else(|| missing("path", "name a file or the folder of a former run"))?;
            let source = StartSource { path: folder.join(path), frame: raw.frame, group: raw.group.clone() };
            Ok((Start::Given, Some(source)))
        }
        Positions => {
            let list = raw.positions.as_ref().ok_or_else(|| missing("positions", "list [x, y, z] for every sphere"))?;
            Ok((Start::Positions(list.iter().map(|&place| place.into()).collect()), None))
        }
    }
}

fn repulsion(raw: &raw::RepulsionSection) -> Repulsion {
    let raw::RepulsionSection { strength, range, screening_length, radius_power, calibrate } = *raw;
    Repulsion { strength, radius_power, range, screening_length, calibrate }
}

fn contacts(raw: &raw::ContactsSection) -> Contacts {
    let usual = Contacts::new(raw.friction);
    let stiffness = raw.stiffness.and_then(|stiffness| match stiffness {
        NumberOr::Number(number) => Some(number),
        NumberOr::Other(raw::Auto::Auto) => None,
    });
    Contacts {
        stiffness,
        settling: raw.adaptation_strain,
        settled: raw.adapted_stiffness,
        roughness: raw.roughness.unwrap_or(usual.roughness),
        overlap: raw.target_overlap.unwrap_or(usual.overlap),
        tangential_ratio: raw.tangential_ratio.unwrap_or(usual.tangential_ratio),
        rolling_friction: raw.rolling_friction.unwrap_or(usual.rolling_friction),
        critical_load: raw.critical_load.unwrap_or(usual.critical_load),
        law: raw.law.map_or(usual.law, Into::into),
        ..usual
    }
}

fn hydrodynamics(raw: &raw::HydrodynamicsSection) -> Hydrodynamics {
    let default = Hydrodynamics::default();
    Hydrodynamics {
        multipoles: raw.multipoles.map_or(default.multipoles, Into::into),
        tolerance: raw.tolerance.unwrap_or(default.tolerance),
        method: raw.method.map_or(default.method, crate::CaseMethod::alone),
        device: raw.device.map_or(default.device, Into::into),
        grid: raw.grid,
        support: raw.support,
        iteration_tolerance: raw.iteration_tolerance,
        costs: raw.costs.map(|costs| [costs.stencils, costs.transforms, costs.pairs]),
        network: raw.network.map(|network| Network {
            ranks: network.ranks,
            threads: network.threads.unwrap_or(1),
            bandwidth: network.bandwidth,
            latency: network.latency.unwrap_or(0.0),
        }),
        lubrication: raw.lubrication.unwrap_or(default.lubrication),
        lubrication_cutoff: raw.lubrication_cutoff,
        preconditioner: raw.preconditioner.unwrap_or(default.preconditioner),
    }
}

fn statistics(raw: &raw::StatisticsSection) -> StatisticsParameters {
    StatisticsParameters {
        samples: Schedule::every(raw.every),
        from: raw.from,
        distance: raw.distance,
        axis: raw.axis.map(Into::into),
        bins: raw.bins,
        diffusive_from: raw.diffusive_from,
    }
}

/// Default integrator.
fn usual_integrator(raw: &SuspensionSections) -> raw::IntegratorKind {
    let is_driven = raw.flow.as_ref().is_some_and(|flow| flow.control == Some(raw::Control::Stress));
    if raw.fluid.thermal_energy.is_some() {
        raw::IntegratorKind::Brownian
    } else if raw.contacts.is_some() || is_driven {
        raw::IntegratorKind::Implicit
    } else {
        raw::IntegratorKind::AdamsBashforth
    }
}

fn integrator(raw: &raw::TimeSection, usual: raw::IntegratorKind, with_contacts: bool) -> Result<Integrator, KeyError> {
    let integrator = raw.integrator.unwrap_or(usual);
    if let raw::IntegratorKind::AdamsBashforth | raw::IntegratorKind::Brownian = integrator {
        for (key, given) in [("time.tolerance", raw.tolerance), ("time.gap_fraction", raw.gap_fraction)] {
            if given.is_some() {
                let message = "is set, but steps are all alike; set time.integrator = \"adaptive\" or \"implicit\", \
                    or leave it out";
                return Err(KeyError::new(key, message));
            }
        }
    }
    if raw.brownian.is_some() && integrator != raw::IntegratorKind::Brownian {
        let message =
            "is set, but only steps of \"brownian\", with fluid.thermal_energy, have a choice of it; leave it out";
        return Err(KeyError::new("time.brownian", message));
    }
    if integrator == raw::IntegratorKind::AdamsBashforth {
        return Ok(Integrator::AdamsBashforth { order: raw.order.unwrap_or(4) });
    }
    if raw.order.is_some() {
        let message = "is set, but only steps of \"adams-bashforth\" have a choice of it; leave it out";
        return Err(KeyError::new("time.order", message));
    }
    if integrator == raw::IntegratorKind::Brownian {
        return Ok(Integrator::Brownian(raw.brownian.map_or_else(BrownianScheme::default, Into::into)));
    }
    let usual = if with_contacts { Adaptive::UNLIMITED } else { Adaptive::default() };
    let control = Adaptive {
        tolerance: raw.tolerance.unwrap_or(usual.tolerance),
        gap_fraction: raw.gap_fraction.unwrap_or(usual.gap_fraction),
    };
    let is_implicit = integrator == raw::IntegratorKind::Implicit;
    Ok(if is_implicit { Integrator::Implicit(control) } else { Integrator::Adaptive(control) })
}

fn output(raw: raw::SuspensionOutputSection, steps: u64) -> OutputSchedules {
    OutputSchedules {
        folder: raw.folder,
        trajectory: Schedule::every(raw.trajectory_every.unwrap_or(share(steps, 100))),
        observables: Schedule::every(raw.observables_every.unwrap_or(1)),
        checkpoints: Schedule::every(raw.checkpoint_every.unwrap_or(share(steps, 10))),
        fields: Schedule::every(raw.fields_every),
        contacts: Schedule::every(raw.contacts_every),
    }
}
