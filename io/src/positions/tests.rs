use super::species::Names;
use super::*;
use crate::{Provenance, Scene, Trajectory, run};
use domain::{Comm, Particles, PeriodicBox, Vector};
use ndarray::{Array1, Array2, Array3};
use simulation::Frame;

fn read(name: &str, text: &str) -> Result<StartFile, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    StartSource::last(path).read().map_err(|e| e.to_string())
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
    StartSource { path, frame, group: group.map(str::to_owned) }.read().map_err(|e| e.to_string())
}

fn put<T: hdf5::H5Type, D: ndarray::Dimension>(group: &hdf5::Group, name: &str, data: &ndarray::Array<T, D>) {
    group.new_dataset_builder().with_data(data).create(name).unwrap();
}

/// A scene that starts from a file in a folder.
fn scene(
    folder: &Path,
    name: &str,
    (edges, flow): (&str, &str),
    species: &[(&str, f64, u64)],
) -> Result<Scene, String> {
    let section = |(name, radius, count): &(&str, f64, u64)| {
        format!("[[species]]\nname = '{name}'\nradius = {radius:?}\ncount = {count}\n")
    };
    let species = species.iter().map(section).collect::<Vec<_>>().concat();
    let text = format!(
        "[box]\n{edges}\n[fluid]\nviscosity = 1.0\n{species}[hydrodynamics]\ntolerance = 1e-2\nlubrication = false\n{flow}\n[time]\nstep = 0.01\n\
         steps = 1\n[particles]\ninitial = 'file'\npath = '{name}'\n"
    );
    Scene::parse(&text, &folder.join("scene.toml").display().to_string(), &[]).map_err(|e| e.to_string())
}

/// A start in a box of 20 with species of the given names, radii and counts, and spheres from a file: positions and
/// radii in the order of species, and the notes.
fn started(name: &str, text: &str, species: &[(&str, f64, u64)]) -> Result<(Vec<[f64; 4]>, String), String> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(name), text).unwrap();
    let scene = scene(folder.path(), name, ("edges = [20.0, 20.0, 20.0]", ""), species)?;
    let (scene, notes) = run::with_start_file(scene, &Comm::alone()).map_err(|e| e.to_string())?;
    let simulation = run::start(&scene, &Comm::alone(), &mut |_| ()).map_err(|e| crate::in_full(&e))?;
    let Particles { positions, species, .. } = simulation.frame().particles;
    let row = |(x, &kind): (&Vector, &u32)| [x.x, x.y, x.z, f64::from(kind)];
    Ok((positions.iter().zip(&species).map(row).collect(), notes.join("\n")))
}

const TWO: [(&str, f64, u64); 2] = [("A", 1.0, 1), ("B", 2.0, 1)];

#[test]
fn csv_is_read_by_its_names() {
    let placed = read("a.csv", "# by hand\nradius, x, y, z, species\n1.5, 1, 2, 3, 0\n\n2.5, 4, 5e-1, 6, 1\n").unwrap();
    assert_eq!(placed.positions, [Vector::new(1.0, 2.0, 3.0), Vector::new(4.0, 0.5, 6.0)]);
    assert_eq!((placed.radii, placed.species), (Some(vec![1.5, 2.5]), Some(Kinds::Indices(vec![0, 1]))));
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
    assert_eq!(placed.species, Some(Kinds::Indices(vec![1])));
    assert!(message("a.csv", "x,y,z,species\n1,2,3,\n").contains("line 2 has no species"));
    assert!(message("a.csv", "x,y,z\n").contains("it has no positions"));
}

