mod hdf5_files;

use super::species::SpeciesNames;
use super::*;
use crate::{Provenance, Trajectory};
use domain::{Particles, PeriodicBox, Vector};
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
