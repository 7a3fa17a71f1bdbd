//! Time series of a suspension.

pub mod averages;
pub mod clouds;
pub mod heights;
pub mod rheology;
mod warnings;

use crate::columns::VELOCITY;
use crate::evaluation::overlap_monitor::{OverlapCounts, OverlappedSteps, Remedies};
use crate::evaluation::stress::ParticleStress;
use crate::model::Model;
use crate::model::box_axes::UserAxes;
use crate::observables::rheology::Rheology;
use crate::sampling::{column, columns, counted, has_columns};
use crate::suspension::{StepReport, Suspension};
use domain::{Boundaries, Number, Vector};
use simulation::Quantity;
use statistics::SpeciesColumns;
use std::time::Instant;

/// Computes the rows of the time series.
pub struct Observer {
    species: Vec<String>,
    rheology: Option<Rheology>,
    /// Columns for the segregation of species, if there are several, and the edges of the unstrained box.
    columns: Option<(SpeciesColumns, Vector)>,
    last: (u64, Instant),
    overlaps: Overlaps,
    repels: bool,
    crowded: OverlappedSteps,
    remedies: Remedies,
    boundaries: Boundaries,
    /// Whether a pressure gradient keeps the flux.
    keeps_flux: bool,
    /// Whether there is Brownian motion; and the thermal energy over the volume of the box, if the osmotic pressure is
    /// defined.
    has_heat: bool,
    ideal_pressure: Option<f64>,
    /// With contacts, the target of the largest overlap over the roughness, and whether the stiffness is automatic; and
    /// the overlaps seen since the stiffness is constant.
    aim: Option<(f64, bool)>,
    pressed: Pressed,
    /// Stiffness at the last row, if it was still adapting.
    unsettled: Option<f64>,
    /// Sums for the comparison with a given stress, if there is one.
    given: Option<GivenStress>,
    /// Whether there are bonds, and whether there are traps.
    tethers: [bool; 2],
    smallest_radius: f64,
    axes: UserAxes,
}

/// Statistics of the largest overlap of contacts, over the roughness, in several rows.
#[derive(Default)]
struct Pressed {
    rows: f64,
    sum: f64,
    deepest: f64,
}

/// A given stress, and the sum of the measured stresses.
#[derive(Debug, Clone, Copy)]
struct GivenStress {
    stress: f64,
    rows: f64,
    sum: f64,
}

/// Relative deviation of the mean stress from the given stress that needs no warning.
const OFF: f64 = 0.05;

/// Quantities of contacts.
const CONTACTS: [(&str, &str); 5] = [
    ("contacts_per_particle", ""),
    ("frictional_contacts", ""),
    ("sliding_contacts", ""),
    ("largest_overlap", ""),
    ("elastic_energy", "force*length"),
];

/// Quantities of the pairs that were too close in the last Brownian solve.
const CROWDED: [(&str, &str); 3] =
    [("overlapping_pairs", ""), ("pairs_at_least_gap", ""), ("deepest_overlap", "length")];

/// Quantities of bonds.
const BONDS: [(&str, &str); 2] = [("bond_energy", "force*length"), ("broken_bonds", "")];

/// Counts of rows with overlapping spheres.
#[derive(Debug, Clone, Copy, Default)]
struct Overlaps {
    rows: u64,
    with_overlap: u64,
    largest: f64,
}