#[test]
fn species_are_those_of_the_names_whatever_the_order_of_rows() {
    let expected = [[2.0, 2.0, 2.0, 1.0], [12.0, 2.0, 2.0, 0.0]];
    let lattice = "Lattice=\"20 0 0 0 20 0 0 0 20\" Properties=";
    for (name, text) in [
        ("a.csv", "x,y,z,species\n2,2,2,B\n12,2,2,A\n".to_owned()),
        ("a.csv", "x,y,z,type\n2,2,2,2\n12,2,2,1\n".to_owned()),
        ("a.csv", "x,y,z,species\n2,2,2,1\n12,2,2,0\n".to_owned()),
        ("a.csv", "x,y,z,radius\n2,2,2,2.00001\n12,2,2,1\n".to_owned()),
        ("a.csv", "x,y,z,diameter\n2,2,2,4\n12,2,2,2\n".to_owned()),
        ("a.csv", "x,y,z,id,species\n12,2,2,2,A\n2,2,2,1,B\n".to_owned()),
        ("a.xyz", format!("2\n{lattice}species:S:1:pos:R:3\nB 2 2 2\nA 12 2 2\n")),
        ("a.xyz", format!("2\n{lattice}pos:R:3:type:I:1\n2 2 2 2\n12 2 2 1\n")),
        ("a.xyz", format!("2\n{lattice}id:I:1:species:S:1:pos:R:3\n9 A 12 2 2\n3 B 2 2 2\n")),
        ("a.xyz", "2\nplain\nB 2 2 2\nA 12 2 2\n".to_owned()),
        ("a.xyz", "2\nplain\n2 2 2 2\n1 12 2 2\n".to_owned()),
        ("dump.lammps", dump("pp pp pp\n0 20\n0 20\n0 20", "id type x y z\n2 1 12 2 2\n1 2 2 2 2")),
        ("dump.lammps", dump("pp pp pp\n-10 10\n-10 10\n-10 10", "id type xs ys zs\n2 1 0.6 0.1 0.1\n1 2 0.1 0.1 0.1")),
        ("dump.lammps", dump("pp pp pp\n0 20\n0 20\n0 20", "id element x y z\n1 B 2 2 2\n2 A 12 2 2")),
    ] {
        let (rows, said) = started(name, &text, &TWO).unwrap_or_else(|e| panic!("{e}: {text}"));
        assert!(
            rows.iter().flatten().zip(expected.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-12),
            "{rows:?} {text}"
        );
        assert!(said.starts_with("2 particles of "), "{said}");
    }
}

fn dump(bounds: &str, atoms: &str) -> String {
    let count = atoms.lines().count() - 1;
    format!("ITEM: TIMESTEP\n50\nITEM: NUMBER OF ATOMS\n{count}\nITEM: BOX BOUNDS {bounds}\nITEM: ATOMS {atoms}\n")
}

#[test]
fn what_contradicts_the_species_of_a_scene_is_refused() {
    let message = |name: &str, text: &str| started(name, text, &TWO).unwrap_err();
    let both = "species A, C, but those of the scene are A, B";
    assert!(message("a.csv", "x,y,z,species\n2,2,2,A\n12,2,2,C\n").contains(both));
    assert!(message("a.xyz", "2\nProperties=species:S:1:pos:R:3\nA 2 2 2\nC 12 2 2\n").contains(both));
    assert!(message("a.xyz", "2\nplain\nA 2 2 2\nC 12 2 2\n").contains(both));
    let radius = "particle 1 has the radius 1, but the radius of species \"B\" is 2 in the scene";
    assert!(message("a.csv", "x,y,z,species,radius\n2,2,2,A,1\n12,2,2,B,1\n").contains(radius));
    assert!(
        message("a.csv", "x,y,z,radius\n2,2,2,1\n12,2,2,3\n")
            .contains("radius 3, but the radii of the scene's species")
    );
    assert!(message("a.csv", "x,y,z,species\n2,2,2,A\n12,2,2,A\n").contains("has 2 spheres of species \"A\""));
    assert!(message("a.csv", "x,y,z,id\n2,2,2,7\n12,2,2,7\n").contains("have the id 7"));
    assert!(message("a.csv", "x,y,z\n2,2,2\n").contains("has 1 positions, but the scene counts 2"));
    assert!(
        started("a.csv", "x,y,z,radius\n2,2,2,1.5\n", &[("A", 1.0, 1)]).unwrap_err().contains("has the radius 1.5")
    );
}

#[test]
fn rows_without_species_go_by_order_and_that_is_said() {
    let (rows, said) = started("a.csv", "x,y,z\n2,2,2\n12,2,2\n", &TWO).unwrap();
    assert_eq!(rows, [[2.0, 2.0, 2.0, 0.0], [12.0, 2.0, 2.0, 1.0]]);
    assert!(said.contains("it has no species; rows are of those of the scene by their order"), "{said}");
    let (_, said) = started("a.xyz", "2\n\nX 2 2 2\nX 12 2 2\n", &TWO).unwrap();
    assert!(said.contains("its names X are not those of the scene"), "{said}");
}

