//! Harmonic traps.

use crate::forces::acting::{Acting, Configuration, Instant, Prediction};
use crate::forces::force::Force;
use crate::model::Model;
use domain::{DomainView, ExpectedCounts, Failure, Particles, PeriodicBox, Vector};
use fcm::Loads;

/// Column of the traps: the unwrapped centre of the particle's trap, and the index of the trap's kind in the model plus
/// 1 (0 without a trap).
pub const TRAPS: &str = "traps";
pub const TRAP_NUMBERS: usize = 4;

/// The traps of a suspension.
pub struct Traps {
    stiffness: Vec<f64>,
    /// Whether there are bonds as well.
    has_bonds: bool,
}

impl Force for Traps {
    fn name(&self) -> &'static str {
        "trap"
    }

    fn add_present_loads(&self, at: &Configuration, loads: &mut Loads) {
        self.add(loads, at, None);
    }

    fn add_loads(&mut self, at: &mut Instant, acting: &mut Acting) -> Result<(), Failure> {
        self.add(&mut acting.loads, &at.configuration(), at.prediction);
        if let Some(prediction) = at.prediction {
            acting.resistances.add_traps(self.resistances(at.particles, prediction.time));
        }
        Ok(())
    }

    /// Any distance will do, and that of bonds does if there are any.
    fn implicit_range(&self, largest_radius: f64) -> Option<f64> {
        (!self.has_bonds).then_some(2.0 * largest_radius)
    }

    fn numbers(&self, _expected: &ExpectedCounts) -> usize {
        TRAP_NUMBERS
    }
}

impl Traps {
    /// The traps of a model.
    pub fn of(model: &Model) -> Option<Self> {
        let stiffness: Vec<f64> = model.traps.iter().map(|traps| traps.stiffness).collect();
        (!stiffness.is_empty()).then_some(Self { stiffness, has_bonds: !model.bonds.is_empty() })
    }

    /// Stiffness of each particle's trap (0 without one), and displacement from its centre.
    fn each(&self, particles: &Particles, cell: &PeriodicBox) -> Vec<(f64, Vector)> {
        let of_one = |(row, numbers): (usize, &[f64; TRAP_NUMBERS])| {
            let place = particles.positions[row] + cell.lattice(particles.steps[row]);
            (self.stiffness_of(numbers), place - Vector::from_slice(numbers))
        };
        rows(particles).iter().enumerate().map(of_one).collect()
    }

    fn stiffness_of(&self, numbers: &[f64; TRAP_NUMBERS]) -> f64 {
        if numbers[3] > 0.0 { self.stiffness[numbers[3] as usize - 1] } else { 0.0 }
    }

    /// Adds the known part of the trap force. With `x*` and `u*` the expected positions and velocities after a time
    /// `t`, the force is `-k (x* - c) - t k (u - u*)`.
    fn add(&self, loads: &mut Loads, at: &Configuration, prediction: Option<&Prediction>) {
        let Configuration { particles, domain, .. } = at;
        loads.forces.resize(particles.len(), Vector::ZERO);
        for (row, (stiffness, away)) in self.each(particles, domain.cell).into_iter().enumerate() {
            let expected = prediction.map_or(Vector::ZERO, |ahead| ahead.time * ahead.velocities[row]);
            loads.forces[row] += stiffness * (expected - away);
        }
    }

    fn resistances(&self, particles: &Particles, time: f64) -> Vec<f64> {
        rows(particles).iter().map(|numbers| time * self.stiffness_of(numbers)).collect()
    }

    /// Energy of the trapped spheres. Collective.
    pub fn energy(&self, particles: &Particles, domain: DomainView) -> f64 {
        let energy = |(k, away): (f64, Vector)| 0.5 * k * away.length_squared();
        let mut sum = [self.each(particles, domain.cell).into_iter().map(energy).sum()];
        domain.comm().sum(&mut sum);
        sum[0]
    }
}

/// The column's numbers for each particle.
fn rows(particles: &Particles) -> &[[f64; TRAP_NUMBERS]] {
    let column = particles.columns.iter().find(|column| column.name == TRAPS);
    column.map_or(&[], |column| column.values.as_chunks().0)
}
