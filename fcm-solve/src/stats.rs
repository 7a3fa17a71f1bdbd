//! `fcm-solve stats`: statistics of a run from its trajectory.

use crate::causes::in_full;
use crate::family;
use crate::number::{finite, positive};
use crate::sampled_frames::SampledFrames;
use crate::streams::{self, json};
use anyhow::{Context, anyhow, bail, ensure};
use domain::{Comm, Need, Particles, Partition, Process};
use io::{FamilyFolder, Kind, Manifest, Provenance, Scene, TrajectoryReader, provenance, write_tables};
use serde_json::json;
use simulation::Table;
use std::path::{Path, PathBuf};
use suspension::{
    Model, Multipoles, SAMPLE_COLUMNS, Sample, Statistics, StatisticsOfRank, StatisticsWanted, column_bytes,
};

/// Which run, and what of it.
#[derive(clap::Args)]
pub struct Args {
    /// The folder of a run, or of a family
    folder: PathBuf,
    /// Leave out what was before this time
    #[arg(long, value_name = "T", value_parser = finite, allow_hyphen_values = true)]
    from: Option<f64>,
    /// Leave out what was after this time
    #[arg(long, value_name = "T", value_parser = finite, allow_hyphen_values = true)]
    to: Option<f64>,
    /// Time lag from which motion is diffusive [default: a quarter of the time taken in]
    #[arg(long, value_name = "T", value_parser = positive, allow_hyphen_values = true)]
    diffusive_from: Option<f64>,
    /// Largest distance of pairs [default: 8 of the largest radius]
    #[arg(long, value_name = "R", value_parser = positive, allow_hyphen_values = true)]
    distance: Option<f64>,
    /// Folder of the tables [default: stats in the folder of the run]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print the summary as JSON
    #[arg(long)]
    json: bool,
}

/// Reads the trajectory frame by frame on the first rank. Collective.
pub fn run(args: &Args, comm: &Comm) -> anyhow::Result<()> {
    let done = if comm.is_first() { take(args) } else { Ok(()) };
    Ok(comm.agree(done.map_err(|e| in_full(&e)))?)
}

fn take(args: &Args) -> anyhow::Result<()> {
    if FamilyFolder::holds_family(&args.folder) {
        return streams::print_here(&family::stats(&args.folder, args.json)?);
    }
    let trajectory = args.folder.join("trajectory.h5");
    let recorded = TrajectoryReader::open(&trajectory)?;
    let scene = Scene::parse(&recorded.provenance().scene, "the scene of the run", &[])?;
    let Kind::Suspension(suspension) = scene.kind() else {
        bail!("{} is not of a suspension, and statistics are of those only", trajectory.display())
    };
    let model = &suspension.model;
    ensure!(
        model.shear_rates().stress().is_none(),
        "{} has velocities in a flow that a stress drives, but not its rates of shear; have the run take statistics, by [statistics]",
        trajectory.display()
    );
    let mut wanted = model.statistics.unwrap_or(StatisticsWanted::ALL);
    wanted.from = args.from.unwrap_or(f64::NEG_INFINITY);
    wanted.diffusive_from = args.diffusive_from.or(wanted.diffusive_from);
    if let Some(distance) = args.distance {
        StatisticsWanted::check_distance(distance, &model.cell).map_err(|e| anyhow!("--distance {e}"))?;
        wanted.distance = Some(distance);
    }
    let until = args.to.unwrap_or(f64::INFINITY);
    for change in recorded.changes().iter().filter(|change| change.changes_answers()) {
        streams::log(format_args!("warning: {}: {change}; the statistics are of both", trajectory.display()));
    }
    let chosen = SampledFrames::of(&recorded, &(wanted.from..=until), &trajectory);
    let (statistics, damaged) = sampled(&recorded, &chosen, (model, wanted), &trajectory)?;
    let Some(mut statistics) = statistics else {
        bail!("the trajectory has no whole frame in that span; change --from and --to")
    };
    let out = args.out.clone().unwrap_or_else(|| args.folder.join("stats"));
    ensure!(out.file_name().is_some(), "--out {} is no name for a folder", out.display());
    let of_run = recorded.provenance();
    let provenance =
        Provenance { scene: of_run.scene.clone(), ..provenance(&scene, of_run.plan.clone(), &Comm::alone()) };
    let tables = statistics.tables();
    let manifest = Manifest::of(&args.folder)?;
    write_tables((&out, "statistics"), &provenance, &tables, &manifest).context("the statistics are lost")?;
    let summary = &tables[0];
    let words = || format!("{}tables     {}\n", in_columns(summary), out.display());
    let frames = json!({ "missing": chosen.missing.count(), "damaged": damaged });
    let values = || json(&json!({ "summary": summary.to_json(), "tables": out, "frames": frames }));
    streams::print_here(&if args.json { values() } else { words() })
}