#[test]
fn the_box_of_a_file_is_that_of_the_scene_or_refused_with_both() {
    let of = |vectors: &str, edges: &str, flow: &str| {
        let folder = tempfile::tempdir().unwrap();
        let text = format!("1\nLattice=\"{vectors}\" Properties=pos:R:3\n1 2 3\n");
        std::fs::write(folder.path().join("a.xyz"), text).unwrap();
        let scene = scene(folder.path(), "a.xyz", (edges, flow), &[("A", 1.0, 1)])?;
        let (scene, _) = run::with_start_file(scene, &Comm::alone()).map_err(|e| e.to_string())?;
        let simulation = run::start(&scene, &Comm::alone(), &mut |_| ()).map_err(|e| crate::in_full(&e))?;
        let cell = simulation.frame().cell;
        Ok::<_, String>((cell.edges(), cell.strain()))
    };
    let (shear, ten) = ("[flow]\nkind = 'shear'\nrate = 1.0", Vector::splat(10.0));
    let tilted = "10 0 0 2.5 10 0 0 0 10";
    assert_eq!(of("10 0 0 0 10 0 0 0 10", "edges = [10, 10, 10]", "").unwrap(), (ten, 0.0));
    assert_eq!(of(tilted, "edges = [10, 10, 10]", shear).unwrap(), (ten, 0.25));
    assert_eq!(of(tilted, "edges = [10, 10, 10]", "").unwrap(), (ten, 0.25));
    assert_eq!(of(tilted, "", shear).unwrap(), (ten, 0.25), "the scene leaves the box out");
    assert_eq!(of(tilted, "edges = [10, 10, 10]\nstrain = 1.25", "").unwrap(), (ten, 0.25));
    let message = of("20 0 0 0 20 0 0 0 20", "edges = [10, 10, 10]", "").unwrap_err();
    assert!(message.contains("its box is 20 x 20 x 20, but that of the scene is 10 x 10 x 10"), "{message}");
    let message = of(tilted, "edges = [10, 10, 10]\nstrain = 0.3", "").unwrap_err();
    assert!(message.contains("its box has a strain of 0.25, but box.strain of the scene is 0.3"), "{message}");
    let straight = format!("{shear}\nlees_edwards = false");
    let message = of(tilted, "edges = [10, 10, 10]", &straight).unwrap_err();
    assert!(message.contains("box.strain is 0.25, but a box with a strain stays as it is"), "{message}");
    let walls = "edges = [10, 10, 10]\nboundaries = ['periodic', 'periodic', 'walls']";
    assert!(of(tilted, walls, "").unwrap_err().contains("10 x 10 x 10 with a strain of 0.25, but that of the scene"));
    assert!(of("10 0 0 0 10 0 1 0 10", "edges = [10, 10, 10]", "").unwrap_err().contains("(1, 0, 10)"));
}

#[test]
fn arrays_of_another_shape_are_refused_by_it() {
    let shaped = |shape: &[usize]| {
        let array = ndarray::ArrayD::<f64>::ones(shape);
        hdf5(|file| put(file, "positions", &array)).map(|read| read.positions.len())
    };
    assert_eq!(shaped(&[5, 3]), Ok(5));
    assert_eq!(shaped(&[3, 3]), Ok(3));
    for (shape, words) in [
        (&[3, 5][..], "has the shape (3, 5), but positions need (N, 3): it is likely (3, N), as Julia, MATLAB"),
        (&[5, 4], "has the shape (5, 4), but positions need (N, 3)"),
        (&[5, 2], "it has two coordinates"),
        (&[15], "has the shape (15,), but positions need (N, 3): it is a flat list"),
        (&[2, 5, 3], "frames belong into the H5MD format"),
        (&[], "has the shape (), but"),
    ] {
        let message = shaped(shape).unwrap_err();
        assert!(message.contains(words), "{shape:?}: {message}");
    }
}

#[derive(hdf5::H5Type, Clone, Copy)]
#[repr(C)]
struct Complex {
    r: f64,
    i: f64,
}

