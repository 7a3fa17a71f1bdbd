//! Change of a solution under a small displacement of the spheres, where the far field is solved for.

use crate::ambient::StrainRate;
use crate::coupled_solver::lubricated_solve::ended;
use crate::coupled_solver::on_device::{SHARP, columns, numbers_of};
use crate::coupled_solver::perturbed_solve::DisplacedSpheres;
use crate::coupled_solver::{CoupledSolver, MOST_ITERATIONS};
use crate::six_vector::SixVector;
use crate::solution::{NO_AMBIENT, SolveInput, StoredSolution};
use domain::parallel::{mapped, of_rows};
use domain::{Particles, PeriodicBox, Traceless, Units, Vector};
use fcm::{ChangeLimits, KnownSolution, Limits, Loads, Motion, SolveError};

/// A solution as numbers in scaled units, with known loads and ambient motions.
struct KnownNumbers {
    units: Units,
    loads: Vec<f64>,
    ambient: Vec<f64>,
    motions: Vec<f64>,
    moments: Vec<f64>,
}

impl KnownNumbers {
    fn new(units: Units, loads: &Loads, ambient: &Motion, found: &StoredSolution) -> Self {
        let count = found.stresslets_far.len();
        let [torque, velocity, rate] = [units.torque(), units.velocity(), units.rate()].map(|unit| 1.0 / unit);
        let Motion { velocities, angular_velocities, .. } = &found.motion;
        let load = numbers_of(loads, &units);
        let moved = |row: usize| SixVector::of_row(row, velocities, angular_velocities).times(velocity, rate).0;
        Self {
            units,
            loads: of_rows(count, |row| load(row).0).into_flattened(),
            ambient: columns(ambient, &units, count),
            motions: of_rows(count, moved).into_flattened(),
            moments: mapped(&found.stresslets_far, |&s| (s * -torque).0).into_flattened(),
        }
    }

    fn solution(&self) -> KnownSolution<'_> {
        let Self { units, loads, ambient, motions, moments } = self;
        KnownSolution { units: *units, loads, ambient, motions, moments }
    }
}

impl CoupledSolver {
    /// Finds the near pairs of free spheres at rest where the far field is solved for. Returns whether they are there.
    pub(super) fn assembles_on_device(&mut self, cell: &PeriodicBox, particles: &Particles) -> bool {
        let none = Loads::default();
        let at_rest = SolveInput::new(&none, StrainRate::default());
        self.far.mobility().constrain(None);
        let is_there = self.solves_on_device(&at_rest);
        if is_there {
            let own = self.in_units(particles, &at_rest);
            self.pairs_of_solve(cell, [particles, &own], &at_rest);
        }
        is_there
    }

    /// [`Self::equivalent_ambient`] with the near pairs that were assembled last.
    pub(super) fn residual_on_device(&mut self, loads: &Loads, found: StoredSolution) -> (Motion, StoredSolution) {
        let units = self.units;
        let known = KnownNumbers::new(units, loads, &NO_AMBIENT, &found);
        let far = self.far.mobility().coupled().expect("near pairs are where the far field solves with them");
        let residual = far.residual(&known.solution());
        let rates = tensors(&residual.strain_rates);
        let needed = Motion { strain_rates: mapped(rates, |&e| e * units.rate()), ..motion(&residual.motions, &units) };
        let stresslets = total(&known.moments, &residual.moments_of_pairs, &units);
        (needed, StoredSolution { stresslets, ..found })
    }

    /// [`Self::perturbed_solution`] with the near pairs that were assembled last.
    pub(super) fn perturbed_on_device(
        &mut self,
        &DisplacedSpheres { loads, ambient, .. }: &DisplacedSpheres,
        found: &StoredSolution,
        tolerance: f64,
    ) -> Result<(Motion, Vec<Traceless>), SolveError> {
        let (units, interrupt) = (self.units, self.far.interrupt().clone());
        let known = KnownNumbers::new(units, loads, ambient, found);
        let limits = Limits { tolerance, iterations: MOST_ITERATIONS, interrupt: &interrupt };
        let change = ChangeLimits { comm: self.partition.comm(), limits, preconditioner: SHARP };
        let far = self.far.mobility().coupled().expect("near pairs are where the far field solves with them");
        let changed = far.changed(&known.solution(), &change);
        ended(&changed.outcome, limits)?;
        Ok((motion(&changed.motions, &units), total(&changed.moments, &changed.moments_of_pairs, &units)))
    }
}

fn tensors(numbers: &[f64]) -> &[Traceless] {
    bytemuck::cast_slice(numbers)
}

/// Velocities and angular velocities in the original units, from six numbers a particle.
fn motion(numbers: &[f64], units: &Units) -> Motion {
    let (rows, [velocity, rate]) = (numbers.as_chunks::<6>().0, [units.velocity(), units.rate()]);
    Motion {
        velocities: mapped(rows, |row| Vector::from_slice(row) * velocity),
        angular_velocities: mapped(rows, |row| Vector::from_slice(&row[3..]) * rate),
        strain_rates: Vec::new(),
    }
}

/// Total stresslets in the original units, from first moments in the far field and of near pairs.
fn total(far: &[f64], of_pairs: &[f64], units: &Units) -> Vec<Traceless> {
    let (far, of_pairs) = (tensors(far), tensors(of_pairs));
    of_rows(far.len(), |row| (far[row] + of_pairs[row]) * -units.torque())
}
