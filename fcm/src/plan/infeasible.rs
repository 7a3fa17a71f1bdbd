//! Plans that are infeasible: the cause, and advice.

use crate::plan::Plan;
use crate::plan::cost;
use crate::plan::costs::Costs;
use crate::plan::method::Method;
use crate::plan::problem::{Precision, Problem};
use domain::{Number, readable_bytes};

/// Seconds of an evaluation, and bytes of a grid, from which on a plan is infeasible.
const SECONDS: f64 = 3600.0;
const BYTES: f64 = 1e13;

impl Plan {
    /// Cause and advice if this plan of a problem is infeasible, that is, if an evaluation takes hours or the grid
    /// needs more memory than machines have.
    #[must_use]
    pub fn infeasible(&self, problem: &Problem) -> Option<String> {
        let (seconds, bytes) = (self.predicted_seconds, self.grid_bytes());
        if seconds < SECONDS && bytes < BYTES {
            return None;
        }
        let particles = problem.radii.iter().map(|r| r.1).sum();
        let Costs { stencils, transforms, pairs } = cost::seconds(self, particles, problem.largest_strain, 1);
        let cause = if bytes >= BYTES || transforms >= stencils.max(pairs) {
            self.infeasible_by_grid(problem)
        } else if stencils >= pairs {
            self.infeasible_by_stencils(particles)
        } else {
            self.infeasible_by_pairs(particles)
        };
        let (hours, room) = (Number(seconds / 3600.0), readable_bytes(bytes));
        Some(format!("an evaluation takes about {hours:.2} hours, and its grid {room}: {cause}"))
    }

    /// Bytes of a velocity field on the grid.
    fn grid_bytes(&self) -> f64 {
        let size = if self.precision == Precision::Single { 4.0 } else { 8.0 };
        3.0 * size * self.grid.iter().map(|&n| n as f64).product::<f64>()
    }

    fn infeasible_by_grid(&self, problem: &Problem) -> String {
        let longest = self.edges.max_element();
        let (axis, edge) =
            "xyz".chars().zip(self.edges.to_array()).find(|(_, edge)| *edge >= longest).unwrap_or_default();
        let [nx, ny, nz] = self.grid;
        let (smallest, largest) = self.extremes();
        if problem.fixed.grid.is_some() {
            return format!("hydrodynamics.grid has {nx} x {ny} x {nz} points; leave it out, or take fewer");
        }
        match self.method {
            Method::Direct => format!(
                "{nx} x {ny} x {nz} points, since every envelope is on the grid and the box is {:.2} of the smallest \
                 radii long along {axis}; leave hydrodynamics.method to the program, or take a smaller box, larger \
                 spheres or a larger tolerance",
                Number(edge / smallest)
            ),
            Method::Split | Method::Dense => format!(
                "{nx} x {ny} x {nz} points, since the box is {:.2} of the largest radii long along {axis}; take a \
                 smaller box, fewer spheres or a larger tolerance",
                Number(edge / largest)
            ),
        }
    }

    fn infeasible_by_stencils(&self, particles: usize) -> String {
        let (points, (smallest, largest)) = (self.support.support, self.extremes());
        match self.method {
            Method::Direct => format!(
                "{particles} stencils of {points} points along an axis, since the largest radius is {:.2} times the \
                 smallest, which sets the grid; leave hydrodynamics.method and grid to the program, or take radii that \
                 are nearer to each other",
                Number(largest / smallest)
            ),
            Method::Split | Method::Dense => {
                format!("there are {particles} particles; take fewer, or a larger tolerance")
            }
        }
    }

    fn infeasible_by_pairs(&self, particles: usize) -> String {
        let density = particles as f64 / self.edges.element_product();
        let neighbours = Number(density * 4.19 * self.cutoff().powi(3));
        let (smallest, largest) = self.extremes();
        format!(
            "{particles} particles with {neighbours:.2} others each within the cutoff, since the common Gaussian is \
             at least as wide as that of the largest radius, {:.2} times the smallest; take fewer particles, or radii \
             that are nearer to each other",
            Number(largest / smallest)
        )
    }
}
