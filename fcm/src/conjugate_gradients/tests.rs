//! Outcomes of the iteration.

use super::*;
use std::sync::atomic::{AtomicUsize, Ordering};

impl Linear for [f64; 2] {
    fn add(&mut self, factor: f64, other: &Self) {
        (0..2).for_each(|k| self[k] += factor * other[k]);
    }

    fn scale_add(&mut self, factor: f64, other: &Self) {
        (0..2).for_each(|k| self[k] = other[k] + factor * self[k]);
    }
}

/// `diag(1, 4)` with a preconditioner of the wrong sign until it has been made more exact `left` times.
struct Wrong {
    left: usize,
    can: usize,
}

impl System for Wrong {
    type Unknowns = [f64; 2];
    type Residual = [f64; 2];

    fn product(&self, residual: &[f64; 2], x: &[f64; 2]) -> f64 {
        residual[0] * x[0] + residual[1] * x[1]
    }

    fn apply(&mut self, direction: &[f64; 2]) -> [f64; 2] {
        [direction[0], 4.0 * direction[1]]
    }

    fn on_step(&mut self, _: f64) {}

    fn precondition(&mut self, residual: &[f64; 2]) -> [f64; 2] {
        if self.left == 0 { *residual } else { residual.map(|r| -r) }
    }

    fn refine_preconditioner(&mut self) -> bool {
        let could = self.can > 0;
        self.left = self.left.saturating_sub(1);
        self.can = self.can.saturating_sub(1);
        could
    }

    fn size(&self, x: &[f64; 2]) -> f64 {
        self.product(x, x)
    }
}

/// A system whose inner products see the first component alone, and whose error counts both.
struct Blind;

impl System for Blind {
    type Unknowns = [f64; 2];
    type Residual = [f64; 2];

    fn product(&self, residual: &[f64; 2], x: &[f64; 2]) -> f64 {
        residual[0] * x[0]
    }

    fn apply(&mut self, direction: &[f64; 2]) -> [f64; 2] {
        *direction
    }

    fn on_step(&mut self, _: f64) {}

    fn precondition(&mut self, residual: &[f64; 2]) -> [f64; 2] {
        *residual
    }

    fn error(&self, _: &[f64; 2], z: &[f64; 2]) -> f64 {
        self.size(z)
    }

    fn size(&self, x: &[f64; 2]) -> f64 {
        x[0] * x[0] + x[1] * x[1]
    }
}

/// No direction reduces the error, so the solve ends with finite numbers.
#[test]
fn an_error_that_no_product_sees_ends_the_solve() {
    let (mut x, mut residual) = ([1.0, 1.0], [0.0, 0.5]);
    let limits = Limits { tolerance: 1e-12, iterations: 10, interrupt: &Interrupt::NEVER };
    let outcome = conjugate_gradients(
        &Comm::alone(),
        &mut Blind,
        Iterate { x: &mut x, residual: &mut residual, z: &mut [0.0; 2] },
        limits,
    );
    let residual = (0.25_f64 / 2.0).sqrt();
    assert_eq!(outcome, IterationOutcome { iterations: 0, residual, converged: false, interrupted: false });
}

fn solved(left: usize, can: usize) -> ([f64; 2], IterationOutcome) {
    let (mut x, mut residual) = ([1.0, 0.0], [2.0, 8.0]);
    let limits = Limits { tolerance: 1e-12, iterations: 10, interrupt: &Interrupt::NEVER };
    let outcome = conjugate_gradients(
        &Comm::alone(),
        &mut Wrong { left, can },
        Iterate { x: &mut x, residual: &mut residual, z: &mut [0.0; 2] },
        limits,
    );
    (x, outcome)
}

#[test]
fn a_preconditioner_that_is_not_positive_is_made_more_exact() {
    for left in 0..3 {
        let (x, outcome) = solved(left, 3);
        assert!(outcome.converged && outcome.iterations == 2, "{outcome:?}");
        assert!((x[0] - 3.0).abs() < 1e-12 && (x[1] - 2.0).abs() < 1e-12, "{x:?}");
    }
}

#[test]
fn one_that_stays_so_ends_the_solve_with_its_residual() {
    let (x, outcome) = solved(3, 1);
    assert_eq!(
        (x, outcome),
        ([1.0, 0.0], IterationOutcome { iterations: 0, residual: 68_f64.sqrt(), converged: false, interrupted: false })
    );
}

/// Only the last rank is asked to stop, after a number of polls.
#[test]
fn one_rank_that_is_asked_to_stop_stops_all() {
    for looks in 0..3 {
        let outcomes = Comm::threads(3, |comm| {
            let left = AtomicUsize::new(looks);
            let last = comm.rank() == 2;
            let one_less = move || left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |n| n.checked_sub(1));
            let asked = move || last && one_less().is_err();
            let interrupt = Interrupt::when(asked);
            let limits = Limits { tolerance: 1e-12, iterations: 10, interrupt: &interrupt };
            let (mut x, mut residual) = ([1.0, 0.0], [2.0, 8.0]);
            conjugate_gradients(
                &comm,
                &mut Wrong { left: 0, can: 0 },
                Iterate { x: &mut x, residual: &mut residual, z: &mut [0.0; 2] },
                limits,
            )
        });
        for outcome in outcomes {
            assert_eq!((outcome.interrupted, outcome.converged), (looks < 2, looks == 2), "{outcome:?}");
            assert_eq!(outcome.iterations, looks);
        }
    }
}
