//! Forces and torques on spheres with magnetic or electric moments.

use super::acting::{Acting, Configuration, Instant, Prediction};
use super::force::{Force, StressName};
use super::near_dipoles::{NearPolarisation, PolarisedPairs};
use crate::columns::ORIENTATION;
use crate::error::step::StepError;
use crate::model::radii::Radii;
use crate::model::{AppliedField, Model, MomentKind, SphereMoment};
use domain::parallel::{change, change_rows, of_rows};
use domain::{Comm, DomainView, ExpectedCounts, Failure, Particles, PeriodicBox, Quaternion, Tensor, Vector};
use fcm::{DipoleField, DipoleProblem, DipoleSolution, Loads, PlanError, Problem};
use std::cell::{RefCell, RefMut};

/// Steps in a period of the field below which a warning is given.
const FEWEST_STEPS: f64 = 20.0;

/// Forces `c (m . grad) H` and torques `c m x H` on spheres with moments `m` in a field `H`, with the constant `c` of
/// the field, and those of near pairs beyond dipoles.
pub struct DipoleForces {
    kind: MomentKind,
    applied: AppliedField,
    species: Vec<SphereMoment>,
    /// Radii by species.
    radii: Vec<f64>,
    /// Made by [`Self::start`].
    field: Option<FieldOfMoments>,
    near: NearPolarisation,
}

/// Field of the moments, and the problem that it was planned for.
struct FieldOfMoments {
    problem: Problem,
    comm: Comm,
    field: RefCell<DipoleField>,
}

/// Weight of the latest value in the running mean of the share of the extrapolation in guesses.
const NEWEST: f64 = 0.5;

/// Induced moments of the last two evaluations and what they belong to, from which guesses are extrapolated.
struct PastMoments {
    /// Applied fields: the last one, and the one before.
    fields: [Vector; 2],
    /// Their times.
    times: [f64; 2],
    /// Part of the change from one evaluation to the next that a guess takes over.
    share: f64,
}

/// Column of the induced moments, from which the next iteration starts.
pub fn induced_column(kind: MomentKind) -> &'static str {
    match kind {
        MomentKind::Magnetic => "induced magnetic moment",
        MomentKind::Electric => "induced electric moment",
    }
}

/// Column of the induced moments of the evaluation before the last one.
fn past_column(kind: MomentKind) -> &'static str {
    match kind {
        MomentKind::Magnetic => "past magnetic moment",
        MomentKind::Electric => "past electric moment",
    }
}

/// Column of the additional moments of near pairs.
fn near_column(kind: MomentKind) -> &'static str {
    match kind {
        MomentKind::Magnetic => "magnetic moment near contact",
        MomentKind::Electric => "electric moment near contact",
    }
}

/// Scalar with [`PastMoments`].
fn past_scalar(kind: MomentKind) -> &'static str {
    match kind {
        MomentKind::Magnetic => "magnetic field of moments",
        MomentKind::Electric => "electric field of moments",
    }
}

impl PastMoments {
    /// The past moments of a run; none before its first evaluation.
    fn of(particles: &Particles, kind: MomentKind) -> Option<Self> {
        let &[a, b, c, x, y, z, last, before, share] = particles.scalars.get(past_scalar(kind))? else { return None };
        let fields = [Vector::new(a, b, c), Vector::new(x, y, z)];
        Some(Self { fields, times: [last, before], share })
    }

    fn store(&self, particles: &mut Particles, kind: MomentKind) {
        let Self { fields: [f, g], times: [last, before], share } = *self;
        particles.scalars.set(past_scalar(kind), &[f.x, f.y, f.z, g.x, g.y, g.z, last, before, share]);
    }

    /// Time since the last evaluation over that between the last two, at most 2; 0 if there were not two.
    fn ahead(&self, time: f64) -> f64 {
        let [last, before] = self.times;
        if last > before { ((time - last) / (last - before)).clamp(0.0, 2.0) } else { 0.0 }
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

/// Induced moments of the last evaluation, with those of near pairs; zero before the first one.
pub fn induced(particles: &Particles, kind: MomentKind) -> Vec<Vector> {
    let [dipoles, near] = [induced_column, near_column].map(|name| vectors(particles, name(kind)));
    let of = |list: &[Vector], row: usize| list.get(row).copied().unwrap_or_default();
    of_rows(particles.len(), |row| of(dipoles, row) + of(near, row))
}

/// Values of a column; empty if there is none.
fn vectors<'a>(particles: &'a Particles, name: &str) -> &'a [Vector] {
    let column = particles.columns.iter().find(|column| column.name == name);
    column.map(|column| bytemuck::cast_slice(&column.values)).unwrap_or_default()
}

