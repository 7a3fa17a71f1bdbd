//! Loads that the given motions of bodies take.

use super::observable::{Observable, ObservedState, measure};
use crate::columns::{CONSTRAINT_LOAD, CONSTRAINT_LOAD_NUMBERS};
use crate::model::Model;
use domain::Vector;
use simulation::Quantity;

/// Mean force and torque, about the centre, on a body of each kind with a given motion, by what moves it: in addition
/// to the other loads on the body.
pub fn driving_loads(model: &Model) -> Vec<Box<dyn Observable>> {
    let kinds: Vec<DrivenKind> = model.kinds_with_given_motion().map(|kind| DrivenKind::of(model, kind)).collect();
    if kinds.is_empty() {
        return Vec::new();
    }
    let names: Vec<String> = kinds.iter().map(|kind| kind.name.clone()).collect();
    let axes = model.user_axes();
    let numbers = |first: usize| {
        let kinds = kinds.clone();
        move |present: &mut ObservedState| {
            let mean = |kind: &DrivenKind| axes.vector(kind.mean(present, first)).to_array();
            kinds.iter().flat_map(mean).collect()
        }
    };
    vec![
        measure(Quantity::vectors("driving_force", "force", &names), numbers(0)),
        measure(Quantity::vectors("driving_torque", "force*length", &names), numbers(3)),
    ]
}

/// A kind of bodies with a given motion.
#[derive(Clone)]
struct DrivenKind {
    name: String,
    /// Ids of its spheres.
    ids: std::ops::Range<u64>,
    count: f64,
}

impl DrivenKind {
    fn of(model: &Model, kind: usize) -> Self {
        let spheres = |kind: usize| model.bodies[kind].count * model.bodies[kind].spheres.len() as u64;
        let first = model.free_spheres() + (0..kind).map(spheres).sum::<u64>();
        let bodies = &model.bodies[kind];
        Self { name: bodies.name.clone(), ids: first..first + spheres(kind), count: bodies.count as f64 }
    }

    /// Mean over the bodies of three numbers of the column, from the `first` on. Collective.
    fn mean(&self, present: &ObservedState, first: usize) -> Vector {
        let suspension = present.suspension();
        let particles = suspension.particles();
        let loads = particles.rows::<CONSTRAINT_LOAD_NUMBERS>(CONSTRAINT_LOAD).unwrap_or_default();
        let its = particles.ids.iter().zip(loads).filter(|(id, _)| self.ids.contains(id));
        let mut sum = its.map(|(_, load)| Vector::from_slice(&load[first..])).sum::<Vector>().to_array();
        suspension.comm().sum(&mut sum);
        Vector::from_array(sum) / self.count
    }
}
