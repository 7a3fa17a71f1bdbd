//! One quantity of a file of frames.

use super::capacity::Capacity;
use crate::checksum::Sum;
use crate::text;
use bytemuck::{NoUninit, Zeroable};
use hdf5::dataset::{AllocTime, FillTime};
use hdf5::{Dataset, Extent, File, Group, H5Type, Hyperslab, Selection, SliceOrIndex};
use ndarray::{ArrayD, ArrayViewD, IxDyn};
use std::borrow::Cow;

/// The description of a quantity.
#[derive(Debug, Clone)]
pub(crate) struct Element {
    /// Path of its group in the file.
    pub(crate) path: String,
    /// Rows and columns of the value of a frame; `None` for a single number.
    pub(crate) shape: Option<[usize; 2]>,
    /// Whether its numbers are integers.
    pub(crate) whole: bool,
    /// Unit, in terms of length, time and force.
    pub(crate) unit: &'static str,
}

impl Element {
    /// Bytes of the value of a frame, including its checksum.
    pub(crate) fn bytes(&self) -> usize {
        let numbers = self.shape.map_or(1, |shape| shape.iter().product());
        size_of::<u64>() + numbers * if self.whole { size_of::<i32>() } else { size_of::<f64>() }
    }
}

/// The value of one quantity in one frame.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Values<'a> {
    Reals(Cow<'a, [f64]>),
    Integers(Cow<'a, [i32]>),
}

impl Values<'_> {
    /// The same values, borrowed.
    pub(crate) fn borrowed(&self) -> Values<'_> {
        match self {
            Self::Reals(values) => Values::Reals(Cow::Borrowed(values)),
            Self::Integers(values) => Values::Integers(Cow::Borrowed(values)),
        }
    }

    /// Real numbers; empty for integers.
    pub(crate) fn reals(&self) -> &[f64] {
        match self {
            Self::Reals(values) => values,
            Self::Integers(_) => &[],
        }
    }
}

impl<'a> From<&'a [f64]> for Values<'a> {
    fn from(values: &'a [f64]) -> Self {
        Self::Reals(Cow::Borrowed(values))
    }
}

impl<'a> From<&'a [i32]> for Values<'a> {
    fn from(values: &'a [i32]) -> Self {
        Self::Integers(Cow::Borrowed(values))
    }
}

impl From<f64> for Values<'_> {
    fn from(value: f64) -> Self {
        Self::Reals(Cow::Owned(vec![value]))
    }
}

/// Function that passes on the rows of a value, block by block.
pub(crate) type ValueBlocks<'a> = dyn Fn(&mut dyn FnMut(&Values) -> hdf5::Result<()>) -> hdf5::Result<()> + 'a;

/// Value of one quantity in a frame to be added.
pub(crate) enum NewValue<'a> {
    /// In one piece.
    Whole(Values<'a>),
    /// Block by block.
    InBlocks(Box<ValueBlocks<'a>>),
}

impl NewValue<'_> {
    fn each(&self, each: &mut dyn FnMut(&Values) -> hdf5::Result<()>) -> hdf5::Result<()> {
        match self {
            Self::Whole(values) => each(values),
            Self::InBlocks(blocks) => blocks(each),
        }
    }
}

/// Number of rows that are read at a time.
pub(super) const BLOCK: usize = 1 << 16;

/// Dataset of a quantity.
pub(super) struct StoredElement {
    values: Dataset,
    shape: Option<[usize; 2]>,
    whole: bool,
}

impl StoredElement {
    /// Creates the group of a quantity; its steps and times are those of the group `clock`.
    pub(super) fn create(file: &File, element: &Element, clock: &str, capacity: Capacity) -> hdf5::Result<Self> {
        let group = group(file, &element.path)?;
        let shape = element.shape.as_ref().map_or(&[][..], |shape| shape);
        let values = if element.whole {
            growing::<i32>(&group, "value", shape, capacity)?
        } else {
            growing::<f64>(&group, "value", shape, capacity)?
        };
        text::write_dimensions(&values, element.unit)?;
        if element.path != clock {
            for name in ["step", "time"] {
                file.link_hard(&format!("/{clock}/{name}"), &format!("/{}/{name}", element.path))?;
            }
        }
        Ok(Self { values, shape: element.shape, whole: element.whole })
    }

