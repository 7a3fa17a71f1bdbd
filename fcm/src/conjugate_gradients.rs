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

    /// This rank's part of `x . P x`.
    fn size(&self, x: &Self::Unknowns) -> f64;
}

/// How an iteration ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// Applications of the matrix.
    pub iterations: usize,
    /// The error left, `(r . P^-1 r / x . P x)^(1/2)`.
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
/// `x`, both in the energy norm of the preconditioner.
pub fn conjugate_gradients<S: System>(
    comm: &Comm,
    system: &mut S,
    (x, residual): (&mut S::Unknowns, &mut S::Unknowns),
    limits: Limits,
) -> Outcome {
    let small = |rz: f64, xx: f64| rz <= limits.tolerance * limits.tolerance * xx || rz == 0.0;
    let mut z = system.precondition(residual);
    let mut direction = z.clone();
    let mut sums = [residual.dot(&z), system.size(x), 0.0];
    comm.sum(&mut sums);
    let mut iterations = 0;
    while !small(sums[0], sums[1]) && iterations < limits.iterations && sums[0].is_finite() {
        let image = system.apply(&direction);
        iterations += 1;
        let mut curvature = [direction.dot(&image)];
        comm.sum(&mut curvature);
        // The residual is orthogonal to the former direction, so this is the step to the minimum along this one.
        let length = sums[0] / curvature[0];
        system.stepped(length);
        x.add(length, &direction);
        residual.add(-length, &image);
        let former = z;
        z = system.precondition(residual);
        let before = sums[0];
        sums = [residual.dot(&z), system.size(x), residual.dot(&former)];
        comm.sum(&mut sums);
        let mut next = z.clone();
        next.add((sums[0] - sums[2]) / before, &direction);
        direction = next;
    }
    // Not a number stays none, whatever it is measured against.
    let residual = if sums[0] == 0.0 { 0.0 } else { (sums[0] / sums[1]).sqrt() };
    Outcome { iterations, residual, converged: small(sums[0], sums[1]) }
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
