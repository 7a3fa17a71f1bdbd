//! Induced moments.

use super::magnetisation::{LinearLaw, Magnetisation};
use super::{DipoleField, DipoleProblem};
use crate::conjugate_gradients::{Iterate, IterationOutcome, Limits, System, conjugate_gradients};
use crate::mobility::MomentFarField;
use domain::parallel::{change, of_rows};
use domain::{Comm, Interrupt, Tensor, Vector};
use std::f64::consts::PI;

/// Largest number of iterations of a linear system.
const MOST_ITERATIONS: usize = 500;

/// Largest number of linearisations.
const MOST_TANGENTS: usize = 300;

/// Result of the iteration.
pub(super) struct InducedMoments {
    pub moments: Vec<Vector>,
    /// Fields by all moments and their gradients, averaged over the spheres, without the applied field.
    pub fields: Vec<(Vector, Tensor)>,
    pub outcome: IterationOutcome,
}

impl DipoleField {
    /// Induced moments `q` of arranged spheres with permanent moments `p` in the applied field `H_0`, by the laws of
    /// their [`Magnetisation`]. With the tangent `T` of a law `m(h)` at a field `g`,
    ///
    /// ```text
    /// T^-1 q + K q = H_0 - K p + T^-1 m(g) - g.
    /// ```
    ///
    /// The last two terms cancel for moments in proportion to the field, which take a single step of this iteration,
    /// Newton's. A step that is no better than the former is followed by some in which moments are in proportion to the
    /// field with their present ratio, which never raise the energy.
    ///
    /// With positive polarisabilities the matrix is positive definite. Negative ones are above `-4/3 pi a^3`, where
    /// minus the matrix is. Fields follow the iteration, so that it takes one evaluation besides those of its steps;
    /// the last correction of the moments, the preconditioned residual, is within the tolerance. Collective.
    pub(super) fn induced(&mut self, radii: &[f64], problem: &DipoleProblem) -> InducedMoments {
        let comm = self.partition.comm().clone();
        let guess = |row: usize| if problem.polarisabilities[row] == 0.0 { Vector::ZERO } else { problem.guess[row] };
        let induced = of_rows(radii.len(), guess);
        let moments = of_rows(radii.len(), |row| problem.permanent[row] + induced[row]);
        let fields = self.far.fields(&moments, true);
        let outcome = IterationOutcome { iterations: 0, residual: 0.0, converged: true, interrupted: false };
        let start = InducedMoments { moments: induced, fields, outcome };
        if !comm.any(problem.polarisabilities.iter().any(|alpha| *alpha != 0.0)) {
            return start;
        }
        let spheres = PolarisableSpheres::new(radii, problem, &comm);
        let tolerance = self.plan.iteration_tolerance;
        if comm.any(spheres.laws.iter().any(Magnetisation::saturates)) {
            return self.saturating(&spheres, start, tolerance);
        }
        let linear = spheres.linearised(&start.fields, true);
        self.linear(&spheres, &linear, start, tolerance).corrected()
    }

    /// The moments by laws that bend.
    fn saturating(&mut self, spheres: &PolarisableSpheres, start: InducedMoments, tolerance: f64) -> InducedMoments {
        let (mut found, mut search) = (Corrected::none(start), TangentSearch::default());
        let mut iterations = 0;
        for _ in 0..MOST_TANGENTS {
            let linear = spheres.linearised(&found.uncorrected.fields, search.is_tangent());
            let is_coarse = search.needed() > tolerance;
            let within = if is_coarse { search.needed() } else { tolerance };
            found = self.linear(spheres, &linear, found.uncorrected, within);
            let bent = spheres.bend(&linear, &found.uncorrected, self.partition.comm());
            let outcome = &mut found.uncorrected.outcome;
            iterations += outcome.iterations;
            let is_found = !is_coarse && bent <= tolerance;
            *outcome = IterationOutcome {
                iterations,
                residual: outcome.residual.max(bent),
                converged: outcome.converged && is_found,
                ..*outcome
            };
            if is_found {
                break;
            }
            search.advance(bent);
        }
        found.corrected()
    }

    /// The moments by linear laws.
    fn linear(
        &mut self,
        spheres: &PolarisableSpheres,
        linear: &[LinearLaw],
        start: InducedMoments,
        tolerance: f64,
    ) -> Corrected {
        let InducedMoments { moments: mut induced, fields, .. } = start;
        let mut residual =
            of_rows(induced.len(), |row| spheres.residual(row, &linear[row], induced[row], fields[row].0));
        let mut z = Vec::new();
        let iterate = Iterate { x: &mut induced, residual: &mut residual, z: &mut z };
        let limits = Limits { tolerance, iterations: MOST_ITERATIONS, interrupt: &Interrupt::NEVER };
        let mut system = Induction { far: &mut self.far, spheres, linear, fields, step: Vec::new() };
        let outcome = conjugate_gradients(self.partition.comm(), &mut system, iterate, limits);
        let fields = system.fields;
        Corrected { uncorrected: InducedMoments { moments: induced, fields, outcome }, correction: z }
    }
}