    pub(super) fn open(file: &File, element: &Element) -> hdf5::Result<Self> {
        let values = file.group(&element.path)?.dataset("value")?;
        let found = values.shape().get(1..).map(<[usize]>::to_vec);
        if found != Some(element.shape.map_or(vec![], |s| s.to_vec())) {
            return Err(format!("{} has frames of shape {found:?}", element.path).into());
        }
        Ok(Self { values, shape: element.shape, whole: element.whole })
    }

    pub(super) fn values(&self) -> &Dataset {
        &self.values
    }

    /// Writes the value of a frame; returns its checksum.
    pub(super) fn write(&self, frame: usize, value: &NewValue) -> hdf5::Result<u64> {
        resize_first(&self.values, frame + 1)?;
        let (mut sum, mut row) = (Sum::default(), 0);
        value.each(&mut |values| {
            row += match values {
                Values::Reals(values) => self.write_rows::<f64>(frame, row, values, &mut sum)?,
                Values::Integers(values) => self.write_rows::<i32>(frame, row, values, &mut sum)?,
            };
            Ok(())
        })?;
        if row != self.shape.map_or(1, |[rows, _]| rows) {
            return Err(format!("{row} rows of a value of the shape {:?}", self.shape).into());
        }
        Ok(sum.get())
    }

    /// Writes rows of a frame's value, starting at row `first`; returns their number.
    fn write_rows<T: H5Type + NoUninit>(
        &self,
        frame: usize,
        first: usize,
        values: &[T],
        sum: &mut Sum,
    ) -> hdf5::Result<usize> {
        sum.add(values);
        let Some([_, columns]) = self.shape else {
            self.values.write_slice(values, one_of(frame, 1))?;
            return Ok(1);
        };
        let rows = values.len() / columns.max(1);
        let view = ArrayViewD::from_shape(IxDyn(&[1, rows, columns]), values).expect("whole rows");
        self.values.write_slice(view, rows_of(frame, first..first + rows))?;
        Ok(rows)
    }

    /// The value of a frame in the form that [`Self::write`] takes.
    pub(super) fn blocks(&self, frame: usize) -> NewValue<'_> {
        let Some([rows, _]) = self.shape else {
            return NewValue::InBlocks(Box::new(move |each| each(&self.read(frame)?)));
        };
        NewValue::InBlocks(Box::new(move |each| {
            for first in (0..rows).step_by(BLOCK) {
                let part = rows_of(frame, first..rows.min(first + BLOCK));
                if self.whole {
                    let values = self.values.read_slice::<i32, _, IxDyn>(part)?;
                    each(&Values::Integers(Cow::Owned(values.into_raw_vec_and_offset().0)))?;
                } else {
                    let values = self.values.read_slice::<f64, _, IxDyn>(part)?;
                    each(&Values::Reals(Cow::Owned(values.into_raw_vec_and_offset().0)))?;
                }
            }
            Ok(())
        }))
    }

    pub(super) fn read(&self, frame: usize) -> hdf5::Result<Values<'static>> {
        if self.whole {
            let values = self.values.read_slice::<i32, _, IxDyn>(self.one(frame))?;
            return Ok(Values::Integers(Cow::Owned(values.into_raw_vec_and_offset().0)));
        }
        let values = self.values.read_slice::<f64, _, IxDyn>(self.one(frame))?;
        Ok(Values::Reals(Cow::Owned(values.into_raw_vec_and_offset().0)))
    }

    fn one(&self, frame: usize) -> Selection {
        one_of(frame, self.shape.map_or(1, |_| 3))
    }
}

