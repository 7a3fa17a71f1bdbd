//! How the fluid of a scene is to be computed.

use crate::model::{Evaluation, Flow, Model, Multipoles, Start};
use domain::{Comm, Particles, PeriodicBox, Vector};
use fcm::{Costs, Fixed, Loading, MethodName, Plan, PlanError, Problem};

/// The radii that occur, smallest first, and how many particles have each.
#[derive(Debug, Clone, PartialEq)]
pub struct Radii(Vec<(f64, usize)>);

impl Radii {
    /// The radii of the particles of all ranks. Collective.
    pub fn shared(particles: &Particles, comm: &Comm) -> Self {
        let mut radii = particles.radii.clone();
        radii.sort_by(f64::total_cmp);
        let own: Vec<[f64; 2]> =
            radii.chunk_by(|a, b| a.total_cmp(b).is_eq()).map(|equal| [equal[0], equal.len() as f64]).collect();
        let all = comm.all_gather(&own).into_iter().map(|[radius, count]| (radius, count as usize));
        Self::of_kinds(all.collect())
    }

    /// Those of groups, some of which may have one radius.
    fn of_kinds(mut kinds: Vec<(f64, usize)>) -> Self {
        kinds.sort_by(|a, b| a.0.total_cmp(&b.0));
        let merged = |equal: &[(f64, usize)]| (equal[0].0, equal.iter().map(|kind| kind.1).sum());
        Self(kinds.chunk_by(|a, b| a.0.total_cmp(&b.0).is_eq()).map(merged).collect())
    }

    /// The radii of a scene that counts its particles itself; none where a file does.
    pub fn of_model(model: &Model) -> Option<Self> {
        if let Start::Given = model.start {
            return None;
        }
        Some(Self::of_kinds(model.species.iter().map(|s| (s.radius, s.count.unwrap_or(0) as usize)).collect()))
    }

    /// Each radius and how many particles have it.
    pub fn kinds(&self) -> &[(f64, usize)] {
        &self.0
    }

    /// How many particles.
    pub fn count(&self) -> usize {
        self.0.iter().map(|(_, count)| count).sum()
    }

    /// Their volume.
    pub fn volume(&self) -> f64 {
        self.0.iter().map(|(radius, count)| 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3) * *count as f64).sum()
    }

    /// The two smallest, if there are as many.
    pub fn smallest_two(&self) -> Option<[f64; 2]> {
        let mut smallest = self.0.iter().flat_map(|&(radius, count)| std::iter::repeat_n(radius, count.min(2)));
        Some([smallest.next()?, smallest.next()?])
    }

    /// The smallest; infinite without particles.
    pub fn smallest(&self) -> f64 {
        self.0.first().map_or(f64::INFINITY, |(radius, _)| *radius)
    }

    /// The largest.
    pub fn largest(&self) -> f64 {
        self.0.last().map_or(0.0, |(radius, _)| *radius)
    }
}

/// The plan for a scene with particles of these radii. It is made as for one rank with one thread, so that the same
/// scene is computed in the same way, and comes out the same, on any number of them.
pub fn plan(model: &Model, radii: &Radii) -> Result<Plan, PlanError> {
    Plan::choose(&problem(model, radii))
}

/// The same in another box, as where a box follows the spheres.
pub fn plan_in(cell: &PeriodicBox, model: &Model, radii: &Radii) -> Result<Plan, PlanError> {
    Plan::choose(&problem_in(cell, model, radii))
}

/// What [`plan`] plans.
pub fn problem(model: &Model, radii: &Radii) -> Problem {
    problem_in(&model.cell, model, radii)
}

/// What [`plan_in`] plans.
pub fn problem_in(cell: &PeriodicBox, model: &Model, radii: &Radii) -> Problem {
    let (edges, contraction) = edges(cell, model);
    let costs = model.hydrodynamics.costs.map(|[stencils, transforms, pairs]| Costs { stencils, transforms, pairs });
    Problem {
        edges,
        boundaries: model.cell.boundaries(),
        volume: cell.edges().element_product(),
        shortest_vector: model
            .stretched_box()
            .map_or_else(|| cell.edges().min_element(), |extension| extension.shortest_vector(cell)),
        contraction,
        largest_strain: largest_strain(model),
        largest_tilts: model.stretched_box().map_or([0.0; 2], |extension| extension.extremes().tilts),
        radii: radii.0.clone(),
        viscosity: model.viscosity,
        multipoles: match model.hydrodynamics.multipoles {
            Multipoles::Monopole => fcm::Multipoles::Monopole,
            Multipoles::Dipole => fcm::Multipoles::Dipole,
        },
        rigid: true,
        lubricated: model.hydrodynamics.lubrication,
        loading: loading(model),
        tolerance: model.hydrodynamics.tolerance,
        threads: 1,
        ranks: 1,
        costs: costs.unwrap_or_default(),
        fixed: fixed(model),
    }
}

/// Loads of a scene: those of a flow, if there is one; else weights and forces of species, equal on many spheres, which stand in a
/// lattice at most where they do not start at random.
fn loading(model: &Model) -> Loading {
    let is_forced = model.species.iter().any(|s| s.force_on(s.radius, model.gravity) != Vector::ZERO);
    match model.start {
        _ if !matches!(model.flow, Flow::None) => Loading::Flow,
        _ if !is_forced => Loading::Varied,
        Start::Random { .. } | Start::Cloud { .. } => Loading::Uniform,
        Start::Lattice(_) | Start::Positions(_) | Start::Given => Loading::UniformOnLattice,
    }
}

/// The longest edges that the box of a scene will have, and the least part of them that it will.
fn edges(cell: &PeriodicBox, model: &Model) -> (Vector, f64) {
    let edges = cell.edges();
    model.stretched_box().map_or((edges, 1.0), |extension| {
        let extremes = extension.extremes();
        (edges * extremes.longest, extremes.contraction)
    })
}

/// The largest strain that the box of a scene will have.
pub fn largest_strain(model: &Model) -> f64 {
    let edges = model.cell.edges();
    if let Some(extension) = model.stretched_box() {
        return extension.extremes().strain;
    }
    let shears = matches!(model.flow, Flow::Shear { lees_edwards: true, .. });
    if shears { 0.5 * edges.x / edges.y } else { model.cell.strain().abs() }
}

/// What the scene says of the plan.
fn fixed(model: &Model) -> Fixed {
    let chosen = &model.hydrodynamics;
    let method = match chosen.method {
        Evaluation::Auto => None,
        Evaluation::Direct => Some(MethodName::Direct),
        Evaluation::Split => Some(MethodName::Split),
    };
    // Where contacts begin to slide or to stick, motions jump: steps can use no more digits of a solve than are asked for.
    let usual = model.contacts.map(|_| chosen.tolerance);
    let iteration_tolerance = chosen.iteration_tolerance.or(usual);
    Fixed { method, grid: chosen.grid, support: chosen.support, iteration_tolerance, ..Fixed::default() }
}
