mod hdf5_files;

use super::species::SpeciesNames;
use super::*;
use crate::{Provenance, Trajectory};
use domain::{Particles, PeriodicBox, Quaternion, Vector};
use ndarray::{Array1, Array2, Array3};
use simulation::Frame;

fn read(name: &str, text: &str) -> Result<StartFile, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    read_start(&StartSource::last(path)).map_err(|e| e.to_string())
}

/// Reads an HDF5 file that `fill` makes.
fn hdf5(fill: impl FnOnce(&hdf5::File)) -> Result<StartFile, String> {
    hdf5_at(None, None, fill)
}

fn hdf5_at(frame: Option<i64>, group: Option<&str>, fill: impl FnOnce(&hdf5::File)) -> Result<StartFile, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    let file = hdf5::File::create(&path).unwrap();
    fill(&file);
    drop(file);
    read_start(&StartSource { path, frame, group: group.map(str::to_owned) }).map_err(|e| e.to_string())
}

fn put<T: hdf5::H5Type, D: ndarray::Dimension>(group: &hdf5::Group, name: &str, data: &ndarray::Array<T, D>) {
    group.new_dataset_builder().with_data(data).create(name).unwrap();
}

#[test]
fn csv_is_read_by_its_names() {
    let placed = read("a.csv", "# by hand\nradius, x, y, z, species\n1.5, 1, 2, 3, 0\n\n2.5, 4, 5e-1, 6, 1\n").unwrap();
    assert_eq!(placed.positions, [Vector::new(1.0, 2.0, 3.0), Vector::new(4.0, 0.5, 6.0)]);
    assert_eq!((placed.radii, placed.species), (Some(vec![1.5, 2.5]), Some(SpeciesColumn::Indices(vec![0, 1]))));
    assert!(read("a.csv", "x,y,z\n1,2,3\n1,two,3\n").unwrap_err().contains("line 3 has two"));
    assert!(read("a.csv", "x,y,z\n1,2,nan\n").unwrap_err().contains("position 0 is"));
}

/// The same orientations in all formats: quaternions with the scalar first, except in XYZ.
#[test]
fn orientations_are_read_from_all_formats() {
    let expected =
        Some(vec![Quaternion::from_array([0.5, 0.1, 0.2, 0.3]), Quaternion::from_array([0.0, 0.0, 1.0, 0.0])]);
    let csv = "orientation_x,x,y,z,orientation_w,orientation_y,orientation_z\n0.1,1,2,3,0.5,0.2,0.3\n0,4,5,6,0,1,0\n";
    assert_eq!(read("a.csv", csv).unwrap().orientations, expected);
    let xyz = "2\nProperties=pos:R:3:orientation:R:4\n1 2 3 0.1 0.2 0.3 0.5\n4 5 6 0 1 0 0\n";
    assert_eq!(read("a.xyz", xyz).unwrap().orientations, expected);
    let other = "1\nProperties=pos:R:3:orientation:R:3\n1 2 3 0.1 0.2 0.3\n";
    assert_eq!(read("a.xyz", other).unwrap().orientations, None);
    let dump = "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: ATOMS x y z quatw quati quatj quatk\n\
                1 2 3 0.5 0.1 0.2 0.3\n4 5 6 0 0 1 0\n";
    assert_eq!(read("dump", dump).unwrap().orientations, expected);
    let rows = |width: usize, values: &[f64]| Array2::from_shape_vec((2, width), values.to_vec()).unwrap();
    let both = |orientations: Array2<f64>| {
        hdf5(|file| {
            put(file, "positions", &rows(3, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
            put(file, "orientations", &orientations);
        })
    };
    let values = [0.5, 0.1, 0.2, 0.3, 0.0, 0.0, 1.0, 0.0];
    assert_eq!(both(rows(4, &values)).unwrap().orientations, expected);
    assert!(both(rows(3, &values[..6])).unwrap_err().contains("orientations has the shape (2, 3); it needs (2, 4)"));
    assert_eq!(read("a.csv", "x,y,z\n1,2,3\n").unwrap().orientations, None);
}

#[test]
fn numbers_that_mean_nothing_are_refused() {
    let message = |name: &str, text: &str| read(name, text).unwrap_err();
    assert!(
        message("a.csv", "x,y,z,radius\n1,2,3,0\n").contains("radius 0 is 0; it needs to be a finite number above 0")
    );
    assert!(message("a.csv", "x,y,z,radius\n1,2,3,1\n1,2,9,inf\n").contains("radius 1 is inf"));
    assert!(message("a.csv", "x,y,z,species\n1,2,3,-1\n").contains("line 2 has species -1; species are whole"));
    assert!(message("a.csv", "x,y,z,species\n1,2,3,0.5\n").contains("line 2 has species 0.5"));
    let placed = read("a.csv", "x,y,z,species\n1,2,3,1.0\n").unwrap();
    assert_eq!(placed.species, Some(SpeciesColumn::Indices(vec![1])));
    assert!(message("a.csv", "x,y,z,species\n1,2,3,\n").contains("line 2 has no species"));
    assert!(message("a.csv", "x,y,z\n").contains("it has no positions"));
}

#[test]
fn other_files_are_refused_by_name() {
    assert!(read("a.txt", "").unwrap_err().contains("another ending than .csv"));
    assert!(read("a.txt", "ITEM: TIMESTEP\n").is_err());
    let message = read("a.h5", "no").unwrap_err();
    assert!(message.contains("can't start from") && message.contains("no whole HDF5 file"), "{message}");
    let missing = |name: &str| read_start(&StartSource::last(name)).unwrap_err().to_string();
    assert!(missing("/nowhere/a.h5").contains("can't read /nowhere/a.h5: there is no such file"));
    assert!(missing("/nowhere/a.csv").contains("can't read /nowhere/a.csv"));
    assert!(missing("/nowhere/dump").contains("can't read /nowhere/dump"));
    let empty = tempfile::tempdir().unwrap();
    assert!(missing(&empty.path().display().to_string()).contains("neither trajectory.h5 nor checkpoints"));
    assert!(read("a.csv", "x,y,z\n1,2,3\n").is_ok());
    let grouped = StartSource { group: Some("all".to_owned()), ..StartSource::last("a.csv") };
    assert!(read_start(&grouped).unwrap_err().to_string().contains("particles.group goes with H5MD files only"));
}