#[test]
fn arrays_of_other_values_than_numbers_are_refused() {
    let values = |fill: &dyn Fn(&hdf5::File)| hdf5(fill).map(|read| read.positions[0]);
    assert_eq!(values(&|file| put(file, "positions", &Array2::<i32>::ones((2, 3)))), Ok(Vector::ONE), "exact");
    assert_eq!(values(&|file| put(file, "positions", &Array2::<f32>::ones((2, 3)))), Ok(Vector::ONE));
    let large = Array2::<i64>::from_elem((2, 3), i64::MAX);
    assert!(values(&|file| put(file, "positions", &large)).unwrap_err().contains("beyond 2^53"));
    let complex = Array2::from_elem((2, 3), Complex { r: 1.0, i: 0.0 });
    assert!(values(&|file| put(file, "positions", &complex)).unwrap_err().contains("has complex numbers"));
    let flags = Array2::from_elem((2, 3), true);
    assert!(values(&|file| put(file, "positions", &flags)).unwrap_err().contains("has values true or false"));
    let nan = Array2::from_elem((2, 3), f64::NAN);
    assert!(values(&|file| put(file, "positions", &nan)).unwrap_err().contains("position 0 is"));
    let nothing = values(&|file| put(file, "coordinates", &nan)).unwrap_err();
    assert!(nothing.contains("neither a dataset positions nor a group particles, as H5MD has; it has coordinates"));
}

#[test]
fn lists_in_hdf5_have_an_entry_for_each_position() {
    let with = |name: &'static str, list: Vec<f64>| {
        hdf5(move |file| {
            put(file, "positions", &Array2::<f64>::ones((3, 3)));
            put(file, name, &Array1::from(list));
        })
    };
    assert_eq!(with("radii", vec![2.0]).unwrap().radii, Some(vec![2.0; 3]));
    assert_eq!(with("species", vec![1.0, 0.0, 1.0]).unwrap().species, Some(Kinds::Indices(vec![1, 0, 1])));
    let message = with("radii", vec![1.0, 1.0]).unwrap_err();
    assert!(message.contains("radii has the shape (2,); it needs (3,), one for each of 3 positions"), "{message}");
    assert!(with("species", vec![0.5, 0.0, 1.0]).unwrap_err().contains("numbers that are no species"));
    assert!(with("id", vec![1.0, -2.0, 3.0]).unwrap_err().contains("not whole, or below 0"));
    assert_eq!(
        with("box", vec![4.0, 5.0, 6.0]).unwrap().cell,
        Some(FileBox { strain: Some(0.0), ..FileBox::straight(Vector::new(4.0, 5.0, 6.0)) })
    );
    assert!(with("box", vec![4.0]).unwrap_err().contains("its box has 1 numbers"));
}

/// Writes an element with a value for each frame.
fn element(group: &hdf5::Group, name: &str, frames: usize, value: impl Fn(usize) -> f64) -> hdf5::Group {
    let element = group.create_group(name).unwrap();
    let values = Array3::from_shape_fn((frames, 2, 3), |(frame, row, axis)| value(frame) + (3 * row + axis) as f64);
    put(&element, "value", &values);
    element
}

fn listed(element: &hdf5::Group, steps: &[i64]) {
    put(element, "step", &Array1::from(steps.to_vec()));
    put(element, "time", &Array1::from(steps.iter().map(|&step| 0.5 * step as f64).collect::<Vec<_>>()));
}

fn scalar(group: &hdf5::Group, name: &str, value: i64) -> hdf5::Dataset {
    let dataset = group.new_dataset::<i64>().create(name).unwrap();
    dataset.write_scalar(&value).unwrap();
    dataset
}

#[test]
fn frames_of_h5md_may_have_listed_or_fixed_steps() {
    let fixed = |file: &hdf5::File| {
        let group = file.create_group("particles/any").unwrap();
        let position = element(&group, "position", 3, |frame| frame as f64);
        let step = scalar(&position, "step", 10);
        step.new_attr::<i64>().create("offset").unwrap().write_scalar(&100).unwrap();
        scalar(&position, "time", 2);
    };
    let last = hdf5(fixed).unwrap();
    assert_eq!(last.positions[0], Vector::new(2.0, 3.0, 4.0));
    assert_eq!(last.frame, TakenFrame { number: 2, count: 3, step: Some(120), time: Some(4.0) });
    assert_eq!(hdf5_at(Some(0), None, fixed).unwrap().frame.step, Some(100));
    assert!(hdf5_at(Some(3), None, fixed).unwrap_err().contains("particles.frame is 3, but it has 3 frames"));
    let explicit = hdf5_at(Some(-2), None, |file| {
        let group = file.create_group("particles/any").unwrap();
        listed(&element(&group, "position", 3, |frame| frame as f64), &[0, 7, 9]);
    });
    assert_eq!(explicit.unwrap().frame, TakenFrame { number: 1, count: 3, step: Some(7), time: Some(3.5) });
    let short = hdf5(|file| {
        let group = file.create_group("particles/any").unwrap();
        listed(&element(&group, "position", 2, |frame| frame as f64), &[0, 7, 9]);
    });
    assert!(short.unwrap_err().contains("particles/any/position/value has 2 frames for 3 steps"));
}

