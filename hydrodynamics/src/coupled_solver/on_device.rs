//! Solve with near pairs where the far field is evaluated.

use crate::coupled_solver::lubricated_solve::{LubricatedSolve, SolveCase, ended};
use crate::coupled_solver::{CoupledSolver, END, START};
use crate::six_vector::SixVector;
use crate::solution::{KeptSolution, Solution};
use crate::units::Scaled;
use domain::parallel::of_rows;
use domain::{Particles, RemoteHolder, Units, remote_columns};
use fcm::{
    CoupledProblem, CoupledSolution, CoupledTolerances, GivenAmbient, GivenLoads, HeldLoads, Limits, Loads, Mobility,
    Motion, SolutionColumns, SolveError,
};

/// Relative error of the preconditioner's inner solves: a device, whose steps are few, takes them four at a time.
pub(super) const SHARP: f64 = 1e-2;

impl LubricatedSolve<'_> {
    /// The solve by the back end of the far field, where the near pairs are.
    pub(super) fn on_device(&self, scaled: Scaled, given: SolveCase, limits: Limits) -> Result<Solution, SolveError> {
        let SolveCase { loads, held, fluctuations, ambient, guess, keeps_columns, moving_in } = given;
        let Scaled { mobility, units } = scaled;
        let swimming = self.with_quadrupoles(mobility, ambient);
        let ambient = swimming.as_ref().unwrap_or(ambient);
        let far = mobility.coupled().expect("near pairs are where the far field solves with them");
        let held = fluctuations.map(|random| &random.loads).or(held);
        let loads_here = if held.is_some() { Vec::new() } else { self.other_loads(loads, &units) };
        let remote = fluctuations.and_then(|random| random.ambient.remote_list());
        let ambient_here = || GivenAmbient::Here(columns(ambient, &units, self.particles.len()));
        let solved = far.solve(&CoupledProblem {
            units,
            loads: held.map_or(GivenLoads::Here(&loads_here), GivenLoads::Held),
            moments: self.other_moments(),
            ambient: remote.map_or_else(ambient_here, GivenAmbient::Held),
            background: self.strain_rate.at_zero.0,
            past: &guess.solutions(),
            moving_in,
            comm: self.comm,
            limits,
            tolerances: CoupledTolerances {
                start: START * limits.tolerance,
                preconditioner: SHARP,
                end: END * limits.tolerance,
            },
        });
        let CoupledSolution { motion, is_finite, columns, compared, outcome } = solved;
        ended(&outcome, limits)?;
        if !is_finite {
            return Err(SolveError::NotFinite);
        }
        let (iterations, residual) = (outcome.iterations, outcome.residual);
        let kept = Some(Box::new(KeptSolution { columns, compared }));
        let solution = Solution { motion, iterations, residual, kept, ..Solution::default() };
        Ok(if keeps_columns { solution } else { with_lists(solution, &self.particles.ids, &*far.holder()) })
    }

    /// Ambient motions and those by the quadrupoles of squirmers, which no unknown changes; `None` without squirmers.
    fn with_quadrupoles(&self, mobility: &mut Mobility, ambient: &Motion) -> Option<Motion> {
        let quadrupoles = self.quadrupoles?;
        let mut motion = mobility.apply_with_quadrupoles(&Loads::default(), quadrupoles);
        motion.add(1.0, ambient);
        Some(motion)
    }

    /// Given loads, and those of other near pairs in the background, six numbers a particle; empty without either.
    fn other_loads(&self, loads: &Loads, units: &Units) -> Vec<f64> {
        let Loads { forces, torques, .. } = loads;
        if forces.is_empty() && torques.is_empty() && !self.near.has_own() {
            return Vec::new();
        }
        let (in_flow, given) = (&self.near.ambient_loads().0, numbers_of(loads, units));
        of_rows(in_flow.len(), |row| (given(row) + in_flow[row]).0).into_flattened()
    }

    /// First moments of other near pairs in the background, five numbers a particle; empty without any.
    fn other_moments(&self) -> &[f64] {
        if self.near.has_own() { bytemuck::cast_slice(self.near.ambient_moments()) } else { &[] }
    }
}

/// Force and torque on a particle in scaled units.
pub(super) fn numbers_of<'a>(loads: &'a Loads, units: &Units) -> impl Fn(usize) -> SixVector + Sync + 'a {
    let torque = 1.0 / units.torque();
    move |row| SixVector::of_row(row, &loads.forces, &loads.torques).times(1.0, torque)
}

/// Motions as numbers in scaled units, those with rates of strain last; empty if there are none.
pub(super) fn columns(motion: &Motion, units: &Units, count: usize) -> Vec<f64> {
    let Motion { velocities, angular_velocities, strain_rates } = motion;
    if velocities.is_empty() && angular_velocities.is_empty() && strain_rates.is_empty() {
        return Vec::new();
    }
    let [velocity, rate] = [units.velocity(), units.rate()].map(|unit| 1.0 / unit);
    let moved = |row: usize| SixVector::of_row(row, velocities, angular_velocities).times(velocity, rate).0;
    let mut columns = of_rows(count, moved).into_flattened();
    let strained = |row: usize| (strain_rates.get(row).copied().unwrap_or_default() * rate).0;
    columns.extend(of_rows(count, strained).as_flattened());
    columns
}

/// A solution with lists of the numbers of its columns, for particles with these ids.
fn with_lists(solution: Solution, ids: &[u64], holder: &dyn RemoteHolder) -> Solution {
    let Some(kept) = &solution.kept else { return solution };
    let SolutionColumns { guessed, forces, torques, stresslets, strain_rates, .. } = &kept.columns;
    let [far, induced, induced_rotation, ..] = guessed;
    let tensors = [far, stresslets, strain_rates];
    let vectors = [induced, induced_rotation, forces, torques];
    let all: Vec<_> = tensors.map(|values| (values, 5)).into_iter().chain(vectors.map(|values| (values, 3))).collect();
    remote_columns::fetch(ids, &all, holder);
    let [far, stresslets, strain_rates] = tensors.map(|values| bytemuck::cast_slice(values).to_vec());
    let [velocities, angular_velocities, forces, torques] = vectors.map(|values| bytemuck::cast_slice(values).to_vec());
    Solution {
        motion: Motion { strain_rates, ..solution.motion },
        stresslets,
        far: Loads { forces, torques, stresslets: far },
        induced: Motion { velocities, angular_velocities, ..Motion::default() },
        kept: None,
        ..solution
    }
}

impl CoupledSolver {
    /// Copies steady loads to where the far field is evaluated, on some particles that move there: they act in all
    /// solves with [`SolveInput::moving_in`](crate::SolveInput::moving_in), in place of loads that are given.
    pub fn hold_loads(&mut self, loads: &Loads, particles: &Particles) {
        let Some(holder) = &self.holder else { return };
        let are_none = loads.forces.is_empty() && loads.torques.is_empty();
        let (count, given) = (if are_none { 0 } else { particles.len() }, numbers_of(loads, &self.units));
        self.held_loads = Some(HeldLoads::new(of_rows(count, |row| given(row).0).as_flattened(), &**holder));
    }

    /// Whether steady loads are where the far field is evaluated.
    pub fn holds_loads(&self) -> bool {
        self.held_loads.is_some()
    }

    /// A solution of particles with all lists, which are brought from where the far field is evaluated.
    pub fn with_lists(&self, solution: Solution, particles: &Particles) -> Solution {
        match &self.holder {
            Some(holder) => with_lists(solution, &particles.ids, &**holder),
            None => solution,
        }
    }
}
