//! Checksums of datasets that are written once, stored in the attribute `checksum`: XXH3 (64 bits) of the bytes of
//! the numbers, little-endian and in their order, or of the text.

use crate::claimed_size;
use bytemuck::NoUninit;
use hdf5::{Dataset, Group, H5Type};
use xxhash_rust::xxh3::{Xxh3, xxh3_64};

const NAME: &str = "checksum";

/// The checksum of numbers.
pub(crate) fn of<T: NoUninit>(values: &[T]) -> u64 {
    xxh3_64(bytemuck::cast_slice(values))
}

/// The checksum of a text as 16 digits.
pub(crate) fn of_text(text: &str) -> String {
    format!("{:016x}", xxh3_64(text.as_bytes()))
}

/// Stores a list of `count` numbers, which `each` passes on block by block, with its checksum.
pub(crate) fn write_blocks<T: H5Type + NoUninit>(
    group: &Group,
    name: &str,
    count: usize,
    each: impl FnOnce(&mut dyn FnMut(&[T]) -> hdf5::Result<()>) -> hdf5::Result<()>,
) -> hdf5::Result<Dataset> {
    let dataset = group.new_dataset::<T>().shape((count,)).create(name)?;
    let (mut sum, mut start) = (Sum::default(), 0);
    each(&mut |values| {
        sum.add(values);
        dataset.write_slice(values, start..start + values.len())?;
        start += values.len();
        Ok(())
    })?;
    attach(&dataset, sum.get())?;
    Ok(dataset)
}

/// Checksum of numbers that arrive in parts.
#[derive(Default)]
pub(crate) struct Sum(Xxh3);

impl Sum {
    /// Adds numbers.
    pub(crate) fn add<T: NoUninit>(&mut self, values: &[T]) {
        self.0.update(bytemuck::cast_slice(values));
    }

    /// Checksum of all numbers so far.
    pub(crate) fn get(&self) -> u64 {
        self.0.digest()
    }
}

/// Stores a dataset's checksum.
pub(crate) fn attach(dataset: &Dataset, checksum: u64) -> hdf5::Result<()> {
    dataset.new_attr::<u64>().create(NAME)?.write_scalar(&checksum)
}

/// Reads all numbers of a dataset; `Err` if they do not match its checksum, if it has one.
pub(crate) fn read<T: H5Type + NoUninit>(dataset: &Dataset) -> hdf5::Result<Vec<T>> {
    claimed_size::check(dataset)?;
    let values = dataset.read_raw::<T>()?;
    compare(dataset, || of(&values))?;
    Ok(values)
}

/// `Err` if a dataset has a checksum that differs from `found`.
pub(crate) fn compare(dataset: &Dataset, found: impl FnOnce() -> u64) -> hdf5::Result<()> {
    if !has_one(dataset)? {
        return Ok(());
    }
    if dataset.attr(NAME)?.read_scalar::<u64>()? == found() {
        return Ok(());
    }
    Err(format!("{} does not fit its checksum", dataset.name().trim_start_matches('/')).into())
}

/// Whether a dataset has a checksum.
pub(crate) fn has_one(dataset: &Dataset) -> hdf5::Result<bool> {
    Ok(dataset.attr_names()?.iter().any(|name| name == NAME))
}
