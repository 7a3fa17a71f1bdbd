//! Forces and torques on spheres with magnetic or electric moments.

use super::acting::{Acting, Configuration, Instant, Prediction};
use super::force::{Force, StressName};
use crate::columns::ORIENTATION;
use crate::error::step::StepError;
use crate::model::radii::Radii;
use crate::model::{AppliedField, Model, MomentKind, SphereMoment};
use domain::parallel::{change_rows, of_rows};
use domain::{Comm, ExpectedCounts, Failure, Particles, Quaternion, Tensor, Vector};
use fcm::{DipoleError, DipoleField, DipoleProblem, DipoleSolution, Loads, PlanError, Problem};
use std::cell::RefCell;

/// Steps in a period of the field below which a warning is given.
const FEWEST_STEPS: f64 = 20.0;

/// Forces `c (m . grad) H` and torques `c m x H` on spheres with moments `m` in a field `H`, with the constant `c` of
/// the field.
pub struct DipoleForces {
    kind: MomentKind,
    applied: AppliedField,
    species: Vec<SphereMoment>,
    /// Made by [`Self::start`].
    field: Option<RefCell<DipoleField>>,
}

/// Column of the induced moments, from which the next iteration starts.
pub fn induced_column(kind: MomentKind) -> &'static str {
    match kind {
        MomentKind::Magnetic => "induced magnetic moment",
        MomentKind::Electric => "induced electric moment",
    }
}

/// Scalar with the applied field to which the induced moments belong.
fn field_scalar(kind: MomentKind) -> &'static str {
    match kind {
        MomentKind::Magnetic => "magnetic field of moments",
        MomentKind::Electric => "electric field of moments",
    }
}

/// Permanent moments of this rank's particles, given those of the species.
pub fn permanent(particles: &Particles, species: &[SphereMoment]) -> Vec<Vector> {
    let column = particles.columns.iter().find(|column| column.name == ORIENTATION);
    let orientations: &[Quaternion] = column.map(|c| bytemuck::cast_slice(&c.values)).unwrap_or_default();
    let of_one = |row: usize| match species[particles.species[row] as usize].permanent {
        0.0 => Vector::ZERO,
        moment => orientations[row].axis() * moment,
    };
    of_rows(particles.len(), of_one)
}

/// Induced moments of the last evaluation; none before the first one and without susceptible spheres.
pub fn induced(particles: &Particles, kind: MomentKind) -> &[Vector] {
    let column = particles.columns.iter().find(|column| column.name == induced_column(kind));
    column.map(|column| bytemuck::cast_slice(&column.values)).unwrap_or_default()
}

impl DipoleForces {
    /// The forces of a model, of each kind of moments that it has.
    pub fn of(model: &Model) -> Vec<Self> {
        let of_kind = |kind: MomentKind| {
            let species = model.species.iter().map(|species| kind.of(species)).collect();
            kind.field(model).map(|applied| Self { kind, applied, species, field: None })
        };
        MomentKind::ALL.into_iter().filter_map(of_kind).collect()
    }

    /// These forces on the spheres of a problem.
    pub fn start(self, problem: &Problem, comm: &Comm) -> Result<Self, PlanError> {
        let plan = DipoleField::plan(&self.applied.problem(problem))?;
        Ok(Self { field: Some(RefCell::new(DipoleField::new(&plan, comm))), ..self })
    }

    fn has_induced(&self) -> bool {
        self.species.iter().any(|moment| moment.susceptibility != 0.0)
    }

    /// Moments and fields at present positions. Collective.
    fn solve(&self, at: &Configuration) -> Result<DipoleSolution, Failure> {
        let (particles, species, applied) = (at.particles, &self.species, self.applied.at(at.time));
        let of_row = |row: usize| species[particles.species[row] as usize].polarisability(particles.radii[row]);
        let problem = DipoleProblem {
            field: applied,
            permanent: &permanent(particles, species),
            polarisabilities: &of_rows(particles.len(), of_row),
            guess: &self.guess(particles, applied),
        };
        let field = self.field.as_ref().expect("forces are started before they act");
        let solved = field.borrow_mut().solve(at.domain, particles, &problem);
        let message = |error: DipoleError| format!("{}: {error}", self.kind.name());
        solved.map_err(|error| Failure { rank: 0, ranks: at.domain.comm().size(), message: message(error) })
    }