impl DipoleForces {
    /// The forces of a model, of each kind of moments that it has.
    pub fn of(model: &Model) -> Vec<Self> {
        let of_kind = |kind: MomentKind| {
            let species: Vec<_> = model.species.iter().map(|species| kind.of(species)).collect();
            let radii: Vec<f64> = model.species.iter().map(|species| species.radius).collect();
            kind.field(model).map(|applied| {
                let near = NearPolarisation::new(&species, &radii);
                Self { kind, applied, near, species, radii, field: None }
            })
        };
        MomentKind::ALL.into_iter().filter_map(of_kind).collect()
    }

    /// These forces on the spheres of a problem.
    pub fn start(self, problem: &Problem, comm: &Comm) -> Result<Self, PlanError> {
        let problem = self.applied.problem(problem);
        let field = RefCell::new(DipoleField::new(&DipoleField::plan(&problem)?, comm));
        Ok(Self { field: Some(FieldOfMoments { problem, comm: comm.clone(), field }), ..self })
    }

    /// The field of the moments in the present box. Collective.
    fn field_in(&self, domain: DomainView) -> Result<RefMut<'_, DipoleField>, Failure> {
        let field = self.field.as_ref().expect("forces are started before they act");
        field.in_box(domain.cell).map_err(|error| self.failure(domain, &error))
    }

    /// The failure of all ranks by an error.
    fn failure(&self, domain: DomainView, error: &dyn std::error::Error) -> Failure {
        Failure { rank: 0, ranks: domain.comm().size(), message: format!("{}: {error}", self.kind.name()) }
    }

    fn has_induced(&self) -> bool {
        self.species.iter().any(|moment| moment.susceptibility != 0.0)
    }

    /// Moments and fields at present positions, from a [guess](Self::guess). Collective.
    fn solve(&self, at: &Configuration, [guess, _]: &[Vec<Vector>; 2]) -> Result<DipoleSolution, Failure> {
        let (particles, applied) = (at.particles, self.applied.at(at.time));
        let laws: Vec<_> = self.spheres().map(|(moment, radius)| moment.magnetisation(radius)).collect();
        let law = |row: usize| laws[particles.species[row] as usize];
        let problem = DipoleProblem {
            field: applied,
            permanent: &permanent(particles, &self.species),
            polarisabilities: &of_rows(particles.len(), |row| law(row).polarisability),
            saturations: &of_rows(particles.len(), |row| law(row).saturation),
            guess,
        };
        let solved = self.field_in(at.domain)?.solve(at.domain, particles, &problem);
        solved.map_err(|error| self.failure(at.domain, &error))
    }

    /// Moments and fields at present positions. Collective.
    fn solve_afresh(&self, at: &Configuration) -> Result<DipoleSolution, Failure> {
        self.solve(at, &self.guess(at.particles, at.time))
    }

    /// Moments and radii by species.
    fn spheres(&self) -> impl Iterator<Item = (&SphereMoment, f64)> {
        self.species.iter().zip(self.radii.iter().copied())
    }

    /// Induced moments of single spheres in an applied field, by species.
    fn alone(&self, field: Vector) -> Vec<Vector> {
        self.spheres().map(|(moment, radius)| moment.moment_alone(radius, field)).collect()
    }

    /// Induced moments that the iteration starts from, and the part of them that is extrapolated, before it is reduced
    /// to its share. What single spheres have in the applied field follows it; the rest, which is due to the others,
    /// continues its change between the last two evaluations.
    fn guess(&self, particles: &Particles, time: f64) -> [Vec<Vector>; 2] {
        let [last, before] = [induced_column, past_column].map(|name| vectors(particles, name(self.kind)));
        let past = PastMoments::of(particles, self.kind).filter(|_| last.len() == particles.len());
        let now = self.alone(self.applied.at(time));
        let of = |alone: &[Vector], row: usize| alone[particles.species[row] as usize];
        let Some(past) = past else {
            return [of_rows(particles.len(), |row| of(&now, row)), vec![Vector::ZERO; particles.len()]];
        };
        let [alone, alone_before] = past.fields.map(|field| self.alone(field));
        let ahead = if before.len() == last.len() { past.ahead(time) } else { 0.0 };
        let change = |row: usize| {
            if ahead == 0.0 {
                return Vector::ZERO;
            }
            (last[row] - before[row] - (of(&alone, row) - of(&alone_before, row))) * ahead
        };
        let changes = of_rows(particles.len(), change);
        let guess = |row: usize| last[row] + (of(&now, row) - of(&alone, row)) + changes[row] * past.share;
        [of_rows(particles.len(), guess), changes]
    }

    /// Stores the induced moments of an evaluation, and the share of the extrapolation with which its guess would have
    /// come closest to them. Collective.
    fn remember(&self, at: &mut Instant, induced: &[Vector], [guess, changes]: &[Vec<Vector>; 2]) {
        let (kind, time, applied) = (self.kind, at.time, self.applied.at(at.time));
        let known = PastMoments::of(at.particles, kind);
        let mut past = known.unwrap_or(PastMoments { fields: [applied; 2], times: [time; 2], share: 1.0 });
        let mut sums = [0.0; 2];
        for ((found, guess), change) in induced.iter().zip(guess).zip(changes) {
            sums[0] += (*found - *guess).dot(*change);
            sums[1] += change.length_squared();
        }
        at.domain.comm().sum(&mut sums);
        if sums[1] > 0.0 {
            let best = (past.share + sums[0] / sums[1]).clamp(0.0, 1.0);
            past.share += NEWEST * (best - past.share);
        }
        if time > past.times[0] {
            let last = vectors(at.particles, induced_column(kind)).to_vec();
            at.particles.vectors(past_column(kind)).copy_from_slice(&last);
            (past.times[1], past.fields[1]) = (past.times[0], past.fields[0]);
        }
        (past.times[0], past.fields[0]) = (time, applied);
        past.store(at.particles, kind);
        at.particles.vectors(induced_column(kind)).copy_from_slice(induced);
    }

    /// Near pairs in the applied field; `None` without polarisable spheres. Collective.
    fn near_pairs<'a>(&self, at: &Configuration<'a>) -> Option<PolarisedPairs<'a>> {
        self.near.reach()?;
        at.near.map(|near| self.near.in_field(near, &at.particles.species, self.applied.at(at.time)))
    }

    fn add(&self, solution: &DipoleSolution, near: Option<&PolarisedPairs>, loads: &mut Loads) {
        let (count, constant) = (solution.moments.len(), self.applied.constant);
        loads.forces.resize(count, Vector::ZERO);
        change_rows(&mut loads.forces, |row, force| *force += solution.force(row) * constant);
        if let Some(near) = near {
            change(&mut loads.forces, &near.forces(), |force, &more| *force += more * constant);
        }
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
        if let Ok(solution) = self.solve_afresh(at) {
            self.add(&solution, self.near_pairs(at).as_ref(), loads);
        }
    }

    fn add_loads(&mut self, at: &mut Instant, acting: &mut Acting) -> Result<(), Failure> {
        let guess = self.guess(at.particles, at.time);
        let solution = self.solve(&at.configuration(), &guess)?;
        let near = self.near_pairs(&at.configuration());
        let moments = near.as_ref().map(PolarisedPairs::moments);
        self.add(&solution, near.as_ref(), &mut acting.loads);
        drop(near);
        if let Some(moments) = moments {
            at.particles.vectors(near_column(self.kind)).copy_from_slice(&moments);
        }
        if self.has_induced() {
            self.remember(at, &solution.induced, &guess);
        }
        Ok(())
    }

    fn range(&self, _largest_radius: f64) -> Option<f64> {
        self.near.reach()
    }

    fn stresses(&self) -> Vec<StressName> {
        vec![StressName::general(self.kind.name())]
    }

    fn moments(&self, at: &Configuration, _beyond: Option<&Prediction>) -> Vec<Vec<Tensor>> {
        let Ok(solution) = self.solve_afresh(at) else { return Vec::new() };
        let Ok(mut field) = self.field_in(at.domain) else { return Vec::new() };
        let mut moments = field.first_moments(at.domain, at.particles, &solution.moments);
        if let Some(near) = self.near_pairs(at) {
            change(&mut moments, &near.first_moments(), |moment, &more| *moment += more);
        }
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
        if self.has_induced() { 9 } else { 0 }
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

impl FieldOfMoments {
    /// The field in a box, planned again if the edges have changed, as where the box follows the spheres. Collective.
    fn in_box(&self, cell: &PeriodicBox) -> Result<RefMut<'_, DipoleField>, PlanError> {
        let mut field = self.field.borrow_mut();
        if !field.fits(cell) {
            let plan = DipoleField::plan(&self.problem.in_box(cell))?;
            *field = DipoleField::new(&plan, &self.comm);
        }
        Ok(field)
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
