//! Verification of datasets of any type that this program stores, by their checksums.

use crate::{checksum, text};
use hdf5::Dataset;
use hdf5::types::{IntSize, TypeDescriptor};

/// `Err` if a dataset of any type that this program stores does not match its checksum.
pub(crate) fn verify(dataset: &Dataset) -> hdf5::Result<()> {
    if !checksum::has_one(dataset)? {
        return Ok(());
    }
    match dataset.dtype()?.to_descriptor()? {
        TypeDescriptor::Float(_) => checksum::read::<f64>(dataset).map(drop),
        TypeDescriptor::Unsigned(IntSize::U4) => checksum::read::<u32>(dataset).map(drop),
        TypeDescriptor::Unsigned(_) => checksum::read::<u64>(dataset).map(drop),
        TypeDescriptor::VarLenUnicode => text::read(dataset).map(drop),
        _ => Ok(()),
    }
}
