//! A field with the first plane along each axis repeated at the far end of the box, as visualisation programs need
//! it: they do not know of periodicity, and would leave a gap of one grid spacing.
//!
//! `repeated/velocity` (nz + 1, ny + 1, nx + 1, 3) is a virtual dataset: it refers to the numbers of `velocity`, and
//! takes no space. `repeated/position` has the positions of its points in a sheared box, `x = i Lx / nx + s y`,
//! `y = j Ly / ny`, `z = k Lz / nz`. It is stored by rows of x for all z, one component each, with so many repeated
//! numbers that compression reduces it to about a hundredth.
//!
//! Along an axis that is not periodic no plane is repeated.

use super::lattice;
use crate::text;
use domain::Vector;
use hdf5::{Dataset, File, Group};
use ndarray::Array4;
use std::ops::Range;

/// Name of the group of the repeated field.
pub(super) const GROUP: &str = "repeated";

/// Adds the velocity with repeated planes, if the file lacks it.
pub(super) fn add_velocity(file: &File) -> hdf5::Result<()> {
    let group = group(file)?;
    if group.link_exists("velocity") {
        return Ok(());
    }
    let (points, [x, y, z]) = (points(file)?, lattice::read(file)?.map_or([true; 3], |lattice| lattice.periodic));
    let shape = |[nz, ny, nx]: [usize; 3]| (nz, ny, nx, 3);
    let repeats = [z, y, x];
    let all: [usize; 3] = std::array::from_fn(|axis| points[axis] + usize::from(repeats[axis]));
    let mut new = group.new_dataset::<f64>().shape(shape(all));
    let corners = (0..8).map(|corner| [corner & 4, corner & 2, corner & 1].map(|bit| bit != 0));
    for again in corners.filter(|again| (0..3).all(|axis| repeats[axis] || !again[axis])) {
        let [from, to] = blocks(points, again);
        let block = |[z, y, x]: [Range<usize>; 3]| hdf5::Hyperslab::from((z, y, x, ..));
        new = new.virtual_map(".", "/velocity", shape(points), block(from), shape(all), block(to));
    }
    text::write_dimensions(&new.create("velocity")?, "length/time")
}

/// Source and destination of a part of the repeated field: all points, or along the axes in `again` the first plane,
/// which is copied after the last.
fn blocks(points: [usize; 3], again: [bool; 3]) -> [[Range<usize>; 3]; 2] {
    let along = |axis: usize| {
        if again[axis] { [0..1, points[axis]..points[axis] + 1] } else { [0..points[axis], 0..points[axis]] }
    };
    let [z, y, x] = [along(0), along(1), along(2)];
    [[z[0].clone(), y[0].clone(), x[0].clone()], [z[1].clone(), y[1].clone(), x[1].clone()]]
}

/// Adds the positions of the grid points of a sheared box, if the file lacks them: with repeated planes and, under
/// the name `position`, without.
pub(super) fn add_position(file: &File) -> hdf5::Result<()> {
    let group = group(file)?;
    if group.link_exists("position") {
        return Ok(());
    }
    let points = points(file)?;
    let dataset = reserve(&group, points.map(|n| n + 1))?;
    let edges: Vec<f64> = file.attr("edges")?.read_raw()?;
    let strain: f64 = file.attr("strain")?.read_scalar()?;
    let spacing = Vector::from_slice(&edges) / Vector::from_array([2, 1, 0].map(|axis| points[axis] as f64));
    for j in 0..=points[1] {
        let place = |(k, _, i, component)| {
            let lattice = Vector::new(i as f64, j as f64, k as f64) * spacing;
            (lattice + Vector::X * (strain * lattice.y))[component]
        };
        let row = Array4::from_shape_fn((points[0] + 1, 1, points[2] + 1, 3), place);
        dataset.write_slice(&row, (.., j..=j, .., ..))?;
    }
    text::write_dimensions(&dataset, "length")?;
    if file.link_exists("position") { Ok(()) } else { show_without_repeats(file, points) }
}

fn reserve(group: &Group, [nz, ny, nx]: [usize; 3]) -> hdf5::Result<Dataset> {
    let new = group.new_dataset::<f64>().shape((nz, ny, nx, 3)).chunk((nz, 1, nx, 1));
    let new = if hdf5::filters::deflate_available() { new.deflate(1) } else { new };
    new.create("position")
}

fn show_without_repeats(file: &File, [nz, ny, nx]: [usize; 3]) -> hdf5::Result<()> {
    let all = || hdf5::Hyperslab::from((0..nz, 0..ny, 0..nx, ..));
    let from = format!("/{GROUP}/position");
    let new = file.new_dataset::<f64>().shape((nz, ny, nx, 3));
    let new = new.virtual_map(".", from, (nz + 1, ny + 1, nx + 1, 3), all(), (nz, ny, nx, 3), all());
    text::write_dimensions(&new.create("position")?, "length")
}

/// Numbers of points along z, y and x.
fn points(file: &File) -> hdf5::Result<[usize; 3]> {
    match file.dataset("velocity")?.shape()[..] {
        [nz, ny, nx, 3] => Ok([nz, ny, nx]),
        ref shape => Err(format!("`velocity` is of the shape {shape:?}; it needs to be nz, ny, nx, 3").into()),
    }
}

fn group(file: &File) -> hdf5::Result<Group> {
    if file.link_exists(GROUP) { file.group(GROUP) } else { file.create_group(GROUP) }
}
