//! A solved flow: its profiles and the quantities that an experiment measures.

use super::{ContinuumProblem, collocation::Collocation, equations::WIDTH};

/// The flow at a height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlowPoint {
    /// Height above the lower wall.
    pub y: f64,
    /// Velocity along the flow.
    pub velocity: f64,
    /// Solid fraction.
    pub solid_fraction: f64,
    /// Granular temperature, a velocity squared.
    pub temperature: f64,
    /// Upward flux of energy.
    pub energy_flux: f64,
}

/// The solution of a [`ContinuumProblem`].
#[derive(Debug, Clone)]
pub struct ContinuumSolution {
    problem: ContinuumProblem,
    grid: std::sync::Arc<Collocation>,
    unknowns: Vec<f64>,
    worst: (f64, f64),
}

impl ContinuumSolution {
    pub(super) fn new(problem: ContinuumProblem, grid: Collocation, unknowns: Vec<f64>) -> Self {
        let mut solution = Self { problem, grid: grid.into(), unknowns, worst: (0.0, 0.0) };
        solution.worst = solution.defect();
        solution
    }

    /// The flow at a height from 0 to `H`; heights outside are clamped to the nearer wall. The upper half mirrors the
    /// lower: `u(H - y) = U - u(y)`.
    pub fn at(&self, y: f64) -> FlowPoint {
        let p = self.problem.parameters();
        let y = y.clamp(0.0, p.gap);
        let upper = y > 0.5 * p.gap;
        let x = 2.0 * if upper { p.gap - y } else { y } / p.gap;
        let [z, w, u] = self.interpolated(x);
        let solid_fraction = self.problem.solid_fraction(z);
        let flux = w * p.pressure * (p.pressure / p.grains.density).sqrt();
        FlowPoint {
            y,
            velocity: p.speed * if upper { 1.0 - u } else { u },
            solid_fraction,
            temperature: p.pressure / (p.grains.density * self.c2(solid_fraction)),
            energy_flux: if upper { -flux } else { flux },
        }
    }

    /// The flow at `count` (at least 2) evenly spaced heights from wall to wall.
    pub fn profile(&self, count: usize) -> Vec<FlowPoint> {
        let step = self.problem.parameters().gap / (count.max(2) - 1) as f64;
        (0..count.max(2)).map(|i| self.at(i as f64 * step)).collect()
    }

    /// Solid fraction averaged over the gap.
    pub fn mean_solid_fraction(&self) -> f64 {
        let weights = self.grid.up_to(self.grid.intervals());
        weights.iter().zip(self.unknowns.chunks_exact(WIDTH)).map(|(w, y)| w * self.problem.solid_fraction(y[0])).sum()
    }

    /// Slip velocity at either wall, `U - u(0) = u(H)`. Negative where the extrapolated flow is faster than the wall.
    pub fn slip(&self) -> f64 {
        self.problem.parameters().speed * (1.0 - self.unknowns[2])
    }

    /// Shear stress `S`.
    pub fn shear_stress(&self) -> f64 {
        self.problem.parameters().pressure * self.unknowns[self.unknowns.len() - 1]
    }

    /// Whether the flow is on the dilute branch: thinner than the solid fraction at which a uniform shear flow needs
    /// the least pressure, with most of the shear in the slip at the walls. No denser flow carries so small a load.
    pub fn is_dilute(&self) -> bool {
        self.mean_solid_fraction() < self.problem.dilute_below()
    }

    /// A warning for the user, if the result needs one.
    pub fn notice(&self) -> Option<String> {
        self.is_dilute().then(|| {
            format!(
                "dilute branch: the mean solid fraction is {:.4}, below {:.4} where a uniform shear flow needs \
                 the least pressure, and {:.0} % of the speed is slip at the walls; the load is too small for a \
                 dense flow at this speed",
                self.mean_solid_fraction(),
                self.problem.dilute_below(),
                200.0 * self.slip() / self.problem.parameters().speed
            )
        })
    }

    /// Collocation intervals over half the gap.
    pub fn intervals(&self) -> usize {
        self.grid.intervals()
    }

    /// Largest residual of the differential equations midway between the collocation points, over the largest rate.
    pub fn residual(&self) -> f64 {
        self.worst.0
    }

    /// Largest residual and its height.
    pub(super) fn worst(&self) -> (f64, f64) {
        self.worst
    }

    fn c2(&self, solid_fraction: f64) -> f64 {
        self.problem.parameters().grains.functions(solid_fraction).c2.value()
    }

    fn interpolated(&self, x: f64) -> [f64; WIDTH] {
        std::array::from_fn(|c| self.grid.interpolate(|j| self.unknowns[WIDTH * j + c], x))
    }

    /// The unknowns interpolated at other collocation points.
    pub(super) fn unknowns_at(&self, points: &[f64]) -> Vec<f64> {
        let stress = self.unknowns[self.unknowns.len() - 1];
        points.iter().flat_map(|&x| self.interpolated(x)).chain([stress]).collect()
    }

    /// Largest relative difference in mean solid fraction, velocity at the wall and shear stress.
    pub(super) fn difference(&self, other: &Self) -> f64 {
        let measured = |s: &Self| [s.mean_solid_fraction(), s.unknowns[2], s.shear_stress()];
        measured(self).iter().zip(measured(other)).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max)
    }

    fn defect(&self) -> (f64, f64) {
        let stress = self.unknowns[self.unknowns.len() - 1];
        let rates = |y: &[f64]| self.problem.rates(y[0], y[1], stress).values;
        let known: Vec<[f64; WIDTH]> = self.unknowns.chunks_exact(WIDTH).map(rates).collect();
        let largest = known.iter().flatten().map(|r| r.abs()).fold(1.0, f64::max);
        let mut worst = (0.0, 0.0);
        for pair in self.grid.points.windows(2) {
            let x = 0.5 * (pair[0] + pair[1]);
            let between = rates(&self.interpolated(x));
            for (c, rate) in between.iter().enumerate() {
                let defect = (self.grid.interpolate(|j| known[j][c], x) - rate).abs() / largest;
                if defect > worst.0 {
                    worst = (defect, 0.5 * x * self.problem.parameters().gap);
                }
            }
        }
        worst
    }
}
