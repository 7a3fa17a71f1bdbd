//! Starts from HDF5 files.

use super::*;

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
    assert_eq!(with("species", vec![1.0, 0.0, 1.0]).unwrap().species, Some(SpeciesColumn::Indices(vec![1, 0, 1])));
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
        SpeciesColumn::Names(SpeciesNames {
            list: list.iter().map(|&s| s.to_owned()).collect(),
            of: of.to_vec(),
            are_symbols: false,
        })
    };
    assert_eq!(
        with(&|group| put(group, "species", &Array1::from(vec![1_u8, 0]))),
        Ok(SpeciesColumn::Indices(vec![1, 0]))
    );
    assert_eq!(with(&|group| drop(scalar(group, "species", 0))), Ok(SpeciesColumn::Indices(vec![0, 0])));
    assert_eq!(
        with(&|group| put(group, "species", &Array1::from(vec![2_i64, 1]))),
        Ok(SpeciesColumn::Types(vec![2, 1]))
    );
    let sorts = Array1::from(vec![Sort::Tracer, Sort::Colloid]);
    assert_eq!(with(&|group| put(group, "species", &sorts)), Ok(names(&["Colloid", "Tracer"], &[1, 0])));
    let of_frames = |group: &hdf5::Group| {
        let species = group.create_group("species").unwrap();
        put(&species, "value", &Array2::from_shape_vec((2, 2), vec![0_i32, 0, 1, 0]).unwrap());
        listed(&species, &[0, 5]);
    };
    assert_eq!(with(&of_frames), Ok(SpeciesColumn::Indices(vec![1, 0])));
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
    let placed = read_start(&StartSource::last(folder.path())).unwrap();
    assert_eq!(placed.positions, *frame.particles.positions);
    assert_eq!((placed.radii, placed.species), (Some(vec![1.0, 2.0]), Some(SpeciesColumn::Indices(vec![0, 1]))));
    assert_eq!(placed.cell, Some(FileBox::of_cell(&cell(2))));
    assert_eq!(placed.frame, TakenFrame { number: 2, count: 3, step: Some(2), time: Some(0.1) });
    let first = read_start(&StartSource { frame: Some(0), ..StartSource::last(folder.path()) }).unwrap();
    assert_eq!((first.positions[0].x, first.frame.step), (1.0, Some(0)));
}
