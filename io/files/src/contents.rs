//! The contents of a result file, as `fcm-solve info` shows them.

use crate::frames::FrameChecksums;
use crate::scene_history::{self, SceneHistory};
use crate::{FileError, Provenance, claimed_size, self_contained, text, verified};
use domain::Number;
use hdf5::{Dataset, File, Group};
use scene::SceneChange;
use serde::Serialize;
use std::fmt::{Display, Formatter};
use std::io::Read;
use std::path::Path;

/// The contents of an HDF5 file of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Contents {
    /// Provenance of the numbers.
    #[serde(flatten)]
    pub provenance: Provenance,
    /// Number of frames, and steps and times of the first and the last one, if the file has frames.
    pub frames: Option<FrameSpan>,
    /// Keys of the scene that have changed in the course of the run.
    pub changes: Vec<SceneChange>,
    /// The datasets.
    pub datasets: Vec<DatasetShape>,
    /// Parts that do not match their checksums.
    pub damage: Vec<String>,
}

/// Description of a dataset, without its values.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DatasetShape {
    /// Path in the file.
    pub name: String,
    /// Shape.
    pub shape: Vec<usize>,
    /// Physical dimensions of the values.
    pub dimensions: String,
}

/// The frames of a file.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FrameSpan {
    /// Number of frames.
    pub count: usize,
    /// Steps of the first and the last frame.
    pub steps: [u64; 2],
    /// Times of the first and the last frame.
    pub times: [f64; 2],
}

impl Contents {
    /// Reads a file written by this program.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        if path.is_dir() {
            return Err(FileError::read(path, &"it is a folder; name a file in it, such as trajectory.h5"));
        }
        if !path.is_file() {
            return Err(FileError::read(path, &"there is no such file"));
        }
        if !starts_as_hdf5(path).map_err(|e| FileError::read(path, &e))? {
            return Err(FileError::read(path, &"it is no HDF5 file; results have names such as trajectory.h5"));
        }
        let file = self_contained::open(path).map_err(|e| FileError::damaged(path, &e))?;
        if !file.link_exists("parameters") {
            return Err(FileError::read(
                path,
                &"it is HDF5, but not a file of this program: it has no group `parameters`",
            ));
        }
        Self::of(&file).map_err(|e| FileError::damaged(path, &e))
    }

    /// The scene of the file, followed by comments with the changes and the steps from which they hold.
    pub fn scene(&self) -> String {
        SceneHistory { first: self.provenance.scene.clone(), changes: self.changes.clone() }.in_words()
    }

    fn of(file: &File) -> hdf5::Result<Self> {
        let provenance = Provenance::read(file)?;
        let mut contents = Self {
            provenance,
            frames: None,
            changes: scene_history::changes(file)?,
            datasets: Vec::new(),
            damage: Vec::new(),
        };
        contents.walk(file.as_group()?)?;
        let frames = contents.frames.map_or(0, |frames| frames.count);
        if let Some(sums) = FrameChecksums::open(file)? {
            contents.damage.extend((0..frames).filter_map(|frame| Some(sums.damage(frame)?.to_string())));
        }
        Ok(contents)
    }

    /// Visits every group once, although links may give it several names or form cycles.
    fn walk(&mut self, root: Group) -> hdf5::Result<()> {
        let (mut waiting, mut seen) = (vec![root], Vec::new());
        while let Some(group) = waiting.pop() {
            let place = group.loc_info()?;
            if !seen.contains(&(place.fileno, place.token)) {
                seen.push((place.fileno, place.token));
                self.visit(&group)?;
                waiting.extend(group.groups()?.into_iter().rev());
            }
        }
        Ok(())
    }

    fn visit(&mut self, group: &Group) -> hdf5::Result<()> {
        for dataset in group.datasets()? {
            let name = dataset.name();
            if name.ends_with("/step") && self.frames.is_none() {
                claimed_size::check(&dataset)?;
                self.frames = frames(&dataset, &claimed_size::dataset(group, "time")?)?;
            }
            if !name.ends_with("/step") && !name.ends_with("/time") && !name.starts_with("/parameters") {
                self.datasets.push(describe(&dataset));
            }
            self.damage.extend(verified::verify(&dataset).err().map(|e| e.to_string()));
        }
        Ok(())
    }
}

/// Number of values of a dataset, such as the steps of frames; 0 if there is no such file or dataset.
pub fn stored_rows(path: &Path, dataset: &str) -> u64 {
    let stored = self_contained::open(path).and_then(|file| file.dataset(dataset));
    stored.map_or(0, |values| values.size() as u64)
}

