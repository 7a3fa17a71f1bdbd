//! Errors of an evaluation against one number at a time, beside what the planner expects of it: the measurements that
//! its bounds were fitted to. Prints Markdown.
//!
//! `cargo run --release -p fcm --example errors`

#[path = "../tests/common/mod.rs"]
mod common;

#[path = "../src/accuracy.rs"]
#[allow(dead_code, reason = "the bounds alone are printed")]
mod accuracy;

/// Where the library's module of bounds looks for it.
mod problem {
    pub use fcm::MethodName;
}

use accuracy::{cutoff_error, grid_error, stencil_error};
use common::{Suspension, errors};
use domain::{PeriodicBox, Vector};
use fcm::{Fixed, Loads, Method, MethodName, Motion, Plan, Precision};

/// A suspension, loads and the exact motion.
struct Case {
    name: String,
    suspension: Suspension,
    loads: Loads,
    exact: Motion,
}

impl Case {
    fn new(count: usize, ratio: f64, fraction: f64) -> Self {
        let volume = 0.5 * count as f64 * 4.0 / 3.0 * std::f64::consts::PI * (1.0 + ratio.powi(3)) / fraction;
        let cell = PeriodicBox::new(Vector::splat(volume.cbrt())).expect("the volume is positive");
        let suspension = Suspension::random(count, ratio, cell, 1);
        let loads = suspension.loads(1);
        let exact = suspension.motion(&loads);
        Self { name: format!("radii 1:{ratio}, {:.0}%", 100.0 * fraction), suspension, loads, exact }
    }

    /// The tightest plan of a method: one number of it is made worse at a time.
    fn tightest(&self, method: MethodName) -> Plan {
        let fixed = Fixed { method: Some(method), precision: Some(Precision::Double), ..Fixed::default() };
        self.suspension.plan(1e-12, fixed)
    }

    /// The largest of the errors of velocities, angular velocities and rates of strain.
    fn error(&self, plan: &Plan) -> f64 {
        errors(&self.suspension.evaluate(plan, &self.loads), &self.exact).into_iter().fold(0.0, f64::max)
    }
}

/// The width of the narrowest Gaussian on the grid, which sets the spacing, and of the widest, which sets the stencil.
fn widths(plan: &Plan) -> [f64; 2] {
    match plan.method {
        Method::Split { width, .. } => [width; 2],
        Method::Direct => {
            let of = |radius: &f64| fcm::Envelope::of_sphere(*radius);
            let [first, last] = [plan.radii.first(), plan.radii.last()].map(|a| of(a.expect("a plan has radii")));
            [first.dipole, last.monopole]
        }
    }
}

/// Grids from coarse to fine with stencils and cutoffs that add nothing: the error by `Sigma / h`.
fn by_resolution(case: &Case, method: MethodName) -> Vec<(f64, f64)> {
    let tight = case.tightest(method);
    let edge = tight.edges.x;
    let [narrowest, widest] = widths(&tight);
    let row = |points: usize| {
        let spacing = edge / points as f64;
        let mut plan = tight.clone();
        plan.grid = [points; 3];
        // Eight widths to either side are exp(-32).
        let support = (16.0 * widest / spacing).ceil() as usize;
        let reach = 0.5 * support as f64 * spacing;
        plan.support = fcm::Support { lanes: support.next_multiple_of(8), support, reach };
        (narrowest / spacing, case.error(&plan))
    };
    let finest = tight.grid[0];
    (4..=finest).step_by(2).filter(|&n| is_good(n) && n * 4 >= finest).map(row).collect()
}

fn is_good(points: usize) -> bool {
    [2, 3, 5, 7].iter().fold(points, |mut n, p| {
        while n.is_multiple_of(*p) {
            n /= p;
        }
        n
    }) == 1
}

/// Stencils from short to long on the finest grid: the error by half a stencil over the width.
fn by_reach(case: &Case, method: MethodName) -> Vec<(f64, f64)> {
    let tight = case.tightest(method);
    let spacing = tight.edges.x / tight.grid[0] as f64;
    let row = |support: usize| {
        let mut plan = tight.clone();
        let reach = 0.5 * support as f64 * spacing;
        plan.support = fcm::Support { lanes: support.next_multiple_of(8), support, reach };
        (reach / widths(&tight)[1], case.error(&plan))
    };
    (8..=tight.support.support).step_by(4).map(row).collect()
}

/// Cutoffs from short to long on the finest grid: the error by the cutoff over the width.
fn by_cutoff(case: &Case) -> Vec<(f64, f64)> {
    let tight = case.tightest(MethodName::Split);
    let row = |reach: i32| {
        let mut plan = tight.clone();
        let width = widths(&tight)[0];
        plan.method = Method::Split { width, cutoff: f64::from(reach) * width };
        (f64::from(reach), case.error(&plan))
    };
    (2..=10).map(row).collect()
}

/// A table for each case: the number, the error, and the bound that the planner goes by.
fn print(title: &str, cases: &[Case], measure: impl Fn(&Case) -> Vec<(f64, f64)>, bound: impl Fn(f64) -> f64) {
    println!("\n## {title}\n\n| suspension | number | error | bound | bound / error |\n|---|---|---|---|---|");
    for case in cases {
        for (number, error) in measure(case).into_iter().filter(|row| row.1 > 1e-12) {
            let bound = bound(number);
            println!("| {} | {number:.2} | {error:.1e} | {bound:.1e} | {:.1} |", case.name, bound / error);
        }
    }
}

fn main() {
    let cases = [Case::new(40, 1.0, 0.05), Case::new(60, 1.0, 0.4), Case::new(30, 2.0, 0.2), Case::new(16, 4.0, 0.4)];
    println!("# Errors by one number at a time\n\nThe largest of the relative errors of velocities, angular");
    println!("velocities and rates of strain; the number in units of the width of the Gaussian on the grid.");
    for method in [MethodName::Direct, MethodName::Split] {
        print(
            &format!("{method:?}: width over grid spacing"),
            &cases,
            |case| by_resolution(case, method),
            |n| grid_error(method, n),
        );
        print(
            &format!("{method:?}: half a stencil over the width"),
            &cases,
            |case| by_reach(case, method),
            |n| stencil_error(method, n),
        );
    }
    print("Split: cutoff of the pairs over the width", &cases, by_cutoff, cutoff_error);
}
