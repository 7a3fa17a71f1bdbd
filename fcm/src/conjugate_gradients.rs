//! Preconditioned conjugate gradients on unknowns shared out among ranks.

use domain::{Comm, Traceless};

/// A list of unknowns, of which each rank holds its own part.
pub trait Unknowns: Clone {
    /// This rank's part of the inner product.
    fn dot(&self, other: &Self) -> f64;

    /// `self += factor other`.
    fn add(&mut self, factor: f64, other: &Self);
}

/// A system `A x = b` with `A` symmetric positive definite, and a preconditioner `P` that resembles `A`. Methods are
/// collective.
pub trait System {
    /// What is solved for.
    type Unknowns: Unknowns;

    /// `A p`.
    fn apply(&mut self, direction: &Self::Unknowns) -> Self::Unknowns;

    /// Told of each step `x += length p` along the last direction, to follow other linear functions of `x`.
    fn stepped(&mut self, length: f64);

    /// `P^-1 r`; need not be linear to the last digit.
    fn precondition(&mut self, residual: &Self::Unknowns) -> Self::Unknowns;

    /// Makes the preconditioner more exact, if it can be: asked for when `r . P^-1 r` came out below zero. All ranks
    /// must answer alike.
    fn sharpen(&mut self) -> bool {
        false
    }

    /// This rank's part of `x . P x`.
    fn size(&self, x: &Self::Unknowns) -> f64;
}

/// How an iteration ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// Applications of the matrix.
    pub iterations: usize,
    /// The error left, `|r . P^-1 r / x . P x|^(1/2)`.
    pub residual: f64,
    /// Whether that is at most what was asked for.
    pub converged: bool,
}

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Largest error allowed, `(r . P^-1 r / x . P x)^(1/2)`.
    pub tolerance: f64,
    /// Most applications of the matrix.
    pub iterations: usize,
}

/// Solves `A x = b` from the starting point in `x`, whose residual `b - A x` is given and left behind as it is at the
/// end. Collective.
///
/// Directions are made conjugate by the rule of Polak and Ribière, which bears a preconditioner that is itself an
/// iteration (Golub & Ye 1999). It stops when the error that the preconditioned residual estimates is small against
/// `x`, both in the energy norm of the preconditioner; or, not converged, when `r . P^-1 r` is below zero and the
/// preconditioner can't be made more exact.
pub fn conjugate_gradients<S: System>(
    comm: &Comm,
    system: &mut S,
    (x, residual): (&mut S::Unknowns, &mut S::Unknowns),
    limits: Limits,
) -> Outcome {
    let small = |sums: [f64; 3]| sums[0].abs() <= limits.tolerance * limits.tolerance * sums[1] || sums[0] == 0.0;
    let (mut z, mut sums) = precondition(comm, system, (x, residual), None);
    let mut direction = z.clone();
    let mut iterations = 0;
    while !small(sums) && iterations < limits.iterations && sums[0].is_finite() && sums[0] > 0.0 {
        let image = system.apply(&direction);
        iterations += 1;
        let mut curvature = [direction.dot(&image)];
        comm.sum(&mut curvature);
        // The residual is orthogonal to the former direction, so this is the step to the minimum along this one.
        let length = sums[0] / curvature[0];
        system.stepped(length);
        x.add(length, &direction);
        residual.add(-length, &image);
        let before = sums[0];
        let (mut next, now) = precondition(comm, system, (x, residual), Some(&z));
        (sums, z) = (now, next.clone());
        next.add((sums[0] - sums[2]) / before, &direction);
        direction = next;
    }
    // Not a number stays none, whatever it is measured against.
    let residual = if sums[0] == 0.0 { 0.0 } else { (sums[0] / sums[1]).abs().sqrt() };
    Outcome { iterations, residual, converged: small(sums) }
}

/// `z = P^-1 r`, as exact as `r . z` above zero needs, and the sums `r . z`, `x . P x` and `r` times the former `z`.
/// Collective.
fn precondition<S: System>(
    comm: &Comm,
    system: &mut S,
    (x, residual): (&S::Unknowns, &S::Unknowns),
    former: Option<&S::Unknowns>,
) -> (S::Unknowns, [f64; 3]) {
    loop {
        let z = system.precondition(residual);
        let mut sums = [residual.dot(&z), system.size(x), former.map_or(0.0, |former| residual.dot(former))];
        comm.sum(&mut sums);
        if sums[0] >= 0.0 || sums[0].is_nan() || !system.sharpen() {
            return (z, sums);
        }
    }
}

impl Unknowns for Vec<Traceless> {
    fn dot(&self, other: &Self) -> f64 {
        self.iter().zip(other).map(|(&a, &b)| a.contract(b)).sum()
    }

    fn add(&mut self, factor: f64, other: &Self) {
        for (a, &b) in self.iter_mut().zip(other) {
            *a += b * factor;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    impl Unknowns for [f64; 2] {
        fn dot(&self, other: &Self) -> f64 {
            self[0] * other[0] + self[1] * other[1]
        }

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
            x.dot(x)
        }
    }

    fn solved(left: usize, can: usize) -> ([f64; 2], Outcome) {
        let (mut x, mut residual) = ([1.0, 0.0], [2.0, 8.0]);
        let limits = Limits { tolerance: 1e-12, iterations: 10 };
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
        assert_eq!((x, outcome), ([1.0, 0.0], Outcome { iterations: 0, residual: 68_f64.sqrt(), converged: false }));
    }
}