impl Observer {
    /// An observer for a model from step `step` on.
    pub fn new(model: &Model, step: u64, smallest_radius: f64) -> Self {
        let species = model.species.iter().map(|s| s.name.clone()).collect();
        let columns = has_columns(model).then(|| (columns(model), model.cell.edges()));
        let (last, repels) = ((step, Instant::now()), model.repulsion.is_some());
        Self {
            species,
            rheology: Rheology::of(model),
            columns,
            last,
            overlaps: Overlaps::default(),
            repels,
            crowded: OverlappedSteps::default(),
            remedies: Remedies::of(model),
            boundaries: model.cell.boundaries(),
            keeps_flux: model.flow.keeps_flux(),
            has_heat: model.thermal_energy.is_some(),
            ideal_pressure: ideal_pressure(model),
            aim: model.contacts.map(|contacts| (contacts.overlap, contacts.stiffness.is_none())),
            pressed: Pressed::default(),
            unsettled: None,
            given: model.shear_rates().stress().map(|stress| GivenStress { stress, rows: 0.0, sum: 0.0 }),
            tethers: [!model.bonds.is_empty(), !model.traps.is_empty()],
            smallest_radius,
            axes: model.user_axes(),
        }
    }

    /// Whether the box is fully periodic.
    fn is_periodic(&self) -> bool {
        self.boundaries == Boundaries::Periodic
    }

    /// Whether the fluid is open, so that the spheres of each species are a cloud.
    fn is_open(&self) -> bool {
        self.boundaries == Boundaries::Open
    }

    /// Warnings about the rows so far.
    pub fn warnings(&self) -> Vec<String> {
        let crowded = self.crowded.warning(self.remedies, self.smallest_radius);
        let off = self.given.and_then(GivenStress::warning);
        [self.overlapped(), crowded, self.soft(), self.settling(), off].into_iter().flatten().collect()
    }

    /// Changes to the scene that would keep the spheres apart.
    pub fn remedies(&self) -> Remedies {
        self.remedies
    }

    /// Includes the stress of the user's forces in rows from now on, if they contribute to the stress.
    pub fn see_loads(&mut self, suspension: &Suspension) {
        if suspension.has_applied_stress() {
            self.rheology.iter_mut().for_each(Rheology::tell_of_applied);
        }
    }

    /// Counts a step that was taken.
    pub fn see_step(&mut self, suspension: &Suspension) {
        suspension.crowded().into_iter().for_each(|crowded| self.crowded.see(crowded));
    }

    /// Quantities of a row. Velocities are relative to the background flow; their variance is component by component.
    /// The osmotic pressure is the sum of `n kT` and the contribution of forces between particles.
    pub fn quantities(&self) -> Vec<Quantity> {
        let mut quantities = vec![
            Quantity::vectors("mean_velocity", "length/time", &self.species),
            Quantity::vectors("velocity_variance", "length^2/time^2", &self.species),
        ];
        quantities.extend(self.rheology.iter().flat_map(Rheology::quantities));
        let walls = self.boundaries.walls();
        if walls > 0 {
            let (rows, columns) = (&["lower", "upper"][..walls], [0, 1].map(|along| self.axes.name(along)));
            let table = Some((rows.iter().map(|&row| row.to_owned()).collect(), columns.map(String::from).to_vec()));
            quantities.push(Quantity { name: "wall_shear_stress", unit: "force/length^2", table });
        }
        quantities.extend(self.keeps_flux.then(|| Quantity::number("pressure_gradient", "force/length^3")));
        quantities.extend(heights::quantities(self.boundaries, &self.species, &self.axes));
        quantities.extend(self.is_open().then(|| clouds::quantity(&self.species)));
        quantities.extend(self.ideal_pressure.iter().map(|_| Quantity::number("osmotic_pressure", "force/length^2")));
        if self.has_heat {
            quantities.extend(CROWDED.map(|(name, unit)| Quantity::number(name, unit)));
        }
        quantities.extend(self.columns.iter().map(|_| Quantity::number("segregation", "")));
        if self.aim.is_some() {
            quantities.extend(CONTACTS.map(|(name, unit)| Quantity::number(name, unit)));
        }
        if let Some((_, true)) = self.aim {
            quantities.push(Quantity::number("contact_stiffness", "force/length^2"));
        }
        let [has_bonds, has_traps] = self.tethers;
        if has_bonds {
            quantities.extend(BONDS.map(|(name, unit)| Quantity::number(name, unit)));
        }
        if has_traps {
            quantities.push(Quantity::number("trap_energy", "force*length"));
        }
        quantities.extend([
            Quantity::number("smallest_gap", "length"),
            Quantity::number("iterations", ""),
            Quantity::number("residual", ""),
            Quantity::number("evaluations", ""),
        ]);
        quantities.extend(self.is_periodic().then(|| Quantity::number("divergence", "")));
        quantities.push(Quantity::number("seconds_per_step", "s"));
        quantities
    }

