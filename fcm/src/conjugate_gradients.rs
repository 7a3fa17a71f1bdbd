//! The Krylov solver: preconditioned conjugate gradients on unknowns shared out among ranks.

use domain::{Comm, Interrupt, Traceless};

/// Numbers that can be added, of which each rank holds its own part.
pub trait Linear: Clone {
    /// `self += factor other`.
    fn add(&mut self, factor: f64, other: &Self);
}

/// A system `A x = b` with `A` symmetric positive definite, and a preconditioner `P` that resembles `A`. Methods are
/// collective.
pub trait System {
    /// What is solved for.
    type Unknowns: Linear;

    /// What is left over of the right-hand side.
    type Residual: Linear;

    /// This rank's part of `r . x`.
    fn product(&self, residual: &Self::Residual, x: &Self::Unknowns) -> f64;

    /// `A p`.
    fn apply(&mut self, direction: &Self::Unknowns) -> Self::Residual;

    /// Told of each step `x += length p` along the last direction, to follow other linear functions of `x`.
    fn stepped(&mut self, length: f64);

    /// `P^-1 r`; need not be linear to the last digit.
    fn precondition(&mut self, residual: &Self::Residual) -> Self::Unknowns;

    /// Makes the preconditioner more exact, if it can be: asked for when `r . P^-1 r` came out below zero. All ranks
    /// must answer alike.
    fn sharpen(&mut self) -> bool {
        false
    }

    /// This rank's part of the square of the error that a preconditioned residual `z = P^-1 r` estimates: `r . z`, unless
    /// another measure says more.
    fn error(&self, residual: &Self::Residual, z: &Self::Unknowns) -> f64 {
        self.product(residual, z)
    }

    /// This rank's part of the square of the size of `x` that goes with it: `x . P x`.
    fn size(&self, x: &Self::Unknowns) -> f64;
}

/// How an iteration ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// Applications of the matrix.
    pub iterations: usize,
    /// The error left, `|r . P^-1 r / x . P x|^(1/2)` or what the system measures in its place.
    pub residual: f64,
    /// Whether that is at most what was asked for.
    pub converged: bool,
    /// Whether the iteration ended before that since some rank was asked to stop.
    pub interrupted: bool,
}

/// When to stop.
#[derive(Clone, Copy)]
pub struct Limits<'a> {
    /// Largest error allowed.
    pub tolerance: f64,
    /// Most applications of the matrix.
    pub iterations: usize,
    /// Looked at after each of them.
    pub interrupt: &'a Interrupt,
}

/// Solves `A x = b` from the starting point in `x`, whose residual `b - A x` is given and left behind as it is at the
/// end. Collective.
///
/// Directions are made conjugate by the rule of Polak and Ribière, which bears a preconditioner that is itself an
/// iteration (Golub & Ye 1999). It stops when the error that the preconditioned residual estimates is small against
/// `x`, both as the system measures them, or in the energy norm of the preconditioner; or, not converged, when `r . P^-1 r` is below zero and the
/// preconditioner can't be made more exact, or when any rank is asked to stop.
pub fn conjugate_gradients<S: System>(
    comm: &Comm,
    system: &mut S,
    (x, residual): (&mut S::Unknowns, &mut S::Residual),
    limits: Limits<'_>,
) -> Outcome {
    let small = |sums: [f64; 5]| sums[4].abs() <= limits.tolerance * limits.tolerance * sums[1] || sums[4] == 0.0;
    let (mut z, mut sums) = precondition(comm, system, (x, residual, limits.interrupt), None);
    let mut direction = z.clone();
    let mut iterations = 0;
    let goes_on = |sums: [f64; 5]| sums[0].is_finite() && sums[0] > 0.0 && sums[3] == 0.0;
    while !small(sums) && iterations < limits.iterations && goes_on(sums) {
        let image = system.apply(&direction);
        iterations += 1;
        let mut curvature = [system.product(&image, &direction)];
        comm.sum(&mut curvature);
        // The residual is orthogonal to the former direction, so this is the step to the minimum along this one.
        let length = sums[0] / curvature[0];
        system.stepped(length);
        x.add(length, &direction);
        residual.add(-length, &image);
        drop(image);
        let before = sums[0];
        let (mut next, now) = precondition(comm, system, (x, residual, limits.interrupt), Some(&z));
        (sums, z) = (now, next.clone());
        next.add((sums[0] - sums[2]) / before, &direction);
        direction = next;
    }
    // Not a number stays none, whatever it is measured against.
    let residual = if sums[4] == 0.0 { 0.0 } else { (sums[4] / sums[1]).abs().sqrt() };
    let converged = small(sums);
    Outcome { iterations, residual, converged, interrupted: !converged && sums[3] > 0.0 }
}

