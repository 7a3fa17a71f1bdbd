//! HDF5 files to which whole frames are appended, and which stay readable if the program is killed.
//!
//! A frame changes three things: its own numbers; the lists of the chunks in which datasets grow, if it begins a
//! chunk, and the lengths of the datasets; and last the length of `step`. A program that is killed at any time leaves
//! a file that every HDF5 reader opens, and the length of `step` is the number of complete frames in it. To that end
//!
//! - no write of a list or a length may be cut in two: each is within one page of memory, as the
//!   kernel handles signals only
//!   between pages. A list therefore has a bounded number of entries (HDF5's fixed array; no filters), and a file has
//!   room for a bounded number of frames; a full file is replaced by a larger one with the same frames;
//! - the superblock has the new end of the file before a list refers to a chunk beyond the former end;
//! - the storage of `step`, eight bytes per frame, is reserved from the start, since its length and
//!   a list of its chunks would
//!   be two writes.
//!
//! `h5repack` compresses a finished file.

mod capacity;
mod element;
mod end_of_file;
mod open;
mod sums;

use crate::watched_file::WatchedFile;
use crate::{FileError, atomic_file, atomic_hdf5};
pub(crate) use element::{Element, NewValue, Values, group, one_of};
use hdf5::File;
use open::OpenFile;
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};
pub use sums::Damage;
pub(crate) use sums::FrameChecksums;

/// Size up to which frames are dropped by making a copy without them. The library cuts a file before it updates the
/// superblock: a larger file, whose copy would take long, is invalid for a moment, and if the program is killed then,
/// until the run is resumed.
const SMALL: u64 = 64 << 20;

/// A file of elements as defined by H5MD: groups with a `value` for each frame, and its `step` and `time`; and a
/// checksum of each element of each frame.
pub(crate) struct Frames {
    path: PathBuf,
    /// `None` after a failed write: the content of the file then stays as it is.
    open: Option<OpenFile>,
    /// Second handle of the file, for detecting changes by others.
    file: WatchedFile,
    damage: Vec<Damage>,
}

/// Description that all files of a kind share.
pub(crate) struct FileKind<'a> {
    /// Quantities of a frame.
    pub(crate) elements: &'a [Element],
    /// Number of frames at the end of the run.
    pub(crate) planned: u64,
    /// Writes the data that are the same for all frames.
    pub(crate) fixed: &'a dyn Fn(&File) -> hdf5::Result<()>,
}

impl Frames {
    /// Creates a file without frames; it replaces any file of that name once it is complete.
    pub(crate) fn create(path: &Path, kind: &FileKind) -> Result<Self, FileError> {
        let made = Self::prepare(path, kind, 0).and_then(Self::place);
        made.inspect_err(|_| atomic_file::remove_temporary(path))
    }

    /// Creates the file under a temporary name, with room for the `written` frames that will be copied to it as well.
    fn prepare(path: &Path, kind: &FileKind, written: usize) -> Result<Self, FileError> {
        let failed = |e: std::io::Error| FileError::write(path, &e);
        let file = atomic_file::create_temporary(path).map_err(failed)?;
        let open =
            OpenFile::create(&atomic_file::temporary(path), kind, written).map_err(|e| FileError::write(path, &e))?;
        let file = WatchedFile::new(path, file).map_err(failed)?;
        Ok(Self { path: path.to_owned(), open: Some(open), file, damage: Vec::new() })
    }

    fn place(self) -> Result<Self, FileError> {
        atomic_file::place(self.file.file(), &self.path).map_err(|e| FileError::write(&self.path, &e))?;
        Ok(self)
    }

    /// Opens a file of an earlier part of the run and drops the frames after step `last`.
    pub(crate) fn resume(path: &Path, kind: &FileKind, last: u64) -> Result<Self, FileError> {
        let damaged = |e: &hdf5::Error| FileError::damaged(path, e);
        let file = std::fs::File::options().read(true).write(true).open(path);
        let file = file.and_then(|file| WatchedFile::new(path, file)).map_err(|e| FileError::read(path, &e))?;
        let is_small = file.file().metadata().is_ok_and(|found| found.len() < SMALL);
        if !is_small {
            end_of_file::restore(file.file()).map_err(|e| FileError::write(path, &e))?;
        }
        let open = OpenFile::existing(path, kind.elements).map_err(|e| damaged(&e))?;
        let (keep, damage) = open.kept(last).map_err(|e| damaged(&e))?;
        let mut old = Self { path: path.to_owned(), open: Some(open), file, damage };
        if old.look(|open| Ok(open.ends_with(keep)))? {
            return Ok(old);
        }
        if is_small {
            return old.larger(kind, keep);
        }
        old.attempt(|open, _| open.truncate(keep))?;
        // Space that was freed would be reused: after a power failure it may be beyond the end of the file.
        old.open = None;
        old.open = Some(OpenFile::existing(path, kind.elements).map_err(|e| damaged(&e))?);
        old.file.note_length()?;
        Ok(old)
    }

