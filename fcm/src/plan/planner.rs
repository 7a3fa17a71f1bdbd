//! Candidate plans of a problem.

use crate::envelope::Envelope;
use crate::grid::gaussian::STEP;
use crate::grid::stencil::Support;
use crate::grid::window::KaiserBessel;
use crate::plan::Plan;
use crate::plan::accuracy::{self, Accuracy, Brackets};
use crate::plan::bounded::WallGrid;
use crate::plan::cost;
use crate::plan::method::{Method, Split};
use crate::plan::problem::{Multipoles, Precision, Problem};
use crate::plan::tolerance_shares::ITERATION_SHARE;
use crate::plan::wavenumber_split::ENOUGH;
use domain::{Boundaries, Vector};
use solver::Grid;
use std::f64::consts::PI;

/// Refinement factors of grids at walls: on finer grids the windows have smaller errors, and images reach less far.
const FINER_AT_WALLS: [f64; 7] = [1.0, 1.1, 1.2, 1.35, 1.6, 2.0, 2.5];

/// Largest cutoff at walls, in smallest radii: images take as many wavenumbers.
const FARTHEST_AT_WALLS: f64 = 1000.0;

/// Largest cutoff, in shortest edges of the box: steps to periodic images are stored in bytes.
const FARTHEST: f64 = 60.0;

/// Least factor from one number of points to the next that is tried: none up to a thousand.
fn coarser(points: usize) -> f64 {
    if points < 1000 { 1.0 } else { 1.04 }
}

/// One way to keep a tolerance: method, resolution and stencil, and width of the Gaussian.
#[derive(Clone, Copy)]
struct PlanCandidate {
    method: Method,
    accuracy: Accuracy,
    width: f64,
}

/// A candidate, and whether its windows keep the error allowed at walls.
struct WallCandidate {
    candidate: PlanCandidate,
    keeps: bool,
}

impl Problem {
    pub(crate) fn largest_radius(&self) -> f64 {
        self.radii.iter().map(|r| r.0).fold(0.0, f64::max)
    }

    /// The same with equal radii merged, as planning needs.
    pub(crate) fn summed_up(&self) -> Self {
        let mut radii = self.radii.clone();
        radii.sort_by(|a, b| a.0.total_cmp(&b.0));
        let sum = |equal: &[(f64, usize)]| (equal[0].0, equal.iter().map(|r| r.1).sum());
        let radii = radii.chunk_by(|a, b| a.0.total_cmp(&b.0).is_eq()).map(sum).collect();
        Self { radii, ..self.clone() }
    }

    pub(crate) fn smallest_radius(&self) -> f64 {
        self.radii.iter().map(|r| r.0).fold(f64::INFINITY, f64::min)
    }

    pub(crate) fn particles(&self) -> usize {
        self.radii.iter().map(|r| r.1).sum()
    }

    /// Seconds by which plans are compared: of an evaluation, on the ranks of the network if there is one.
    pub(crate) fn seconds_of(&self, plan: &Plan) -> f64 {
        self.network.map_or(plan.predicted_seconds, |network| network.evaluation(plan, &self.radii))
    }

    /// Plans that keep the tolerance: the best of each method, precision and stencil. If none keeps it at walls, the
    /// one with the smallest error there.
    pub(crate) fn candidates(&self) -> Vec<Plan> {
        if let Some(gridless) = self.fixed.method.and_then(Method::gridless) {
            return vec![gridless.plan(self)];
        }
        let (mut best, mut least): (Vec<Plan>, Option<Plan>) = (Vec::new(), None);
        for candidate in self.direct().into_iter().chain(self.split()) {
            for precision in self.precisions() {
                for WallCandidate { candidate, keeps } in self.at_walls(&candidate, precision) {
                    let is_within = |plan: &Plan| plan.cutoff() <= FARTHEST * self.edges.min_element();
                    let Some(plan) = self.plan(&candidate, precision).filter(is_within) else { continue };
                    if !keeps {
                        if least.as_ref().is_none_or(|least| plan.predicted_error < least.predicted_error) {
                            least = Some(plan);
                        }
                        continue;
                    }
                    let alike = |other: &&mut Plan| {
                        let same_method = other.method == plan.method;
                        same_method && (other.precision, other.support.support) == (precision, plan.support.support)
                    };
                    match best.iter_mut().find(alike) {
                        Some(other) if self.seconds_of(other) <= self.seconds_of(&plan) => {}
                        Some(other) => *other = plan,
                        None => best.push(plan),
                    }
                }
            }
        }
        if best.is_empty() {
            best.extend(least);
        }
        best
    }

