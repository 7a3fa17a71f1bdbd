//! The kinetic theory of a shear cell: solved once for each speed and pressure.

use crate::outline;
use crate::{Listener, RunError, provenance};
use domain::{Comm, Number};
use files::{Manifest, read_rows, write_tables};
use granular::kinetic_theory::{ContinuumProblem, ContinuumSolution, FlowPoint};
use scene::{ContinuumScene, Scene, in_full};
use simulation::Table;
use std::path::Path;

/// Whether a folder contains the solutions of all problems.
pub(super) fn is_solved(problems: &ContinuumScene, folder: &Path) -> bool {
    let rows = read_rows(&summary(), &folder.join("summary.csv"));
    folder.join(SOLUTION).with_extension("h5").exists() && rows.is_ok_and(|rows| rows.len() == problems.problems.len())
}

/// Name of the file of all tables, which is written last.
const SOLUTION: &str = "solution";

/// Solves all problems and writes their profiles. Problems without a solution are listed at the end.
pub(super) fn solve(
    problems: &ContinuumScene,
    scene: &Scene,
    run: &Manifest,
    listener: &dyn Listener,
) -> Result<(), RunError> {
    let (mut summary, mut profile) = (summary(), profile());
    let mut unsolved = Vec::new();
    for problem in &problems.problems {
        match problem.solve() {
            Ok(solution) => {
                report(problem, &solution, listener);
                summary.add(&[], &summary_of(problem, &solution));
                add_profile(&mut profile, problem, &solution.profile(problems.points));
            }
            Err(reason) => unsolved.push(format!("{}: {}", title(problem), in_full(&reason))),
        }
    }
    let provenance = provenance(scene, outline::continuum(problems).text().to_owned(), &Comm::alone());
    write_tables(run.folder(), SOLUTION, &provenance, &[summary, profile], run)?;
    if unsolved.is_empty() { Ok(()) } else { Err(RunError::Unsolved { unsolved, problems: problems.problems.len() }) }
}

fn title(problem: &ContinuumProblem) -> String {
    let p = problem.parameters();
    format!("at a speed of {} and a pressure of {}", Number(p.speed), Number(p.pressure))
}

fn report(problem: &ContinuumProblem, solution: &ContinuumSolution, listener: &dyn Listener) {
    listener.line(&format!(
        "{}: mean solid fraction {:.4}, slip {:.4} of the speed, shear stress {:.5}",
        title(problem),
        Number(solution.mean_solid_fraction()),
        Number(solution.slip() / problem.parameters().speed),
        Number(solution.shear_stress())
    ));
    if let Some(notice) = solution.notice() {
        listener.line(&format!("warning: {notice}"));
    }
}

fn summary() -> Table {
    let stress = "force/length^2";
    Table::new(
        "summary",
        &[],
        &[
            ("speed", "length/time"),
            ("pressure", stress),
            ("mean_solid_fraction", ""),
            ("slip", "length/time"),
            ("shear_stress", stress),
            ("residual", ""),
            ("intervals", ""),
            ("dilute", ""),
        ],
    )
}

fn summary_of(problem: &ContinuumProblem, solution: &ContinuumSolution) -> [f64; 8] {
    let p = problem.parameters();
    [
        p.speed,
        p.pressure,
        solution.mean_solid_fraction(),
        solution.slip(),
        solution.shear_stress(),
        solution.residual(),
        solution.intervals() as f64,
        f64::from(solution.is_dilute()),
    ]
}

fn profile() -> Table {
    Table::new(
        "profile",
        &[],
        &[
            ("speed", "length/time"),
            ("pressure", "force/length^2"),
            ("y", "length"),
            ("velocity", "length/time"),
            ("solid_fraction", ""),
            ("temperature", "length^2/time^2"),
            ("energy_flux", "force/(length*time)"),
        ],
    )
}

fn add_profile(table: &mut Table, problem: &ContinuumProblem, points: &[FlowPoint]) {
    let p = problem.parameters();
    for FlowPoint { y, velocity, solid_fraction, temperature, energy_flux } in points {
        table.add(&[], &[p.speed, p.pressure, *y, *velocity, *solid_fraction, *temperature, *energy_flux]);
    }
}
