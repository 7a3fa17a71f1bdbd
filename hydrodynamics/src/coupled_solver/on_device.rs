//! Solve with near pairs where the far field is evaluated.

use crate::coupled_solver::lubricated_solve::{Found, LubricatedSolve, ScaledInput, ended};
use crate::coupled_solver::{END, ROUGH, START};
use crate::six_vector::{SixVector, SixVectors};
use crate::system::SystemSolution;
use crate::units::Scaled;
use domain::Traceless;
use fcm::{CoupledProblem, CoupledSolution, CoupledStart, CoupledTolerances, Limits, Motion, SolveError};

impl LubricatedSolve<'_> {
    /// The solve by the back end of the far field, if the near pairs are there.
    pub(super) fn on_device(
        &self,
        scaled: &mut Scaled,
        input: &ScaledInput,
        limits: Limits,
    ) -> Option<Result<Found, SolveError>> {
        if !self.near.is_on_device() {
            return None;
        }
        let units = scaled.units;
        let far = scaled.mobility.coupled()?;
        let ScaledInput { known, ambient, motions, moments, moving, .. } = input;
        let start = CoupledStart {
            motions: numbers(motions).to_vec(),
            loads: numbers(moving).to_vec(),
            moments: moments.iter().flat_map(|moment| moment.0).collect(),
        };
        let solution = far.solve(&CoupledProblem {
            units,
            loads: numbers(known),
            ambient: columns(ambient, known.0.len()),
            background: self.strain_rate.at_zero.0,
            start,
            comm: self.comm,
            limits,
            tolerances: CoupledTolerances {
                start: START * limits.tolerance,
                preconditioner: ROUGH,
                end: END * limits.tolerance,
            },
        });
        Some(ended(&solution.outcome, limits).map(|()| found(&solution)))
    }
}

fn numbers(vectors: &SixVectors) -> &[f64] {
    bytemuck::cast_slice(&vectors.0)
}

/// Motions as numbers, those with rates of strain last; empty if there are none.
fn columns(motion: &Motion, count: usize) -> Vec<f64> {
    let Motion { velocities, angular_velocities, strain_rates } = motion;
    if velocities.is_empty() && angular_velocities.is_empty() && strain_rates.is_empty() {
        return Vec::new();
    }
    let mut columns = numbers(&SixVectors::new(count, velocities, angular_velocities)).to_vec();
    columns.extend((0..count).flat_map(|row| strain_rates.get(row).copied().unwrap_or_default().0));
    columns
}

fn found(solution: &CoupledSolution) -> Found {
    let six = |list: &[f64]| SixVectors(list.as_chunks().0.iter().map(|&vector| SixVector(vector)).collect());
    let tensors = |list: &[f64]| list.as_chunks().0.iter().map(|&tensor| Traceless(tensor)).collect::<Vec<_>>();
    let solved = SystemSolution {
        motions: six(&solution.motions),
        loads: six(&solution.loads),
        moments: tensors(&solution.moments),
        strain_rates: tensors(&solution.strain_rates),
    };
    Found { solved, by_motions: tensors(&solution.first_moments), outcome: solution.outcome }
}