/// Whether a file begins with the HDF5 signature.
fn starts_as_hdf5(path: &Path) -> std::io::Result<bool> {
    let mut start = Vec::new();
    std::fs::File::open(path)?.take(text::HDF5.len() as u64).read_to_end(&mut start)?;
    Ok(start == text::HDF5)
}

fn frames(steps: &Dataset, times: &Dataset) -> hdf5::Result<Option<FrameSpan>> {
    let times_name = times.name();
    [steps, times].into_iter().try_for_each(|dataset| claimed_size::check(dataset))?;
    let (steps, times): (Vec<u64>, Vec<f64>) = (steps.read_raw()?, times.read_raw()?);
    let count = steps.len();
    let Some(last) = count.checked_sub(1) else { return Ok(None) };
    // Times are written before steps, so there may be one more.
    let [Some(&from), Some(&until)] = [times.first(), times.get(last)] else {
        return Err(format!("it has {count} steps, but {times_name} has {} times", times.len()).into());
    };
    if !(from.is_finite() && until.is_finite()) {
        return Err(format!("its frames go from time {from} to time {until}").into());
    }
    Ok(Some(FrameSpan { count, steps: [steps[0], steps[last]], times: [from, until] }))
}

fn describe(dataset: &Dataset) -> DatasetShape {
    DatasetShape { name: dataset.name(), shape: dataset.shape(), dimensions: text::read_dimensions(dataset) }
}

impl Display for DatasetShape {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let shape: Vec<String> = self.shape.iter().map(ToString::to_string).collect();
        write!(f, "{}", format!("{:<46} {:<16} {}", self.name, shape.join(" x "), self.dimensions).trim_end())
    }
}

impl Display for FrameSpan {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let Self { count, steps: [first, last], times } = self;
        let [from, until] = times.map(Number);
        write!(f, "{count}, steps {first} to {last}, times {from:.6} to {until:.6}")
    }
}

impl Display for Contents {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "written by {}", self.provenance.program)?;
        self.frames.iter().try_for_each(|frames| writeln!(f, "frames     {frames}"))?;
        self.changes.iter().try_for_each(|change| writeln!(f, "changed    {change}"))?;
        write!(f, "{}", self.provenance.plan)?;
        self.datasets.iter().try_for_each(|dataset| writeln!(f, "  {dataset}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads a file with the parameters of a run and the content that `fill` writes.
    fn read(fill: impl FnOnce(&File)) -> Result<Contents, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.h5");
        let file = File::create(&path).unwrap();
        provenance().write(&file).unwrap();
        fill(&file);
        drop(file);
        Contents::read(&path).map_err(|e| e.to_string())
    }

    fn provenance() -> Provenance {
        let [scene, program, plan] = ["kind = \"suspension\"", "test 1", "direct"].map(String::from);
        Provenance { scene, program, plan, ranks: 3, seed: 7 }
    }

    fn clock(file: &File, steps: &[u64], times: &[f64]) {
        let group = file.create_group("a").unwrap();
        group.new_dataset_builder().with_data(steps).create("step").unwrap();
        group.new_dataset_builder().with_data(times).create("time").unwrap();
    }

    #[test]
    fn links_to_what_they_stand_in_have_an_end() {
        let contents = read(|file| {
            let group = file.create_group("a").unwrap();
            group.new_dataset_builder().with_data(&[1.0]).create("b").unwrap();
            file.link_hard("/", "a/all").unwrap();
            group.link_hard("/a", "self").unwrap();
        });
        assert_eq!(contents.unwrap().datasets.len(), 1);
    }

    #[test]
    fn a_file_says_where_it_comes_from() {
        assert_eq!(read(|_| ()).unwrap().provenance, provenance());
    }

    #[test]
    fn frames_without_times_are_damage() {
        let span = read(|file| clock(file, &[0, 5], &[0.0, 0.5, 1.0])).unwrap().frames.unwrap();
        assert_eq!((span.count, span.steps, span.times), (2, [0, 5], [0.0, 0.5]));
        assert!(read(|file| clock(file, &[0, 5], &[0.0])).unwrap_err().contains("2 steps, but /a/time has 1 times"));
        assert!(read(|file| clock(file, &[0], &[f64::NAN])).unwrap_err().contains("time NaN"));
    }
}