/// `z = P^-1 r`, as exact as `r . z` above zero needs, and the sums `r . z`, `x . P x`, `r` times the former `z`, and
/// the number of ranks that are asked to stop, and the error. Collective.
fn precondition<S: System>(
    comm: &Comm,
    system: &mut S,
    (x, residual, interrupt): (&S::Unknowns, &S::Residual, &Interrupt),
    former: Option<&S::Unknowns>,
) -> (S::Unknowns, [f64; 5]) {
    loop {
        let z = system.precondition(residual);
        let asked = f64::from(u8::from(interrupt.is_requested()));
        let again = former.map_or(0.0, |former| system.product(residual, former));
        let (product, error) = (system.product(residual, &z), system.error(residual, &z));
        let mut sums = [product, system.size(x), again, asked, error];
        comm.sum(&mut sums);
        if sums[0] >= 0.0 || sums[0].is_nan() || !system.sharpen() {
            return (z, sums);
        }
    }
}

impl Linear for Vec<Traceless> {
    fn add(&mut self, factor: f64, other: &Self) {
        for (a, &b) in self.iter_mut().zip(other) {
            *a += b * factor;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    impl Linear for [f64; 2] {
        fn add(&mut self, factor: f64, other: &Self) {
            (0..2).for_each(|k| self[k] += factor * other[k]);
        }
    }

    /// `diag(1, 4)` with a preconditioner that has the sign wrong until it was made more exact this often.
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

        fn stepped(&mut self, _: f64) {}

        fn precondition(&mut self, residual: &[f64; 2]) -> [f64; 2] {
            if self.left == 0 { *residual } else { residual.map(|r| -r) }
        }

        fn sharpen(&mut self) -> bool {
            let could = self.can > 0;
            self.left = self.left.saturating_sub(1);
            self.can = self.can.saturating_sub(1);
            could
        }

        fn size(&self, x: &[f64; 2]) -> f64 {
            self.product(x, x)
        }
    }

    /// A system that sees the first number alone, and counts both as errors.
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

        fn stepped(&mut self, _: f64) {}

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

    /// No direction lessens what is left, so the solve ends with numbers.
    #[test]
    fn an_error_that_no_product_sees_ends_the_solve() {
        let (mut x, mut residual) = ([1.0, 1.0], [0.0, 0.5]);
        let limits = Limits { tolerance: 1e-12, iterations: 10, interrupt: &Interrupt::NEVER };
        let outcome = conjugate_gradients(&Comm::alone(), &mut Blind, (&mut x, &mut residual), limits);
        let residual = (0.25_f64 / 2.0).sqrt();
        assert_eq!(outcome, Outcome { iterations: 0, residual, converged: false, interrupted: false });
    }

    fn solved(left: usize, can: usize) -> ([f64; 2], Outcome) {
        let (mut x, mut residual) = ([1.0, 0.0], [2.0, 8.0]);
        let limits = Limits { tolerance: 1e-12, iterations: 10, interrupt: &Interrupt::NEVER };
        let outcome = conjugate_gradients(&Comm::alone(), &mut Wrong { left, can }, (&mut x, &mut residual), limits);
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
            ([1.0, 0.0], Outcome { iterations: 0, residual: 68_f64.sqrt(), converged: false, interrupted: false })
        );
    }

    /// The last rank alone is asked to stop, after a number of looks.
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
                conjugate_gradients(&comm, &mut Wrong { left: 0, can: 0 }, (&mut x, &mut residual), limits)
            });
            for outcome in outcomes {
                assert_eq!((outcome.interrupted, outcome.converged), (looks < 2, looks == 2), "{outcome:?}");
                assert_eq!(outcome.iterations, looks);
            }
        }
    }
}
