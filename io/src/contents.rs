//! What a result file holds, in words.

use crate::frames::Sums;
use crate::{FileError, checksum, text};
use domain::Number;
use hdf5::{Dataset, File, Group, LocationInfo, LocationToken};
use std::fmt::{Display, Formatter};
use std::io::Read;
use std::path::Path;

/// What an HDF5 file of a run holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Contents {
    /// The program that wrote it.
    pub program: String,
    /// The scene that it comes from.
    pub scene: String,
    /// How the fluid was computed.
    pub plan: String,
    /// Steps and times of the first and the last frame and the number of frames, where the file has frames.
    pub frames: Option<FrameSpan>,
    /// Names and shapes of the datasets, with their physical dimensions.
    pub datasets: Vec<String>,
    /// What is not as it was written, by its checksums.
    pub damage: Vec<String>,
}

/// The frames of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameSpan {
    /// How many.
    pub count: usize,
    /// Steps of the first and of the last.
    pub steps: [u64; 2],
    /// Their times.
    pub times: [f64; 2],
}

impl Contents {
    /// Reads a file that this program wrote.
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
        let file = File::open(path).map_err(|e| FileError::damaged(path, &e))?;
        if !file.link_exists("parameters") {
            return Err(FileError::read(
                path,
                &"it is HDF5, but not a file of this program: it has no group `parameters`",
            ));
        }
        Self::of(&file).map_err(|e| FileError::damaged(path, &e))
    }

    fn of(file: &File) -> hdf5::Result<Self> {
        let parameters = file.group("parameters")?;
        let program = parameters.attr("program")?.read_scalar::<hdf5::types::VarLenUnicode>()?.to_string();
        let mut contents = Self {
            program,
            scene: text::read_dataset(&parameters, "scene")?,
            plan: text::read_dataset(&parameters, "plan")?,
            frames: None,
            datasets: Vec::new(),
            damage: Vec::new(),
        };
        contents.walk(&file.as_group()?, &mut Vec::new())?;
        let frames = contents.frames.map_or(0, |frames| frames.count);
        if let Some(sums) = Sums::open(file)? {
            contents.damage.extend((0..frames).filter_map(|frame| Some(sums.damage(frame)?.to_string())));
        }
        Ok(contents)
    }

    /// Adds what a group holds, once: links may lead back to groups that were seen.
    fn walk(&mut self, group: &Group, seen: &mut Vec<(u64, LocationToken)>) -> hdf5::Result<()> {
        let LocationInfo { fileno, token, .. } = group.loc_info()?;
        if seen.contains(&(fileno, token)) {
            return Ok(());
        }
        seen.push((fileno, token));
        for dataset in group.datasets()? {
            let name = dataset.name();
            if name.ends_with("/step") && self.frames.is_none() {
                self.frames = frames(&dataset, &group.dataset("time")?)?;
            }
            if !name.ends_with("/step") && !name.ends_with("/time") && !name.starts_with("/parameters") {
                self.datasets.push(describe(&dataset));
            }
            self.damage.extend(checksum::verify(&dataset).err().map(|e| e.to_string()));
        }
        group.groups()?.iter().try_for_each(|group| self.walk(group, seen))
    }
}

/// Whether a file begins with the signature of HDF5.
fn starts_as_hdf5(path: &Path) -> std::io::Result<bool> {
    let mut start = Vec::new();
    std::fs::File::open(path)?.take(SIGNATURE.len() as u64).read_to_end(&mut start)?;
    Ok(start == SIGNATURE)
}

const SIGNATURE: [u8; 8] = *b"\x89HDF\r\n\x1a\n";

fn frames(steps: &Dataset, times: &Dataset) -> hdf5::Result<Option<FrameSpan>> {
    let times_name = times.name();
    let (steps, times): (Vec<u64>, Vec<f64>) = (steps.read_raw()?, times.read_raw()?);
    let count = steps.len();
    // Times are written before steps: there may be one more.
    let Some(last) = count.checked_sub(1) else { return Ok(None) };
    let Some(&end) = times.get(last) else {
        return Err(format!("{times_name} has fewer frames than the steps").into());
    };
    Ok(Some(FrameSpan { count, steps: [steps[0], steps[last]], times: [times[0], end] }))
}

fn describe(dataset: &Dataset) -> String {
    let shape: Vec<String> = dataset.shape().iter().map(ToString::to_string).collect();
    let dimensions = text::read_dimensions(dataset);
    format!("{:<46} {:<16} {dimensions}", dataset.name(), shape.join(" x ")).trim_end().to_owned()
}

impl Display for Contents {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "written by {}", self.program)?;
        if let Some(FrameSpan { count, steps: [first, last], times: [from, until] }) = self.frames {
            let [from, until] = [from, until].map(Number);
            writeln!(f, "frames     {count}, steps {first} to {last}, times {from:.6} to {until:.6}")?;
        }
        write!(f, "{}", self.plan)?;
        self.datasets.iter().try_for_each(|dataset| writeln!(f, "  {dataset}"))
    }
}
