//! A file of frames that is open in the HDF5 library.

use super::capacity::Capacity;
use super::element::{StoredElement, group, growing, reserve, resize_first, write_number};
use super::{Damage, Element, FileKind, FrameChecksums, NewValue, Values, end_of_file};
use crate::{atomic_hdf5, claimed_size, self_contained, text};
use hdf5::file::{FileAccessBuilder, LibraryVersion};
use hdf5::{Dataset, File, OpenMode};
use std::path::Path;

/// The file and its datasets.
pub(super) struct OpenFile {
    file: File,
    stored: Vec<StoredElement>,
    steps: Dataset,
    times: Dataset,
    /// `None` for files of versions without checksums.
    sums: Option<FrameChecksums>,
}

impl OpenFile {
    /// Creates a file without frames, with capacity for `written` frames that will be copied to it.
    pub(super) fn create(path: &Path, kind: &FileKind, written: usize) -> hdf5::Result<Self> {
        // A superblock of this version has no flag for files open for writing, which a killed program would leave set.
        File::with_options()
            .with_fapl(|f| in_pages(f).libver_bounds(LibraryVersion::V18, LibraryVersion::V18))
            .create(path)?
            .close()?;
        let file = for_writing(path)?;
        let capacity = Capacity::new(kind.elements, kind.planned, written);
        Self::fill(&file, kind, capacity).inspect_err(|_| atomic_hdf5::leave_open(&file))
    }

    fn fill(file: &File, kind: &FileKind, capacity: Capacity) -> hdf5::Result<Self> {
        let elements = kind.elements;
        let first = group(file, &elements[0].path)?;
        let steps = reserve::<i64>(&first, "step", capacity)?;
        let times = growing::<f64>(&first, "time", &[], capacity)?;
        text::write_dimensions(&times, "time")?;
        let mut stored = Vec::with_capacity(elements.len());
        for element in elements {
            stored.push(StoredElement::create(file, element, &elements[0].path, capacity)?);
        }
        let paths: Vec<String> = elements.iter().map(|element| element.path.clone()).collect();
        let sums = Some(FrameChecksums::create(file, &paths, capacity)?);
        (kind.fixed)(file)?;
        file.flush()?;
        Ok(Self { file: file.clone(), stored, steps, times, sums })
    }

    /// Opens a file of an earlier part of the run.
    pub(super) fn existing(path: &Path, elements: &[Element]) -> hdf5::Result<Self> {
        let file = for_writing(path)?;
        self_contained::check(&file)?;
        let first = file.group(&elements[0].path)?;
        let (steps, times) = (first.dataset("step")?, first.dataset("time")?);
        let stored = elements.iter().map(|element| StoredElement::open(&file, element)).collect::<hdf5::Result<_>>()?;
        let sums = FrameChecksums::open(&file)?;
        Ok(Self { file, stored, steps, times, sums })
    }

    pub(super) fn file(&self) -> &File {
        &self.file
    }

    /// Steps of the frames, in order.
    pub(super) fn steps_written(&self) -> hdf5::Result<Vec<u64>> {
        claimed_size::check(&self.steps)?;
        self.steps.read_raw()
    }

    /// Whether the file has no capacity for another frame.
    pub(super) fn is_full(&self) -> bool {
        let most = |d: &Dataset| d.space().ok()?.maxdims().first().copied()?;
        most(&self.steps).is_some_and(|most| self.steps.size() >= most)
    }

    /// Number of frames up to step `last`, and the damaged ones among them.
    pub(super) fn kept(&self, last: u64) -> hdf5::Result<(usize, Vec<Damage>)> {
        let steps = self.steps_written()?;
        let mut damage: Vec<Damage> =
            self.sums.iter().flat_map(|s| (0..steps.len()).filter_map(|f| s.damage(f))).collect();
        let is_unknown = |frame: usize| damage.iter().any(|d| d.frame == frame && d.has_clock());
        let is_last = |(frame, &step): (usize, &u64)| step <= last && !is_unknown(frame);
        let keep = steps.iter().enumerate().rposition(is_last).map_or(0, |frame| frame + 1);
        damage.retain(|damage| damage.frame < keep);
        Ok((keep, damage))
    }

