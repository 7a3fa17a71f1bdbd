//! Magnetic or electric moments of the spheres.

mod induced;
mod magnetisation;
mod redistribution;

use crate::conjugate_gradients::IterationOutcome;
use crate::mobility::MomentFarField;
use crate::plan::problem::{Fixed, Loading, Multipoles, Problem};
use crate::plan::{Plan, PlanError};
use domain::parallel::{all_rows, of_rows};
use domain::{Boundaries, Comm, DomainView, Number, Particles, Partition, PeriodicBox, Tensor, Vector};
use induced::InducedMoments;
pub use magnetisation::Magnetisation;
use redistribution::Elsewhere;

/// Field of moments in a periodic box or in open space, averaged over the spheres (Climent, Maxey & Karniadakis,
/// Langmuir 20, 507, 2004; Keaveny & Maxey, J. Comput. Phys. 227, 9554, 2008).
///
/// A sphere of radius `a` at `Y` has the magnetisation `m Delta'(x - Y)`, with the Gaussian envelope of the dipoles of
/// its flow, of width `a / (6 sqrt(pi))^(1/3)`. With it the field of a single sphere, averaged over its own envelope,
/// is that within a uniformly magnetised sphere, `-m / (4 pi a^3)`. The field is `H = H_0 - grad phi` with
/// `lap phi = div M`: for a wavevector `k`, `H(k) = -k (k . M(k)) / k^2`, and its average over the box is the applied
/// field `H_0`, as in a needle along it. Averaged over the spheres it is `H_0 - K m`, with `K` symmetric and positive
/// semi-definite; gradients are averaged in the same way. Forces and torques are those of an energy: with the constant
/// `mu_0` of the units, `F = mu_0 (m . grad) H` and `T = mu_0 m x H`.
///
/// Results have the error of the plan relative to the field of a sphere's own moment. Methods are collective. Positions
/// are inside the box; particles may be divided among the ranks by any partition.
pub struct DipoleField {
    plan: Plan,
    partition: Partition,
    far: MomentFarField,
}

/// Moments to find in an applied field.
#[derive(Debug, Clone, Copy)]
pub struct DipoleProblem<'a> {
    /// Applied field `H_0`, the average over the box.
    pub field: Vector,
    /// Permanent moments of this rank's spheres.
    pub permanent: &'a [Vector],
    /// Ratio of a sphere's induced moment to the field in it, `4/3 pi a^3 chi` with the susceptibility `chi`; 0 for a
    /// sphere without an induced moment. All that are not zero have the same sign on all ranks.
    pub polarisabilities: &'a [f64],
    /// Largest induced moments, see [`Magnetisation`], infinite for moments in proportion to the field, whatever its
    /// size; or none, if all are. Spheres with a largest moment have positive polarisabilities.
    pub saturations: &'a [f64],
    /// Induced moments from which the iteration starts, or none.
    pub guess: &'a [Vector],
}

/// Moments of the spheres, and the field that they are in.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DipoleSolution {
    /// Induced moments.
    pub induced: Vec<Vector>,
    /// Permanent and induced moments.
    pub moments: Vec<Vector>,
    /// Fields, the applied field included, averaged over the spheres.
    pub fields: Vec<Vector>,
    /// Gradients of the field; column `c` is the derivative along `c`.
    pub gradients: Vec<Tensor>,
    /// Iterations for the induced moments.
    pub iterations: usize,
}

impl DipoleProblem<'_> {
    /// Law of a sphere's induced moment.
    fn law(&self, row: usize) -> Magnetisation {
        let saturation = self.saturations.get(row).copied().unwrap_or(f64::INFINITY);
        Magnetisation { polarisability: self.polarisabilities[row], saturation }
    }
}

impl DipoleSolution {
    /// Force on a sphere over `mu_0`, `(m . grad) H`.
    pub fn force(&self, row: usize) -> Vector {
        self.gradients[row] * self.moments[row]
    }

    /// Torque on a sphere over `mu_0`, `m x H`. Only a permanent moment has one: an induced one is along the field.
    pub fn torque(&self, row: usize) -> Vector {
        (self.moments[row] - self.induced[row]).cross(self.fields[row])
    }
}

/// Reason why moments are not found.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum DipoleError {
    /// The iteration did not converge.
    #[error(
        "the induced moments did not converge in {iterations} iterations: their relative error is {residual:.1e}, and \
         {tolerance:.1e} is asked for; a larger tolerance or a smaller susceptibility may help"
    )]
    NotConverged {
        /// Number of iterations.
        iterations: usize,
        /// Relative error left.
        residual: f64,
        /// Relative error asked for.
        tolerance: f64,
    },
    /// Some moments or fields are not finite.
    #[error("the field of the moments is not finite, at a largest position of {}", Number(*.0))]
    NotFinite(f64),
}

