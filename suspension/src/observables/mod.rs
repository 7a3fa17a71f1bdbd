//! Time series of a suspension.

pub mod averages;
pub mod clouds;
mod filaments;
mod given_motions;
pub mod heights;
mod moments;
pub mod observable;
pub mod orientations;
pub mod rheology;
mod series_warnings;
mod swimmers;
mod velocities;

use crate::evaluation::overlap_monitor::Remedies;
use crate::evaluation::stress::ParticleStress;
use crate::forces::force::StressName;
use crate::model::Model;
use crate::model::box_axes::UserAxes;
use crate::observables::observable::{NumberRow, Observable, ObservedState, measure, numbers};
use crate::observables::rheology::Rheology;
use crate::observables::series_warnings::SeriesWarnings;
use crate::sampling::{columns, counted, has_columns};
use crate::suspension::Suspension;
use domain::parallel::stage;
use domain::{Boundaries, Vector};
use simulation::Quantity;
use std::time::Instant;

/// Computes the rows of the time series.
pub struct Observer {
    species: usize,
    list: Vec<Box<dyn Observable>>,
    rheology: Option<Rheology>,
    /// Contributions to the stress that are in the list.
    stresses: Vec<StressName>,
    /// Place in the list after the last contribution to the stress.
    after_stresses: usize,
    warnings: SeriesWarnings,
}

/// A quantity with the name of another.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the time series has a quantity \"{0}\" already")]
pub struct NameTaken(String);

/// Quantities of contacts.
const CONTACTS: [NumberRow; 5] = [
    ("contacts_per_particle", "", |present| of_contacts(present, 0)),
    ("frictional_contacts", "", |present| of_contacts(present, 1)),
    ("sliding_contacts", "", |present| of_contacts(present, 2)),
    ("largest_overlap", "", |present| of_contacts(present, 3)),
    ("elastic_energy", "force*length", |present| of_contacts(present, 4)),
];

/// A number of [`Suspension::contact_numbers`].
fn of_contacts(present: &mut ObservedState, index: usize) -> f64 {
    present.contact_numbers().map_or(f64::NAN, |numbers| numbers[index])
}

/// Stiffness of contacts, if it is automatic.
const STIFFNESS: [NumberRow; 1] = [("contact_stiffness", "force/length^2", |present| {
    present.suspension().contact_stiffness().map_or(f64::NAN, |(stiffness, _)| stiffness)
})];

/// Quantities of the pairs that were too close in the last Brownian solve.
const CROWDED: [NumberRow; 3] = [
    ("overlapping_pairs", "", |present| {
        present.suspension().overlap_counts().map_or(f64::NAN, |c| c.overlapping as f64)
    }),
    ("pairs_at_least_gap", "", |present| {
        present.suspension().overlap_counts().map_or(f64::NAN, |c| c.at_minimum_gap as f64)
    }),
    ("deepest_overlap", "length", |present| present.suspension().overlap_counts().map_or(f64::NAN, |c| c.depth)),
];

/// Quantities of bonds.
const BONDS: [NumberRow; 2] = [
    ("bond_energy", "force*length", |present| present.suspension().bond_totals().map_or(f64::NAN, |t| t.stretching)),
    ("broken_bonds", "", |present| present.suspension().bond_totals().map_or(f64::NAN, |t| t.broken)),
];

/// Energies of bonds that resist bending.
const BEAMS: [NumberRow; 2] = [
    ("bending_energy", "force*length", |present| present.suspension().bond_totals().map_or(f64::NAN, |t| t.bending)),
    ("twisting_energy", "force*length", |present| present.suspension().bond_totals().map_or(f64::NAN, |t| t.twisting)),
];

/// Energy of traps.
const TRAPS: [NumberRow; 1] =
    [("trap_energy", "force*length", |present| present.suspension().trap_energy().unwrap_or(f64::NAN))];

/// Pressure gradient that keeps the flux.
const PRESSURE: [NumberRow; 1] =
    [("pressure_gradient", "force/length^3", |present| present.suspension().pressure_gradient().unwrap_or(f64::NAN))];

