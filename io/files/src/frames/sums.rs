//! Checksums of frames.

use super::capacity::Capacity;
use super::element::{BLOCK, growing, one_of, resize_first, rows_of};
use crate::checksum::{self, Sum};
use bytemuck::NoUninit;
use hdf5::types::{TypeDescriptor, VarLenUnicode};
use hdf5::{Dataset, File, H5Type};
use ndarray::{Array2, IxDyn};
use std::fmt::{Display, Formatter};

/// Path of the checksums in a file: a row for each frame, a column for each name in the attribute `of`.
const PLACE: &str = "parameters/checksums";
/// Name of the first column.
const CLOCK: &str = "step and time";

/// XXH3 checksums (64 bits) of each frame: of the bytes of its step (i64) and time (f64), and of the bytes of each
/// element's value, little-endian, row by row.
pub(crate) struct FrameChecksums {
    stored: Dataset,
    columns: Vec<ChecksumColumn>,
    /// Datasets of steps and times.
    clock: Option<[Dataset; 2]>,
}

/// An element with checksums.
struct ChecksumColumn {
    path: String,
    values: Option<Dataset>,
}

/// A damaged frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Damage {
    /// Index of the frame, from 0.
    pub frame: usize,
    /// The damaged parts: paths of elements in the file, or `step and time`.
    pub elements: Vec<String>,
}

impl FrameChecksums {
    /// Creates the dataset for frames of the elements at these paths.
    pub(super) fn create(file: &File, paths: &[String], capacity: Capacity) -> hdf5::Result<Self> {
        let names: Vec<&str> = [CLOCK].into_iter().chain(paths.iter().map(String::as_str)).collect();
        let (folder, name) = PLACE.split_once('/').expect("a group and a name");
        let stored = growing::<u64>(&super::group(file, folder)?, name, &[names.len()], capacity)?;
        let names: Vec<VarLenUnicode> = names.into_iter().map(crate::text::scalar).collect();
        stored.new_attr_builder().with_data(&names).create("of")?;
        Self::of(file, stored)
    }

    /// The checksums of a file, if it has some.
    pub(crate) fn open(file: &File) -> hdf5::Result<Option<Self>> {
        let Ok(stored) = file.dataset(PLACE) else { return Ok(None) };
        Self::of(file, stored).map(Some)
    }

    fn of(file: &File, stored: Dataset) -> hdf5::Result<Self> {
        let names = stored.attr("of")?.read_raw::<VarLenUnicode>()?;
        if stored.shape().get(1..) != Some(&[names.len()]) || names.is_empty() {
            return Err(format!("{PLACE} has {:?} numbers for {} names", stored.shape(), names.len()).into());
        }
        let open = |path: String| file.dataset(&path).ok();
        let column = |path: &str| ChecksumColumn { path: path.to_owned(), values: open(format!("{path}/value")) };
        let columns: Vec<ChecksumColumn> = names[1..].iter().map(|name| column(name.as_str())).collect();
        let first = columns.first().map(|column| column.path.clone()).unwrap_or_default();
        let clock = open(format!("{first}/step")).zip(open(format!("{first}/time"))).map(|(step, time)| [step, time]);
        Ok(Self { stored, columns, clock })
    }

    /// Checksum of a frame's step and time.
    pub(super) fn of_clock(step: u64, time: f64) -> u64 {
        checksum::of(&[step, time.to_bits()])
    }

    pub(super) fn write(&self, frame: usize, sums: &[u64]) -> hdf5::Result<()> {
        resize_first(&self.stored, frame + 1)?;
        let row = Array2::from_shape_vec((1, sums.len()), sums.to_vec()).expect("a row");
        self.stored.write_slice(&row, one_of(frame, 2))
    }

    pub(super) fn stored(&self) -> &Dataset {
        &self.stored
    }

    pub(super) fn read(&self, frame: usize) -> hdf5::Result<Vec<u64>> {
        Ok(self.stored.read_slice::<u64, _, IxDyn>(one_of(frame, 2))?.into_raw_vec_and_offset().0)
    }

    /// Whether a frame's step and time match their checksum.
    pub(crate) fn has_clock(&self, frame: usize) -> bool {
        let stored = self.read(frame).ok().and_then(|sums| sums.first().copied());
        stored.is_some() && self.clock_sum(frame).ok() == stored
    }

    /// Damage of a frame, if there is any.
    pub(crate) fn damage(&self, frame: usize) -> Option<Damage> {
        let sums = self.read(frame).unwrap_or_default();
        let fits = |place: usize, found: hdf5::Result<u64>| found.is_ok_and(|found| sums.get(place) == Some(&found));
        let mut elements = Vec::new();
        if !fits(0, self.clock_sum(frame)) {
            elements.push(CLOCK.to_owned());
        }
        for (place, column) in self.columns.iter().enumerate() {
            if !fits(place + 1, column.sum(frame)) {
                elements.push(column.path.clone());
            }
        }
        (!elements.is_empty()).then_some(Damage { frame, elements })
    }

    fn clock_sum(&self, frame: usize) -> hdf5::Result<u64> {
        let [steps, times] = self.clock.as_ref().ok_or("there are no steps")?;
        let step = steps.read_slice::<u64, _, IxDyn>(one_of(frame, 1))?;
        let time = times.read_slice::<f64, _, IxDyn>(one_of(frame, 1))?;
        Ok(Self::of_clock(step.first().copied().unwrap_or(0), time.first().copied().unwrap_or(0.0)))
    }
}

impl ChecksumColumn {
    fn sum(&self, frame: usize) -> hdf5::Result<u64> {
        let values = self.values.as_ref().filter(|values| values.ndim() > 0).ok_or("there are no values")?;
        match values.dtype()?.to_descriptor()? {
            TypeDescriptor::Integer(_) => sum_of::<i32>(values, frame),
            _ => sum_of::<f64>(values, frame),
        }
    }
}

/// Checksum of the value of a frame, which is read block by block if it has rows.
fn sum_of<T: H5Type + NoUninit>(values: &Dataset, frame: usize) -> hdf5::Result<u64> {
    let mut sum = Sum::default();
    let mut add = |part| -> hdf5::Result<()> {
        sum.add(&values.read_slice::<T, _, IxDyn>(part)?.into_raw_vec_and_offset().0);
        Ok(())
    };
    if let [_, rows, _] = values.shape()[..] {
        if frame >= values.shape()[0] {
            return Err(format!("{} has no frame {frame}", values.name()).into());
        }
        (0..rows).step_by(BLOCK).try_for_each(|first| add(rows_of(frame, first..rows.min(first + BLOCK))))?;
    } else {
        add(one_of(frame, values.ndim()))?;
    }
    Ok(sum.get())
}

impl Damage {
    /// Whether the step or the time is damaged.
    pub(super) fn has_clock(&self) -> bool {
        self.elements.iter().any(|element| element == CLOCK)
    }
}

impl Display for Damage {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "frame {} does not fit its checksums: {}", self.frame, self.elements.join(", "))
    }
}