#[test]
fn a_group_of_particles_is_the_only_one_or_named() {
    let two = |file: &hdf5::File| {
        for (name, value) in [("all", 0.0), ("solvent", 5.0)] {
            let group = file.create_group(&format!("particles/{name}")).unwrap();
            put(&group, "position", &Array2::from_elem((2, 3), value));
        }
    };
    assert!(hdf5(two).unwrap_err().contains("several groups of particles, all, solvent; name one by particles.group"));
    assert_eq!(hdf5_at(None, Some("solvent"), two).unwrap().positions[1], Vector::splat(5.0));
    let message = hdf5_at(None, Some("other"), two).unwrap_err();
    assert!(
        message.contains("particles.group is \"other\", but its groups of particles are all, solvent"),
        "{message}"
    );
    assert!(hdf5_at(None, Some("a"), |file| put(file, "positions", &Array2::<f64>::ones((2, 3)))).is_err());
}

#[derive(hdf5::H5Type, Clone, Copy)]
#[repr(u8)]
#[expect(dead_code, reason = "a species without particles")]
enum Sort {
    Colloid = 4,
    Nobody = 5,
    Tracer = 9,
}

#[test]
fn species_of_h5md_are_fixed_or_of_frames_numbers_or_names() {
    let with = |fill: &dyn Fn(&hdf5::Group)| {
        hdf5(|file| {
            let group = file.create_group("particles/any").unwrap();
            listed(&element(&group, "position", 2, |frame| frame as f64), &[0, 10]);
            fill(&group);
        })
        .map(|read| read.species.unwrap())
    };
    let names = |list: &[&str], of: &[u32]| {
        Kinds::Names(Names { list: list.iter().map(|&s| s.to_owned()).collect(), of: of.to_vec(), are_symbols: false })
    };
    assert_eq!(with(&|group| put(group, "species", &Array1::from(vec![1_u8, 0]))), Ok(Kinds::Indices(vec![1, 0])));
    assert_eq!(with(&|group| drop(scalar(group, "species", 0))), Ok(Kinds::Indices(vec![0, 0])));
    assert_eq!(with(&|group| put(group, "species", &Array1::from(vec![2_i64, 1]))), Ok(Kinds::Types(vec![2, 1])));
    let sorts = Array1::from(vec![Sort::Tracer, Sort::Colloid]);
    assert_eq!(with(&|group| put(group, "species", &sorts)), Ok(names(&["Colloid", "Tracer"], &[1, 0])));
    let of_frames = |group: &hdf5::Group| {
        let species = group.create_group("species").unwrap();
        put(&species, "value", &Array2::from_shape_vec((2, 2), vec![0_i32, 0, 1, 0]).unwrap());
        listed(&species, &[0, 5]);
    };
    assert_eq!(with(&of_frames), Ok(Kinds::Indices(vec![1, 0])));
    let words: Vec<hdf5::types::VarLenUnicode> = ["b", "a"].map(|s| s.parse().unwrap()).to_vec();
    assert_eq!(with(&|group| put(group, "species", &Array1::from(words.clone()))), Ok(names(&["b", "a"], &[0, 1])));
}

