//! `fcm-solve stats`: the answers of a run, and statistics of its trajectory.

use crate::causes::in_full;
use crate::family;
use crate::number::finite;
use crate::streams::{self, json};
use crate::trajectory_statistics::{Options, TrajectoryStatistics};
use anyhow::bail;
use domain::Comm;
use files::{Provenance, SCENES};
use report::{AnswerRange, RunAnswer, answers_in_json, answers_in_lines, run_answers};
use run::FamilyFolder;
use scene::{Kind, Scene};
use serde_json::{Value, json};
use simulation::Table;
use std::path::PathBuf;

/// Run, time span and tables of `fcm-solve stats`.
#[derive(clap::Args)]
pub struct StatsArgs {
    /// The folder of a run, or of a family
    folder: PathBuf,
    /// Leave out the part before this time [default: answers.from of the scene, or the transient found]
    #[arg(long, value_name = "T", value_parser = finite, allow_hyphen_values = true)]
    from: Option<f64>,
    /// Leave out the part after this time
    #[arg(long, alias = "to", value_name = "T", value_parser = finite, allow_hyphen_values = true)]
    until: Option<f64>,
    #[command(flatten)]
    of_trajectory: Options,
    /// Print answers and summary as JSON
    #[arg(long)]
    json: bool,
}

/// Reads the time series and the trajectory on the first rank. Collective.
pub fn run(args: &StatsArgs, comm: &Comm) -> anyhow::Result<()> {
    let done = if comm.is_first() { args.take() } else { Ok(()) };
    Ok(comm.agree(done.map_err(|e| in_full(&e)))?)
}

impl StatsArgs {
    fn take(&self) -> anyhow::Result<()> {
        if FamilyFolder::holds_family(&self.folder) {
            return streams::print_here(&family::stats(&self.folder, self.json)?);
        }
        let scene = self.scene()?;
        let until = self.until.unwrap_or(f64::INFINITY);
        let range = match self.from {
            Some(from) => AnswerRange { from: Some(from), until },
            None => AnswerRange { until, ..AnswerRange::of_run(&self.folder, &scene) },
        };
        let answers = run_answers(&self.folder, &scene, &range)?;
        let (statistics, why_not) = match self.statistics(&scene, until)? {
            Ok(statistics) => (Some(statistics), None),
            Err(reason) if answers.is_empty() => bail!(reason),
            Err(reason) => (None, Some(reason)),
        };
        if let Some(reason) = why_not {
            streams::log(format_args!("note: there are no statistics of motions: {reason}"));
        }
        let printed = if self.json { in_json(&answers, statistics) } else { in_lines(&answers, statistics) };
        streams::print_here(&printed)
    }

    /// The scene recorded in the provenance of the results; for a run without it, the scene.toml of the folder.
    fn scene(&self) -> anyhow::Result<Scene> {
        let (kept, table) = (self.folder.join("scene.toml"), self.folder.join("observables.csv"));
        match Provenance::of_folder(&self.folder)? {
            Some(recorded) => {
                let recorded_in = format!("the scene in the results of {}", self.folder.display());
                Ok(SCENES.parse(&recorded.scene, &recorded_in, &[])?)
            }
            None if table.is_file() => Ok(SCENES.read(&kept, &[])?),
            None => bail!(
                "{}: no results of a run: neither trajectory.h5 nor observables.csv; name the folder of a run that \
                 has begun",
                self.folder.display()
            ),
        }
    }

    /// The statistics of the trajectory; the inner `Err` is the reason why there are none.
    fn statistics(&self, scene: &Scene, until: f64) -> anyhow::Result<Result<TrajectoryStatistics, String>> {
        let trajectory = self.folder.join("trajectory.h5");
        let Kind::Suspension(suspension) = scene.kind() else {
            return Ok(Err(format!(
                "{}: not of a suspension, and only those have statistics of motions",
                self.folder.display()
            )));
        };
        if !trajectory.exists() {
            return Ok(Err(format!(
                "{} does not exist; a run writes it if output.trajectory_every is set",
                trajectory.display()
            )));
        }
        if suspension.model.shear_rates().stress().is_some() {
            return Ok(Err(format!(
                "{} has velocities in a flow that a stress drives, but not its rates of shear; have the run take \
                 statistics, by [statistics]",
                trajectory.display()
            )));
        }
        let times = [self.from.unwrap_or(f64::NEG_INFINITY), until];
        self.of_trajectory.statistics_of(&self.folder, scene, suspension, times).map(Ok)
    }
}

fn in_json(answers: &[RunAnswer], statistics: Option<TrajectoryStatistics>) -> String {
    let mut values = json!({ "answers": answers_in_json(answers) });
    if let (Some(of), Value::Object(values)) = (statistics, &mut values) {
        values.insert("summary".to_owned(), of.summary.to_json());
        values.insert("tables".to_owned(), json!(of.folder));
        values.insert("frames".to_owned(), json!({ "missing": of.missing, "damaged": of.damaged }));
    }
    json(&values)
}

fn in_lines(answers: &[RunAnswer], statistics: Option<TrajectoryStatistics>) -> String {
    let of_motions = statistics
        .map_or_else(String::new, |of| format!("{}tables     {}\n", in_columns(&of.summary), of.folder.display()));
    let answers = answers_in_lines(answers);
    let gap = if answers.is_empty() || of_motions.is_empty() { "" } else { "\n" };
    answers + gap + &of_motions
}

/// The summary as text: quantity, species, value and error in columns.
fn in_columns(summary: &Table) -> String {
    let line = |(words, numbers): &(Vec<String>, Vec<f64>)| {
        let error = match (numbers[1], numbers[2]) {
            (error, _) if error == 0.0 || !error.is_finite() => String::new(),
            (error, 0.0) => format!("+- {error:.2e} at least"),
            (error, _) => format!("+- {error:.2e}"),
        };
        let value = if numbers[0].is_finite() { format!("{:.6e}", numbers[0]) } else { "unknown".to_owned() };
        let line = format!("{:<28} {:<12} {value:>13} {error:<20} {}", words[0], words[1], words[2]);
        line.trim_end().to_owned() + "\n"
    };
    summary.rows.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_known_is_said_so() {
        let mut table =
            Table::new("summary", &["quantity", "species", "unit"], &[("value", ""), ("error", ""), ("converged", "")]);
        table.add(&["D_slope_x", "a", "length^2/time"], &[f64::NAN, f64::NAN, 0.0]);
        table.add(&["T_xx", "a", ""], &[0.5, f64::INFINITY, 0.0]);
        table.add(&["T_yy", "a", ""], &[0.5, 0.25, 0.0]);
        table.add(&["T_zz", "a", ""], &[0.5, 0.25, 1.0]);
        table.add(&["count", "a", ""], &[2.0, 0.0, 1.0]);
        let text = in_columns(&table);
        let words: Vec<Vec<&str>> = text.lines().map(|line| line.split_whitespace().collect()).collect();
        let expected = [
            "D_slope_x a unknown length^2/time",
            "T_xx a 5.000000e-1",
            "T_yy a 5.000000e-1 +- 2.50e-1 at least",
            "T_zz a 5.000000e-1 +- 2.50e-1",
            "count a 2.000000e0",
        ];
        assert_eq!(words.iter().map(|line| line.join(" ")).collect::<Vec<_>>(), expected);
    }
}
