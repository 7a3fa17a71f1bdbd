//! Interface of the quantities of the time series.

use crate::evaluation::stress::ParticleStress;
use crate::observables::heights::Heights;
use crate::observables::swimmers::Clusters;
use crate::observables::velocities::VelocityMoments;
use crate::suspension::{StepReport, Suspension};
use domain::Tensor;
use simulation::Quantity;
use std::cell::OnceCell;

/// A quantity of the time series: its name, its unit and its numbers in one place.
pub trait Observable {
    /// Name, unit and, for a table, its rows and columns.
    fn quantity(&self) -> Quantity;

    /// Present numbers, row by row of a table, on every rank. Collective.
    fn row(&mut self, present: &mut ObservedState) -> Vec<f64>;
}

/// The present state of a suspension, with results that several quantities use, each computed when it is first asked
/// for. The methods are collective.
pub struct ObservedState<'a> {
    suspension: &'a mut Suspension,
    species: usize,
    report: Option<StepReport>,
    stress: Option<Vec<ParticleStress>>,
    velocities: Option<VelocityMoments>,
    heights: Option<Heights>,
    clusters: Option<Clusters>,
    contacts: OnceCell<Option<[f64; 5]>>,
}

impl<'a> ObservedState<'a> {
    /// The present state of a suspension of a number of species.
    pub fn new(suspension: &'a mut Suspension, species: usize) -> Self {
        Self {
            suspension,
            species,
            report: None,
            stress: None,
            velocities: None,
            heights: None,
            clusters: None,
            contacts: OnceCell::new(),
        }
    }

    /// The suspension.
    pub fn suspension(&self) -> &Suspension {
        self.suspension
    }

    /// Number of species.
    pub fn species(&self) -> usize {
        self.species
    }

    /// Summary of the last step.
    pub fn report(&mut self) -> StepReport {
        *self.report.get_or_insert_with(|| self.suspension.report())
    }

    /// Stress of the particles of each species.
    pub fn stress(&mut self) -> &[ParticleStress] {
        self.stress.get_or_insert_with(|| self.suspension.stress(self.species))
    }

    /// Sum of the stress of all species and contributions.
    pub fn total_stress(&mut self) -> Tensor {
        ParticleStress::sum(self.stress())
    }

    /// Numbers of the contacts, see [`Suspension::contact_numbers`].
    pub fn contact_numbers(&mut self) -> Option<[f64; 5]> {
        *self.contacts.get_or_init(|| self.suspension.contact_numbers())
    }

    /// Mean and variance of the velocities of each species.
    pub(super) fn velocities(&mut self) -> &VelocityMoments {
        self.velocities.get_or_insert_with(|| VelocityMoments::of(self.suspension, self.species))
    }

    /// Spheres that are close to each other.
    pub(super) fn clusters(&mut self) -> Clusters {
        *self.clusters.get_or_insert_with(|| Clusters::of(self.suspension))
    }

    /// Distribution of the spheres along z.
    pub(super) fn heights(&mut self) -> &Heights {
        self.heights.get_or_insert_with(|| Heights::of(self.suspension, self.species))
    }
}

/// Name and unit of a quantity that is one number, and the number.
pub type NumberRow = (&'static str, &'static str, fn(&mut ObservedState) -> f64);

/// Quantities that are one number each.
pub fn numbers(list: &[NumberRow]) -> impl Iterator<Item = Box<dyn Observable>> {
    list.iter().map(|&(name, unit, of)| measure(Quantity::number(name, unit), move |present| vec![of(present)]))
}

/// A quantity with a function for its row.
pub fn measure(quantity: Quantity, row: impl FnMut(&mut ObservedState) -> Vec<f64> + 'static) -> Box<dyn Observable> {
    Box::new(QuantityByFunction { quantity, row })
}

struct QuantityByFunction<F> {
    quantity: Quantity,
    row: F,
}

impl<F: FnMut(&mut ObservedState) -> Vec<f64>> Observable for QuantityByFunction<F> {
    fn quantity(&self) -> Quantity {
        self.quantity.clone()
    }

    fn row(&mut self, present: &mut ObservedState) -> Vec<f64> {
        (self.row)(present)
    }
}
