//! Files that grow in the course of a run: opened at its start, or after the last step of an earlier part.

use files::{
    FileError, Manifest, MissingSteps, OutputKind, ParticleRows, Provenance, SceneHistory, SceneRecord, Series,
    Trajectory, drop_contacts_after, drop_fields_after, stored_rows,
};
use scene::OutputSchedules;
use simulation::Quantity;
use std::path::PathBuf;

/// Trajectory and time series: on the first rank, if they are ever due.
#[derive(Default)]
pub(super) struct Files {
    pub trajectory: Option<Trajectory>,
    pub series: Option<Series>,
    /// Warnings about damaged or missing parts, which the run does not need, in the files of
    /// an earlier part of the run.
    pub warnings: Vec<String>,
}

/// Parameters for opening files: at the start, or after the last step of an earlier part, with room until a step.
pub(super) struct OpenParameters<'a> {
    pub run: &'a Manifest,
    pub provenance: &'a Provenance,
    /// The scene, and the output schedules.
    pub scene: &'a SceneRecord,
    pub last: Option<u64>,
    pub room: u64,
}

const TRAJECTORY: &str = "trajectory.h5";
const SERIES: &str = "observables.h5";
const TABLE: &str = "observables.csv";

impl Files {
    /// Waits until all written data are on the disk.
    pub fn sync(&self) -> Result<(), FileError> {
        self.trajectory.as_ref().map_or(Ok(()), Trajectory::sync)?;
        self.series.as_ref().map_or(Ok(()), Series::sync)
    }

    /// Damaged frames and rows of an earlier part of the run.
    fn damage(&self) -> Vec<String> {
        let trajectory = self.trajectory.iter().flat_map(Trajectory::damage).map(|damage| (TRAJECTORY, damage));
        let series = self.series.iter().flat_map(Series::damage).map(|damage| (SERIES, damage));
        let warning = |(name, damage)| format!("{name} is damaged: {damage}; the run goes on without it");
        trajectory.chain(series).map(warning).collect()
    }
}