/// The statistics of frames, none if none is whole, and how many are damaged; each of these is named in a warning.
fn sampled(
    recorded: &TrajectoryReader,
    chosen: &SampledFrames,
    (model, wanted): (&Model, StatisticsWanted),
    path: &Path,
) -> anyhow::Result<(Option<Statistics>, u64)> {
    let (alone, mut statistics) = (Comm::alone(), None::<Statistics>);
    let everything = Partition::new(&alone, [1, 1]);
    let (mut before, mut damaged) = (None, 0);
    for &frame in &chosen.frames {
        let (step, time) = (recorded.steps()[frame], recorded.times()[frame]);
        let (cell, particles) = match recorded.frame(frame) {
            Ok(frame) => frame,
            Err(error) => {
                streams::log(format_args!("warning: {error}; the statistics are without this frame"));
                damaged += 1;
                continue;
            }
        };
        fits(&particles, model).with_context(|| format!("frame {frame} of {}", path.display()))?;
        if statistics.is_none() {
            check_memory(model, particles.len() as f64, chosen.samples)?;
        }
        let statistics = statistics.get_or_insert_with(|| Statistics::new(model, wanted, &particles, &alone));
        statistics.pass_over(before.map_or(0, |before| (step - before) / chosen.interval - 1));
        before = Some(step);
        let (rate, cell, particles) = (model.shear_rates().before_time(time), &cell, &particles);
        let (partition, shear_stress, pressure_gradient) = (&everything, None, None);
        statistics.sample(&Sample { time, rate, cell, particles, partition, shear_stress, pressure_gradient });
    }
    Ok((statistics, damaged))
}

/// Refuses particles of which no statistics can be made: without velocities, or of another scene.
fn fits(particles: &Particles, model: &Model) -> anyhow::Result<()> {
    let needed =
        if model.hydrodynamics.multipoles == Multipoles::Dipole { &SAMPLE_COLUMNS[..] } else { &SAMPLE_COLUMNS[..1] };
    for name in needed {
        let has = particles.columns.iter().any(|column| column.name == *name);
        ensure!(has, "it has no {name}, which statistics are made of");
    }
    let species = model.species.len();
    let unknown = particles.species.iter().find(|&&s| s as usize >= species);
    ensure!(unknown.is_none(), "it has a sphere of species {}; the scene has {species}, from 0", unknown.unwrap_or(&0));
    Ok(())
}

/// Refuses samples of so many particles of a model that there is no memory for.
fn check_memory(model: &Model, particles: f64, samples: u64) -> anyhow::Result<()> {
    let share = StatisticsOfRank::alone(particles);
    let kept = share.bytes(model, (samples, rayon::current_num_threads()));
    let frame = Particles::bytes(particles, 11);
    let peak = kept.then(column_bytes(model)).then(frame).then(share.sample_bytes(model));
    let need = Need { resident: Process::ALONE.resident(peak.most), ..Need::default() };
    Comm::check_memory_of(&[need]).with_context(|| {
        format!("{samples} samples of {particles} particles of {} species take too much memory; take fewer, by --from and --to",
            model.species.len())
    })
}

/// The summary for reading: quantity, species, value and error.
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
