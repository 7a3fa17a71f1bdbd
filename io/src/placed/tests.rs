use super::*;
use crate::{Frame, Provenance, Trajectory};
use domain::{Particles, PeriodicBox};

fn read(name: &str, text: &str) -> Result<Placed, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    Placed::read(&path).map_err(|e| e.to_string())
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
    assert_eq!(read("b.extxyz", "1\nplain\nA 1 2 3\n").unwrap().positions, [Vector::new(1.0, 2.0, 3.0)]);
    assert!(read("a.xyz", "3\n\nA 1 2 3\n").unwrap_err().contains("has 1 particles, its first line says 3"));
    assert!(read("a.xyz", "many\n").unwrap_err().contains("not the number of particles"));
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
    let placed = Placed::read(folder.path()).unwrap();
    assert_eq!(placed.positions, frame.particles.positions);
    assert_eq!((placed.radii, placed.species), (Some(vec![1.0, 2.0]), Some(vec![0, 1])));
}

#[test]
fn other_files_are_refused_by_name() {
    assert!(read("a.txt", "").unwrap_err().contains("positions are read from .csv"));
    assert!(read("a.h5", "no").unwrap_err().contains("a.h5 is damaged"));
    let missing = Placed::read(Path::new("/nowhere/a.h5")).unwrap_err().to_string();
    assert!(missing.contains("can't read /nowhere/a.h5: there is no such file"));
    assert!(Placed::read(Path::new("/nowhere/a.csv")).unwrap_err().to_string().contains("can't read /nowhere/a.csv"));
}
