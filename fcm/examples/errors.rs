//! Errors of an evaluation against one parameter at a time, next to the planner's bounds: the measurements to which
//! the bounds were fitted. Prints Markdown.
//!
//! `cargo run --release -p fcm-solve-fcm --example errors`

#[path = "../tests/common/mod.rs"]
mod common;

use common::{Suspension, error, vectors, worst};
use domain::{PeriodicBox, Vector};
use fcm::accuracy::{Brackets, cutoff_error, direct_grid_error, split_grid_error, stencil_error, window_error};
use fcm::{Fixed, Loads, Method, Motion, Multipoles, Output, Plan, Precision, Problem, Split};

/// A suspension, its loads and the exact motion.
#[derive(Clone)]
struct ErrorCase {
    name: String,
    suspension: Suspension,
    multipoles: Multipoles,
    loads: Loads,
    exact: Motion,
}

impl ErrorCase {
    fn new(count: usize, ratio: f64, fraction: f64, multipoles: Multipoles) -> Self {
        let volume = 0.5 * count as f64 * 4.0 / 3.0 * std::f64::consts::PI * (1.0 + ratio.powi(3)) / fraction;
        let cell = PeriodicBox::new(Vector::splat(volume.cbrt())).expect("the volume is positive");
        let suspension = Suspension::random(count, ratio, cell, 1);
        let mut loads = suspension.loads(1);
        if multipoles == Multipoles::Monopole {
            loads = Loads { forces: loads.forces, ..Loads::default() };
        }
        let exact = suspension.motion(&loads);
        let terms = if multipoles == Multipoles::Monopole { "forces alone, " } else { "" };
        let name = format!("{terms}radii 1:{ratio}, {:.0}%", 100.0 * fraction);
        Self { name, suspension, multipoles, loads, exact }
    }

    /// The most accurate plan of a method, of which one parameter at a time is degraded.
    fn tightest(&self, method: Method) -> Plan {
        let fixed = Fixed { method: Some(method), precision: Some(Precision::Double), ..Fixed::default() };
        let problem = Problem { fixed, multipoles: self.multipoles, ..self.suspension.problem(1e-12) };
        Plan::choose(&problem).expect("a tolerance that is kept")
    }

    /// Largest of the errors of velocities, angular velocities and rates of strain; with monopoles the error of
    /// velocities.
    fn error(&self, plan: &Plan) -> f64 {
        if self.multipoles == Multipoles::Dipole {
            return worst(&self.suspension.evaluate(plan, &self.loads), &self.exact);
        }
        let found = self.suspension.mobility(plan).apply(&self.loads, Output::Velocities);
        error(&vectors(&found.velocities), &vectors(&self.exact.velocities))
    }
}

/// Width of the narrowest Gaussian on the grid, which sets the spacing, and of the widest, which sets the stencil.
fn widths(plan: &Plan) -> [f64; 2] {
    if let Some(Split { width, .. }) = plan.split {
        return [width; 2];
    }
    let of = |radius: &f64| fcm::Envelope::of_sphere(*radius);
    let [first, last] = [plan.radii.first(), plan.radii.last()].map(|a| of(a.expect("a plan has radii")));
    [own(plan, first), last.monopole]
}

/// Row of a table: the degraded parameter, the error, and the planner's bound.
struct ErrorRow {
    number: String,
    error: f64,
    bound: f64,
}

/// Error by `Sigma / h`: grids from coarse to fine, with stencils and cutoffs of negligible error.
fn by_resolution(case: &ErrorCase, method: Method) -> Vec<ErrorRow> {
    let tight = case.tightest(method);
    let [narrowest, widest] = widths(&tight);
    let row = |points: usize| {
        let plan = on_grid(&tight, points);
        let spacing = plan.edges.x / points as f64;
        // At eight widths to either side a Gaussian is exp(-32).
        let support = if method == Method::Split { 16 } else { (16.0 * widest / spacing).ceil() as usize };
        let resolution = narrowest / spacing;
        ErrorRow {
            number: format!("{resolution:.2}"),
            error: case.error(&with_support(&plan, support)),
            bound: match method {
                Method::Direct => direct_grid_error(case.multipoles, resolution),
                _ => split_grid_error(case.multipoles, resolution, brackets(&tight)),
            },
        }
    };
    grids(&tight).into_iter().map(row).collect()
}

/// Sizes of grids up to that of a plan.
fn grids(plan: &Plan) -> Vec<usize> {
    let finest = plan.grid[0];
    (4..=finest).step_by(2).filter(|&n| is_good(n) && n * 4 >= finest).collect()
}

fn on_grid(plan: &Plan, points: usize) -> Plan {
    Plan { grid: [points; 3], ..plan.clone() }
}

fn with_support(plan: &Plan, support: usize) -> Plan {
    let reach = 0.5 * support as f64 * plan.edges.x / plan.grid[0] as f64;
    let support = fcm::Support { lanes: support.next_multiple_of(8), support, reach };
    Plan { support, ..plan.clone() }
}