    /// Induced moments that the iteration starts from: those of the last evaluation, changed with the applied field as
    /// those of single spheres.
    fn guess(&self, particles: &Particles, applied: Vector) -> Vec<Vector> {
        let (known, species) = (induced(particles, self.kind), &self.species);
        let before = particles.scalars.numbers(field_scalar(self.kind)).map_or(Vector::ZERO, Vector::from_array);
        let of_row = |row: usize| {
            let response = species[particles.species[row] as usize].response(particles.radii[row]);
            known.get(row).copied().unwrap_or_default() + (applied - before) * response
        };
        of_rows(particles.len(), of_row)
    }

    fn add(&self, solution: &DipoleSolution, loads: &mut Loads) {
        let (count, constant) = (solution.moments.len(), self.applied.constant);
        loads.forces.resize(count, Vector::ZERO);
        change_rows(&mut loads.forces, |row, force| *force += solution.force(row) * constant);
        if self.species.iter().any(|moment| moment.permanent != 0.0) {
            loads.torques.resize(count, Vector::ZERO);
            change_rows(&mut loads.torques, |row, torque| *torque += solution.torque(row) * constant);
        }
    }
}

impl Force for DipoleForces {
    fn name(&self) -> &'static str {
        self.kind.name()
    }

    fn add_present_loads(&self, at: &Configuration, loads: &mut Loads) {
        // Moments that are not found cause an error where they are asked for first, in an evaluation.
        if let Ok(solution) = self.solve(at) {
            self.add(&solution, loads);
        }
    }

    fn add_loads(&mut self, at: &mut Instant, acting: &mut Acting) -> Result<(), Failure> {
        let solution = self.solve(&at.configuration())?;
        if self.has_induced() {
            at.particles.vectors(induced_column(self.kind)).copy_from_slice(&solution.induced);
            at.particles.scalars.set(field_scalar(self.kind), &self.applied.at(at.time).to_array());
        }
        self.add(&solution, &mut acting.loads);
        Ok(())
    }

    fn stresses(&self) -> Vec<StressName> {
        vec![StressName::general(self.kind.name())]
    }

    fn moments(&self, at: &Configuration, _beyond: Option<&Prediction>) -> Vec<Vec<Tensor>> {
        let Ok(solution) = self.solve(at) else { return Vec::new() };
        let field = self.field.as_ref().expect("forces are started before they act");
        let mut moments = field.borrow_mut().first_moments(at.domain, at.particles, &solution.moments);
        let constant = self.applied.constant;
        change_rows(&mut moments, |row, moment| {
            *moment = (*moment + rotation(solution.torque(row)) * -0.5) * constant;
        });
        vec![moments]
    }

    fn explain(&self, step: u64, source: Failure) -> StepError {
        StepError::Moments { step, source }
    }

    fn numbers(&self, _expected: &ExpectedCounts) -> usize {
        if self.has_induced() { 3 } else { 0 }
    }

    fn warnings(&self, model: &Model, _radii: &Radii) -> Vec<String> {
        let mut warnings = Vec::new();
        let name = self.kind.name();
        if model.repulsion.is_none() && model.contacts.is_none() && !model.hydrodynamics.lubrication {
            warnings.push(format!("[{name}] attracts spheres, and nothing keeps them apart; add [repulsion]"));
        }
        if let Some(frequency) = self.applied.frequency() {
            let steps = std::f64::consts::TAU / (frequency.abs() * model.time_step);
            if steps < FEWEST_STEPS {
                warnings.push(format!(
                    "a period of {name}.frequency has {steps:.1} steps; the motion in it is resolved from about \
                     {FEWEST_STEPS} on: take a shorter time.step"
                ));
            }
        }
        warnings
    }
}

/// The tensor `A` with `A v = T x v`.
fn rotation(torque: Vector) -> Tensor {
    Tensor::from_cols(torque.cross(Vector::X), torque.cross(Vector::Y), torque.cross(Vector::Z))
}

impl AppliedField {
    /// The problem of the moments' field for the spheres of a problem.
    pub fn problem(&self, problem: &Problem) -> Problem {
        Problem { tolerance: self.tolerance.unwrap_or(problem.tolerance), ..problem.clone() }
    }
}
