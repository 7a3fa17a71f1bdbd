//! Newton's method with continuation in the energy that crosses the walls, on successively finer collocation grids.

use super::{
    ContinuumProblem, ContinuumSolution, SolutionStart, UniformFlow, collocation::Collocation, equations::WIDTH, linear,
};
use domain::{Bytes, Number};

/// Intervals of the grids for the continuation: the second, with the first start only, is for problems that do not
/// converge on the first grid.
const FIRST_GRIDS: [usize; 2] = [24, 96];
/// Intervals that resolve most problems.
const USUAL_GRID: usize = 192;
/// Intervals beyond which the solver gives up.
const FINEST_GRID: usize = 384;
/// Newton steps on one problem.
const NEWTON_STEPS: usize = 40;
/// Smallest step of the continuation.
const SMALLEST_STEP: f64 = 1.0 / 256.0;
/// Change of the solution between two grids, and residual between points, at which it counts as resolved.
const RESOLUTION: f64 = 1e-9;
/// Target residual of Newton's method, and the largest residual accepted where round-off stops it: near packing
/// `1 - v/v0` has lost digits.
const RESIDUALS: [f64; 2] = [1e-12, 1e-9];
/// Solid fractions of the last starts, over that of packing.
const LAST_STARTS: [f64; 4] = [0.75, 0.25, 0.05, 0.01];

/// Why there is no solution.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ContinuumError {
    /// Newton's method stopped short.
    #[error(
        "the shear cell's equations did not converge from a uniform solid fraction of {start:.4}: with {energy:.3} of \
         the walls' energy terms the {equation} keeps a residual of {residual:.2e} at y = {:.3}, where the solid \
         fraction is {solid_fraction:.4}; try another `start`, or more pressure",
        Number(*y)
    )]
    NoConvergence {
        /// Solid fraction of the start.
        start: f64,
        /// Progress of the continuation: 0 for no energy through the walls, 1 for the problem itself.
        energy: f64,
        /// The equation with the largest residual.
        equation: &'static str,
        /// That residual.
        residual: f64,
        /// Height of that residual.
        y: f64,
        /// The solid fraction there.
        solid_fraction: f64,
    },
    /// The finest grid is not fine enough.
    #[error(
        "the shear cell's solution is not resolved by {intervals} intervals: its residual between points is \
         {residual:.2e} near y = {:.3}",
        Number(*y)
    )]
    Unresolved {
        /// Intervals over half the gap.
        intervals: usize,
        /// Largest residual between the points.
        residual: f64,
        /// Height of that residual.
        y: f64,
    },
}

/// A failure of Newton's method to converge: index of the equation with the largest residual, that
/// residual, and the unknowns.
struct NotConverged {
    equation: usize,
    residual: f64,
    unknowns: Vec<f64>,
}

impl ContinuumProblem {
    /// Solves the problem from each uniform flow in turn, densest first: directly, or else by continuation in the
    /// energy through the walls; then from thinner and thinner guesses. Refines the grid until the answer no longer
    /// depends on it. The error is that of the first start.
    pub fn solve(&self) -> Result<ContinuumSolution, ContinuumError> {
        let mut failure = None;
        let starts = self.starts();
        let tries = starts.iter().map(|&start| (FIRST_GRIDS[0], start)).chain([(FIRST_GRIDS[1], starts[0])]);
        for (intervals, start) in tries {
            let grid = Collocation::new(intervals);
            match self.follow(&grid, start).and_then(|unknowns| self.refine(grid, unknowns)) {
                Ok(solution) => return Ok(solution),
                Err(error) => failure = failure.or(Some(error)),
            }
        }
        Err(failure.expect("there is always a start"))
    }

    /// Predicted memory: Newton's matrix of all unknowns, and the matrix of integrals between collocation points.
    pub fn bytes() -> Bytes {
        let points = (USUAL_GRID + 1) as f64;
        let unknowns = WIDTH as f64 * points + 1.0;
        Bytes::list::<f64>(unknowns * unknowns).then(Bytes::list::<f64>(points * points)).freed()
    }

    fn starts(&self) -> Vec<UniformFlow> {
        let at = |solid_fraction| UniformFlow { solid_fraction, slip: 0.1, stress_ratio: 0.3 };
        let packed = self.parameters().grains.radial.packed();
        match self.parameters().start {
            SolutionStart::SolidFraction(v) => vec![at(v)],
            SolutionStart::Densest => {
                self.uniform().into_iter().chain(LAST_STARTS.map(|part| at(part * packed))).collect()
            }
        }
    }

    fn follow(&self, grid: &Collocation, start: UniformFlow) -> Result<Vec<f64>, ContinuumError> {
        let mut unknowns = self.constant(grid, start);
        let (mut energy, mut step) = (0.0, 1.0);
        while energy < 1.0 {
            let next = f64::min(energy + step, 1.0);
            match self.newton(grid, unknowns.clone(), next) {
                Ok(solved) => {
                    (unknowns, energy) = (solved, next);
                    step *= 2.0;
                }
                Err(_) if step > SMALLEST_STEP => step *= 0.5,
                Err(not_converged) => return Err(self.explain(grid, &not_converged, start.solid_fraction, energy)),
            }
        }
        Ok(unknowns)
    }