    /// Writes the values of a frame after the last one; returns their checksums.
    pub(super) fn write(&self, clock: (u64, f64), values: &[NewValue]) -> hdf5::Result<Vec<u64>> {
        assert_eq!(values.len(), self.stored.len(), "a value for each element");
        let frame = self.steps.size();
        let mut sums = vec![FrameChecksums::of_clock(clock.0, clock.1)];
        for (stored, value) in self.stored.iter().zip(values) {
            sums.push(stored.write(frame, value)?);
        }
        write_number(&self.times, frame, clock.1)?;
        Ok(sums)
    }

    /// Publishes a frame that has been written; `on_disk` is another handle of the file.
    pub(super) fn publish(&self, step: u64, sums: &[u64], on_disk: &std::fs::File) -> hdf5::Result<()> {
        let frame = self.steps.size();
        self.write_sums(frame, sums)?;
        end_of_file::extend_to(on_disk, self.file.size()).map_err(|e| hdf5::Error::from(e.to_string()))?;
        self.file.flush()?;
        write_number(&self.steps, frame, step as i64)?;
        self.file.flush()
    }

    fn write_sums(&self, frame: usize, sums: &[u64]) -> hdf5::Result<()> {
        self.sums.as_ref().map_or(Ok(()), |stored| stored.write(frame, sums))
    }

    /// Step, time and values of a frame.
    pub(super) fn frame(&self, frame: usize) -> hdf5::Result<((u64, f64), Vec<Values<'static>>)> {
        let clock = (one(&self.steps, frame)?, one(&self.times, frame)?);
        Ok((clock, self.stored.iter().map(|stored| stored.read(frame)).collect::<hdf5::Result<_>>()?))
    }

    /// Whether there are exactly `frames` frames, and no parts of others.
    pub(super) fn ends_with(&self, frames: usize) -> bool {
        self.growing().into_iter().chain([&self.steps]).all(|dataset| dataset.shape().first() == Some(&frames))
    }

    /// Drops all but the first `frames` frames.
    pub(super) fn truncate(&self, frames: usize) -> hdf5::Result<()> {
        resize_first(&self.steps, frames)?;
        self.file.flush()?;
        for dataset in self.growing() {
            // Lists may have chunks beyond the last frame if the length was not written any more.
            let most = dataset.space()?.maxdims().first().copied().flatten();
            resize_first(dataset, most.unwrap_or(frames).max(frames))?;
            resize_first(dataset, frames)?;
        }
        self.file.flush()
    }

    /// All datasets of frames except the steps.
    fn growing(&self) -> Vec<&Dataset> {
        let values = self.stored.iter().map(StoredElement::values);
        values.chain([&self.times]).chain(self.sums.as_ref().map(FrameChecksums::stored)).collect()
    }

    /// Appends the first `frames` frames to another file, which nobody reads yet, with their stored checksums.
    pub(super) fn copy_to(&self, new: &Self, frames: usize) -> hdf5::Result<()> {
        for frame in 0..frames {
            let clock = (one::<i64>(&self.steps, frame)?, one(&self.times, frame)?);
            let values: Vec<NewValue> = self.stored.iter().map(|stored| stored.blocks(frame)).collect();
            let now = new.write((clock.0 as u64, clock.1), &values)?;
            let former = self.sums.as_ref().map(|sums| sums.read(frame)).transpose()?;
            new.write_sums(frame, &former.unwrap_or(now))?;
            write_number(&new.steps, frame, clock.0)?;
        }
        new.file.flush()
    }
}

fn one<T: hdf5::H5Type + Clone>(dataset: &Dataset, frame: usize) -> hdf5::Result<T> {
    let found = dataset.read_slice_1d::<T, _>(frame..=frame)?;
    found.first().cloned().ok_or_else(|| format!("{} has no frame {frame}", dataset.name()).into())
}

fn for_writing(path: &Path) -> hdf5::Result<File> {
    let newest = LibraryVersion::V110;
    File::with_options().with_fapl(|f| in_pages(f).libver_bounds(newest, newest)).open_as(path, OpenMode::ReadWrite)
}

/// Aligns every object of the file to a page of memory of its own. Values are written at once: the library would
/// cache them until it is closed, and lose them silently if that fails.
fn in_pages(file: &mut FileAccessBuilder) -> &mut FileAccessBuilder {
    file.alignment(1, PAGE).meta_block_size(0).small_data_block_size(0).sieve_buf_size(0).chunk_cache(0, 0, 0.0)
}

/// Size of a page of memory.
pub(super) const PAGE: u64 = 4096;