/// Quantities of the last step.
const STEP: [NumberRow; 4] = [
    ("smallest_gap", "length", |present| present.report().smallest_gap),
    ("iterations", "", |present| present.report().iterations as f64),
    ("residual", "", |present| present.report().residual),
    ("evaluations", "", |present| present.report().evaluations as f64),
];

/// Divergence of the flow in a fully periodic box.
const DIVERGENCE: [NumberRow; 1] = [("divergence", "", |present| present.report().divergence.unwrap_or(f64::NAN))];

impl Observer {
    /// An observer for a suspension of a model.
    pub fn new(model: &Model, suspension: &Suspension, smallest_radius: f64) -> Self {
        let (species, axes): (Vec<String>, _) =
            (model.species.iter().map(|s| s.name.clone()).collect(), model.user_axes());
        let rheology = Rheology::of(model);
        let stresses = rheology.as_ref().map(|_| rheology::parts(model, &suspension.stresses_of_forces()));
        let stresses = stresses.unwrap_or_default();
        let mut list = Vec::from(velocities::velocities(&species, axes));
        let parts = |rheology: &Rheology| stresses.iter().map(|&part| rheology.part(part)).collect::<Vec<_>>();
        list.extend(rheology.iter().flat_map(parts));
        let after_stresses = list.len();
        list.extend(rheology.iter().flat_map(Rheology::derived));
        list.extend(of_boundaries(model, &species, &axes));
        list.extend(of_model(model));
        list.push(seconds_per_step(suspension.clock().step()));
        let warnings = SeriesWarnings::of(model, rheology.as_ref(), smallest_radius);
        Self { species: species.len(), list, rheology, stresses, after_stresses, warnings }
    }

    /// Warnings about the rows so far.
    pub fn warnings(&self) -> Vec<String> {
        self.warnings.all()
    }

    /// Changes to the scene that would keep the spheres apart.
    pub fn remedies(&self) -> Remedies {
        self.warnings.remedies()
    }

    /// Includes the stress of forces that were added, if they contribute to the stress.
    pub fn see_forces(&mut self, suspension: &Suspension) {
        let [_, of_user] = suspension.stresses_of_forces();
        let Some(rheology) = &self.rheology else { return };
        for name in of_user.into_iter().filter(|name| !self.stresses.contains(name)).collect::<Vec<_>>() {
            self.list.insert(self.after_stresses, rheology.part(name));
            self.stresses.push(name);
            self.after_stresses += 1;
        }
    }

    /// Adds a quantity at the end of each row. Refuses the name of another.
    pub fn add(&mut self, observable: Box<dyn Observable>) -> Result<(), NameTaken> {
        let name = observable.quantity().name;
        if self.list.iter().any(|other| other.quantity().name == name) {
            return Err(NameTaken(name.into_owned()));
        }
        self.list.push(observable);
        Ok(())
    }

    /// Counts a step that was taken.
    pub fn see_step(&mut self, suspension: &Suspension) {
        self.warnings.see_step(suspension);
    }

    /// Quantities of a row. Velocities are relative to the background flow; their variance is component by component.
    /// The osmotic pressure is the sum of `n kT` and the contribution of forces between particles.
    pub fn quantities(&self) -> Vec<Quantity> {
        self.list.iter().map(|observable| observable.quantity()).collect()
    }

    /// A row for the present state. Collective.
    pub fn observe(&mut self, suspension: &mut Suspension) -> Vec<Vec<f64>> {
        let _stage = stage("observables");
        let mut present = ObservedState::new(suspension, self.species);
        let rows = self.list.iter_mut().map(|observable| observable.row(&mut present)).collect();
        self.warnings.see_row(&mut present);
        rows
    }
}

/// Quantities of certain boundaries.
fn of_boundaries(model: &Model, species: &[String], axes: &UserAxes) -> Vec<Box<dyn Observable>> {
    let boundaries = model.cell.boundaries();
    let mut list: Vec<_> = wall_shear_stress(boundaries.walls(), *axes).into_iter().collect();
    if model.flow.keeps_flux() {
        list.extend(numbers(&PRESSURE));
    }
    list.extend(heights::heights(boundaries, species, axes));
    if boundaries == Boundaries::Open {
        list.push(clouds::cloud(species));
    }
    list
}

