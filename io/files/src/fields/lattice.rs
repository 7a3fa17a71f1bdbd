//! Grid points of a field in a box that is not periodic along all axes: attributes of its file, which fully
//! periodic boxes do not have.

use crate::text;
use hdf5::types::FixedAscii;
use hdf5::{File, Group};
use simulation::VelocityField;

/// Grid of the points, by x, y and z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PointLattice {
    /// Position of the first point.
    pub(super) origin: [f64; 3],
    /// Spacing along each axis.
    pub(super) spacing: [f64; 3],
    /// Whether the box is periodic, for each axis.
    pub(super) periodic: [bool; 3],
}

/// Writes the attributes.
pub(super) fn write(root: &Group, field: &VelocityField) -> hdf5::Result<()> {
    let boundary = field.periodic.map(|yes| text::fixed(if yes { "periodic" } else { "none" }));
    let boundary = boundary.into_iter().collect::<hdf5::Result<Vec<_>>>()?;
    root.new_attr::<FixedAscii<64>>().shape(3).create("boundary")?.write(&boundary)?;
    for (name, vector) in [("origin", field.origin), ("spacing", field.spacing)] {
        root.new_attr::<f64>().shape(3).create(name)?.write(&ndarray::arr1(&vector.to_array()))?;
    }
    Ok(())
}

/// Reads the attributes, if a file has them.
pub(super) fn read(file: &File) -> hdf5::Result<Option<PointLattice>> {
    if !file.attr_names()?.iter().any(|name| name == "boundary") {
        return Ok(None);
    }
    let three = |name: &str| {
        let numbers: Vec<f64> = file.attr(name)?.read_raw()?;
        numbers.try_into().map_err(|all: Vec<f64>| hdf5::Error::from(format!("`{name}` has {} numbers", all.len())))
    };
    let boundary = file.attr("boundary")?.read_raw::<FixedAscii<64>>()?;
    let &[x, y, z] = &boundary[..] else { return Err(format!("`boundary` has {} words", boundary.len()).into()) };
    let periodic = [x, y, z].map(|word| word.as_str() == "periodic");
    Ok(Some(PointLattice { origin: three("origin")?, spacing: three("spacing")?, periodic }))
}