    /// A row for the present state. Collective.
    pub fn observe(&mut self, suspension: &mut Suspension) -> Vec<Vec<f64>> {
        let (means, variances) = self.moments(suspension);
        let report = suspension.report();
        let seconds = self.seconds_per_step(suspension.clock().step());
        let StepReport { iterations, residual, evaluations, divergence, smallest_gap } = report;
        self.overlaps.see(smallest_gap);
        let mut row = vec![self.vectors(means), self.variances(&variances)];
        let is_wanted = self.rheology.is_some() || self.ideal_pressure.is_some() || self.boundaries.walls() > 0;
        let stress = is_wanted.then(|| suspension.stress(self.species.len()));
        if let (Some(rheology), Some(stress)) = (&self.rheology, &stress) {
            row.extend(rheology.row(stress, suspension.shear()));
            let [rate, _] = suspension.shear();
            self.given.iter_mut().for_each(|given| given.see(rheology.driving_stress(stress, rate)));
        }
        if let Some(stress) = stress.as_ref().filter(|_| self.boundaries.walls() > 0) {
            row.push(self.along_walls(&suspension.wall_stress(&ParticleStress::sum(stress))));
        }
        row.extend(suspension.pressure_gradient().map(|number| vec![number]));
        let particles = suspension.particles();
        let moving = (particles, column(particles, VELOCITY));
        row.extend(heights::rows(suspension.cell(), moving, self.species.len(), suspension.comm()));
        if self.is_open() {
            row.push(clouds::row(suspension.particles(), self.species.len(), suspension.comm()));
        }
        if let (Some(pressure), Some(stress)) = (self.ideal_pressure, &stress) {
            row.push(vec![pressure * count(suspension) + ParticleStress::pressure(&ParticleStress::sum(stress))]);
        }
        if let Some(OverlapCounts { overlapping, at_minimum_gap, depth }) = suspension.crowded() {
            row.extend([overlapping as f64, at_minimum_gap as f64, depth].map(|number| vec![number]));
        }
        if let Some((columns, edges)) = &self.columns {
            let mut counted = counted((columns, *edges), (suspension.cell(), suspension.particles()));
            suspension.comm().sum(counted.counts());
            row.push(vec![counted.intensity()]);
        }
        if let Some(numbers) = suspension.contact_numbers() {
            let (stiffness, stays) = suspension.contact_stiffness().expect("spheres may touch");
            self.unsettled = (!stays).then_some(stiffness);
            if stays {
                let Pressed { rows, sum, deepest } = &mut self.pressed;
                (*rows, *sum, *deepest) = (*rows + 1.0, *sum + numbers[3], deepest.max(numbers[3]));
            }
            row.extend(numbers.map(|number| vec![number]));
            row.extend(self.aim.filter(|(_, is_chosen)| *is_chosen).map(|_| vec![stiffness]));
        }
        row.extend(suspension.bond_numbers().into_iter().flatten().map(|number| vec![number]));
        row.extend(suspension.trap_energy().map(|energy| vec![energy]));
        let (iterations, evaluations) = (iterations as f64, evaluations as f64);
        row.extend([smallest_gap, iterations, residual, evaluations].map(|number| vec![number]));
        row.extend(divergence.into_iter().chain([seconds]).map(|number| vec![number]));
        row
    }

    fn vectors(&self, of_box: Vec<Vector>) -> Vec<f64> {
        of_box.into_iter().flat_map(|vector| self.axes.vector(vector).to_array()).collect()
    }