/// Quantities of a model's forces and integrator.
fn of_model(model: &Model) -> Vec<Box<dyn Observable>> {
    let mut list: Vec<_> = osmotic_pressure(model).into_iter().collect();
    if model.thermal_energy.is_some() {
        list.extend(numbers(&CROWDED));
    }
    if has_columns(model) {
        list.push(segregation(model));
    }
    if let Some(contacts) = model.contacts {
        list.extend(numbers(&CONTACTS));
        list.extend(contacts.stiffness.is_none().then(|| numbers(&STIFFNESS)).into_iter().flatten());
    }
    if !model.bonds.is_empty() {
        list.extend(numbers(&BONDS));
        list.extend(model.has_beams().then(|| numbers(&BEAMS)).into_iter().flatten());
    }
    if !model.traps.is_empty() {
        list.extend(numbers(&TRAPS));
    }
    list.extend(filaments::filaments(model));
    list.extend(orientations::orientations(model));
    list.extend(given_motions::driving_loads(model));
    list.extend(swimmers::swimmers(model));
    list.extend(moments::moments(model));
    list.extend(numbers(&STEP));
    if model.cell.boundaries() == Boundaries::Periodic {
        list.extend(numbers(&DIVERGENCE));
    }
    list
}

/// Shear stress on each wall along the two axes parallel to it; `None` without walls.
fn wall_shear_stress(walls: usize, axes: UserAxes) -> Option<Box<dyn Observable>> {
    let rows = ["lower", "upper"][..walls].iter().map(|&row| row.to_owned()).collect();
    let columns = [0, 1].map(|along| axes.name(along).to_string()).to_vec();
    let quantity = Quantity { name: "wall_shear_stress".into(), unit: "force/length^2", table: Some((rows, columns)) };
    let of_wall = move |[x, y]: [f64; 2]| {
        let stress = axes.vector(Vector::new(x, y, 0.0));
        [0, 1].map(|along| stress[axes.axis(along)])
    };
    let row = move |present: &mut ObservedState| {
        let stress = present.total_stress();
        present.suspension().wall_stress(&stress).into_iter().flat_map(of_wall).collect()
    };
    (walls > 0).then(|| measure(quantity, row))
}

/// Osmotic pressure of Brownian spheres. `None` with walls, on which the pressure differs.
fn osmotic_pressure(model: &Model) -> Option<Box<dyn Observable>> {
    let energy = model.thermal_energy.filter(|_| model.cell.boundaries() == Boundaries::Periodic)?;
    let of_one = energy / model.cell.volume();
    Some(measure(Quantity::number("osmotic_pressure", "force/length^2"), move |present| {
        let forces = ParticleStress::pressure(&present.total_stress());
        vec![of_one * count(present.suspension()) + forces]
    }))
}

/// Intensity of segregation of several species.
fn segregation(model: &Model) -> Box<dyn Observable> {
    let (columns, edges) = (columns(model), model.cell.edges());
    measure(Quantity::number("segregation", ""), move |present| {
        let suspension = present.suspension();
        let mut counted = counted(&columns, edges, suspension.cell(), suspension.particles());
        suspension.comm().sum(counted.counts());
        vec![counted.intensity()]
    })
}

/// Wall-clock time per step since the last row, or since the start at a step.
fn seconds_per_step(step: u64) -> Box<dyn Observable> {
    let mut last = (step, Instant::now());
    measure(Quantity::number("seconds_per_step", "s"), move |present| {
        let step = present.suspension().clock().step();
        let (before, began) = std::mem::replace(&mut last, (step, Instant::now()));
        let steps = step.saturating_sub(before).max(1);
        vec![began.elapsed().as_secs_f64() / steps as f64]
    })
}

/// Total number of particles. Collective.
fn count(suspension: &Suspension) -> f64 {
    let mut count = [suspension.particles().len() as f64];
    suspension.comm().sum(&mut count);
    count[0]
}