impl OpenParameters<'_> {
    pub fn files(
        &self,
        output: &OutputSchedules,
        frame: ParticleRows,
        quantities: &[Quantity],
    ) -> Result<Files, FileError> {
        if let Some(last) = self.last {
            self.run.remove_temporary_files();
            drop_fields_after(self.run, last)?;
            drop_contacts_after(self.run, last)?;
        }
        let [frames, rows] = self.capacities(output, quantities);
        let [trajectory, series] = self.histories()?;
        let is_there = |name: &str| self.path(name).exists();
        let were_there = [is_there(TRAJECTORY), is_there(SERIES) || is_there(TABLE)];
        let mut files = Files {
            trajectory: if frames > 0 { Some(self.trajectory(frame, frames, &trajectory)?) } else { None },
            series: if rows > 0 { Some(self.series(quantities, rows, &series)?) } else { None },
            warnings: Vec::new(),
        };
        files.warnings = files.damage();
        if let Some(last) = self.last {
            files.warnings.extend(self.missing(&files, were_there, last)?);
        }
        Ok(files)
    }

    /// Numbers of frames and rows at the end: existing ones, at whatever intervals, and future ones.
    fn capacities(&self, output: &OutputSchedules, quantities: &[Quantity]) -> [u64; 2] {
        let first = quantities.first().map_or(String::new(), |quantity| format!("observables/{}/step", quantity.name));
        let files = [
            (output.trajectory, OutputKind::Frames, TRAJECTORY, "particles/all/position/step"),
            (output.observables, OutputKind::Rows, SERIES, first.as_str()),
        ];
        files.map(|(schedule, what, name, steps)| {
            let all = schedule.count_until(self.room);
            let Some(last) = self.last.filter(|_| all > 0) else { return all };
            let expected = MissingSteps::of(&self.scene.periods(what, last), &[], &(0..=last)).count();
            expected.max(stored_rows(&self.path(name), steps)) + all - schedule.count_until(last).min(all)
        })
    }

    fn path(&self, name: &str) -> PathBuf {
        self.run.folder().join(name)
    }

    /// Scene histories of the trajectory and of the time series, up to the present scene. If one file has none,
    /// it takes that of the other.
    fn histories(&self) -> Result<[SceneHistory; 2], FileError> {
        let now = self.scene.text();
        let own = [TRAJECTORY, SERIES].map(|name| self.last.and_then(|_| SceneHistory::of(&self.path(name))));
        let any = own.iter().flatten().next().cloned();
        let any = any.unwrap_or_else(|| SceneHistory { first: now.to_owned(), changes: Vec::new() });
        let mut histories = own.map(|own| own.unwrap_or_else(|| any.clone()));
        if let Some(last) = self.last {
            for (history, name) in histories.iter_mut().zip([TRAJECTORY, SERIES]) {
                history.bring_to(now, last).map_err(|reason| FileError::damaged(&self.path(name), &reason))?;
            }
        }
        Ok(histories)
    }

    fn trajectory(&self, frame: ParticleRows, frames: u64, scenes: &SceneHistory) -> Result<Trajectory, FileError> {
        let (path, provenance) = (self.path(TRAJECTORY), self.provenance_with(scenes));
        self.run.enter(&path)?;
        let mut trajectory = match self.last {
            Some(last) if path.exists() => Trajectory::resume_for(&path, &provenance, frame, last, frames),
            _ => Trajectory::create_for(&path, &provenance, frame, frames),
        }?;
        trajectory.note_scenes(scenes)?;
        Ok(trajectory)
    }

    fn series(&self, quantities: &[Quantity], rows: u64, scenes: &SceneHistory) -> Result<Series, FileError> {
        let provenance = self.provenance_with(scenes);
        let mut series = match self.last {
            Some(last) => Series::resume(self.run, &provenance, quantities, last, rows),
            None => Series::create(self.run, &provenance, quantities, rows),
        }?;
        series.note_scenes(scenes)?;
        Ok(series)
    }

    fn provenance_with(&self, scenes: &SceneHistory) -> Provenance {
        Provenance { scene: scenes.first.clone(), ..self.provenance.clone() }
    }

    /// Warnings about output of the earlier part that is missing, up to its last step.
    fn missing(&self, files: &Files, [had_frames, had_rows]: [bool; 2], last: u64) -> Result<Vec<String>, FileError> {
        let steps_of = |folder: &str, name: &str| files_of(&self.path(folder), name);
        let frames = files.trajectory.as_ref().map(Trajectory::steps).transpose()?;
        let rows = files.series.as_ref().map(Series::steps).transpose()?;
        let all = [
            (OutputKind::Frames, (TRAJECTORY, "frames", had_frames), frames.or_else(|| (!had_frames).then(Vec::new))),
            (OutputKind::Rows, (SERIES, "rows", had_rows), rows.or_else(|| (!had_rows).then(Vec::new))),
            (OutputKind::Fields, ("fields", "files", true), Some(steps_of("fields", "velocity-"))),
            (OutputKind::Contacts, ("contacts", "files", true), Some(steps_of("contacts", "contacts-"))),
        ];
        let warning = |(what, (name, things, was_there), there): (OutputKind, (&str, &str, bool), Option<Vec<u64>>)| {
            let missing = MissingSteps::of(&self.scene.periods(what, last), &there?, &(0..=last));
            let (path, count) = (self.path(name), missing.count());
            let found = match (was_there, things) {
                (false, _) => "is gone",
                (true, "files") => "is not as the run has left it",
                (true, _) => "was cut, or replaced by another copy",
            };
            (!missing.is_empty()).then(|| {
                format!(
                    "{} {found}: {count} {things} are missing, of {missing}, which the run has written before its \
                     checkpoint of step {last}; it goes on without them",
                    path.display()
                )
            })
        };
        Ok(all.into_iter().filter_map(warning).collect())
    }
}

/// Steps of the numbered files in a folder whose names begin with `start`.
fn files_of(folder: &std::path::Path, start: &str) -> Vec<u64> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let step = |name: &str| name.strip_prefix(start)?.strip_suffix(".h5")?.parse().ok();
    entries.filter_map(|entry| step(entry.file_name().to_str()?)).collect()
}