fn is_good(points: usize) -> bool {
    [2, 3, 5, 7].iter().fold(points, |mut n, p| {
        while n.is_multiple_of(*p) {
            n /= p;
        }
        n
    }) == 1
}

/// Error by half the stencil over the width: the direct method's stencils from short to long on the finest grid.
fn by_reach(case: &ErrorCase) -> Vec<ErrorRow> {
    let tight = case.tightest(Method::Direct);
    let row = |support: usize| {
        let plan = with_support(&tight, support);
        let reach = plan.support.reach / widths(&tight)[1];
        ErrorRow { number: format!("{reach:.2}"), error: case.error(&plan), bound: stencil_error(reach) }
    };
    (8..=tight.support.support).step_by(4).map(row).collect()
}

/// Errors of the split method's windows, by number of points and by grid.
fn by_window(case: &ErrorCase) -> Vec<ErrorRow> {
    let tight = case.tightest(Method::Split);
    let brackets = brackets(&tight);
    let mut rows = Vec::new();
    for support in [4, 5, 6, 7, 8, 10, 12, 14, 16] {
        for points in grids(&tight) {
            let plan = with_support(&on_grid(&tight, points), support);
            let resolution = widths(&tight)[0] * points as f64 / plan.edges.x;
            let bound = window_error(case.multipoles, support, resolution, brackets);
            // Skips grids whose own error is not small against the window's.
            if 4.0 * split_grid_error(case.multipoles, resolution, brackets) < bound {
                rows.push(ErrorRow {
                    number: format!("{support} at {resolution:.2}"),
                    error: case.error(&plan),
                    bound,
                });
            }
        }
    }
    rows
}

/// Width of the envelope of the plan's highest multipole: the dipole's, or the force's with monopoles alone.
fn own(plan: &Plan, envelope: fcm::Envelope) -> f64 {
    if plan.multipoles == Multipoles::Monopole { envelope.monopole } else { envelope.dipole }
}

/// Brackets of a plan as the planner computes them.
fn brackets(plan: &Plan) -> Brackets {
    let square = |radius: Option<&f64>| own(plan, fcm::Envelope::of_sphere(*radius.expect("a plan has radii"))).powi(2);
    let ([least, most], width) = ([square(plan.radii.first()), square(plan.radii.last())], widths(plan)[0].powi(2));
    Brackets {
        common: 0.5 - (0.125 * least + 0.375 * most) / width,
        own: 0.25 * (most - least) / width,
        stretch: 1.0,
        size: plan.radii.last().expect("a plan has radii") / width.sqrt(),
    }
}

/// Error by the cutoff over the width: cutoffs from short to long on the finest grid.
fn by_cutoff(case: &ErrorCase) -> Vec<ErrorRow> {
    let tight = case.tightest(Method::Split);
    let row = |tenths: i32| {
        let (width, reach) = (widths(&tight)[0], 0.1 * f64::from(tenths));
        let plan = Plan { split: Some(Split { width, cutoff: reach * width }), ..tight.clone() };
        ErrorRow {
            number: format!("{reach:.1}"),
            error: case.error(&plan),
            bound: cutoff_error(case.multipoles, reach, brackets(&tight)),
        }
    };
    (20..=100).step_by(10).map(row).collect()
}

/// Prints a table with the rows of all cases.
fn print(title: &str, cases: &[ErrorCase], measure: impl Fn(&ErrorCase) -> Vec<ErrorRow>) {
    println!("\n## {title}\n\n| suspension | number | error | bound | bound / error |\n|---|---|---|---|---|");
    for case in cases {
        for ErrorRow { number, error, bound } in measure(case).into_iter().filter(|row| row.error > 1e-12) {
            println!("| {} | {number} | {error:.1e} | {bound:.1e} | {:.1} |", case.name, bound / error);
        }
    }
}

fn main() {
    let of = |terms| {
        [(40, 1.0, 0.05), (60, 1.0, 0.4), (30, 2.0, 0.2), (16, 4.0, 0.4)]
            .map(|(count, ratio, fraction)| ErrorCase::new(count, ratio, fraction, terms))
    };
    let cases = [of(Multipoles::Dipole), of(Multipoles::Monopole)].concat();
    println!("# Errors by one number at a time\n\nThe largest of the relative errors of velocities, angular");
    println!("velocities and rates of strain; the number in units of the width of the Gaussian on the grid.");
    for method in [Method::Direct, Method::Split] {
        print(&format!("{method:?}: width over grid spacing"), &cases, |case| by_resolution(case, method));
    }
    print("Direct: half a stencil over the width", &cases, by_reach);
    print("Split: points of the window, at width over grid spacing", &cases, by_window);
    print("Split: cutoff of the pairs over the width", &cases, by_cutoff);
}
