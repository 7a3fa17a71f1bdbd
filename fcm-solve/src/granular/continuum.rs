//! The kinetic theory of a shear cell: solved once for each speed and pressure.

use super::outline;
use crate::output::provenance;
use crate::streams;
use anyhow::{Context, ensure};
use domain::{Comm, Number};
use drivers::continuum::{Point, Problem, Solution};
use io::{ContinuumScene, Scene, Table, write_tables};
use std::path::Path;
use std::process::ExitCode;

/// Whether a folder has the solutions of all problems.
pub fn is_solved(problems: &ContinuumScene, folder: &Path) -> bool {
    let rows = summary().read_rows(&folder.join("summary.csv"));
    folder.join(SOLUTION).with_extension("h5").exists() && rows.is_ok_and(|rows| rows.len() == problems.problems.len())
}

/// The file of all tables, which is written last.
const SOLUTION: &str = "solution";

/// Solves all problems and writes their profiles. Those that have no solution are named at the end.
pub fn solve(problems: &ContinuumScene, scene: &Scene, folder: &Path, comm: &Comm) -> anyhow::Result<ExitCode> {
    let (mut summary, mut profile) = (summary(), profile());
    let mut unsolved = Vec::new();
    for problem in &problems.problems {
        match problem.solve().with_context(|| title(problem)) {
            Ok(solution) => {
                report(problem, &solution);
                summary.add(&[], &summary_of(problem, &solution));
                add_profile(&mut profile, problem, &solution.profile(problems.points));
            }
            Err(error) => unsolved.push(error),
        }
    }
    let provenance = provenance(scene, outline::continuum(problems), comm);
    write_tables(folder, SOLUTION, &provenance, &[summary, profile])?;
    streams::log(format_args!("finished; results in {}", folder.display()));
    ensure!(unsolved.is_empty(), "{}", of_all(&unsolved, problems.problems.len()));
    Ok(ExitCode::SUCCESS)
}

/// Why problems have no solution, a line each.
fn of_all(unsolved: &[anyhow::Error], problems: usize) -> String {
    let reasons: Vec<String> = unsolved.iter().map(|error| format!("{error:#}")).collect();
    format!("{} of {problems} problems have no solution:\n{}", unsolved.len(), reasons.join("\n"))
}

fn title(problem: &Problem) -> String {
    let p = problem.parameters();
    format!("at a speed of {} and a pressure of {}", Number(p.speed), Number(p.pressure))
}

fn report(problem: &Problem, solution: &Solution) {
    streams::log(format_args!(
        "{}: mean solid fraction {:.4}, slip {:.4} of the speed, shear stress {:.5}",
        title(problem),
        Number(solution.mean_solid_fraction()),
        Number(solution.slip() / problem.parameters().speed),
        Number(solution.shear_stress())
    ));
    if let Some(notice) = solution.notice() {
        streams::log(format_args!("warning: {notice}"));
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

fn summary_of(problem: &Problem, solution: &Solution) -> [f64; 8] {
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

fn add_profile(table: &mut Table, problem: &Problem, points: &[Point]) {
    let p = problem.parameters();
    for Point { y, velocity, solid_fraction, temperature, energy_flux } in points {
        table.add(&[], &[p.speed, p.pressure, *y, *velocity, *solid_fraction, *temperature, *energy_flux]);
    }
}
