//! HDF5 files to which whole frames are appended, and which stay readable if the program is killed.
//!
//! A frame changes three things: its own numbers; lists of the pieces in which datasets grow, where it begins one, with the
//! lengths of the datasets; and last the length of `step`. A program that is killed at any moment leaves a file that every
//! HDF5 reader opens, and the length of `step` is the number of whole frames in it. For that
//!
//! - no write of a list or a length may be cut in two: each stands within a page of memory, between which alone the kernel
//!   looks for signals. A list has a bounded number of places then (HDF5's fixed array; no filters), and a file room for a
//!   bounded number of frames; a full file is replaced by a larger one with the same frames;
//! - the superblock has the end of the file before a list names a piece that goes beyond the former one;
//! - the storage of `step`, eight bytes a frame, is reserved from the start, since its length and a list of its pieces would
//!   be two writes.
//!
//! `h5repack` compresses a finished file.

mod element;
mod end_of_file;
mod open;
mod room;
mod sums;

use crate::watched_file::WatchedFile;
use crate::{FileError, atomic_file, atomic_hdf5};
pub(crate) use element::{Added, Element, Values, group, one_of};
use hdf5::File;
use open::Open;
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};
pub use sums::Damage;
pub(crate) use sums::Sums;

/// Bytes up to which frames are dropped by a copy without them. The library cuts a file before its superblock says so: a
/// larger one, whose copy takes long, is none for a moment, and if the program is killed then, until the run goes on.
const SMALL: u64 = 64 << 20;

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
    /// Frames at the end of the run.
    pub(crate) planned: u64,
    /// Writes what does not change from frame to frame.
    pub(crate) fixed: &'a dyn Fn(&File) -> hdf5::Result<()>,
}

impl Frames {
    /// A file without frames; it replaces any of that name once it is complete.
    pub(crate) fn create(path: &Path, kind: &Kind) -> Result<Self, FileError> {
        let made = Self::prepare(path, kind, 0).and_then(Self::place);
        made.inspect_err(|_| atomic_file::remove_temporary(path))
    }

    /// The same under the name of a temporary file, for those frames too that are written elsewhere.
    fn prepare(path: &Path, kind: &Kind, written: usize) -> Result<Self, FileError> {
        let failed = |e: std::io::Error| FileError::write(path, &e);
        let file = atomic_file::create_temporary(path).map_err(failed)?;
        let open =
            Open::create(&atomic_file::temporary(path), kind, written).map_err(|e| FileError::write(path, &e))?;
        let file = WatchedFile::new(path, file).map_err(failed)?;
        Ok(Self { path: path.to_owned(), open: Some(open), file, damage: Vec::new() })
    }

    fn place(self) -> Result<Self, FileError> {
        atomic_file::place(self.file.file(), &self.path).map_err(|e| FileError::write(&self.path, &e))?;
        Ok(self)
    }

    /// Opens a file of a former run and drops the frames after step `last`.
    pub(crate) fn resume(path: &Path, kind: &Kind, last: u64) -> Result<Self, FileError> {
        let damaged = |e: &hdf5::Error| FileError::damaged(path, e);
        let file = std::fs::File::options().read(true).write(true).open(path);
        let file = file.and_then(|file| WatchedFile::new(path, file)).map_err(|e| FileError::read(path, &e))?;
        let is_small = file.file().metadata().is_ok_and(|found| found.len() < SMALL);
        if !is_small {
            end_of_file::restore(file.file()).map_err(|e| FileError::write(path, &e))?;
        }
        let open = Open::existing(path, kind.elements).map_err(|e| damaged(&e))?;
        let (keep, damage) = open.kept(last).map_err(|e| damaged(&e))?;
        let mut old = Self { path: path.to_owned(), open: Some(open), file, damage };
        if old.look(|open| Ok(open.ends_with(keep)))? {
            return Ok(old);
        }
        if is_small {
            return old.larger(kind, keep);
        }
        old.attempt(|open, _| open.truncate(keep))?;
        // Places that are given back would be taken again: after a loss of power they may be beyond the end of the file.
        old.open = None;
        old.open = Some(Open::existing(path, kind.elements).map_err(|e| damaged(&e))?);
        old.file.note_length()?;
        Ok(old)
    }

    /// A file that takes the place of this one, with its first frames and room for more.
    fn larger(&self, kind: &Kind, frames: usize) -> Result<Self, FileError> {
        let copied = || {
            let mut new = Self::prepare(&self.path, kind, frames)?;
            let old = self.open()?;
            new.attempt(|new, _| old.copy_to(new, frames))?;
            new.place()
        };
        let new = copied().inspect_err(|_| atomic_file::remove_temporary(&self.path))?;
        Ok(Self { damage: self.damage.clone(), ..new })
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

    /// Adds a frame with one value for each element of the kind, in their order. It is in the file when this returns.
    pub(crate) fn append(&mut self, kind: &Kind, clock: (u64, f64), values: &[Values]) -> Result<(), FileError> {
        let values: Vec<Added> = values.iter().map(|values| Added::Whole(values.borrowed())).collect();
        self.append_blocks(kind, clock, &values)
    }

    /// The same with values that may come block by block.
    pub(crate) fn append_blocks(&mut self, kind: &Kind, clock: (u64, f64), values: &[Added]) -> Result<(), FileError> {
        self.file.check().inspect_err(|_| self.abandon())?;
        if self.look(|open| Ok(open.is_full()))? {
            let frames = self.steps_written()?.len();
            *self = self.larger(kind, frames).inspect_err(|_| self.abandon())?;
        }
        let sums = self.attempt(|open, _| open.write(clock, values))?;
        // Now a file that was cut meanwhile is still shorter, or has lost its beginning.
        self.file.check().and_then(|()| self.check_start()).inspect_err(|_| self.abandon())?;
        self.attempt(|open, file| open.publish(clock.0, &sums, file))?;
        self.file.note_growth()
    }

    /// `Err` if the header of the root group is not there any more, which begins the second page of the file.
    fn check_start(&self) -> Result<(), FileError> {
        let mut header = [0; 4];
        let read = self.file.file().read_exact_at(&mut header, open::PAGE);
        if read.is_ok() && header == *b"OHDR" {
            return Ok(());
        }
        Err(FileError::Lost { path: self.path.clone(), what: "was cut or overwritten".to_owned() })
    }

    /// Writes something else into the file.
    pub(crate) fn write(&mut self, write: impl FnOnce(&File) -> hdf5::Result<()>) -> Result<(), FileError> {
        self.attempt(|open, _| write(open.file()))
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

    fn attempt<T>(&mut self, write: impl FnOnce(&Open, &std::fs::File) -> hdf5::Result<T>) -> Result<T, FileError> {
        let error = match write(self.open()?, self.file.file()) {
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
