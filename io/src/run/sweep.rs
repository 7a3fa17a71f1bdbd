//! Many runs of sheared disks, and their averages over the seeds.

use super::stored_cases::StoredCases;
use super::{Listener, RunError, outline, provenance};
use crate::{Manifest, Scene, write_tables};
use domain::Comm;
use drivers::disks::{Branch, Record, Sweep, estimated_free_path};
use simulation::Table;

/// Makes the runs that are left, several at a time, and writes the averages. Finished runs are stored.
pub(super) fn sweep(sweep: &Sweep, scene: &Scene, run: &Manifest, listener: &dyn Listener) -> Result<(), RunError> {
    let plan = format!("sweep      {}\n", outline::cases(sweep));
    listener.line(&format!("{plan}results    {}", run.folder().display()));
    let runs = sweep.run(&StoredCases::of(run, scene, sweep.cases().len(), listener)?)?;
    let branches = sweep.branches(&runs)?;
    let tables = [averages(&branches), summary(&branches)];
    Ok(write_tables((run.folder(), "sweep"), &provenance(scene, plan, &Comm::alone()), &tables, run)?)
}

/// What a branch is of.
const OF: [(&str, &str); 3] = [("viscosity", "force*time/length^2"), ("rate", "1/time"), ("area_fraction", "")];

fn of(branch: &Branch) -> [f64; 3] {
    [branch.case.viscosity, branch.case.rate, branch.case.area_fraction]
}

/// Mean and standard error over the seeds of each number at each strain.
fn averages(branches: &[Branch]) -> Table {
    let mut table = Table::new("averages", &[], &OF);
    for (name, unit) in Record::COLUMNS {
        table.columns.extend([(name.to_owned(), unit), (format!("{name}_error"), unit)]);
    }
    for branch in branches {
        for numbers in &branch.averages {
            let numbers: Vec<f64> = numbers.iter().flat_map(|e| [e.mean, e.error]).collect();
            table.add(&[], &[&of(branch)[..], &numbers].concat());
        }
    }
    table
}

/// The segregation in the last tenth of the runs against the two lengths.
fn summary(branches: &[Branch]) -> Table {
    let lengths = [("viscous_length", "length"), ("estimated_free_path", "length")];
    let last = [("last_segregation", ""), ("last_segregation_error", "")];
    let mut table = Table::new("branches", &[], &[&OF[..], &lengths, &last].concat());
    for branch in branches {
        let path = estimated_free_path(branch.case.area_fraction);
        let numbers = [branch.viscous_length, path, branch.last.mean, branch.last.error];
        table.add(&[], &[&of(branch)[..], &numbers].concat());
    }
    table
}
