//! Text in HDF5 files.

use crate::checksum;
use hdf5::types::{FixedAscii, VarLenUnicode};
use hdf5::{Dataset, Group, Location};
use std::str::FromStr;

/// First bytes of an HDF5 file.
pub(crate) const HDF5: [u8; 8] = *b"\x89HDF\r\n\x1a\n";

/// Text as HDF5 stores it.
pub(crate) fn scalar(text: &str) -> VarLenUnicode {
    // HDF5 strings end at the first zero character.
    VarLenUnicode::from_str(&text.replace('\0', " ")).expect("text without zeros")
}

pub(crate) fn write_attribute(place: &Location, name: &str, text: &str) -> hdf5::Result<()> {
    place.new_attr::<VarLenUnicode>().create(name)?.write_scalar(&scalar(text))
}

/// Stores a text with its checksum.
pub(crate) fn write_dataset(group: &Group, name: &str, text: &str) -> hdf5::Result<()> {
    let (dataset, text) = (group.new_dataset::<VarLenUnicode>().create(name)?, scalar(text));
    dataset.write_scalar(&text)?;
    checksum::attach(&dataset, checksum::of(text.as_bytes()))
}

/// Reads a text; `Err` if it does not match its checksum, if it has one.
pub(crate) fn read_dataset(group: &Group, name: &str) -> hdf5::Result<String> {
    read(&group.dataset(name)?)
}

/// Like [`read_dataset`], for an open dataset.
pub(crate) fn read(dataset: &Dataset) -> hdf5::Result<String> {
    let text = dataset.read_scalar::<VarLenUnicode>()?;
    checksum::compare(dataset, || checksum::of(text.as_bytes()))?;
    Ok(text.as_str().to_owned())
}

/// ASCII text of at most 64 bytes with a fixed length, as H5MD requires of its own attributes.
pub(crate) fn fixed(text: &str) -> hdf5::Result<FixedAscii<64>> {
    FixedAscii::from_ascii(text).map_err(|e| format!("`{text}`: {e}").into())
}

/// Stores the physical dimensions of a dataset's numbers, in terms of length, time and force. H5MD's `unit` is not
/// suitable: it has names of units, by which readers convert, and the units of a scene are the user's choice.
pub(crate) fn write_dimensions(dataset: &Dataset, dimensions: &str) -> hdf5::Result<()> {
    write_attribute(dataset, "dimensions", dimensions)
}

/// Physical dimensions of a dataset's numbers; older files have them as `unit`.
pub(crate) fn read_dimensions(dataset: &Dataset) -> String {
    let attribute = dataset.attr("dimensions").or_else(|_| dataset.attr("unit"));
    let text = attribute.and_then(|a| a.read_scalar::<VarLenUnicode>());
    text.map(|text| text.to_string()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dimensions_are_read_by_their_name_of_today_and_of_before() {
        let folder = tempfile::tempdir().unwrap();
        let file = hdf5::File::create(folder.path().join("file.h5")).unwrap();
        let [new, old, none] = ["new", "old", "none"].map(|name| file.new_dataset::<f64>().create(name).unwrap());
        write_dimensions(&new, "length/time").unwrap();
        write_attribute(&old, "unit", "length").unwrap();
        assert_eq!([&new, &old, &none].map(read_dimensions), ["length/time", "length", ""]);
        assert!(new.attr("unit").is_err());
    }

    #[test]
    fn text_of_a_fixed_length_is_refused_if_it_does_not_fit() {
        assert_eq!(fixed("fcm-solve").unwrap().as_str(), "fcm-solve");
        assert!(fixed(&"a".repeat(65)).is_err() && fixed("\u{b5}m").is_err());
    }
}
