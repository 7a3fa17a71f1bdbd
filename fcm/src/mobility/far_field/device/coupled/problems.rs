//! Coupled problems in the units of a device.

use super::super::DeviceFarField;
use super::{SolutionLists, change};
use crate::mobility::coupled::{
    ChangeLimits, ChangedSolution, CoupledProblem, CoupledResidual, CoupledSolution, GivenAmbient, KnownSolution,
};
use domain::Units;
use gpu::{ColumnUnits, LoadFactors};

/// Largest magnitude of a number.
fn largest<'a>(numbers: impl IntoIterator<Item = &'a f64>) -> f64 {
    numbers.into_iter().fold(0.0, |largest: f64, number| largest.max(number.abs()))
}

impl DeviceFarField {
    /// Solves a problem.
    pub(in super::super) fn solve_coupled(&mut self, problem: &CoupledProblem) -> CoupledSolution {
        let CoupledProblem { loads, ambient, background, units: given, .. } = problem;
        // Held loads are estimated with those that resist held motions.
        let ambient = match ambient {
            GivenAmbient::Here(numbers) => &numbers[..],
            GivenAmbient::Held(_) => &[],
        };
        let by_motions = self.largest_resistance * largest(ambient.iter().chain(background));
        let factors = self.factors(given, loads.largest().max(self.largest_surface_force.abs()).max(by_motions));
        let units = ColumnUnits { velocity: given.velocity(), rate: given.rate(), torque: given.torque() };
        self.kept.release_unused();
        let positions = self.particles.positions.remote_list();
        let lists = SolutionLists { kept: &self.kept, places: &self.places, positions, units };
        let orders = self.tables.orders([true; 2], [true; 2]);
        let solution = super::solve(&self.split, problem, &lists, &factors, &orders);
        self.note_evaluations(1 + solution.outcome.iterations as u64, [true; 2]);
        solution
    }

    /// Residual of a solution.
    pub(in super::super) fn coupled_residual(&mut self, known: &KnownSolution) -> CoupledResidual {
        let factors = self.factors_of(known);
        let residual = change::residual(&self.split, known, &factors, &self.tables.orders([true; 2], [true; 2]));
        self.note_evaluations(1, [true; 2]);
        residual
    }

    /// Solution near a known one.
    pub(in super::super) fn change_coupled(&mut self, known: &KnownSolution, limits: &ChangeLimits) -> ChangedSolution {
        let factors = self.factors_of(known);
        let orders = self.tables.orders([true; 2], [true; 2]);
        let changed = change::solve(&self.split, known, limits, &factors, &orders);
        self.note_evaluations(1 + changed.outcome.iterations as u64, [true; 2]);
        changed
    }

    /// Factors of a known solution, whose loads are those that are known and those that its motions cause.
    fn factors_of(&mut self, known: &KnownSolution) -> LoadFactors {
        let by_motions = self.largest_resistance * largest(known.motions.iter().chain(known.ambient));
        self.factors(&known.units, largest(known.loads).max(by_motions))
    }

    /// Factors from given units to those of the far field, whose unit of force becomes that of a load: the largest one
    /// that is given or between surfaces, or by which single spheres resist motions and strain of the fluid.
    fn factors(&mut self, given: &Units, load: f64) -> LoadFactors {
        let own = self.units.with_force(load);
        self.units = own;
        LoadFactors {
            force: 1.0 / own.force,
            torque: given.torque() / own.torque(),
            velocity: own.velocity() / given.velocity(),
            rate: own.rate() / given.rate(),
        }
    }
}
