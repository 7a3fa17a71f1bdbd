//! Coupled problems in the units of a device.

use super::super::DeviceFarField;
use super::change::{self, KnownOnDevice};
use super::{FIVE, SIX, SolutionLists};
use crate::mobility::coupled::{
    ChangeLimits, ChangedSolution, CoupledProblem, CoupledResidual, CoupledSolution, GivenAmbient, HeldLoads,
    KnownSolution,
};
use crate::mobility::fluctuating::{ExactConditions, HeldSolution, SolutionChange};
use domain::Units;
use gpu::{ChangeColumns, ColumnUnits, DeviceList, KnownLists, LoadFactors};

/// Largest magnitude of a number.
fn largest<'a>(numbers: impl IntoIterator<Item = &'a f64>) -> f64 {
    numbers.into_iter().fold(0.0, |largest: f64, number| largest.max(number.abs()))
}

/// Units of columns over those of a solve.
fn units_of(units: &Units) -> ColumnUnits {
    ColumnUnits { velocity: units.velocity(), rate: units.rate(), torque: units.torque() }
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
        let units = units_of(given);
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

    /// Conditions for which a solution on the device is exact.
    pub(in super::super) fn exact_conditions_of(&mut self, found: &HeldSolution, loads: &HeldLoads) -> ExactConditions {
        self.kept.release_unused();
        let count = self.places.len();
        let [force, torque, stresslet, ambient] = [3, 3, FIVE, SIX + FIVE].map(|width| self.kept.list(width * count));
        let lists = self.known_lists(found, [force, torque, stresslet, ambient]);
        let given = loads.list().map(|list| self.kept.held(list));
        let orders = self.tables.orders([true; 2], [true; 2]);
        let known = KnownOnDevice { lists, count, factors: self.present_factors(&found.units), orders: &orders };
        change::store_conditions(&self.split, &known, given);
        self.note_evaluations(1, [true; 2]);
        let [force, torque, stresslets, ambient] = [force, torque, stresslet, ambient].map(|list| self.kept.keep(list));
        ExactConditions { loads: [force, torque], ambient, stresslets }
    }

    /// Change of a solution on the device over a divisor.
    pub(in super::super) fn change_of_held(
        &mut self,
        found: &HeldSolution,
        exact: &ExactConditions,
        divisor: f64,
        limits: &ChangeLimits,
    ) -> SolutionChange {
        self.kept.release_unused();
        let (count, [force, torque]) = (self.places.len(), &exact.loads);
        let of_exact = [force, torque, &exact.stresslets, &exact.ambient].map(|list| self.kept.held(list));
        let [velocities, stresslets] = [3, FIVE].map(|width| self.kept.list(width * count));
        let (lists, orders) = (self.known_lists(found, of_exact), self.tables.orders([true; 2], [true; 2]));
        let known = KnownOnDevice { lists, count, factors: self.present_factors(&found.units), orders: &orders };
        let changes = ChangeColumns { velocities, stresslets, divisor };
        let outcome = change::store_change(&self.split, &known, &changes, limits);
        self.note_evaluations(1 + outcome.iterations as u64, [true; 2]);
        let [velocities, stresslets] = [velocities, stresslets].map(|list| self.kept.keep(list));
        SolutionChange { velocities, stresslets, outcome }
    }

    /// Lists of a solution, with those of forces, torques, total stresslets and ambient motions.
    fn known_lists(&self, found: &HeldSolution, [force, torque, stresslets, ambient]: [DeviceList; 4]) -> KnownLists {
        let [motions @ .., far_stresslets] =
            [&found.motions[0], &found.motions[1], &found.far_stresslets].map(|list| self.kept.held(list));
        KnownLists {
            motions,
            far_stresslets,
            loads: [force, torque],
            stresslets,
            ambient,
            units: units_of(&found.units),
        }
    }

    /// Factors from given units to those of the far field, with the unit of force of the last solve.
    fn present_factors(&mut self, given: &Units) -> LoadFactors {
        self.factors(given, self.units.force)
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