    /// A larger file that replaces this one, with its first frames and room for more.
    fn larger(&self, kind: &FileKind, frames: usize) -> Result<Self, FileError> {
        let copied = || {
            let mut new = Self::prepare(&self.path, kind, frames)?;
            let old = self.open()?;
            new.attempt(|new, _| old.copy_to(new, frames))?;
            new.place()
        };
        let new = copied().inspect_err(|_| atomic_file::remove_temporary(&self.path))?;
        Ok(Self { damage: self.damage.clone(), ..new })
    }

    /// The damaged frames among those that were there at the start. They are left as they are.
    pub(crate) fn damage(&self) -> &[Damage] {
        &self.damage
    }

    /// Steps of the frames, in order.
    pub(crate) fn steps_written(&self) -> Result<Vec<u64>, FileError> {
        self.look(OpenFile::steps_written)
    }

    /// Step, time and values of a frame.
    pub(crate) fn frame(&self, frame: usize) -> Result<((u64, f64), Vec<Values<'static>>), FileError> {
        self.look(|open| open.frame(frame))
    }

    /// Appends a frame with one value for each element of the kind, in their order. It is in
    /// the file when this returns.
    pub(crate) fn append(&mut self, kind: &FileKind, clock: (u64, f64), values: &[Values]) -> Result<(), FileError> {
        let values: Vec<NewValue> = values.iter().map(|values| NewValue::Whole(values.borrowed())).collect();
        self.append_blocks(kind, clock, &values)
    }

    /// Like [`Self::append`], with values that may come block by block.
    pub(crate) fn append_blocks(
        &mut self,
        kind: &FileKind,
        clock: (u64, f64),
        values: &[NewValue],
    ) -> Result<(), FileError> {
        self.file.check().inspect_err(|_| self.abandon())?;
        if self.look(|open| Ok(open.is_full()))? {
            let frames = self.steps_written()?.len();
            *self = self.larger(kind, frames).inspect_err(|_| self.abandon())?;
        }
        let sums = self.attempt(|open, _| open.write(clock, values))?;
        // Now a file that was cut in the meantime is still shorter, or has lost its beginning.
        self.file.check().and_then(|()| self.check_start()).inspect_err(|_| self.abandon())?;
        self.attempt(|open, file| open.publish(clock.0, &sums, file))?;
        self.file.note_growth()
    }

    /// `Err` if the header of the root group, which begins the second page of the file, is missing.
    fn check_start(&self) -> Result<(), FileError> {
        let mut header = [0; 4];
        let read = self.file.file().read_exact_at(&mut header, open::PAGE);
        if read.is_ok() && header == *b"OHDR" {
            return Ok(());
        }
        Err(FileError::Lost { path: self.path.clone(), what: "was cut or overwritten".to_owned() })
    }

    /// Writes other data to the file.
    pub(crate) fn write(&mut self, write: impl FnOnce(&File) -> hdf5::Result<()>) -> Result<(), FileError> {
        self.attempt(|open, _| write(open.file()))
    }

    /// Waits until all frames so far are on the disk.
    pub(crate) fn sync(&self) -> Result<(), FileError> {
        self.file.check()?;
        atomic_file::sync(self.file.file()).map_err(|e| FileError::write(&self.path, &e))
    }

    fn open(&self) -> Result<&OpenFile, FileError> {
        self.open.as_ref().ok_or_else(|| FileError::write(&self.path, &"a write to it has failed before"))
    }

    fn look<T>(&self, read: impl FnOnce(&OpenFile) -> hdf5::Result<T>) -> Result<T, FileError> {
        read(self.open()?).map_err(|e| FileError::damaged(&self.path, &e))
    }

    fn attempt<T>(&mut self, write: impl FnOnce(&OpenFile, &std::fs::File) -> hdf5::Result<T>) -> Result<T, FileError> {
        let error = match write(self.open()?, self.file.file()) {
            Ok(value) => return Ok(value),
            Err(error) => error,
        };
        self.abandon();
        Err(FileError::write(&self.path, &error))
    }

    /// Gives up the file and leaves its content as it is.
    fn abandon(&mut self) {
        if let Some(open) = self.open.take() {
            atomic_hdf5::leave_open(open.file());
            std::mem::forget(open);
        }
    }
}

#[cfg(test)]
mod tests;