    fn variances(&self, of_box: &[Vector]) -> Vec<f64> {
        of_box.iter().flat_map(|squares| self.axes.list(squares.to_array())).collect()
    }

    /// Stresses along the two axes of the box that are parallel to the walls.
    fn along_walls(&self, of_box: &[[f64; 2]]) -> Vec<f64> {
        let of_wall = |&[x, y]: &[f64; 2]| {
            let stress = self.axes.vector(Vector::new(x, y, 0.0));
            [0, 1].map(|along| stress[self.axes.axis(along)])
        };
        of_box.iter().flat_map(of_wall).collect()
    }

    /// Mean and variance of the velocity of each species.
    fn moments(&self, suspension: &Suspension) -> (Vec<Vector>, Vec<Vector>) {
        let velocities = suspension.velocities_in_flow();
        let kinds = &suspension.particles().species;
        let mean_of = |value: &dyn Fn(usize) -> Vector| {
            let mut sums = vec![0.0; 4 * self.species.len()];
            for (i, &kind) in kinds.iter().enumerate() {
                let sum = &mut sums[4 * kind as usize..][..4];
                for (component, add) in sum.iter_mut().zip(value(i).to_array().into_iter().chain([1.0])) {
                    *component += add;
                }
            }
            suspension.comm().sum(&mut sums);
            sums.chunks_exact(4).map(|s| Vector::from_slice(s) / s[3]).collect::<Vec<_>>()
        };
        let means = mean_of(&|i| velocities[i]);
        let fluctuation = |i: usize| velocities[i] - means[kinds[i] as usize];
        let variances = mean_of(&|i| fluctuation(i) * fluctuation(i));
        (means, variances)
    }

    fn seconds_per_step(&mut self, step: u64) -> f64 {
        let (before, began) = std::mem::replace(&mut self.last, (step, Instant::now()));
        let steps = step.saturating_sub(before).max(1);
        began.elapsed().as_secs_f64() / steps as f64
    }
}

impl GivenStress {
    fn see(&mut self, found: f64) {
        (self.rows, self.sum) = (self.rows + 1.0, self.sum + found);
    }

    /// A warning if the mean stress deviates from the given one.
    fn warning(self) -> Option<String> {
        let found = self.sum / self.rows / self.stress;
        ((found - 1.0).abs() > OFF).then(|| {
            format!(
                "the stress was {:.3} times flow.stress in the mean: contacts bounce where steps are too long for \
                 their stiffness; try a shorter time.step, a smaller contacts.stiffness, or contacts.settling = 0.0",
                Number(found)
            )
        })
    }
}

impl Overlaps {
    fn see(&mut self, smallest_gap: f64) {
        self.rows += 1;
        self.with_overlap += u64::from(smallest_gap < 0.0);
        self.largest = self.largest.max(-smallest_gap);
    }
}

/// Ideal osmotic pressure of one Brownian sphere in the box. `None` with walls, on which the pressure differs.
fn ideal_pressure(model: &Model) -> Option<f64> {
    let energy = model.thermal_energy.filter(|_| model.cell.boundaries() == Boundaries::Periodic)?;
    Some(energy / model.cell.volume())
}

/// Total number of particles. Collective.
fn count(suspension: &Suspension) -> f64 {
    let mut count = [suspension.particles().len() as f64];
    suspension.comm().sum(&mut count);
    count[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_stress_than_that_given_is_worth_a_word() {
        let of = |found: [f64; 2]| {
            let mut given = GivenStress { stress: 2.0, rows: 0.0, sum: 0.0 };
            for stress in found {
                given.see(stress);
            }
            given.warning()
        };
        assert_eq!(of([1.9, 2.15]), None);
        let said = of([4.0, 5.0]).unwrap();
        assert!(said.starts_with("the stress was 2.25 times flow.stress in the mean"), "{said}");
        assert!(of([1.8, 1.8]).is_some());
    }
}