    fn allows(&self, method: Method) -> bool {
        self.fixed.device.allows(method) && self.fixed.method.is_none_or(|fixed| fixed == method)
    }

    fn precisions(&self) -> impl Iterator<Item = Precision> {
        // An iteration continued below the round-off of the grid would follow its noise.
        let finest = (self.tolerance / self.error_amplification()).min(self.iteration_tolerance() / ITERATION_SHARE);
        let single = finest >= accuracy::FINEST_SINGLE || self.fixed.precision.is_some();
        let enough = move |precision: &Precision| single || *precision == Precision::Double;
        let fixed = self.fixed.precision;
        let all = [Precision::Single, Precision::Double].into_iter();
        all.filter(enough).filter(move |&precision| fixed.is_none_or(|fixed| fixed == precision))
    }

    fn direct(&self) -> Vec<PlanCandidate> {
        let is_possible = self.multipoles != Multipoles::Moments && !self.is_tilted();
        if !is_possible || !self.allows(Method::Direct) || self.boundaries != Boundaries::Periodic {
            return Vec::new();
        }
        let (method, width) = (Method::Direct, self.own_width(self.smallest_radius()));
        let all = Accuracy::direct(self.multipoles, self.tolerance * self.tolerance_share()).into_iter();
        all.map(|accuracy| PlanCandidate { method, accuracy, width }).collect()
    }

    /// Common Gaussians worth trying: those for each efficient number of points along the longest edge, up to large
    /// numbers, of which steps of a few percent skip some.
    fn split(&self) -> Vec<PlanCandidate> {
        let [fewest, most] = KaiserBessel::POINTS;
        if !self.allows(Method::Split) || self.fixed.support.is_some_and(|p| !(fewest..=most).contains(&p)) {
            return Vec::new();
        }
        let least = Envelope::of_sphere(self.largest_radius()).monopole;
        if let Some(width) = self.fixed.width {
            return self.of_width(width);
        }
        if let Some(grid) = self.fixed.grid {
            let spacing = self.edges / Vector::from_array(grid.map(|n| n as f64));
            let mut all = self.of_spacing(spacing.max_element());
            for candidate in &mut all {
                candidate.width = (candidate.width * self.coarsening(spacing)).max(least);
            }
            return all;
        }
        let mut all = self.of_width(least);
        let mut points = 7;
        loop {
            points = Grid::good_size((points + 1).max((points as f64 * coarser(points)) as usize));
            let mut some = self.of_spacing(self.edges.max_element() / points as f64);
            some.retain(|candidate| candidate.width > least);
            if some.is_empty() || points == Grid::MOST {
                return all;
            }
            all.append(&mut some);
        }
    }

    /// Candidates with a given width of the Gaussian.
    fn of_width(&self, width: f64) -> Vec<PlanCandidate> {
        let brackets = |resolution: f64| self.brackets(width, self.stretch_at(width / resolution));
        let all = Accuracy::split(self.multipoles, self.tolerance * self.tolerance_share(), brackets).into_iter();
        all.map(|accuracy| PlanCandidate { method: Method::Split, accuracy, width }).collect()
    }

    /// Candidates with a given grid spacing.
    fn of_spacing(&self, spacing: f64) -> Vec<PlanCandidate> {
        let stretch = self.stretch_at(spacing);
        let brackets = |resolution: f64| self.brackets(spacing * resolution, stretch);
        let all = Accuracy::split(self.multipoles, self.tolerance * self.tolerance_share(), brackets).into_iter();
        let method = Method::Split;
        all.map(|accuracy| PlanCandidate { method, accuracy, width: spacing * accuracy.resolution }).collect()
    }

    /// Grid that a candidate needs; none if it has more points than the largest supported grid.
    fn grid(&self, candidate: &PlanCandidate) -> Option<[usize; 3]> {
        if let Some(grid) = self.fixed.grid {
            return Some(grid);
        }
        let needed = self.lengths_of(candidate) / candidate.width
            * candidate.accuracy.resolution
            * self.lengthened_for(candidate.method);
        if needed.max_element() > Grid::MOST as f64 {
            return None;
        }
        let grid = needed.to_array().map(|n| Grid::good_size((n - 1e-9).ceil() as usize));
        (grid.iter().map(|&n| n as f64).product::<f64>() <= Grid::MOST_IN_ALL).then_some(grid)
    }

