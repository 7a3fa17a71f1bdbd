use super::*;
use crate::{Provenance, Trajectory};
use domain::{Particles, PeriodicBox, Vector};
use simulation::Frame;

fn read(name: &str, text: &str) -> Result<GivenPositions, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    read_positions(&path).map_err(|e| e.to_string())
}

#[test]
fn csv_is_read_by_its_names() {
    let placed = read("a.csv", "# by hand\nradius, x, y, z, species\n1.5, 1, 2, 3, 0\n\n2.5, 4, 5e-1, 6, 1\n").unwrap();
    assert_eq!(placed.positions, [Vector::new(1.0, 2.0, 3.0), Vector::new(4.0, 0.5, 6.0)]);
    assert_eq!((placed.radii, placed.species), (Some(vec![1.5, 2.5]), Some(vec![0, 1])));
    assert!(read("a.csv", "x,y\n1,2\n").unwrap_err().contains("no column z"));
    assert!(read("a.csv", "x,y,z\n1,2,3\n1,two,3\n").unwrap_err().contains("line 3 has two"));
    assert!(read("a.csv", "x,y,z\n1,2\n").unwrap_err().contains("line 2 has nothing"));
    assert!(read("a.csv", "x,y,z\n1,2,nan\n").unwrap_err().contains("position 0 is"));
}

#[test]
fn extended_xyz_is_read_by_its_properties() {
    let text =
        "2\nLattice=\"9 0 0 0 9 0 0 0 9\" Properties=species:S:1:radius:R:1:pos:R:3 Time=0\nA 1 2 3 4\nB 1 5 6 7\n";
    let placed = read("a.xyz", text).unwrap();
    assert_eq!(placed.positions[1], Vector::new(5.0, 6.0, 7.0));
    assert_eq!((placed.radii, placed.species), (Some(vec![1.0, 1.0]), None));
    let late = "1\nProperties=id:I:1:velo:R:3:pos:R:3:radius:R:1\n7 0 0 0 1 2 3 4\n";
    assert_eq!(read("a.xyz", late).unwrap().positions, [Vector::new(1.0, 2.0, 3.0)]);
    assert_eq!(read("b.extxyz", "1\nplain\nA 1 2 3\n").unwrap().positions, [Vector::new(1.0, 2.0, 3.0)]);
    assert!(read("a.xyz", "3\n\nA 1 2 3\n").unwrap_err().contains("has 1 particles, its first line says 3"));
    assert!(read("a.xyz", "many\n").unwrap_err().contains("not the number of particles"));
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
    assert_eq!(read("a.csv", "x,y,z,species\n1,2,3,1.0\n").unwrap().species, Some(vec![1]));
    assert!(message("a.csv", "x,y,z\n").contains("it has no positions"));
    let wide = "1\nProperties=a:S:18446744073709551615:pos:R:3\nA 1 2 3\n";
    assert!(message("a.xyz", wide).contains("are not name:type:columns"));
}

#[test]
fn hdf5_needs_a_radius_for_each_position() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    let file = hdf5::File::create(&path).unwrap();
    file.new_dataset_builder().with_data(&ndarray::Array2::<f64>::ones((3, 3))).create("positions").unwrap();
    file.new_dataset_builder().with_data(&[1.0, 1.0]).create("radii").unwrap();
    drop(file);
    let message = read_positions(&path).unwrap_err().to_string();
    assert!(message.contains("it has 3 positions, but 2 radii; it needs one for each"), "{message}");
}

#[test]
fn the_last_frame_of_a_run_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let mut particles = Particles::default();
    particles.push(0, Vector::ONE, 1.0, 0);
    particles.push(1, Vector::ZERO, 2.0, 1);
    let provenance =
        Provenance { scene: String::new(), program: "test 1".into(), plan: String::new(), ranks: 1, seed: 0 };
    let path = folder.path().join("trajectory.h5");
    let cell = PeriodicBox::new(Vector::splat(9.0)).unwrap();
    let mut frame = Frame { particles, cell, periodic: [true; 3] };
    let mut trajectory = Trajectory::create(&path, &provenance, &frame, 10).unwrap();
    for step in 0..3 {
        frame.particles.positions[0].x = 1.0 + step as f64;
        trajectory.append((step, 0.1), &frame).unwrap();
    }
    drop(trajectory);
    let placed = read_positions(folder.path()).unwrap();
    assert_eq!(placed.positions, frame.particles.positions);
    assert_eq!((placed.radii, placed.species), (Some(vec![1.0, 2.0]), Some(vec![0, 1])));
}

#[test]
fn other_files_are_refused_by_name() {
    assert!(read("a.txt", "").unwrap_err().contains("positions are read from .csv"));
    assert!(read("a.h5", "no").unwrap_err().contains("a.h5 is damaged"));
    let missing = read_positions(Path::new("/nowhere/a.h5")).unwrap_err().to_string();
    assert!(missing.contains("can't read /nowhere/a.h5: there is no such file"));
    assert!(read_positions(Path::new("/nowhere/a.csv")).unwrap_err().to_string().contains("can't read /nowhere/a.csv"));
}