/// Choice between tangents, which converge fast nearby, and moments in proportion to the field, which converge always.
#[derive(Default)]
struct TangentSearch {
    /// Error of the last linear laws; 0 before the first ones.
    last: f64,
    /// Error below which tangents are tried again after a step by them that was not better.
    trusted: Option<f64>,
}

impl TangentSearch {
    fn is_tangent(&self) -> bool {
        self.trusted.is_none()
    }

    /// Error that a linear system may have.
    fn needed(&self) -> f64 {
        0.02 * self.last.min(1.0)
    }

    fn advance(&mut self, bent: f64) {
        self.trusted = match self.trusted {
            None if self.last > 0.0 && bent > 0.5 * self.last => Some(0.1 * self.last.min(bent)),
            None => None,
            Some(trusted) => Some(trusted).filter(|&trusted| bent > trusted),
        };
        self.last = bent;
    }
}

/// Moments to which the fields belong, and their last correction.
struct Corrected {
    uncorrected: InducedMoments,
    correction: Vec<Vector>,
}

impl Corrected {
    fn none(uncorrected: InducedMoments) -> Self {
        Self { uncorrected, correction: Vec::new() }
    }

    fn corrected(mut self) -> InducedMoments {
        change(&mut self.uncorrected.moments, &self.correction, |moment, &correction| *moment += correction);
        self.uncorrected
    }
}

/// The spheres in the applied field.
struct PolarisableSpheres {
    applied: Vector,
    laws: Vec<Magnetisation>,
    /// `s / (4 pi a^3)` with the sign `s` of the polarisabilities.
    own: Vec<f64>,
    sign: f64,
}

impl PolarisableSpheres {
    fn new(radii: &[f64], problem: &DipoleProblem, comm: &Comm) -> Self {
        let is_negative = comm.any(problem.polarisabilities.iter().any(|alpha| *alpha < 0.0));
        let sign = if is_negative { -1.0 } else { 1.0 };
        let own = of_rows(radii.len(), |row| sign / (4.0 * PI * radii[row].powi(3)));
        Self { applied: problem.field, laws: of_rows(radii.len(), |row| problem.law(row)), own, sign }
    }

    fn has_moment(&self, row: usize) -> bool {
        self.laws[row].polarisability != 0.0
    }

    /// The laws near given fields by moments.
    fn linearised(&self, fields: &[(Vector, Tensor)], is_tangent: bool) -> Vec<LinearLaw> {
        let of_row = |row: usize| self.laws[row].linearised(self.applied + fields[row].0, is_tangent);
        of_rows(fields.len(), |row| if self.has_moment(row) { of_row(row) } else { LinearLaw::NONE })
    }

    /// Residual of a moment in a field by all moments; zero without an induced moment.
    fn residual(&self, row: usize, law: &LinearLaw, moment: Vector, field: Vector) -> Vector {
        let inside = (self.applied + field + law.offset) * self.sign;
        if self.has_moment(row) { inside - law.field(moment) } else { Vector::ZERO }
    }

    /// Difference between the moments by the laws and by their linearisations, over the moments. Collective.
    fn bend(&self, linear: &[LinearLaw], found: &InducedMoments, comm: &Comm) -> f64 {
        let mut sums = [0.0; 2];
        for row in (0..linear.len()).filter(|&row| self.has_moment(row)) {
            let (law, own, inside) = (&linear[row], self.own[row], self.applied + found.fields[row].0);
            let moment = self.laws[row].moment(inside);
            sums[0] += law.size(moment - law.alone(inside + law.offset, 0.0), own);
            sums[1] += law.size(moment, own);
        }
        comm.sum(&mut sums);
        if sums[1] > 0.0 { (sums[0] / sums[1]).sqrt() } else { 0.0 }
    }
}

/// The system `T^-1 q + s K q`, with the sign `s` of the polarisabilities.
struct Induction<'a> {
    far: &'a mut MomentFarField,
    spheres: &'a PolarisableSpheres,
    linear: &'a [LinearLaw],
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
        let Self { spheres, linear, step, .. } = self;
        let of_row = |row: usize| linear[row].field(direction[row]) - step[row].0 * spheres.sign;
        of_rows(step.len(), |row| if spheres.has_moment(row) { of_row(row) } else { Vector::ZERO })
    }

    fn on_step(&mut self, length: f64) {
        change(&mut self.fields, &self.step, |sum, step| {
            *sum = (sum.0 + step.0 * length, sum.1 + step.1 * length);
        });
    }

    fn precondition(&mut self, residual: &Vec<Vector>) -> Vec<Vector> {
        let Self { spheres, linear, .. } = self;
        let of_row = |row: usize| linear[row].alone(residual[row], spheres.own[row]);
        of_rows(residual.len(), |row| if spheres.has_moment(row) { of_row(row) } else { Vector::ZERO })
    }

    fn size(&self, x: &Vec<Vector>) -> f64 {
        let of_row = |row: usize| self.linear[row].size(x[row], self.spheres.own[row]);
        (0..x.len()).filter(|&row| self.spheres.has_moment(row)).map(of_row).sum()
    }
}
