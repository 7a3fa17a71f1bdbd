//! HDF5 files that grow by whole frames and survive being cut short.
//!
//! The room for all frames of a run is reserved when the file is made, as a hole that takes no space on the disk until
//! it is written (HDF5's implicit chunk index: no filters, a fixed largest size, early allocation). A frame then
//! changes two things: its own numbers, and afterwards the lengths of the datasets, each of which is one small write in
//! place. The length of `step` is written last. A program that is killed at any moment leaves a file that every HDF5
//! reader opens, and the length of `step` is the number of whole frames in it. For that no write of a length may be cut
//! in two: what the library writes at once stands within a page of memory, where the kernel does not look for signals.
//! Compression would need chunks of any length and with them an index that grows; `h5repack` compresses a finished
//! file.

mod element;

use crate::FileError;
use element::Stored;
pub(crate) use element::{Element, Values};
use hdf5::file::{FileAccessBuilder, LibraryVersion};
use hdf5::{Dataset, File, OpenMode};
use std::path::{Path, PathBuf};

/// A file of elements in the sense of H5MD: groups with a `value` for each frame beside its `step` and `time`.
pub(crate) struct Frames {
    file: File,
    path: PathBuf,
    stored: Vec<Stored>,
    steps: Dataset,
    times: Dataset,
}

impl Frames {
    /// A file for up to `capacity` frames of the given elements, in place of any of that name.
    pub(crate) fn create(path: &Path, elements: &[Element], capacity: u64) -> Result<Self, FileError> {
        Self::try_create(path, elements, capacity.max(1) as usize).map_err(|e| FileError::write(path, &e))
    }

    fn try_create(path: &Path, elements: &[Element], capacity: usize) -> hdf5::Result<Self> {
        // A superblock of this version has no mark for files open for writing, which a killed program would leave set.
        File::with_options()
            .with_fapl(|f| in_pages(f).libver_bounds(LibraryVersion::V18, LibraryVersion::V18))
            .create(path)?;
        let file = for_writing(path)?;
        let first = element::group(&file, &elements[0].path)?;
        let steps = element::reserve::<i64>(&first, "step", None, capacity)?;
        let times = element::reserve::<f64>(&first, "time", None, capacity)?;
        crate::text::write_dimensions(&times, "time")?;
        let mut stored = Vec::with_capacity(elements.len());
        for element in elements {
            stored.push(Stored::create(&file, element, (&elements[0].path, capacity))?);
        }
        file.flush()?;
        Ok(Self { file, path: path.to_owned(), stored, steps, times })
    }

    /// Opens a file of a former run, drops the frames after step `last`, and sees to it that there is room for
    /// `capacity` frames; `anew` makes an empty file of the same kind at another path, where there is not.
    pub(crate) fn resume(
        path: &Path,
        elements: &[Element],
        (last, capacity): (u64, u64),
        anew: impl Fn(&Path) -> Result<Self, FileError>,
    ) -> Result<Self, FileError> {
        let mut old = Self::open(path, elements).map_err(|e| FileError::damaged(path, &e))?;
        let keep = old.steps_written()?.iter().take_while(|&&step| step <= last).count();
        if (old.capacity() as u64) < capacity {
            let larger = path.with_extension("tmp");
            let mut new = anew(&larger)?;
            old.copy_to(&mut new, keep).map_err(|e| FileError::write(&larger, &e))?;
            drop((old, new));
            std::fs::rename(&larger, path).map_err(|e| FileError::write(path, &e))?;
            old = Self::open(path, elements).map_err(|e| FileError::damaged(path, &e))?;
        }
        old.truncate(keep).map_err(|e| FileError::write(path, &e))?;
        Ok(old)
    }

    fn open(path: &Path, elements: &[Element]) -> hdf5::Result<Self> {
        let file = for_writing(path)?;
        let first = file.group(&elements[0].path)?;
        let (steps, times) = (first.dataset("step")?, first.dataset("time")?);
        let stored = elements.iter().map(|element| Stored::open(&file, element)).collect::<hdf5::Result<_>>()?;
        Ok(Self { file, path: path.to_owned(), stored, steps, times })
    }

    /// The file, for what does not change from frame to frame.
    pub(crate) fn file(&self) -> &File {
        &self.file
    }

    /// The steps of the frames, in order.
    pub(crate) fn steps_written(&self) -> Result<Vec<u64>, FileError> {
        self.steps.read_raw::<u64>().map_err(|e| FileError::damaged(&self.path, &e))
    }

    fn capacity(&self) -> usize {
        let most = |d: &Dataset| d.space().ok()?.maxdims().first().copied()?;
        most(&self.steps).unwrap_or(0)
    }

    /// Adds a frame with one value for each element, in the order in which they were given. It is in the file when this
    /// returns.
    pub(crate) fn append(&mut self, (step, time): (u64, f64), values: &[Values]) -> Result<(), FileError> {
        assert_eq!(values.len(), self.stored.len(), "a value for each element");
        self.try_append((step, time), values).map_err(|e| FileError::write(&self.path, &e))
    }

    fn try_append(&mut self, (step, time): (u64, f64), values: &[Values]) -> hdf5::Result<()> {
        let frame = self.steps.size();
        for (stored, values) in self.stored.iter().zip(values) {
            stored.write(frame, values)?;
        }
        element::write_number(&self.times, frame, time)?;
        self.file.flush()?;
        element::write_number(&self.steps, frame, step as i64)?;
        self.file.flush()
    }

    fn truncate(&mut self, frames: usize) -> hdf5::Result<()> {
        self.steps.resize((frames,))?;
        self.file.flush()?;
        self.times.resize((frames,))?;
        self.stored.iter().try_for_each(|stored| stored.resize(frames))?;
        self.file.flush()
    }

    fn copy_to(&self, new: &mut Self, frames: usize) -> hdf5::Result<()> {
        let (steps, times): (Vec<u64>, Vec<f64>) = (self.steps.read_raw()?, self.times.read_raw()?);
        for frame in 0..frames {
            let values = self.stored.iter().map(|stored| stored.read(frame)).collect::<hdf5::Result<Vec<_>>>()?;
            new.try_append((steps[frame], times[frame]), &values)?;
        }
        Ok(())
    }
}

fn for_writing(path: &Path) -> hdf5::Result<File> {
    let newest = LibraryVersion::V110;
    File::with_options().with_fapl(|f| in_pages(f).libver_bounds(newest, newest)).open_as(path, OpenMode::ReadWrite)
}

/// Makes whatever the file consists of begin at a page of memory, by itself.
fn in_pages(file: &mut FileAccessBuilder) -> &mut FileAccessBuilder {
    file.alignment(1, PAGE).meta_block_size(0)
}

const PAGE: u64 = 4096;

#[cfg(test)]
mod tests;