    /// A candidate on grids that are fine enough at walls, each with a window whose error is allowed there; if there
    /// are none, on the finest grid with the window of least error. Unchanged without walls.
    fn at_walls(&self, candidate: &PlanCandidate, precision: Precision) -> Vec<WallCandidate> {
        if self.boundaries.walls() == 0 {
            return vec![WallCandidate { candidate: *candidate, keeps: true }];
        }
        let PlanCandidate { accuracy: Accuracy { resolution, points }, width, .. } = *candidate;
        let cutoff = self.fixed.cutoff.unwrap_or_else(|| self.cutoff(width));
        if cutoff > FARTHEST_AT_WALLS * self.smallest_radius() {
            return Vec::new();
        }
        let of_walls = |factor: f64, points: usize| {
            let accuracy = Accuracy { resolution: factor * resolution, points };
            (accuracy, self.wall_error(Split { width, cutoff }, width / accuracy.resolution, points))
        };
        let with = |factor: f64, points: usize| {
            let (accuracy, error) = of_walls(factor, points);
            (PlanCandidate { accuracy, ..*candidate }, error.hypot(self.amplified(width, accuracy, precision)))
        };
        let longest = KaiserBessel::POINTS[1].max(points);
        let windows = |factor: f64| (points..=longest).map(move |points| with(factor, points));
        let allowed = ENOUGH * self.allowed_at_walls();
        // If the error of the longest window is too large, so are the others.
        let may_be = |factor: &f64| of_walls(*factor, longest).1 <= allowed;
        let enough = |factor: f64| windows(factor).find(|(_, error)| *error <= allowed);
        // A fixed grid is not refined.
        let finer = &FINER_AT_WALLS[..if self.fixed.grid.is_some() { 1 } else { FINER_AT_WALLS.len() }];
        let mut found = Vec::new();
        for &factor in finer.iter().filter(|factor| may_be(factor)) {
            let Some((candidate, _)) = enough(factor) else { continue };
            found.push(WallCandidate { candidate, keeps: true });
            // A finer grid could not have a shorter window.
            if candidate.accuracy.points == points {
                break;
            }
        }
        if found.is_empty() {
            let least = windows(finer[finer.len() - 1]).min_by(|one, other| one.1.total_cmp(&other.1));
            found.extend(least.map(|(candidate, _)| WallCandidate { candidate, keeps: false }));
        }
        found
    }

    /// Round-off error as the highest wavenumbers amplify it, where the transform of a window that is long for its
    /// Gaussian nearly vanishes.
    fn amplified(&self, width: f64, Accuracy { resolution, points }: Accuracy, precision: Precision) -> f64 {
        let window = KaiserBessel::new(points, resolution);
        let Brackets { common, own, .. } = self.brackets(width, self.stretch());
        let gain = |k: f64| {
            let square = (k * resolution).powi(2);
            (-0.5 * square).exp() * (1.0 + common * square) * (1.0 + own * square) * window.transform(0.0)
                / window.transform(k)
        };
        let most = [0.5, 0.6, 0.7, 0.8, 0.9, 1.0].map(|part| gain(part * PI)).into_iter().fold(1.0, f64::max);
        most.powi(2) * if precision == Precision::Single { accuracy::ROUND_OFF } else { f64::EPSILON }
    }

    /// Error of the walls' flow on a grid of this spacing, with windows of `points` points for a Gaussian of this
    /// width.
    fn wall_error(&self, split: Split, spacing: f64, points: usize) -> f64 {
        let Split { width, cutoff } = split;
        let at_walls = WallGrid {
            boundaries: self.boundaries,
            radii: [self.smallest_radius(), self.largest_radius()],
            multipoles: self.multipoles,
            allowed: self.wavenumber_split_tolerance(),
            width,
            cutoff,
            spacing,
            points,
            height: self.edges.z,
        };
        at_walls.cut().1
    }

    /// Lengths that the grid of a candidate needs.
    fn lengths_of(&self, candidate: &PlanCandidate) -> Vector {
        if self.boundaries == Boundaries::Periodic {
            return self.edges;
        }
        let points = self.fixed.support.unwrap_or(candidate.accuracy.points);
        let window = points as f64 * candidate.width / candidate.accuracy.resolution;
        self.lengths(window, self.overlap(candidate.width))
    }

    /// Distance from which common Gaussians do not overlap: the cutoff, except with forces alone, where the cutoff
    /// may be 0.
    fn overlap(&self, width: f64) -> f64 {
        let brackets = self.brackets(width, self.stretch());
        width * accuracy::cutoff(Multipoles::Dipole, self.tolerance * self.tolerance_share(), brackets)
    }

