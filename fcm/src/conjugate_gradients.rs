//! Preconditioned conjugate gradients, with the unknowns distributed over ranks.

use domain::parallel::change;
use domain::{Comm, Interrupt, Traceless, Vector};

/// Vectors of a linear space, of which each rank holds its own part.
pub trait Linear: Clone {
    /// `self += factor other`.
    fn add(&mut self, factor: f64, other: &Self);

    /// `self = other + factor self`.
    fn scale_add(&mut self, factor: f64, other: &Self);
}

/// A system `A x = b` with `A` symmetric positive definite, and a preconditioner `P` that resembles `A`. Methods are
/// collective.
pub trait System {
    /// Type of the unknowns `x`.
    type Unknowns: Linear;

    /// Type of the residual `b - A x`.
    type Residual: Linear;

    /// This rank's part of the inner product `r . x`.
    fn product(&self, residual: &Self::Residual, x: &Self::Unknowns) -> f64;

    /// `A p`.
    fn apply(&mut self, direction: &Self::Unknowns) -> Self::Residual;

    /// `A p`, and this rank's part of the curvature `p . A p`.
    fn curvature(&mut self, direction: &Self::Unknowns) -> (Self::Residual, f64) {
        let image = self.apply(direction);
        let curvature = self.product(&image, direction);
        (image, curvature)
    }

    /// Turns a direction into `z + factor p`, of which it returns [`Self::curvature`]. It can be done in one pass.
    fn turn(&mut self, direction: &mut Self::Unknowns, factor: f64, z: &Self::Unknowns) -> (Self::Residual, f64) {
        direction.scale_add(factor, z);
        self.curvature(direction)
    }

    /// Called with each step `x += length p` along the last direction, to update other linear functions of `x`.
    fn on_step(&mut self, length: f64);

    /// `P^-1 r`; needs to be linear only approximately.
    fn precondition(&mut self, residual: &Self::Residual) -> Self::Unknowns;

    /// Makes the preconditioner more exact, if possible; returns whether it did. Called if `r . P^-1 r` is negative.
    /// All ranks must return the same.
    fn refine_preconditioner(&mut self) -> bool {
        false
    }

    /// This rank's part of the square of the error that a preconditioned residual `z = P^-1 r` estimates: `r . z`,
    /// unless the system has a stricter measure.
    fn error(&self, residual: &Self::Residual, z: &Self::Unknowns) -> f64 {
        self.product(residual, z)
    }

    /// This rank's part of the square of the size of `x` to which the error is relative: `x . P x`.
    fn size(&self, x: &Self::Unknowns) -> f64;

    /// Takes a step, if one is given, and measures the residual: computes `z = P^-1 r`, in place of the `z` before
    /// the step, and this rank's sums. An implementation can do all of it in one pass over the unknowns.
    fn step_and_measure(
        &mut self,
        at: Iterate<Self::Unknowns, Self::Residual>,
        step: Option<Step<Self::Unknowns, Self::Residual>>,
    ) -> InnerProducts {
        let Iterate { x, residual, z } = at;
        let mut former = 0.0;
        if let Some(Step { length, direction, image }) = step {
            x.add(length, direction);
            residual.add(-length, &image);
            former = self.product(residual, z);
        }
        *z = self.precondition(residual);
        InnerProducts { product: self.product(residual, z), former, error: self.error(residual, z), size: self.size(x) }
    }
}

/// A system as the iteration sees it: a [`System`], or one that iterates in the memory of a device.
pub trait SteppedSystem {
    /// Type of the unknowns.
    type Unknowns;

    /// Type of the residual.
    type Residual;

    /// See [`System::refine_preconditioner`].
    fn refine_preconditioner(&mut self) -> bool;

    /// Preconditions the residual and measures it, see [`System::step_and_measure`].
    fn measure(&mut self, at: Iterate<Self::Unknowns, Self::Residual>) -> InnerProducts;

    /// Takes the step to the minimum along the next direction, and measures the new residual. The next direction takes
    /// the place of the last one, which is `None` at first. Collective.
    fn advance(
        &mut self,
        comm: &Comm,
        at: Iterate<Self::Unknowns, Self::Residual>,
        direction: &mut Option<Self::Unknowns>,
        turn: Turn,
    ) -> InnerProducts;
}

/// Numbers by which the next direction, `z + factor p`, and the step along it follow from the last ones.
#[derive(Debug, Clone, Copy)]
pub struct Turn {
    /// Part of the last direction `p`; without one it does not matter.
    pub factor: f64,
    /// `r . z` over all ranks.
    pub product: f64,
}

impl<S: System> SteppedSystem for S {
    type Unknowns = S::Unknowns;
    type Residual = S::Residual;

    fn refine_preconditioner(&mut self) -> bool {
        System::refine_preconditioner(self)
    }

    fn measure(&mut self, at: Iterate<S::Unknowns, S::Residual>) -> InnerProducts {
        self.step_and_measure(at, None)
    }

    fn advance(
        &mut self,
        comm: &Comm,
        at: Iterate<S::Unknowns, S::Residual>,
        direction: &mut Option<S::Unknowns>,
        turn: Turn,
    ) -> InnerProducts {
        let (image, curvature) = match direction {
            Some(direction) => self.turn(direction, turn.factor, at.z),
            None => self.curvature(direction.insert(at.z.clone())),
        };
        let mut sum = [curvature];
        comm.sum(&mut sum);
        // The residual is orthogonal to the former direction, so this step reaches the minimum along the new one.
        let length = turn.product / sum[0];
        self.on_step(length);
        let step = direction.as_ref().map(|direction| Step { length, direction, image });
        self.step_and_measure(at, step)
    }
}