/// Selection of one frame of a dataset with this number of dimensions, as a block of length 1.
pub(crate) fn one_of(frame: usize, dimensions: usize) -> Selection {
    let all = SliceOrIndex::Unlimited { start: 0, step: 1, block: 1 };
    let mut slices = vec![all; dimensions];
    slices[0] = SliceOrIndex::SliceCount { start: frame, step: 1, count: 1, block: 1 };
    Selection::new(Hyperslab::from(slices))
}

/// Selection of rows of one frame of a three-dimensional dataset.
pub(super) fn rows_of(frame: usize, rows: std::ops::Range<usize>) -> Selection {
    let range = |start, count| SliceOrIndex::SliceCount { start, step: 1, count, block: 1 };
    let all = SliceOrIndex::Unlimited { start: 0, step: 1, block: 1 };
    Selection::new(Hyperslab::from(vec![range(frame, 1), range(rows.start, rows.len()), all]))
}

pub(super) fn write_number<T: H5Type + Clone>(dataset: &Dataset, frame: usize, number: T) -> hdf5::Result<()> {
    dataset.resize((frame + 1,))?;
    dataset.write_slice(&ndarray::arr1(&[number]), one_of(frame, 1))
}

/// The group at a path, created with its parents if they do not exist.
pub(crate) fn group(file: &File, path: &str) -> hdf5::Result<Group> {
    let mut group = file.as_group()?;
    for name in path.split('/') {
        group = if group.link_exists(name) { group.group(name)? } else { group.create_group(name)? };
    }
    Ok(group)
}

/// A one-dimensional dataset without frames, with all storage reserved.
pub(super) fn reserve<T: H5Type>(group: &Group, name: &str, capacity: Capacity) -> hdf5::Result<Dataset> {
    let new = group.new_dataset::<T>().with_dcpl(|d| d.alloc_time(Some(AllocTime::Early)).fill_time(FillTime::Never));
    let dataset = new.chunk((capacity.frames.min(512),)).shape((0..=capacity.frames,)).create(name)?;
    // The first frame makes the library reserve the storage; then the dataset is emptied again.
    resize_first(&dataset, 1)?;
    resize_first(&dataset, 0)?;
    Ok(dataset)
}

/// A dataset without frames, with values of the given shape, whose storage grows in chunks.
pub(super) fn growing<T: H5Type + Clone + Zeroable>(
    group: &Group,
    name: &str,
    shape: &[usize],
    capacity: Capacity,
) -> hdf5::Result<Dataset> {
    let new = group.new_dataset::<T>().with_dcpl(|d| d.alloc_time(Some(AllocTime::Incr)).fill_time(FillTime::Never));
    let chunk = capacity.chunk(shape.iter().product::<usize>() * size_of::<T>());
    let chunk = [&[chunk], shape].concat();
    let extents = [Extent::from(0..=capacity.frames)].into_iter().chain(shape.iter().map(|&n| Extent::from(n)));
    let dataset = new.chunk(chunk).shape(extents.collect::<Vec<_>>()).create(name)?;
    // The first number makes the library write the list of chunks; later it only changes addresses in the list.
    resize_first(&dataset, 1)?;
    if !shape.contains(&0) {
        let first =
            Hyperslab::from(vec![SliceOrIndex::SliceCount { start: 0, step: 1, count: 1, block: 1 }; 1 + shape.len()]);
        let zero = ArrayD::from_elem(vec![1; 1 + shape.len()], T::zeroed());
        dataset.write_slice(&zero, Selection::new(first))?;
    }
    resize_first(&dataset, 0)?;
    Ok(dataset)
}

/// Changes the number of frames of a dataset.
pub(super) fn resize_first(dataset: &Dataset, frames: usize) -> hdf5::Result<()> {
    let mut shape = dataset.shape();
    shape[0] = frames;
    dataset.resize(shape)
}
