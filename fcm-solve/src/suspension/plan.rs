//! How the fluid of a scene is to be computed.

use domain::{Comm, Particles};
use fcm::{Costs, Fixed, MethodName, Plan, PlanError, Precision, Problem};
use io::{Evaluation, Flow, Hydrodynamics, Multipoles, SuspensionScene};

/// The radii that occur, smallest first, and how many particles have each.
#[derive(Debug, Clone, PartialEq)]
pub struct Radii(Vec<(f64, usize)>);

impl Radii {
    /// The radii of particles that are all on the first rank. Collective.
    pub fn shared(particles: &Particles, comm: &Comm) -> Self {
        let mut radii = particles.radii.clone();
        comm.broadcast(&mut radii);
        radii.sort_by(f64::total_cmp);
        Self(radii.chunk_by(|a, b| a.total_cmp(b).is_eq()).map(|equal| (equal[0], equal.len())).collect())
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
pub fn plan(scene: &SuspensionScene, radii: &Radii) -> Result<Plan, PlanError> {
    Plan::choose(&problem(scene, radii))
}

/// What [`plan`] plans.
pub fn problem(scene: &SuspensionScene, radii: &Radii) -> Problem {
    let edges = scene.cell.edges();
    let shears = matches!(scene.flow, Flow::Shear { lees_edwards: true, .. });
    let costs = scene.hydrodynamics.costs.map(|[stencils, transforms, pairs]| Costs { stencils, transforms, pairs });
    Problem {
        edges,
        largest_strain: if shears { 0.5 * edges.x / edges.y } else { 0.0 },
        radii: radii.0.clone(),
        viscosity: scene.viscosity,
        multipoles: match scene.hydrodynamics.multipoles {
            Multipoles::Monopole => fcm::Multipoles::Monopole,
            Multipoles::Dipole => fcm::Multipoles::Dipole,
        },
        rigid: true,
        tolerance: scene.hydrodynamics.tolerance,
        threads: 1,
        ranks: 1,
        costs: costs.unwrap_or_default(),
        fixed: fixed(&scene.hydrodynamics),
    }
}

/// What the scene says of the plan. With lubrication the grid is in f64: the modes of a pair of gap `h` see differences
/// of velocities over `sqrt(h)`, in which the noise of f32 would keep the solve from its end at gaps below 1e-5.
fn fixed(chosen: &Hydrodynamics) -> Fixed {
    let method = match chosen.method {
        Evaluation::Auto => None,
        Evaluation::Direct => Some(MethodName::Direct),
        Evaluation::Split => Some(MethodName::Split),
    };
    let iteration_tolerance = chosen.iteration_tolerance;
    let precision = chosen.lubrication.then_some(Precision::Double);
    Fixed { method, precision, grid: chosen.grid, support: chosen.support, iteration_tolerance, ..Fixed::default() }
}
