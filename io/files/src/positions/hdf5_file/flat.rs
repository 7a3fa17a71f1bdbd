//! Datasets named as in cases of `fcm-solve mobility`.

use super::array::{Array, words};
use crate::positions::{FileBox, StartFile, TakenFrame, frame};
use domain::{PeriodicBox, Vector};
use hdf5::File;
use scene::StartSource;
use scene::document::excerpt;

/// Reads `positions`, and if present `radii`, `species`, `id`, `orientations`, `box` and `strain`.
pub(super) fn read(file: &File, source: &StartSource) -> Result<StartFile, String> {
    frame::pick(source.frame, 1)?;
    if source.group.is_some() {
        return Err("particles.group goes with H5MD files only; leave it out".to_owned());
    }
    let positions = dataset(file, "positions")?.ok_or_else(|| without(file))?.vectors()?;
    let count = positions.len();
    let radii = dataset(file, "radii")?.map(|radii| radii.one_each(count)).transpose()?;
    let species = dataset(file, "species")?.map(|species| species.kinds(count)).transpose()?;
    let ids = dataset(file, "id")?.map(|ids| ids.ids(count)).transpose()?;
    let orientations = dataset(file, "orientations")?.map(|rows| rows.orientations(count)).transpose()?;
    let frame = TakenFrame { count: 1, ..TakenFrame::default() };
    Ok(StartFile { positions, radii, species, ids, orientations, cell: cell(file)?, frame, ..StartFile::default() })
}

fn dataset(file: &File, name: &str) -> Result<Option<Array>, String> {
    if !file.link_exists(name) {
        return Ok(None);
    }
    file.dataset(name).map_err(words).and_then(Array::fixed).map(Some)
}

fn without(file: &File) -> String {
    let names = file.member_names().unwrap_or_default();
    let has = if names.is_empty() { "nothing".to_owned() } else { excerpt(&names.join(", ")) };
    format!("it has neither a dataset positions nor a group particles, as H5MD has; it has {has}")
}

/// Box of three edges, with a strain if there is one, or of three lattice vectors.
fn cell(file: &File) -> Result<Option<FileBox>, String> {
    let Some(edges) = numbers(file, "box")? else { return Ok(None) };
    if edges.len() == 9 {
        return FileBox::lattice([0, 3, 6].map(|first| Vector::from_slice(&edges[first..]))).checked().map(Some);
    }
    let edges: [f64; 3] = edges
        .try_into()
        .map_err(|edges: Vec<f64>| format!("its box has {} numbers; it needs 3 edges or 3 vectors", edges.len()))?;
    let strain = numbers(file, "strain")?.unwrap_or(vec![0.0]);
    let [strain] = strain[..] else { return Err("its strain is no single number".to_owned()) };
    let cell = PeriodicBox::sheared(Vector::from_array(edges), strain);
    Ok(Some(FileBox::of_cell(&cell.map_err(|e| format!("its box: {e}"))?)))
}

/// Numbers of a dataset or of an attribute.
fn numbers(file: &File, name: &str) -> Result<Option<Vec<f64>>, String> {
    if let Some(found) = dataset(file, name)? {
        return found.numbers().map(Some);
    }
    let is_there = file.attr_names().map_err(words)?.iter().any(|attribute| attribute == name);
    is_there.then(|| file.attr(name)?.read_raw::<f64>()).transpose().map_err(|e| format!("its attribute {name}: {e}"))
}
