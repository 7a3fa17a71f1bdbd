//! Measures of displacements of particles that move on a device.

use super::kept_lists::KeptLists;
use super::{by_rows, succeeded};
use crate::mobility::stepping::{
    DisplacementError, DisplacementOrders, DisplacementWeights, GapChanges, HeldSteps, HeldVelocities, Separation,
    SeparationLimits,
};
use domain::RemoteList;
use gpu::{DeviceList, StepInput};
use solver::BackgroundFlow;

impl DisplacementOrders<'_> {
    /// Weights of each order, and the ratios up to which a motion counts as smooth.
    fn parts(&self) -> (&[DisplacementWeights], [f64; 2]) {
        match self {
            Self::Two(weights) => (&weights[..], [0.0; 2]),
            Self::Four { weights, smooth } => (&weights[..], *smooth),
        }
    }
}

/// Weights of the differences between displacements and the next ones.
fn differences(weights: &[DisplacementWeights]) -> Vec<DisplacementWeights> {
    let between =
        |pair: &[DisplacementWeights]| -> DisplacementWeights { std::array::from_fn(|k| pair[0][k] - pair[1][k]) };
    weights.windows(2).map(between).collect()
}

/// Largest number of rounds between two looks of the host.
const LARGEST_BATCH: usize = 16;

/// A number, or infinity in place of one that is none; 0 without any.
fn or_infinite(number: Option<f64>) -> f64 {
    number.map_or(0.0, |number| if number.is_nan() { f64::INFINITY } else { number })
}

impl KeptLists {
    /// Input of measures of the arranged particles.
    fn measured(&self) -> StepInput<'_> {
        StepInput { radii: &self.radii, length: self.length, ..StepInput::default() }
    }

    /// The same with velocities, whose columns are `columns`.
    fn moving_by<'a>(&'a self, velocities: &HeldVelocities, columns: &'a [DeviceList]) -> StepInput<'a> {
        let HeldVelocities { positions, flow, deformation, .. } = velocities;
        StepInput {
            positions: Some(self.held(positions)),
            gradient: by_rows(&flow.gradient()),
            deformation: by_rows(deformation),
            columns,
            ..self.measured()
        }
    }

    fn all_held(&self, columns: &[RemoteList]) -> Vec<DeviceList> {
        columns.iter().map(|remote| self.held(remote)).collect()
    }

    /// Displacements that move pairs apart, after the last round that moved any, and whether none is left to move.
    /// The host looks after one round, after two more, and then after ever more of them.
    fn rounds(&self, input: &StepInput, rounds: usize, count: usize) -> (Option<DeviceList>, bool) {
        let lists = [self.list(count), self.list(count)];
        let (mut done, mut batch, mut still) = (0, 1, None);
        while done < rounds && still.is_none() {
            let next = rounds.min(done + batch);
            let pushed = succeeded(self.field.borrow_mut().push_apart(input, lists, done..next));
            still = pushed.iter().position(|&particles| particles == 0).map(|place| done + place);
            (done, batch) = (next, LARGEST_BATCH.min(2 * batch));
        }
        let moved = still.unwrap_or(done).checked_sub(1).map(|last| lists[last % 2]);
        for unused in lists.iter().filter(|&&list| Some(list) != moved) {
            self.field.borrow_mut().release(unused);
        }
        (moved, still.is_some())
    }
}

impl HeldSteps for KeptLists {
    fn combined(&self, terms: &[(RemoteList, f64)]) -> RemoteList {
        self.release_unused();
        let terms: Vec<(DeviceList, f64)> = terms.iter().map(|(remote, weight)| (self.held(remote), *weight)).collect();
        let sum = self.list(terms[0].0.count());
        succeeded(self.field.borrow_mut().combine(&terms, &sum));
        self.keep(sum)
    }

    fn with_flow(
        &self,
        velocities: &RemoteList,
        positions: &RemoteList,
        flow: &BackgroundFlow,
        times: f64,
    ) -> RemoteList {
        self.release_unused();
        let columns = [self.held(velocities)];
        let (sum, gradient) = (self.list(columns[0].count()), by_rows(&flow.gradient()));
        let (positions, weights) = (Some(self.held(positions)), &[[times, 0.0, 0.0, 0.0]]);
        let input = StepInput { columns: &columns, positions, gradient, weights, ..StepInput::default() };
        succeeded(self.field.borrow_mut().add_flow(&input, &sum));
        self.keep(sum)
    }

    fn limited(&self, column: &RemoteList, most: f64) -> RemoteList {
        self.release_unused();
        let column = self.held(column);
        let limited = self.list(column.count());
        succeeded(self.field.borrow_mut().limit(column, &self.radii, most, &limited));
        self.keep(limited)
    }

    fn displacement_error(&self, columns: &[RemoteList], orders: &DisplacementOrders) -> DisplacementError {
        let ((weights, smooth), columns) = (orders.parts(), self.all_held(columns));
        let input = StepInput { columns: &columns, weights: &differences(weights), smooth, ..self.measured() };
        let found = succeeded(self.field.borrow_mut().displacement_error(&input));
        DisplacementError { error: or_infinite(found.error), roughness: or_infinite(found.roughness) }
    }

    fn gap_changes(
        &self,
        velocities: &HeldVelocities,
        orders: &DisplacementOrders,
        least: [f64; 2],
        reach: f64,
    ) -> GapChanges {
        let ((weights, smooth), columns) = (orders.parts(), self.all_held(velocities.columns));
        let input = StepInput { weights, smooth, least, reach, ..self.moving_by(velocities, &columns) };
        let found = succeeded(self.field.borrow_mut().gap_changes(&input));
        let [loss, error, roughness] = [found.loss, found.error, found.roughness].map(Option::unwrap_or_default);
        GapChanges { gap: found.gap.unwrap_or(f64::INFINITY), loss, error, roughness }
    }

    fn moved_apart(
        &self,
        velocities: &HeldVelocities,
        weights: &DisplacementWeights,
        limits: &SeparationLimits,
    ) -> Separation {
        self.release_unused();
        let columns = self.all_held(velocities.columns);
        let &SeparationLimits { closest, slack, rounds, reach } = limits;
        let weights = &[*weights];
        let input = StepInput { weights, closest, slack, reach, ..self.moving_by(velocities, &columns) };
        match self.rounds(&input, rounds, self.held(velocities.positions).count()) {
            (None, true) => Separation::Apart,
            (Some(list), true) => Separation::By(self.keep(list)),
            (list, false) => {
                if let Some(list) = list {
                    self.field.borrow_mut().release(&list);
                }
                Separation::Fails
            }
        }
    }

    fn smallest_relative_gap(&self, reach: f64) -> f64 {
        let input = StepInput { reach, ..self.measured() };
        succeeded(self.field.borrow_mut().smallest_relative_gap(&input)).unwrap_or(f64::INFINITY)
    }
}