impl DipoleField {
    /// The plan for moments of the spheres of a problem; what the problem says about the flow does not matter.
    pub fn plan(problem: &Problem) -> Result<Plan, PlanError> {
        Plan::choose(&Problem {
            viscosity: 1.0,
            multipoles: Multipoles::Moments,
            rigid: false,
            lubricated: false,
            loading: Loading::Varied,
            fixed: Fixed::default(),
            ..problem.clone()
        })
    }

    /// Sets up the field for a plan of [`Self::plan`].
    pub fn new(plan: &Plan, comm: &Comm) -> Self {
        let partition = Partition::new(comm, [plan.grid[1], plan.grid[2]]);
        Self { far: MomentFarField::of_moments(plan, &partition), partition, plan: plan.clone() }
    }

    /// Whether the plan is for a box: other than a periodic one, a box in open space needs the edges of the plan.
    pub fn fits(&self, cell: &PeriodicBox) -> bool {
        self.plan.boundaries == Boundaries::Periodic || self.plan.edges == cell.edges()
    }

    /// Fields `-K m` of given moments, averaged over the spheres, without the applied field.
    pub fn fields(&mut self, domain: DomainView, particles: &Particles, moments: &[Vector]) -> Vec<Vector> {
        let place = Elsewhere::new(&self.partition, domain, particles, &[moments]);
        self.arrange(domain.cell, &place.particles);
        let fields = self.far.fields(&place.vectors(0), false);
        place.back(of_rows(fields.len(), |row| fields[row].0))
    }

    /// Moments in an applied field, and the field. Fails on every rank or on none.
    pub fn solve(
        &mut self,
        domain: DomainView,
        particles: &Particles,
        problem: &DipoleProblem,
    ) -> Result<DipoleSolution, DipoleError> {
        let (zeros, polarisable) = (vec![Vector::ZERO; particles.len()], problem.polarisabilities);
        let guess = if problem.guess.len() == particles.len() { problem.guess } else { &zeros };
        let alone = of_rows(particles.len(), |row| Vector::new(polarisable[row], problem.law(row).saturation, 0.0));
        let place = Elsewhere::new(&self.partition, domain, particles, &[problem.permanent, guess, &alone]);
        self.arrange(domain.cell, &place.particles);
        let [permanent, guess, alone] = [0, 1, 2].map(|list| place.vectors(list));
        let [polarisabilities, saturations] = [0, 1].map(|c| of_rows(alone.len(), |row| alone[row][c]));
        let problem = DipoleProblem {
            field: problem.field,
            permanent: &permanent,
            polarisabilities: &polarisabilities,
            saturations: &saturations,
            guess: &guess,
        };
        let solution = self.solve_here(&place.particles, &problem)?;
        Ok(DipoleSolution {
            induced: place.back(solution.induced),
            moments: place.back(solution.moments),
            fields: place.back(solution.fields),
            gradients: place.back(solution.gradients),
            iterations: solution.iterations,
        })
    }

    /// The same for particles that the grid's partition divides among the ranks.
    fn solve_here(&mut self, particles: &Particles, problem: &DipoleProblem) -> Result<DipoleSolution, DipoleError> {
        let InducedMoments { moments: induced, fields: found, outcome } = self.induced(&particles.radii, problem);
        let moments = of_rows(induced.len(), |row| problem.permanent[row] + induced[row]);
        let finite = all_rows(found.len(), |row| found[row].0.is_finite() && moments[row].is_finite());
        let IterationOutcome { iterations, residual, converged, .. } = outcome;
        if self.partition.comm().any(!finite || !residual.is_finite()) {
            let mut farthest = [particles.positions.iter().fold(0.0, |most: f64, x| most.max(x.abs().max_element()))];
            self.partition.comm().max(&mut farthest);
            return Err(DipoleError::NotFinite(farthest[0]));
        }
        if !converged {
            return Err(DipoleError::NotConverged { iterations, residual, tolerance: self.plan.iteration_tolerance });
        }
        let fields = of_rows(found.len(), |row| found[row].0 + problem.field);
        let gradients = of_rows(found.len(), |row| found[row].1);
        Ok(DipoleSolution { induced, moments, fields, gradients, iterations })
    }

    /// Contributions of the spheres to the derivative of the energy over `mu_0`, `m . K m / 2`, with respect to a
    /// deformation `e_ab` of the lattice and of the positions, `x -> x + e x`, at constant moments: the first moment of
    /// the forces between moments, `-(x_i - x_j)_b F_a` for a pair, in column `b`.
    pub fn first_moments(&mut self, domain: DomainView, particles: &Particles, moments: &[Vector]) -> Vec<Tensor> {
        let place = Elsewhere::new(&self.partition, domain, particles, &[moments]);
        self.arrange(domain.cell, &place.particles);
        place.back(self.far.first_moments(&place.vectors(0)))
    }

    /// Evaluations of the field so far.
    pub fn evaluations(&self) -> u64 {
        self.far.work().evaluations
    }

    fn arrange(&mut self, cell: &PeriodicBox, particles: &Particles) {
        if self.partition.comm().any(!self.far.has_arranged(cell, particles)) {
            self.far.arrange_particles(cell, particles);
        }
    }
}
