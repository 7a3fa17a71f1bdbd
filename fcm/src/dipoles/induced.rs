//! Induced moments.

use super::{DipoleField, DipoleProblem};
use crate::conjugate_gradients::{Iterate, IterationOutcome, Limits, System, conjugate_gradients};
use crate::mobility::GridFarField;
use domain::parallel::{change, of_rows};
use domain::{Interrupt, Tensor, Vector};
use std::f64::consts::PI;

/// Largest number of iterations.
const MOST_ITERATIONS: usize = 500;

/// Result of the iteration.
pub(super) struct InducedMoments {
    pub moments: Vec<Vector>,
    /// Fields by all moments and their gradients, averaged over the spheres, without the applied field.
    pub fields: Vec<(Vector, Tensor)>,
    pub outcome: IterationOutcome,
}

impl DipoleField {
    /// Induced moments `q` of arranged spheres with permanent moments `p` in the applied field `H_0`. The moment of a
    /// sphere with the polarisability `alpha` is `alpha` times the field in it, so
    ///
    /// ```text
    /// q / alpha + K q = H_0 - K p.
    /// ```
    ///
    /// With positive polarisabilities the matrix is positive definite. Negative ones are above `-4/3 pi a^3`, where
    /// minus the matrix is. Fields follow the iteration, so that it takes one evaluation besides those of its steps;
    /// the last correction of the moments, the preconditioned residual, is within the tolerance. Collective.
    pub(super) fn induced(&mut self, radii: &[f64], problem: &DipoleProblem) -> InducedMoments {
        let comm = self.partition.comm().clone();
        let polarisabilities = problem.polarisabilities;
        let mut induced =
            of_rows(radii.len(), |row| if polarisabilities[row] == 0.0 { Vector::ZERO } else { problem.guess[row] });
        let moments = of_rows(radii.len(), |row| problem.permanent[row] + induced[row]);
        let fields = self.far.fields(&moments, true);
        if !comm.any(polarisabilities.iter().any(|alpha| *alpha != 0.0)) {
            let outcome = IterationOutcome { iterations: 0, residual: 0.0, converged: true, interrupted: false };
            return InducedMoments { moments: induced, fields, outcome };
        }
        let is_negative = comm.any(polarisabilities.iter().any(|alpha| *alpha < 0.0));
        let spheres = Polarisable::new(radii, polarisabilities, if is_negative { -1.0 } else { 1.0 });
        let mut residual = of_rows(radii.len(), |row| spheres.image(row, -induced[row], problem.field + fields[row].0));
        let mut z = Vec::new();
        let iterate = Iterate { x: &mut induced, residual: &mut residual, z: &mut z };
        let tolerance = self.plan.iteration_tolerance;
        let limits = Limits { tolerance, iterations: MOST_ITERATIONS, interrupt: &Interrupt::NEVER };
        let mut system = Induction { far: &mut self.far, spheres, fields, step: Vec::new() };
        let outcome = conjugate_gradients(&comm, &mut system, iterate, limits);
        let fields = system.fields;
        change(&mut induced, &z, |moment, &correction| *moment += correction);
        InducedMoments { moments: induced, fields, outcome }
    }
}

/// Coefficients of the system by sphere.
struct Polarisable {
    /// Sign `s` of the polarisabilities.
    sign: f64,
    /// `1 / |alpha|`.
    inverse: Vec<f64>,
    /// Inverse of the diagonal for single spheres; 0 without an induced moment.
    scale: Vec<f64>,
}

impl Polarisable {
    fn new(radii: &[f64], polarisabilities: &[f64], sign: f64) -> Self {
        let inverse: Vec<f64> = polarisabilities.iter().map(|alpha| alpha.abs().recip()).collect();
        let diagonal = |row: usize| inverse[row] + sign / (4.0 * PI * radii[row].powi(3));
        let scale = of_rows(radii.len(), |row| if polarisabilities[row] == 0.0 { 0.0 } else { 1.0 / diagonal(row) });
        Self { sign, inverse, scale }
    }

    /// `q / |alpha| + s h` for a moment and a field; zero without an induced moment.
    fn image(&self, row: usize, moment: Vector, field: Vector) -> Vector {
        if self.scale[row] == 0.0 { Vector::ZERO } else { moment * self.inverse[row] + field * self.sign }
    }
}

/// The system `|alpha|^-1 q + s K q`, with the sign `s` of the polarisabilities.
struct Induction<'a> {
    far: &'a mut GridFarField,
    spheres: Polarisable,
    /// Fields by the moments of the iterate, and their gradients.
    fields: Vec<(Vector, Tensor)>,
    /// The same by those of the last direction.
    step: Vec<(Vector, Tensor)>,
}

impl System for Induction<'_> {
    type Unknowns = Vec<Vector>;
    type Residual = Vec<Vector>;

    fn product(&self, residual: &Vec<Vector>, x: &Vec<Vector>) -> f64 {
        residual.iter().zip(x).map(|(r, x)| r.dot(*x)).sum()
    }

    fn apply(&mut self, direction: &Vec<Vector>) -> Vec<Vector> {
        self.step = self.far.fields(direction, true);
        let (fields, spheres) = (&self.step, &self.spheres);
        of_rows(fields.len(), |row| spheres.image(row, direction[row], -fields[row].0))
    }

    fn on_step(&mut self, length: f64) {
        change(&mut self.fields, &self.step, |sum, step| {
            *sum = (sum.0 + step.0 * length, sum.1 + step.1 * length);
        });
    }

    fn precondition(&mut self, residual: &Vec<Vector>) -> Vec<Vector> {
        let scale = &self.spheres.scale;
        of_rows(residual.len(), |row| residual[row] * scale[row])
    }

    fn size(&self, x: &Vec<Vector>) -> f64 {
        let of_one = |(x, scale): (&Vector, &f64)| if *scale == 0.0 { 0.0 } else { x.length_squared() / scale };
        x.iter().zip(&self.spheres.scale).map(of_one).sum()
    }
}
