//! Plan of the far field of a scene.

use crate::model::radii::Radii;
use crate::model::{Flow, Model, MomentKind, MultipoleOrder, Start};
use domain::{PeriodicBox, Vector};
use fcm::{Costs, DipoleField, Fixed, Loading, Plan, PlanError, Problem};

/// The plan for a scene with particles of these radii. It is made for one rank with one thread, so that the same scene
/// is computed in the same way, with the same results, on any number of them.
pub fn plan(model: &Model, radii: &Radii) -> Result<Plan, PlanError> {
    Plan::choose(&problem(model, radii))
}

/// The plan in another box, for boxes that follow the spheres.
pub fn plan_in(cell: &PeriodicBox, model: &Model, radii: &Radii) -> Result<Plan, PlanError> {
    Plan::choose(&problem_in(cell, model, radii))
}

/// The problem that [`plan`] solves.
pub fn problem(model: &Model, radii: &Radii) -> Problem {
    problem_in(&model.cell, model, radii)
}

/// The problem that [`plan_in`] solves.
pub fn problem_in(cell: &PeriodicBox, model: &Model, radii: &Radii) -> Problem {
    let (edges, smallest_edge_ratio) = edges(cell, model);
    let costs = model.hydrodynamics.costs.map(|[stencils, transforms, pairs]| Costs { stencils, transforms, pairs });
    Problem {
        edges,
        boundaries: model.cell.boundaries(),
        volume: cell.edges().element_product(),
        shortest_vector: model
            .stretched_box()
            .map_or_else(|| cell.edges().min_element(), |extension| extension.shortest_vector(cell)),
        smallest_edge_ratio,
        largest_strain: largest_strain(model),
        largest_tilts: model.stretched_box().map_or([0.0; 2], |extension| extension.extremes().tilts),
        radii: radii.0.clone(),
        viscosity: model.viscosity,
        multipoles: match model.hydrodynamics.multipoles {
            MultipoleOrder::Monopole => fcm::Multipoles::Monopole,
            MultipoleOrder::Dipole => fcm::Multipoles::Dipole,
        },
        rigid: true,
        lubricated: model.hydrodynamics.lubrication,
        loading: loading(model),
        tolerance: model.hydrodynamics.tolerance,
        threads: 1,
        ranks: 1,
        costs: costs.unwrap_or_default(),
        network: model.hydrodynamics.network,
        fixed: fixed(model),
    }
}

/// Plans of the fields of moments of a scene, as far as there are any.
pub fn dipole_plans(model: &Model, radii: &Radii) -> Vec<Plan> {
    let problem = problem(model, radii);
    let fields = MomentKind::ALL.into_iter().filter_map(|kind| kind.field(model));
    fields.filter_map(|field| DipoleField::plan(&field.problem(&problem)).ok()).collect()
}

/// Loading of a scene: that of a flow, if there is one; otherwise forces that are uniform for each species. Spheres
/// that do not start at random may form a lattice.
fn loading(model: &Model) -> Loading {
    let is_forced = model.species.iter().any(|s| s.force_on(s.radius, model.gravity) != Vector::ZERO);
    let is_flowing = !matches!(model.flow, Flow::None);
    match model.start {
        _ if model.has_swimmers() && (is_flowing || !is_forced) => Loading::Swimming,
        _ if is_flowing => Loading::Flow,
        _ if !is_forced => Loading::Varied,
        Start::Random { .. } | Start::Cloud { .. } => Loading::Uniform,
        Start::Lattice(_) | Start::Positions(_) | Start::Given => Loading::UniformOnLattice,
    }
}

/// Longest edges of the box at any time, and the smallest factor by which one of them contracts.
fn edges(cell: &PeriodicBox, model: &Model) -> (Vector, f64) {
    let edges = cell.edges();
    model.stretched_box().map_or((edges, 1.0), |extension| {
        let extremes = extension.extremes();
        (edges * extremes.longest, extremes.contraction)
    })
}

/// Largest strain of the box of a scene at any time.
pub fn largest_strain(model: &Model) -> f64 {
    let edges = model.cell.edges();
    if let Some(extension) = model.stretched_box() {
        return extension.extremes().strain;
    }
    let shears = matches!(model.flow, Flow::Shear { lees_edwards: true, .. });
    if shears { 0.5 * edges.x / edges.y } else { model.cell.strain().abs() }
}

/// Parts of the plan that the scene fixes.
fn fixed(model: &Model) -> Fixed {
    let chosen = &model.hydrodynamics;
    // With contacts, motions jump at the onset of sliding or sticking: steps gain nothing from solves tighter than the
    // tolerance.
    let usual = model.contacts.map(|_| chosen.tolerance);
    let iteration_tolerance = chosen.iteration_tolerance.or(usual);
    Fixed {
        method: chosen.method,
        device: chosen.device,
        grid: chosen.grid,
        support: chosen.support,
        iteration_tolerance,
        ..Fixed::default()
    }
}
