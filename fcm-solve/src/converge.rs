//! `fcm-solve converge`: change of an answer with the step, the box, the tolerance and the stiffness of contacts.

use crate::commands::quoted;
use crate::family::{self, FamilyTask, Part};
use crate::scene_file::read;
use crate::signals::{Signals, StopArgs};
use crate::streams::{self, json};
use anyhow::{bail, ensure};
use domain::{Comm, Number};
use run::{AnswerChange, ChangeVerdict, ExistingRun, FamilyFolder};
use scene::Convergence;
use serde_json::json;
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// The scene, the quantity, and the runs to make.
#[derive(clap::Args)]
pub struct ConvergeArgs {
    /// The scene file
    scene: PathBuf,
    /// The quantity, as the answers of a run name it, or a part of its name
    #[arg(long, value_name = "QUANTITY")]
    of: String,
    /// Seeds of each kind of run
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u64).range(2..=1000))]
    seeds: u64,
    /// Folder of the runs [default: results/ and the scene's name with -converge]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Set a key of the scene, as in --set time.step=0.01; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    /// Replace the runs in that folder; otherwise the missing ones are made
    #[arg(long)]
    force: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    stops: StopArgs,
}

/// Makes the missing runs, and prints the change of the quantity at each point.
pub fn run(args: &ConvergeArgs, comm: &Comm) -> anyhow::Result<ExitCode> {
    ensure!(comm.size() == 1, "the runs are made by one process, side by side on its cores: start it without mpirun");
    let scene = read(&args.scene, &args.overrides, comm)?;
    let wanted = Convergence::of(&scene, args.seeds)?;
    for what in &wanted.left_out {
        streams::log(format_args!("left out: {what}"));
    }
    let path = args.folder();
    let signals = Signals::watch(comm, args.command(&path), &args.stops)?;
    let work = FamilyTask { family: &wanted.family, part: Part::WHOLE, accepted: &[] };
    let former = if args.force { ExistingRun::Replace } else { ExistingRun::Continue };
    let code = family::run(&work, &path, former, &signals)?;
    if code == ExitCode::SUCCESS {
        streams::print(comm, &answer(args, &wanted, &FamilyFolder::of(&path))?)?;
    }
    Ok(code)
}

impl ConvergeArgs {
    fn folder(&self) -> PathBuf {
        let name = self.scene.file_stem().unwrap_or(self.scene.as_os_str()).to_string_lossy();
        self.out.clone().unwrap_or_else(|| Path::new("results").join(format!("{name}-converge")))
    }

    /// Command line that makes the remaining runs.
    fn command(&self, folder: &Path) -> String {
        let sets: String = self.overrides.iter().fold(String::new(), |sets, set| sets + " --set " + &quoted(set));
        let [scene, folder] = [&self.scene, folder].map(|path| quoted(&path.display().to_string()));
        format!("fcm-solve converge {scene} --of {} --seeds {} --out {folder}{sets}", quoted(&self.of), self.seeds)
    }
}

/// The quantity at each point, in words or as JSON.
fn answer(args: &ConvergeArgs, wanted: &Convergence, folder: &FamilyFolder) -> anyhow::Result<String> {
    let (quantity, species) = quantity(&args.of, &folder.quantities(&wanted.family)?)?;
    let found = folder.changes(&wanted.family, (&quantity, &species))?;
    let names = std::iter::once("as it is").chain(wanted.changes.iter().copied());
    let rows: Vec<(&str, Option<AnswerChange>)> = names.zip(found).collect();
    let verdicts = folder.first_verdicts(&wanted.family, (&quantity, &species))?;
    Ok(if args.json { values(&quantity, &species, &rows) } else { words(&quantity, &species, &verdicts, &rows) })
}

/// The quantity of that name, or the only one whose name contains it.
fn quantity(name: &str, known: &BTreeSet<(String, String)>) -> anyhow::Result<(String, String)> {
    let full = |(quantity, species): &(String, String)| {
        if species.is_empty() || species == "all" { quantity.clone() } else { format!("{quantity}[{species}]") }
    };
    if let Some(found) = known.iter().find(|of| full(of) == name) {
        return Ok(found.clone());
    }
    let like: Vec<&(String, String)> = known.iter().filter(|of| full(of).contains(name)).collect();
    if let [found] = like[..] {
        return Ok(found.clone());
    }
    let which = if like.is_empty() { "no answer of the runs has" } else { "more than one answer of the runs has" };
    let all: Vec<String> = known.iter().map(full).collect();
    bail!(
        "--of {name}: {which} that name; there are {}",
        if all.is_empty() { "none".to_owned() } else { all.join(", ") }
    )
}

fn words(quantity: &str, species: &str, verdicts: &str, rows: &[(&str, Option<AnswerChange>)]) -> String {
    let of = if species.is_empty() || species == "all" { String::new() } else { format!(" of {species}") };
    let mut text = format!("{quantity}{of}, over the second half of each run\n");
    let width = rows.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    for (place, (name, found)) in rows.iter().enumerate() {
        let Some(found) = found else {
            writeln!(text, "{name:<width$}  no value").expect("text grows");
            continue;
        };
        let [mean, error] = [found.mean, found.error].map(Number);
        write!(text, "{name:<width$}  {mean:.5} +- {error:.2}").expect("text grows");
        match place {
            0 => writeln!(text, "  ({} seeds; by themselves {verdicts})", found.seeds),
            _ => writeln!(text, "  {}", change(found)),
        }
        .expect("text grows");
    }
    text + &conclusion(&rows[1..])
}

