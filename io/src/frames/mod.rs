//! HDF5 files to which whole frames are appended, and which stay readable if the program is killed.
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
mod open;
mod sums;

use crate::watched_file::WatchedFile;
use crate::{FileError, atomic_file, atomic_hdf5};
pub(crate) use element::{Added, Element, Values, group, one_of};
use hdf5::File;
use open::Open;
use std::path::{Path, PathBuf};
pub use sums::Damage;
pub(crate) use sums::Sums;

/// A file of elements in the sense of H5MD: groups with a `value` for each frame beside its `step` and `time`; and a
/// checksum of each frame of each.
pub(crate) struct Frames {
    path: PathBuf,
    /// Nothing after a failed write: what was in the file by then stays as it is.
    open: Option<Open>,
    /// Another handle of the file, which knows of all that fails later on.
    file: WatchedFile,
    damage: Vec<Damage>,
}

/// What all files of a kind have.
pub(crate) struct Kind<'a> {
    /// What each frame has a value of.
    pub(crate) elements: &'a [Element],
    /// Frames that the file has room for.
    pub(crate) capacity: u64,
    /// Writes what does not change from frame to frame.
    pub(crate) fixed: &'a dyn Fn(&File) -> hdf5::Result<()>,
}

impl Frames {
    /// A file without frames; it replaces any of that name once it is complete.
    pub(crate) fn create(path: &Path, kind: &Kind) -> Result<Self, FileError> {
        let made = Self::prepare(path, kind).and_then(Self::place);
        made.inspect_err(|_| atomic_file::remove_temporary(path))
    }

    /// The same under the name of a temporary file.
    fn prepare(path: &Path, kind: &Kind) -> Result<Self, FileError> {
        let failed = |e: std::io::Error| FileError::write(path, &e);
        let file = atomic_file::create_temporary(path).map_err(failed)?;
        let open = Open::create(&atomic_file::temporary(path), kind).map_err(|e| FileError::write(path, &e))?;
        let file = WatchedFile::new(path, file).map_err(failed)?;
        Ok(Self { path: path.to_owned(), open: Some(open), file, damage: Vec::new() })
    }

    fn place(self) -> Result<Self, FileError> {
        atomic_file::place(self.file.file(), &self.path).map_err(|e| FileError::write(&self.path, &e))?;
        Ok(self)
    }

    /// Opens a file of a former run, drops the frames after step `last`, and makes room for all frames to come.
    pub(crate) fn resume(path: &Path, kind: &Kind, last: u64) -> Result<Self, FileError> {
        let damaged = |e: &hdf5::Error| FileError::damaged(path, e);
        let file = std::fs::File::options().read(true).write(true).open(path);
        let file = file.and_then(|file| WatchedFile::new(path, file)).map_err(|e| FileError::read(path, &e))?;
        let open = Open::existing(path, kind.elements).map_err(|e| damaged(&e))?;
        let (keep, damage) = open.kept(last).map_err(|e| damaged(&e))?;
        let mut old = Self { path: path.to_owned(), open: Some(open), file, damage };
        if old.look(|open| Ok(open.capacity()))? >= kind.capacity as usize {
            old.attempt(|open| open.truncate(keep))?;
            old.file.note_length()?;
            return Ok(old);
        }
        old.copied(kind, keep).inspect_err(|_| atomic_file::remove_temporary(path))
    }

    /// Replaces this file by one with more room and the same first frames.
    fn copied(self, kind: &Kind, frames: usize) -> Result<Self, FileError> {
        let mut new = Self::prepare(&self.path, kind)?;
        if let Some(old) = &self.open {
            new.attempt(|new| old.copy_to(new, frames))?;
        }
        let new = new.place()?;
        Ok(Self { damage: self.damage, ..new })
    }

    /// The frames, of those that were there before, that are not as they were written. They are left as they are.
    pub(crate) fn damage(&self) -> &[Damage] {
        &self.damage
    }

    /// The steps of the frames, in order.
    pub(crate) fn steps_written(&self) -> Result<Vec<u64>, FileError> {
        self.look(Open::steps_written)
    }

    /// Step, time and values of a frame.
    pub(crate) fn frame(&self, frame: usize) -> Result<((u64, f64), Vec<Values<'static>>), FileError> {
        self.look(|open| open.frame(frame))
    }

    /// Adds a frame with one value for each element, in the order in which they were given. It is in the file when this
    /// returns.
    pub(crate) fn append(&mut self, clock: (u64, f64), values: &[Values]) -> Result<(), FileError> {
        let values: Vec<Added> = values.iter().map(|values| Added::Whole(values.borrowed())).collect();
        self.append_blocks(clock, &values)
    }

    /// The same with values that may come block by block.
    pub(crate) fn append_blocks(&mut self, clock: (u64, f64), values: &[Added]) -> Result<(), FileError> {
        self.file.check().inspect_err(|_| self.abandon())?;
        self.attempt(|open| open.append(clock, values, None))?;
        self.file.note_growth()
    }

    /// Writes something else into the file.
    pub(crate) fn write(&mut self, write: impl FnOnce(&File) -> hdf5::Result<()>) -> Result<(), FileError> {
        self.attempt(|open| write(open.file()))
    }

    /// Waits until all frames so far are on the disk.
    pub(crate) fn sync(&self) -> Result<(), FileError> {
        self.file.check()?;
        atomic_file::sync(self.file.file()).map_err(|e| FileError::write(&self.path, &e))
    }

    fn open(&self) -> Result<&Open, FileError> {
        self.open.as_ref().ok_or_else(|| FileError::write(&self.path, &"a write to it has failed before"))
    }

    fn look<T>(&self, read: impl FnOnce(&Open) -> hdf5::Result<T>) -> Result<T, FileError> {
        read(self.open()?).map_err(|e| FileError::damaged(&self.path, &e))
    }

    fn attempt<T>(&mut self, write: impl FnOnce(&Open) -> hdf5::Result<T>) -> Result<T, FileError> {
        let open = self.open()?;
        let error = match write(open) {
            Ok(value) => return Ok(value),
            Err(error) => error,
        };
        self.abandon();
        Err(FileError::write(&self.path, &error))
    }

    /// Leaves the file as it is.
    fn abandon(&mut self) {
        if let Some(open) = self.open.take() {
            atomic_hdf5::leave_open(open.file());
            std::mem::forget(open);
        }
    }
}

#[cfg(test)]
mod tests;
