//! Solve with near pairs where the far field is evaluated.

use crate::coupled_solver::lubricated_solve::{Found, LubricatedSolve, ScaledInput, ended};
use crate::coupled_solver::{END, ROUGH, START};
use crate::six_vector::{SixVector, SixVectors};
use crate::system::{SingleSpheres, SystemSolution};
use crate::units::Scaled;
use domain::Traceless;
use fcm::{
    CoupledProblem, CoupledSolution, CoupledStart, CoupledTolerances, Limits, Motion, NearResistance, SolveError,
};

impl LubricatedSolve<'_> {
    /// The solve by the back end of the far field, if it has one for free spheres.
    pub(super) fn on_device(
        &self,
        scaled: &mut Scaled,
        input: &ScaledInput,
        limits: Limits,
    ) -> Option<Result<Found, SolveError>> {
        if self.bodies.is_some() || self.quadrupoles.is_some() || !self.is_preconditioned {
            return None;
        }
        let units = scaled.units;
        let viscosity = scaled.mobility.plan().viscosity / units.viscosity;
        let radii: Vec<f64> = scaled.mobility.plan().radii.iter().map(|radius| radius / units.length).collect();
        let far = scaled.mobility.coupled()?;
        let ScaledInput { spheres, known, ambient, motions, moments, moving } = input;
        let start = CoupledStart {
            motions: numbers(motions).to_vec(),
            loads: numbers(moving).to_vec(),
            moments: moments.iter().flat_map(|moment| moment.0).collect(),
        };
        let solution = far.solve(&CoupledProblem {
            units,
            near: self.resistance(spheres, &SingleSpheres::new(viscosity, &radii)),
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

    /// Resistance of the near pairs of spheres, and of single spheres of each radius.
    fn resistance(&self, spheres: &SingleSpheres, of_radii: &SingleSpheres) -> NearResistance {
        let triangle =
            |block: [f64; 36]| (0..6).flat_map(move |row| (0..=row).map(move |column| block[6 * row + column]));
        let blocks = self.near.stiff().inverses(&spheres.motion, |_, _| {});
        let alone = of_radii.motion.iter().zip(&of_radii.strain);
        let [stiff, soft] = self.near.rows();
        NearResistance {
            stiff,
            soft,
            inverses: blocks.iter().flat_map(|block| triangle(block.numbers())).collect(),
            single: alone.map(|(motion, &strain)| [motion.0[0], motion.0[3], strain]).collect(),
        }
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
    Found { solved, outcome: solution.outcome }
}
