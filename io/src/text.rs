//! Text in HDF5 files.

use hdf5::types::VarLenUnicode;
use hdf5::{Group, Location};
use std::str::FromStr;

/// Text as HDF5 stores it.
pub(crate) fn scalar(text: &str) -> VarLenUnicode {
    // HDF5 strings end at the first zero character.
    VarLenUnicode::from_str(&text.replace('\0', " ")).expect("text without zeros")
}

pub(crate) fn write_attribute(place: &Location, name: &str, text: &str) -> hdf5::Result<()> {
    place.new_attr::<VarLenUnicode>().create(name)?.write_scalar(&scalar(text))
}

pub(crate) fn write_dataset(group: &Group, name: &str, text: &str) -> hdf5::Result<()> {
    group.new_dataset::<VarLenUnicode>().create(name)?.write_scalar(&scalar(text))
}

pub(crate) fn read_dataset(group: &Group, name: &str) -> hdf5::Result<String> {
    Ok(group.dataset(name)?.read_scalar::<VarLenUnicode>()?.as_str().to_owned())
}
