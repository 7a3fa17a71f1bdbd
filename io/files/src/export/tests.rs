use super::*;
use crate::{Provenance, Trajectory};
use domain::{Particles, PeriodicBox, Vector};
use simulation::Frame;

/// An exported trajectory of two frames of two particles in a sheared box between walls: the folder and the file.
fn exported(format: Format) -> (tempfile::TempDir, Vec<u8>) {
    let folder = tempfile::tempdir().unwrap();
    let recorded = recorded(folder.path());
    let out = folder.path().join("out").with_extension(format.extension());
    export(&recorded, &mut (0..2).map(|k| recorded.snapshot(k).unwrap()), format, &out, &Manifest::none(folder.path()))
        .unwrap();
    let content = std::fs::read(out).unwrap();
    (folder, content)
}

fn recorded(folder: &Path) -> TrajectoryReader {
    let path = folder.join("trajectory.h5");
    let provenance =
        Provenance { scene: String::new(), program: "test 1".into(), plan: String::new(), ranks: 1, seed: 2 };
    let frame = |k: u32| {
        let mut particles = Particles::default();
        particles.push(0, Vector::new(0.1, 2.0, 3.0), 0.5, 0);
        particles.push(1, Vector::new(5.0, 1.5, 4.0), 1e-5, 1);
        particles.steps[1] = [k as i32, 0, 0];
        particles.vectors("velocity")[1] = Vector::X * f64::from(k);
        let cell = PeriodicBox::sheared(Vector::new(8.0, 4.0, 5.0), 0.25 * f64::from(k)).unwrap();
        Frame { particles, cell, periodic: [true, true, false] }
    };
    let mut trajectory = Trajectory::create(&path, &provenance, &frame(0), 2).unwrap();
    (0..2).for_each(|k| trajectory.append((10 * u64::from(k), 0.1 * f64::from(k)), &frame(k)).unwrap());
    drop(trajectory);
    TrajectoryReader::open(&path).unwrap()
}

#[test]
fn extended_xyz_has_all_digits() {
    let (folder, content) = exported(Format::Xyz);
    let keys = "Properties=species:I:1:pos:R:3:radius:R:1:id:I:1:velo:R:3 pbc=\"T T F\"";
    let expected = format!(
        "2\nLattice=\"8.0 0.0 0.0 0.0 4.0 0.0 0.0 0.0 5.0\" {keys} Time=0.0 Step=0\n\
         0 0.1 2.0 3.0 0.5 0 0.0 0.0 0.0\n1 5.0 1.5 4.0 1e-5 1 0.0 0.0 0.0\n\
         2\nLattice=\"8.0 0.0 0.0 1.0 4.0 0.0 0.0 0.0 5.0\" {keys} Time=0.1 Step=10\n\
         0 0.1 2.0 3.0 0.5 0 0.0 0.0 0.0\n1 5.0 1.5 4.0 1e-5 1 1.0 0.0 0.0\n"
    );
    assert_eq!(String::from_utf8(content).unwrap(), expected);
    let placed = crate::read_start(&scene::StartSource::last(folder.path().join("out.xyz"))).unwrap();
    assert_eq!((placed.radii, placed.frame.count), (Some(vec![0.5, 1e-5]), 2), "a run can start from it");
}

#[test]
fn gsd_has_an_index_in_the_order_of_frames_and_names() {
    let (_folder, content) = exported(Format::Gsd);
    let number = |place: usize| u64::from_le_bytes(content[place..place + 8].try_into().unwrap()) as usize;
    let [index, entries, names, blocks] = [8, 16, 24, 32].map(number);
    assert_eq!((number(0), &content[40..48]), (0x65DF_65DF_65DF_65DF, &[4, 0, 1, 0, 0, 0, 2, 0][..]));
    assert_eq!((names, content.len()), (index + 32 * entries, names + 64 * blocks));
    let entry = |k: usize| (number(index + 32 * k), content[index + 32 * k + 28], number(index + 32 * k + 16));
    let order: Vec<_> = (0..entries).map(|k| (entry(k).0, entry(k).1)).collect();
    assert!(order.is_sorted() && order.iter().filter(|(frame, _)| *frame == 1).count() == 7, "{order:?}");
    let list: Vec<_> = content[names..].split(|b| *b == 0).take_while(|name| !name.is_empty()).collect();
    assert_eq!((list[0], list.len()), (&b"configuration/step"[..], 10));
    assert_eq!(content[entry(0).2..][..8], [0; 8], "step 0");
}

#[test]
fn vtp_files_are_listed_with_their_times() {
    let (folder, content) = exported(Format::Vtp);
    let list = String::from_utf8(content).unwrap();
    assert!(list.contains("<DataSet timestep=\"0.1\" part=\"0\" file=\"out/10.vtp\"/>"), "{list}");
    let piece = std::fs::read(folder.path().join("out/10.vtp")).unwrap();
    let start = piece.windows(2).position(|bytes| bytes == b"\n_").unwrap() + 2;
    assert_eq!(piece[start..start + 16], [48_u64.to_le_bytes(), 0.1_f64.to_le_bytes()].concat());
    let header = String::from_utf8_lossy(&piece[..start]);
    let offsets: Vec<usize> =
        header.split("offset=\"").skip(1).map(|rest| rest.split('"').next().unwrap().parse().unwrap()).collect();
    let length =
        |place: usize| u64::from_le_bytes(piece[start + place..start + place + 8].try_into().unwrap()) as usize;
    assert!(offsets.len() > 4 && offsets[0] == 0);
    assert!(offsets.windows(2).all(|pair| pair[1] == pair[0] + 8 + length(pair[0])), "{offsets:?}");
    for words in ["Name=\"velocity\" NumberOfComponents=\"3\"", ">8.0 0.0 0.0 1.0 4.0 0.0 0.0 0.0 5.0 <", ">0.1<"] {
        assert!(header.contains(words), "{header}");
    }
}

#[test]
fn names_that_will_not_do_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let recorded = recorded(folder.path());
    let refused = |format, name: &str| {
        let (path, none) = (folder.path().join(name), Manifest::none(folder.path()));
        export(&recorded, &mut std::iter::empty(), format, &path, &none).unwrap_err().to_string()
    };
    assert!(refused(Format::Vtp, "a.vtp").contains("needs to end in .pvd"));
    assert!(refused(Format::Xyz, ".").contains("it is no file"));
    assert!(refused(Format::Gsd, "none/a.gsd").contains("No such file"));
}

#[test]
fn species_have_names_unless_they_are_more_than_particles() {
    let named = ["small", "large", "absent"].map(str::to_owned).to_vec();
    assert_eq!(names(&[0, 1, 0], named.clone()).unwrap(), ["small", "large"]);
    assert_eq!(names(&[2], named).unwrap(), ["small", "large", "absent"]);
    assert_eq!(names(&[0, 1], Vec::new()).unwrap(), ["0", "1"]);
    assert!(names(&[0, u32::MAX], Vec::new()).unwrap_err().contains("species 4294967295"));
}