/// Unknowns, residual and preconditioned residual of the iteration, which change in place.
pub struct Iterate<'a, X, R> {
    /// `x`
    pub x: &'a mut X,
    /// `r = b - A x`
    pub residual: &'a mut R,
    /// `z = P^-1 r`
    pub z: &'a mut X,
}

impl<X, R> Iterate<'_, X, R> {
    fn reborrow(&mut self) -> Iterate<'_, X, R> {
        Iterate { x: self.x, residual: self.residual, z: self.z }
    }
}

/// Step of the iteration, `x += length p` and `r -= length A p`.
pub struct Step<'a, X, R> {
    /// Length of the step.
    pub length: f64,
    /// Direction `p`.
    pub direction: &'a X,
    /// Image `A p`; its memory is released after the step.
    pub image: R,
}

/// Inner products of the residual `r` and `z = P^-1 r`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct InnerProducts {
    /// `r . z`.
    pub product: f64,
    /// `r` times the `z` before the step; 0 if there was no step.
    pub former: f64,
    /// See [`System::error`].
    pub error: f64,
    /// See [`System::size`].
    pub size: f64,
}

impl std::ops::Add for InnerProducts {
    type Output = Self;

    fn add(self, more: Self) -> Self {
        Self {
            product: self.product + more.product,
            former: self.former + more.former,
            error: self.error + more.error,
            size: self.size + more.size,
        }
    }
}

/// Result of an iteration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IterationOutcome {
    /// Number of applications of the matrix.
    pub iterations: usize,
    /// Relative error left, `|r . P^-1 r / x . P x|^(1/2)`, or the system's own measure.
    pub residual: f64,
    /// Whether the residual is within the tolerance.
    pub converged: bool,
    /// Whether the iteration ended before convergence because some rank was asked to stop.
    pub interrupted: bool,
}

/// Stopping criteria.
#[derive(Clone, Copy)]
pub struct Limits<'a> {
    /// Largest relative error allowed.
    pub tolerance: f64,
    /// Largest number of applications of the matrix.
    pub iterations: usize,
    /// Polled after each application.
    pub interrupt: &'a Interrupt,
}

/// Solves `A x = b` from the initial guess `x` with its residual `b - A x`; both are updated in place. At the end `z`
/// holds `P^-1` of the residual; its initial value does not matter. Collective.
///
/// Directions are made conjugate by the formula of Polak and Ribière, which tolerates a preconditioner that is itself
/// an iteration (Golub & Ye 1999). The iteration converges when the error that the preconditioned residual estimates
/// is small against `x`, both as the system measures them (by default in the energy norm of the preconditioner). It
/// ends without convergence when `r . P^-1 r` is negative and the preconditioner can't be made more exact, or when
/// any rank is asked to stop.
pub fn conjugate_gradients<S: SteppedSystem>(
    comm: &Comm,
    system: &mut S,
    mut iterate: Iterate<S::Unknowns, S::Residual>,
    limits: Limits<'_>,
) -> IterationOutcome {
    let small = |at: &InnerProducts| at.error.abs() <= limits.tolerance * limits.tolerance * at.size || at.error == 0.0;
    let ends = |at: &InnerProducts, iterations: usize, asked: bool| {
        small(at) || iterations >= limits.iterations || !at.product.is_finite() || at.product <= 0.0 || asked
    };
    let own = system.measure(iterate.reborrow());
    let (mut at, mut asked) = settled(comm, system, iterate.reborrow(), own, limits.interrupt);
    let (mut iterations, mut direction, mut factor) = (0, None, 0.0);
    while !ends(&at, iterations, asked) {
        iterations += 1;
        let before = at.product;
        let own = system.advance(comm, iterate.reborrow(), &mut direction, Turn { factor, product: before });
        (at, asked) = settled(comm, system, iterate.reborrow(), own, limits.interrupt);
        factor = (at.product - at.former) / before;
    }
    // NaN stays NaN, whatever it is divided by.
    let residual = if at.error == 0.0 { 0.0 } else { (at.error / at.size).abs().sqrt() };
    let converged = small(&at);
    IterationOutcome { iterations, residual, converged, interrupted: !converged && asked }
}

/// Sums of all ranks, after the preconditioner was made more exact until `r . z` is positive, and whether any rank is
/// asked to stop. Collective.
fn settled<S: SteppedSystem>(
    comm: &Comm,
    system: &mut S,
    mut iterate: Iterate<S::Unknowns, S::Residual>,
    mut own: InnerProducts,
    interrupt: &Interrupt,
) -> (InnerProducts, bool) {
    let mut of_step = None;
    loop {
        let asked = f64::from(u8::from(interrupt.is_requested()));
        let mut sums = [own.product, own.former, own.error, own.size, asked];
        comm.sum(&mut sums);
        let [product, former, error, size, asked] = sums;
        let former = *of_step.get_or_insert(former);
        if product >= 0.0 || product.is_nan() || !system.refine_preconditioner() {
            return (InnerProducts { product, former, error, size }, asked > 0.0);
        }
        own = system.measure(iterate.reborrow());
    }
}

impl Linear for Vec<Traceless> {
    fn add(&mut self, factor: f64, other: &Self) {
        change(self, other, |a, &b| *a += b * factor);
    }

    fn scale_add(&mut self, factor: f64, other: &Self) {
        change(self, other, |a, &b| *a = b + *a * factor);
    }
}

impl Linear for Vec<Vector> {
    fn add(&mut self, factor: f64, other: &Self) {
        change(self, other, |a, &b| *a += b * factor);
    }

    fn scale_add(&mut self, factor: f64, other: &Self) {
        change(self, other, |a, &b| *a = b + *a * factor);
    }
}

#[cfg(test)]
mod tests;
