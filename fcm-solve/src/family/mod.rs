//! Families of runs: each member is run by a child process of this program, on a core of its own if there are at least
//! as many members as cores.

mod check;
mod child;
mod info;
mod outcome;
mod part;
mod pool;
mod stats;

use crate::part_progress::PartProgress;
use crate::signals::Signals;
use crate::streams;
use anyhow::{bail, ensure};
pub use check::check;
use domain::{AvailableMemory, Comm};
pub use info::info;
pub use part::Part;
use pool::ProcessPool;
use run::{ExistingRun, FamilyFolder, MemberState};
use scene::{Family, Member};
pub use stats::stats;
use std::path::Path;
use std::process::ExitCode;

/// Family to make, the part of it that this program makes, and the changes that are accepted.
pub struct FamilyTask<'a> {
    /// Family to make.
    pub family: &'a Family,
    /// Part of the family that this program makes.
    pub part: Part,
    /// Keys whose values may have changed when members are continued.
    pub accepted: &'a [String],
}

/// Largest number of failures that are named at the end.
const NAMED: usize = 10;

/// Makes the missing runs of a family, and the table of their answers.
pub fn run(work: &FamilyTask, path: &Path, former: ExistingRun, signals: &Signals) -> anyhow::Result<ExitCode> {
    let family = work.family;
    let folder = FamilyFolder::claim(path, family, former)?;
    let members = work.part.of(family.members());
    let mut missing = Vec::new();
    for member in &members {
        if folder.state(member, &family.scene(member)?) != MemberState::Finished {
            missing.push(*member);
        }
    }
    let at_once = at_once(family, &missing)?.min(missing.len()).max(1);
    let mut progress = PartProgress::start(&Comm::alone(), "all runs");
    progress.say(&described(work, members.len(), missing.len(), at_once));
    progress.say(&format!("results    {}", folder.path().display()));
    let done = members.len() - missing.len();
    progress.show(done as f64 / members.len().max(1) as f64);
    let mut pool = ProcessPool::new(work, &folder, at_once, signals, progress);
    pool.make(&missing, done, members.len())?;
    folder.write_table(family)?;
    end(&pool, &folder, members.len(), signals)
}

/// A line that describes the members to make.
fn described(work: &FamilyTask, all: usize, missing: usize, at_once: usize) -> String {
    let FamilyTask { family, part, .. } = work;
    let points = family.points().count();
    let part = part.described(family.members().len());
    let finished = if all > missing { format!(", {} finished before", all - missing) } else { String::new() };
    format!("family     {all} runs{part}, {points} points{finished}; {at_once} at a time")
}

/// Number of runs at a time: one per core, as far as memory allows. Every point is planned first.
fn at_once(family: &Family, missing: &[&Member]) -> anyhow::Result<usize> {
    let cores = rayon::current_num_threads();
    let mut most = 0.0_f64;
    for members in missing.chunk_by(|one, other| one.point == other.point) {
        let scene = family.scene(members[0])?;
        let bytes = run::predicted_memory(scene.kind(), 1)
            .map_err(|e| anyhow::anyhow!("{}: {}", members[0], scene::in_full(&e)))?;
        most = most.max(bytes.unwrap_or_default());
    }
    let room = AvailableMemory::of_machine().map_or(f64::INFINITY, |room| room.bytes);
    Ok(if most > 0.0 { cores.min((room / most) as usize) } else { cores }.max(1))
}

/// Reports failures, or the command that continues the family, and returns the exit code.
fn end(pool: &ProcessPool, folder: &FamilyFolder, all: usize, signals: &Signals) -> anyhow::Result<ExitCode> {
    signals.tell_steps_taken(pool.steps_taken());
    if let Some(stop) = signals.received() {
        ensure!(
            !pool.is_in_vain(stop),
            "the family's time is too short for a step of any run: give it more time (--walltime, or the job's limit)"
        );
        streams::log(format_args!("stopped by {stop}; go on with: {}", signals.command()));
        return Ok(stop.into());
    }
    let failures = pool.failures();
    let Some(first) = failures.first() else {
        streams::inform(format_args!("finished; results in {}", folder.path().display()));
        return Ok(ExitCode::SUCCESS);
    };
    for failure in failures.iter().take(NAMED) {
        streams::log(failure);
    }
    bail!(
        "{} of {all} runs failed{}, see {}; the others are finished; try those again with: {}",
        failures.len(),
        if failures.len() > NAMED { format!(", of which {NAMED} are named") } else { String::new() },
        first.log.display(),
        signals.command()
    );
}