    /// Periods of the grid of a candidate: the edges along periodic axes, along others the number of points times the
    /// spacing.
    fn period(&self, candidate: &PlanCandidate, grid: [usize; 3]) -> Vector {
        let spacing = candidate.width / candidate.accuracy.resolution;
        let along = |axis: usize| {
            if self.boundaries.is_periodic(axis) { self.edges[axis] } else { grid[axis] as f64 * spacing }
        };
        Vector::from_array(std::array::from_fn(along))
    }

    fn plan(&self, candidate: &PlanCandidate, precision: Precision) -> Option<Plan> {
        let PlanCandidate { method, width, .. } = *candidate;
        let grid = self.grid(candidate)?;
        let period = self.period(candidate, grid);
        let spacing = period / Vector::from_array(grid.map(|n| n as f64));
        let widest = match method {
            Method::Split => width,
            _ => Envelope::of_sphere(self.largest_radius()).monopole,
        };
        let support = self.support(candidate, spacing, widest);
        let split = (method == Method::Split)
            .then(|| Split { width, cutoff: self.fixed.cutoff.unwrap_or_else(|| self.cutoff(width)) });
        let round_off = if precision == Precision::Single { accuracy::ROUND_OFF } else { 0.0 };
        let mut plan = Plan {
            edges: self.edges,
            boundaries: self.boundaries,
            period,
            fluid_margin: None,
            smallest_edge_ratio: self.smallest_edge_ratio,
            is_tilted: self.is_tilted(),
            radii: self.radii.iter().map(|r| r.0).collect(),
            viscosity: self.viscosity,
            multipoles: self.multipoles,
            tolerance: self.tolerance,
            iteration_tolerance: self.iteration_tolerance(),
            wavenumber_split_tolerance: self.wavenumber_split_tolerance(),
            image_cutoff: self.image_cutoff(),
            method,
            split,
            device: self.fixed.device,
            precision,
            grid,
            support,
            predicted_error: self.expected(split, [width, widest], spacing, support).hypot(round_off),
            predicted_seconds: 0.0,
        };
        plan.predicted_seconds = cost::predicted(&plan, self);
        Some(plan)
    }

    /// Cutoff that a common Gaussian needs.
    fn cutoff(&self, width: f64) -> f64 {
        width
            * accuracy::cutoff(
                self.multipoles,
                self.tolerance * self.tolerance_share(),
                self.brackets(width, self.stretch()),
            )
    }

    /// Stencils that a candidate needs on a grid.
    fn support(&self, candidate: &PlanCandidate, spacing: Vector, widest: f64) -> Support {
        let needed = candidate.accuracy.points;
        if candidate.method == Method::Split {
            let support = self.fixed.support.unwrap_or(needed);
            return Support {
                lanes: support.next_multiple_of(STEP),
                support,
                reach: 0.5 * support as f64 * spacing.max_element(),
            };
        }
        let reach = 0.5 * needed as f64 / candidate.accuracy.resolution * widest;
        // The grid shrinks with the edges.
        let needed = |h: f64| ((2.0 * reach / (h * self.smallest_edge_ratio) - 1e-9).ceil() as usize).min(Grid::MOST);
        let points = |h: f64| self.fixed.support.unwrap_or_else(|| needed(h));
        let reach = self.fixed.support.map_or(reach, |points| 0.5 * points as f64 * spacing.max_element());
        Support {
            lanes: points(spacing.x / self.stretch()).next_multiple_of(STEP),
            support: points(spacing.y).max(points(spacing.z)),
            reach,
        }
    }

    /// Error expected of the final choice, with the parameters that the user fixed and the narrowest and the widest
    /// Gaussian on the grid.
    fn expected(&self, split: Option<Split>, [narrowest, widest]: [f64; 2], spacing: Vector, support: Support) -> f64 {
        let lengthened = self.lengthened_on(split.is_some(), spacing);
        let resolution = narrowest / (spacing * lengthened).max_element();
        match split {
            None => accuracy::direct_error(self.multipoles, resolution, support.reach / widest),
            Some(Split { width, cutoff }) => {
                let stretch = if self.is_reduced() { lengthened.y } else { self.stretch() };
                let brackets = self.brackets(width, stretch);
                accuracy::split_error(self.multipoles, resolution, support.support, brackets)
                    .hypot(accuracy::cutoff_error(self.multipoles, cutoff / width, brackets))
                    .hypot(self.wall_error(Split { width, cutoff }, spacing.max_element(), support.support))
            }
        }
    }
}
