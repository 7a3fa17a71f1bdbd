//! Statistics of the frames of a trajectory.

use crate::number::positive;
use crate::sampled_frames::SampledFrames;
use crate::streams;
use anyhow::{Context, anyhow, bail, ensure};
use domain::{Comm, MemoryNeed, Particles, Partition, Process};
use files::{Manifest, Provenance, TrajectoryReader, write_tables};
use run::provenance;
use scene::{Scene, SuspensionScene};
use simulation::Table;
use std::path::{Path, PathBuf};
use suspension::{
    Model, MultipoleOrder, RankCounts, SAMPLE_COLUMNS, Sample, Statistics, StatisticsParameters, column_bytes,
};

/// Options of the statistics of a trajectory.
#[derive(clap::Args)]
pub struct Options {
    /// Time lag from which motion is diffusive [default: a quarter of the time span]
    #[arg(long, value_name = "T", value_parser = positive, allow_hyphen_values = true)]
    diffusive_from: Option<f64>,
    /// Largest distance of pairs [default: 8 of the largest radius]
    #[arg(long, value_name = "R", value_parser = positive, allow_hyphen_values = true)]
    distance: Option<f64>,
    /// Folder of the tables [default: stats in the folder of the run]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// The statistics of a run's trajectory.
pub struct TrajectoryStatistics {
    /// Summary table.
    pub summary: Table,
    /// Folder of all tables.
    pub folder: PathBuf,
    /// Number of frames that the run should have written but that are absent.
    pub missing: u64,
    /// Number of damaged frames.
    pub damaged: u64,
}

impl Options {
    /// Reads the frames of a run's trajectory between two times one by one, and writes the tables of their statistics.
    pub fn statistics_of(
        &self,
        folder: &Path,
        scene: &Scene,
        suspension: &SuspensionScene,
        [from, until]: [f64; 2],
    ) -> anyhow::Result<TrajectoryStatistics> {
        let trajectory = folder.join("trajectory.h5");
        let recorded = TrajectoryReader::open(&trajectory)?;
        let model = &suspension.model;
        let wanted = self.wanted(model, from)?;
        for change in recorded.changes().iter().filter(|change| change.changes_answers()) {
            streams::log(format_args!("warning: {}: {change}; the statistics are of both", trajectory.display()));
        }
        let chosen = SampledFrames::of(&recorded, &(wanted.from..=until), &trajectory);
        let (statistics, damaged) = sampled(&recorded, &chosen, model, wanted, &trajectory)?;
        let Some(mut statistics) = statistics else {
            bail!("the trajectory has no whole frame in that span; change --from and --until")
        };
        let out = self.out.clone().unwrap_or_else(|| folder.join("stats"));
        ensure!(out.file_name().is_some(), "--out {} is no name for a folder", out.display());
        let of_run = recorded.provenance();
        let provenance =
            Provenance { scene: of_run.scene.clone(), ..provenance(scene, of_run.plan.clone(), &Comm::alone()) };
        let tables = statistics.tables();
        let manifest = Manifest::of(folder)?;
        write_tables(&out, "statistics", &provenance, &tables, &manifest).context("the statistics are lost")?;
        let summary = tables.into_iter().next().expect("the summary is the first of the tables");
        Ok(TrajectoryStatistics { summary, folder: out, missing: chosen.missing.count(), damaged })
    }

    /// The scene's choice of statistics, overridden by the options.
    fn wanted(&self, model: &Model, from: f64) -> anyhow::Result<StatisticsParameters> {
        let mut wanted = model.statistics.unwrap_or(StatisticsParameters::ALL);
        wanted.from = from;
        wanted.diffusive_from = self.diffusive_from.or(wanted.diffusive_from);
        if let Some(distance) = self.distance {
            StatisticsParameters::check_distance(distance, &model.cell).map_err(|e| anyhow!("--distance {e}"))?;
            wanted.distance = Some(distance);
        }
        Ok(wanted)
    }
}

/// Statistics of frames, and the number of damaged frames, each of which is named in a warning; no statistics if no
/// frame is whole.
fn sampled(
    recorded: &TrajectoryReader,
    chosen: &SampledFrames,
    model: &Model,
    wanted: StatisticsParameters,
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
        statistics.skip_missing(before.map_or(0, |before| (step - before) / chosen.interval - 1));
        before = Some(step);
        let (rate, cell, particles) = (model.shear_rates().before_time(time), &cell, &particles);
        let (partition, shear_stress, pressure_gradient) = (&everything, None, None);
        statistics.sample(&Sample { time, rate, cell, particles, partition, shear_stress, pressure_gradient });
    }
    Ok((statistics, damaged))
}

/// Refuses particles without the columns that statistics need, or with species that the scene does not have.
fn fits(particles: &Particles, model: &Model) -> anyhow::Result<()> {
    let needed = if model.hydrodynamics.multipoles == MultipoleOrder::Dipole {
        &SAMPLE_COLUMNS[..]
    } else {
        &SAMPLE_COLUMNS[..1]
    };
    for name in needed {
        let has = particles.columns.iter().any(|column| column.name == *name);
        ensure!(has, "it has no {name}, which statistics are made of");
    }
    let species = model.species.len();
    let unknown = particles.species.iter().find(|&&s| s as usize >= species);
    ensure!(unknown.is_none(), "it has a sphere of species {}; the scene has {species}, from 0", unknown.unwrap_or(&0));
    Ok(())
}

/// Refuses a number of samples of `particles` particles that does not fit into memory.
fn check_memory(model: &Model, particles: f64, samples: u64) -> anyhow::Result<()> {
    let share = RankCounts::alone(particles);
    let kept = share.bytes(model, samples, rayon::current_num_threads());
    let frame = Particles::bytes(particles, 11);
    let peak = kept.then(column_bytes(model)).then(frame).then(share.sample_bytes(model));
    let need = MemoryNeed { resident: Process::ALONE.resident(peak.most), ..MemoryNeed::default() };
    Comm::check_memory_of(&[need]).with_context(|| {
        format!(
            "{samples} samples of {particles} particles of {} species take too much memory; take fewer, by --from \
            and --until",
            model.species.len()
        )
    })
}