#[test]
fn boxes_of_h5md_are_edges_or_vectors_fixed_or_of_frames() {
    let with = |fill: &dyn Fn(&hdf5::Group)| {
        hdf5(|file| {
            let group = file.create_group("particles/any").unwrap();
            listed(&element(&group, "position", 2, |frame| frame as f64), &[0, 10]);
            fill(&group.create_group("box").unwrap());
        })
        .map(|read| read.cell)
    };
    let tilted = [[8.0, 0.0, 0.0], [1.0, 4.0, 0.0], [0.0, 0.0, 5.0]];
    let vectors = FileBox::lattice(tilted.map(Vector::from_array));
    assert_eq!(with(&|_| ()), Ok(None));
    let edges = Array1::from(vec![8.0, 4.0, 5.0]);
    assert_eq!(with(&|cell| put(cell, "edges", &edges)), Ok(Some(FileBox::straight(Vector::new(8.0, 4.0, 5.0)))));
    assert_eq!(with(&|cell| put(cell, "edges", &ndarray::arr2(&tilted))), Ok(Some(vectors)));
    let of_frames = |cell: &hdf5::Group| {
        let edges = cell.create_group("edges").unwrap();
        let turned = Array3::from_shape_fn((2, 3, 3), |(frame, i, j)| if frame == 1 { tilted[i][j] } else { 0.0 });
        put(&edges, "value", &turned);
        listed(&edges, &[0, 10]);
    };
    assert_eq!(with(&of_frames), Ok(Some(vectors)));
    assert!(with(&|cell| put(cell, "edges", &Array1::from(vec![8.0, 4.0]))).unwrap_err().contains("has the shape [2]"));
}

/// Frames of a sheared run: positions, box and strain are those of the last frame, to the last bit.
#[test]
fn a_former_run_is_read_with_the_strain_of_its_box() {
    let folder = tempfile::tempdir().unwrap();
    let mut particles = Particles::default();
    particles.push(0, Vector::ONE, 1.0, 0);
    particles.push(1, Vector::ZERO, 2.0, 1);
    let provenance =
        Provenance { scene: String::new(), program: "test 1".into(), plan: String::new(), ranks: 1, seed: 0 };
    let path = folder.path().join("trajectory.h5");
    let cell = |step: u64| PeriodicBox::sheared(Vector::splat(9.0), 0.1 * step as f64).unwrap();
    let mut frame = Frame { particles, cell: cell(0), periodic: [true; 3] };
    let mut trajectory = Trajectory::create(&path, &provenance, &frame, 10).unwrap();
    for step in 0..3 {
        frame.particles.positions[0].x = 1.0 + step as f64;
        frame.cell = cell(step);
        trajectory.append((step, 0.1), &frame).unwrap();
    }
    drop(trajectory);
    let placed = StartSource::last(folder.path()).read().unwrap();
    assert_eq!(placed.positions, frame.particles.positions);
    assert_eq!((placed.radii, placed.species), (Some(vec![1.0, 2.0]), Some(Kinds::Indices(vec![0, 1]))));
    assert_eq!(placed.cell, Some(FileBox::of_cell(&cell(2))));
    assert_eq!(placed.frame, TakenFrame { number: 2, count: 3, step: Some(2), time: Some(0.1) });
    let first = StartSource { frame: Some(0), ..StartSource::last(folder.path()) }.read().unwrap();
    assert_eq!((first.positions[0].x, first.frame.step), (1.0, Some(0)));
}

#[test]
fn other_files_are_refused_by_name() {
    assert!(read("a.txt", "").unwrap_err().contains("another ending than .csv"));
    assert!(read("a.txt", "ITEM: TIMESTEP\n").is_err());
    let message = read("a.h5", "no").unwrap_err();
    assert!(message.contains("can't start from") && message.contains("no whole HDF5 file"), "{message}");
    let missing = |name: &str| StartSource::last(name).read().unwrap_err().to_string();
    assert!(missing("/nowhere/a.h5").contains("can't read /nowhere/a.h5: there is no such file"));
    assert!(missing("/nowhere/a.csv").contains("can't read /nowhere/a.csv"));
    assert!(missing("/nowhere/dump").contains("can't read /nowhere/dump"));
    let empty = tempfile::tempdir().unwrap();
    assert!(missing(&empty.path().display().to_string()).contains("neither trajectory.h5 nor checkpoints"));
    assert!(read("a.csv", "x,y,z\n1,2,3\n").is_ok());
    let grouped = StartSource { group: Some("all".to_owned()), ..StartSource::last("a.csv") };
    assert!(grouped.read().unwrap_err().to_string().contains("particles.group goes with H5MD files only"));
}
