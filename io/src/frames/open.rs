//! A file of frames as the HDF5 library has it open.

use super::element::{Stored, group, reserve, write_number};
use super::{Added, Damage, Element, Kind, Sums, Values};
use crate::{atomic_hdf5, claimed_size, stored_inside, text};
use hdf5::file::{FileAccessBuilder, LibraryVersion};
use hdf5::{Dataset, File, OpenMode};
use std::path::Path;

/// The file and its datasets.
pub(super) struct Open {
    file: File,
    stored: Vec<Stored>,
    steps: Dataset,
    times: Dataset,
    /// Nothing in files of programs that wrote none.
    sums: Option<Sums>,
}

impl Open {
    /// Makes a file without frames.
    pub(super) fn create(path: &Path, kind: &Kind) -> hdf5::Result<Self> {
        // A superblock of this version has no mark for files open for writing, which a killed program would leave set.
        File::with_options()
            .with_fapl(|f| in_pages(f).libver_bounds(LibraryVersion::V18, LibraryVersion::V18))
            .create(path)?
            .close()?;
        let file = for_writing(path)?;
        Self::fill(&file, kind).inspect_err(|_| atomic_hdf5::leave_open(&file))
    }

    fn fill(file: &File, kind: &Kind) -> hdf5::Result<Self> {
        let (elements, capacity) = (kind.elements, kind.capacity.max(1) as usize);
        let first = group(file, &elements[0].path)?;
        let steps = reserve::<i64>(&first, "step", None, capacity)?;
        let times = reserve::<f64>(&first, "time", None, capacity)?;
        text::write_dimensions(&times, "time")?;
        let mut stored = Vec::with_capacity(elements.len());
        for element in elements {
            stored.push(Stored::create(file, element, (&elements[0].path, capacity))?);
        }
        let paths: Vec<String> = elements.iter().map(|element| element.path.clone()).collect();
        let sums = Some(Sums::create(file, &paths, capacity)?);
        (kind.fixed)(file)?;
        file.flush()?;
        Ok(Self { file: file.clone(), stored, steps, times, sums })
    }

    /// Opens a file of a former run.
    pub(super) fn existing(path: &Path, elements: &[Element]) -> hdf5::Result<Self> {
        let file = for_writing(path)?;
        stored_inside::check(&file)?;
        let first = file.group(&elements[0].path)?;
        let (steps, times) = (first.dataset("step")?, first.dataset("time")?);
        let stored = elements.iter().map(|element| Stored::open(&file, element)).collect::<hdf5::Result<_>>()?;
        let sums = Sums::open(&file)?;
        Ok(Self { file, stored, steps, times, sums })
    }

    pub(super) fn file(&self) -> &File {
        &self.file
    }

    /// The steps of the frames, in order.
    pub(super) fn steps_written(&self) -> hdf5::Result<Vec<u64>> {
        claimed_size::check(&self.steps)?;
        self.steps.read_raw()
    }

    /// The most frames that it has room for.
    pub(super) fn capacity(&self) -> usize {
        let most = |d: &Dataset| d.space().ok()?.maxdims().first().copied()?;
        most(&self.steps).unwrap_or(0)
    }

    /// How many frames there are until step `last`, and which of them are damaged.
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

    /// Adds a frame, with checksums that it has already or with its own.
    pub(super) fn append(&self, clock: (u64, f64), values: &[Added], sums: Option<Vec<u64>>) -> hdf5::Result<()> {
        assert_eq!(values.len(), self.stored.len(), "a value for each element");
        let frame = self.steps.size();
        let mut found = vec![Sums::of_clock(clock)];
        for (stored, value) in self.stored.iter().zip(values) {
            found.push(stored.write(frame, value)?);
        }
        write_number(&self.times, frame, clock.1)?;
        if let Some(stored) = &self.sums {
            stored.write(frame, &sums.unwrap_or(found))?;
        }
        self.file.flush()?;
        write_number(&self.steps, frame, clock.0 as i64)?;
        self.file.flush()
    }

    /// Step, time and values of a frame.
    pub(super) fn frame(&self, frame: usize) -> hdf5::Result<((u64, f64), Vec<Values<'static>>)> {
        let clock = (one(&self.steps, frame)?, one(&self.times, frame)?);
        Ok((clock, self.stored.iter().map(|stored| stored.read(frame)).collect::<hdf5::Result<_>>()?))
    }

    pub(super) fn truncate(&self, frames: usize) -> hdf5::Result<()> {
        self.steps.resize((frames,))?;
        self.file.flush()?;
        self.times.resize((frames,))?;
        self.stored.iter().try_for_each(|stored| stored.resize(frames))?;
        self.sums.iter().try_for_each(|sums| sums.resize(frames))?;
        self.file.flush()
    }

    /// Adds the first frames to another file, with the checksums that they have.
    pub(super) fn copy_to(&self, new: &Self, frames: usize) -> hdf5::Result<()> {
        for frame in 0..frames {
            let clock = (one(&self.steps, frame)?, one(&self.times, frame)?);
            let values: Vec<Added> = self.stored.iter().map(|stored| stored.blocks(frame)).collect();
            let sums = self.sums.as_ref().map(|sums| sums.read(frame)).transpose()?;
            new.append(clock, &values, sums)?;
        }
        Ok(())
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

/// Makes whatever the file consists of begin at a page of memory, by itself. What is in one piece is written at once:
/// the library would keep it until it is closed, and lose it without a word if that fails.
fn in_pages(file: &mut FileAccessBuilder) -> &mut FileAccessBuilder {
    file.alignment(1, PAGE).meta_block_size(0).sieve_buf_size(0)
}

/// A page of memory.
pub(super) const PAGE: u64 = 4096;
