//! Velocity fields on the grid, and the XDMF file for opening them in `ParaView`.

mod lattice;
mod repeated;
#[cfg(test)]
mod tests;
mod xdmf;

use crate::{FileError, Manifest, Provenance, atomic_file, atomic_hdf5, checksum, manifest, text};
use hdf5::File;
use simulation::VelocityField;
use std::path::{Path, PathBuf};

/// Writes a field to `fields/` in the folder of a run and adds it to the index `fields.xdmf`.
pub fn write_field(field: &VelocityField, run: &Manifest, provenance: &Provenance) -> Result<(), FileError> {
    let fields = run.folder().join("fields");
    run.make_folder(&fields)?;
    let path = fields.join(format!("velocity-{:010}.h5", field.step));
    run.enter(&path)?;
    atomic_hdf5::write(&path, |file| fill(file, field, provenance))?;
    run.enter(&run.folder().join(INDEX))?;
    add_to_index(run, &path)
}

/// Name of the XDMF file.
const INDEX: &str = "fields.xdmf";

fn fill(file: &File, field: &VelocityField, provenance: &Provenance) -> hdf5::Result<()> {
    provenance.write(file)?;
    let [nx, ny, nz] = field.points;
    let dataset = file.new_dataset::<f64>().shape((nz, ny, nx, 3)).create("velocity")?;
    dataset.write_raw(bytemuck::cast_slice::<_, f64>(&field.values))?;
    checksum::attach(&dataset, checksum::of(&field.values))?;
    text::write_dimensions(&dataset, "length/time")?;
    text::write_attribute(&dataset, "note", field.note)?;
    let root = file.as_group()?;
    root.new_attr::<u64>().create("step")?.write_scalar(&field.step)?;
    root.new_attr::<f64>().create("time")?.write_scalar(&field.time)?;
    root.new_attr::<f64>().create("strain")?.write_scalar(&field.cell.strain())?;
    let edges = ndarray::arr1(&field.cell.edges().to_array());
    root.new_attr::<f64>().shape(3).create("edges")?.write(&edges)?;
    if field.periodic != [true; 3] {
        lattice::write(&root, field)?;
    }
    repeated::add_velocity(file)?;
    if field.cell.strain() == 0.0 { Ok(()) } else { repeated::add_position(file) }
}

/// Removes the fields of an earlier part of the run after step `last`.
pub fn drop_fields_after(run: &Manifest, last: u64) -> Result<(), FileError> {
    let late = format!("velocity-{last:010}.h5");
    let is_late = |path: &PathBuf| path.file_name().is_some_and(|name| *name > *late);
    field_files(run).iter().filter(|path| is_late(path)).try_for_each(|path| run.remove(path))?;
    let index = run.folder().join(INDEX);
    if !index.exists() {
        return Ok(());
    }
    run.enter(&index)?;
    index_fields(run)
}

/// Field files that the run has made, oldest first.
fn field_files(run: &Manifest) -> Vec<PathBuf> {
    let fields = run.folder().join("fields");
    let is_field = |path: &PathBuf| path.starts_with(&fields) && manifest::is_numbered(path, "velocity-", ".h5");
    run.files().into_iter().filter(|path| is_field(path) && path.is_file()).collect()
}

/// Adds the latest field to the index. The index is rewritten if it lacks earlier fields, or if these need another
/// kind of mesh together with this one. Otherwise no earlier field is read.
fn add_to_index(run: &Manifest, path: &Path) -> Result<(), FileError> {
    let (index, before) = (run.folder().join(INDEX), field_files(run).len() - 1);
    let series = std::fs::read_to_string(&index).unwrap_or_default();
    let frame = xdmf::XdmfFrame::read(path).map_err(|e| FileError::damaged(path, &e))?;
    let Some(longer) = xdmf::longer(&series, before, &frame) else { return index_fields(run) };
    if xdmf::is_curved(&series) && !frame.has_position {
        complete(path, true)?;
    }
    atomic_file::replace(&index, longer.as_bytes())
}

/// Writes the index of all fields. Readers assume that all frames of a series have the mesh type and the size of the
/// first. So if any frame is of a sheared box, all are given as curvilinear meshes, also those of an orthogonal box;
/// and frames on a grid that differs from that of the last frame, as former versions computed them in sheared boxes,
/// are left out. Frames of a box that follows the spheres are kept: each is a collection of one mesh, and parts of
/// collections may have any size.
fn index_fields(run: &Manifest) -> Result<(), FileError> {
    let files = field_files(run);
    let mut frames = Vec::with_capacity(files.len());
    for path in &files {
        frames.push(xdmf::XdmfFrame::read(path).map_err(|e| FileError::damaged(path, &e))?);
    }
    let curved = frames.iter().any(|frame| frame.strain != 0.0);
    for (frame, path) in frames.iter().zip(&files) {
        if !frame.has_velocity || (curved && !frame.has_position) {
            complete(path, curved)?;
        }
    }
    atomic_file::replace(&run.folder().join(INDEX), xdmf::series(frames, curved).as_bytes())
}

/// Adds to a file what the series requires: positions to the frames of an orthogonal box before the first sheared
/// one, and repeated planes to files of versions of this program that did not write them.
fn complete(path: &Path, curved: bool) -> Result<(), FileError> {
    atomic_hdf5::change(path, |file| {
        repeated::add_velocity(file)?;
        if curved { repeated::add_position(file) } else { Ok(()) }
    })
}