/// A change with its error, in per cent of the quantity if the quantity is larger than its own error, else in its
/// units; and its verdict.
fn change(found: &AnswerChange) -> String {
    let is_relative = (found.mean - found.change).abs() > found.error;
    let ([change, error, most], unit) = if is_relative {
        (found.relative().map(|part| 100.0 * part), " %")
    } else {
        ([found.change, found.change_error, found.at_most()], "")
    };
    let verdict = match found.verdict() {
        ChangeVerdict::NotSeen => format!("not seen, at most {:.2}{unit}", Number(most)),
        other => other.name().to_owned(),
    };
    format!("{} +- {:.2}{unit}: {verdict}", signed(change), Number(error))
}

fn signed(number: f64) -> String {
    format!("{}{:.2}", if number > 0.0 { "+" } else { "" }, Number(number))
}

/// Lines that list the changes by verdict: those that matter, those below the error, and those not seen.
fn conclusion(rows: &[(&str, Option<AnswerChange>)]) -> String {
    let with = |wanted: ChangeVerdict| {
        let names = rows.iter().filter(|(_, found)| found.is_some_and(|found| found.verdict() == wanted));
        names.map(|(name, _)| *name).collect::<Vec<_>>().join(", ")
    };
    let words = [
        (ChangeVerdict::Matters, "matters: "),
        (ChangeVerdict::Small, "changes it by less than its error: "),
        (ChangeVerdict::NotSeen, "makes no difference that these seeds show: "),
        (ChangeVerdict::Unknown, "unknown, for want of seeds or of longer runs: "),
    ];
    let lines = words.into_iter().map(|(verdict, words)| (words, with(verdict))).filter(|(_, names)| !names.is_empty());
    lines.fold(String::new(), |text, (words, names)| text + words + &names + "\n")
}

fn values(quantity: &str, species: &str, rows: &[(&str, Option<AnswerChange>)]) -> String {
    let row = |(name, found): &(&str, Option<AnswerChange>)| {
        json!({
            "what": name,
            "mean": found.map(|found| found.mean),
            "error": found.map(|found| found.error),
            "seeds": found.map(|found| found.seeds),
            "change": found.map(|found| found.change),
            "change_error": found.map(|found| found.change_error),
            "verdict": found.map(|found| found.verdict().name()),
        })
    };
    json(&json!({ "quantity": quantity, "species": species, "runs": rows.iter().map(row).collect::<Vec<_>>() }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_are_found_by_a_part_of_their_name() {
        let known = [("relative_viscosity", "all"), ("velocity_x", "a"), ("velocity_y", "a"), ("velocity", "all")];
        let known: BTreeSet<_> = known.map(|(quantity, species)| (quantity.to_owned(), species.to_owned())).into();
        let found = |name: &str| quantity(name, &known).map(|(quantity, _)| quantity);
        assert_eq!(found("viscosity").unwrap(), "relative_viscosity");
        assert_eq!(found("velocity").unwrap(), "velocity");
        assert_eq!(found("velocity_x[a]").unwrap(), "velocity_x");
        assert!(found("velocity_").unwrap_err().to_string().contains("more than one answer"));
        assert!(
            found("density")
                .unwrap_err()
                .to_string()
                .contains("no answer of the runs has that name; there are relative_viscosity,")
        );
    }

    #[test]
    fn a_table_says_what_matters() {
        let base = AnswerChange { mean: 2.0, error: 0.1, seeds: 3, change: 0.0, change_error: 0.0 };
        let rows = [
            ("as it is", Some(base)),
            ("half the step", Some(AnswerChange { change: 0.01, change_error: 0.02, ..base })),
            ("twice the edges", Some(AnswerChange { mean: 3.0, change: 1.0, change_error: 0.2, ..base })),
            ("a tenth of the tolerance", None),
            ("four times the stiffness", Some(AnswerChange { change: -0.02, change_error: 0.002, ..base })),
        ];
        let text = words("relative_viscosity", "all", "2 converged, 1 too short", &rows);
        for expected in [
            "relative_viscosity, over the second half of each run\n",
            "as it is                  2 +- 0.1  (3 seeds; by themselves 2 converged, 1 too short)\n",
            "half the step             2 +- 0.1  +0.5 +- 1 %: not seen, at most 3.8 %\n",
            "twice the edges           3 +- 0.1  +50 +- 10 %: matters\n",
            "a tenth of the tolerance  no value\n",
            "four times the stiffness  2 +- 0.1  -0.99 +- 0.099 %: small\n",
            "matters: twice the edges\nchanges it by less than its error: four times the stiffness\n\
             makes no difference that these seeds show: half the step\n",
        ] {
            assert!(text.contains(expected), "{expected}{text}");
        }
    }
}