    fn constant(&self, grid: &Collocation, start: UniformFlow) -> Vec<f64> {
        let z = self.logit(start.solid_fraction);
        let speed = |x: f64| 1.0 - start.slip - (0.5 - start.slip) * x;
        let mut unknowns: Vec<f64> = grid.points.iter().flat_map(|&x| [z, 0.0, speed(x)]).collect();
        unknowns.push(start.stress_ratio);
        unknowns
    }

    /// Damped Newton method: the logit moves by at most 1 per step, and each step must reduce the residuals.
    fn newton(&self, grid: &Collocation, mut unknowns: Vec<f64>, energy: f64) -> Result<Vec<f64>, NotConverged> {
        let norm = |r: &[f64]| r.iter().map(|x| x * x).sum::<f64>();
        let (mut residual, mut jacobian) = self.linearise(grid, &unknowns, energy);
        for _ in 0..NEWTON_STEPS {
            let Some(change) = linear::solve(&mut jacobian, residual.clone()) else { break };
            let turn = change.chunks(WIDTH).map(|c| c[0].abs()).fold(0.0, f64::max);
            let size = largest(&change);
            let mut fraction = f64::min(1.0, 1.0 / turn);
            loop {
                let moved: Vec<f64> = unknowns.iter().zip(&change).map(|(u, c)| u - fraction * c).collect();
                let (next, slopes) = self.linearise(grid, &moved, energy);
                if norm(&next) < norm(&residual) || size < 1e-9 {
                    (unknowns, residual, jacobian) = (moved, next, slopes);
                    break;
                }
                fraction *= 0.5;
                if fraction < 1e-3 {
                    return if largest(&residual) < RESIDUALS[1] {
                        Ok(unknowns)
                    } else {
                        Err(not_converged(&residual, unknowns))
                    };
                }
            }
            if size < 1e-9 && largest(&residual) < RESIDUALS[0] {
                return Ok(unknowns);
            }
        }
        Err(not_converged(&residual, unknowns))
    }

    fn explain(&self, grid: &Collocation, not_converged: &NotConverged, start: f64, energy: f64) -> ContinuumError {
        let (names, last) = (["solid fraction's flux law", "energy balance", "shear stress law"], grid.intervals());
        let (equation, point) = match not_converged.equation.checked_sub(WIDTH * last) {
            None => (names[not_converged.equation % WIDTH], not_converged.equation / WIDTH + 1),
            Some(boundary) => (
                ["wall's momentum", "wall's energy", "mid-plane's energy", "mid-plane's velocity"][boundary],
                if boundary < 2 { 0 } else { last },
            ),
        };
        ContinuumError::NoConvergence {
            start,
            energy,
            equation,
            residual: not_converged.residual,
            y: 0.5 * self.parameters().gap * grid.points[point],
            solid_fraction: self.solid_fraction(not_converged.unknowns[WIDTH * point]),
        }
    }

    fn refine(&self, mut grid: Collocation, mut unknowns: Vec<f64>) -> Result<ContinuumSolution, ContinuumError> {
        let mut before = ContinuumSolution::new(*self, grid, unknowns.clone());
        loop {
            let intervals = 2 * before.intervals();
            if intervals > FINEST_GRID {
                let (residual, y) = before.worst();
                return Err(ContinuumError::Unresolved { intervals: before.intervals(), residual, y });
            }
            grid = Collocation::new(intervals);
            unknowns = before.unknowns_at(&grid.points);
            unknowns = self
                .newton(&grid, unknowns, 1.0)
                .map_err(|not_converged| self.explain(&grid, &not_converged, before.mean_solid_fraction(), 1.0))?;
            let after = ContinuumSolution::new(*self, grid, unknowns);
            if after.difference(&before) < RESOLUTION && after.residual() < RESOLUTION {
                return Ok(after);
            }
            before = after;
        }
    }
}

fn largest(numbers: &[f64]) -> f64 {
    numbers.iter().map(|x| x.abs()).fold(0.0, f64::max)
}

fn not_converged(residual: &[f64], unknowns: Vec<f64>) -> NotConverged {
    let worst = |&(_, a): &(usize, &f64), &(_, b): &(usize, &f64)| a.abs().total_cmp(&b.abs());
    let (equation, &residual) = residual.iter().enumerate().max_by(worst).expect("there are equations");
    NotConverged { equation, residual, unknowns }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinetic_theory::ContinuumParameters;

    /// Collocation converges faster than any power of the number of intervals: beyond 24 only round-off remains.
    #[test]
    fn the_answer_does_not_depend_on_the_grid() {
        for (speed, pressure) in [(1.4, 5500.0), (2.0, 5500.0), (2.8, 2500.0)] {
            let problem =
                ContinuumProblem::new(ContinuumParameters { speed, pressure, ..ContinuumParameters::default() })
                    .unwrap();
            let start = problem.starts()[0];
            let on = |intervals: usize| {
                let grid = Collocation::new(intervals);
                let unknowns = problem.follow(&grid, start).ok().unwrap();
                ContinuumSolution::new(problem, grid, unknowns)
            };
            let [coarse, fine, finest] = [24, 48, 192].map(on);
            assert!(finest.difference(&coarse) < 1e-7 && finest.difference(&fine) < 1e-9);
            assert!((finest.mean_solid_fraction() - fine.mean_solid_fraction()).abs() < 1e-10);
            assert!(finest.residual() < 1e-9);
        }
    }
}
