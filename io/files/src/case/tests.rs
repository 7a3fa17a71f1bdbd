use super::*;
use domain::AxisRotation;
use hdf5::File;
use hdf5::types::{FixedAscii, VarLenUnicode};
use scene::{CaseBoundary, CaseBox, CaseTerms};

fn read(text: &str) -> Result<Case, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("case.json");
    std::fs::write(&path, text).unwrap();
    read_case(&path).map_err(|e| e.to_string().replace(&path.display().to_string(), "case.json"))
}

fn hdf5_case(write: impl FnOnce(&File)) -> Result<Case, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("case.h5");
    let file = File::create(&path).unwrap();
    file.new_dataset_builder().with_data(&[4.0, 5.0, 6.0]).create("box").unwrap();
    file.new_dataset_builder().with_data(&ndarray::array![[1.0, 2.0, 3.0]]).create("positions").unwrap();
    for (name, number) in [("viscosity", 2.0), ("radii", 0.5)] {
        file.new_dataset::<f64>().create(name).unwrap().write_scalar(&number).unwrap();
    }
    write(&file);
    drop(file);
    read_case(&path).map_err(|e| e.to_string().replace(&path.display().to_string(), "case.h5"))
}

#[test]
fn numbers_in_hdf5_that_are_none_are_refused_by_name() {
    for wrong in [f64::NAN, f64::INFINITY] {
        let error = hdf5_case(|file| {
            file.new_dataset::<f64>().create("lubrication_cutoff").unwrap().write_scalar(&wrong).unwrap();
        });
        let expected =
            format!("can't read case.h5: lubrication_cutoff contains {wrong}; every number needs to be finite");
        assert_eq!(error.unwrap_err(), expected);
    }
}

#[test]
fn links_that_lead_back_end() {
    for name in ["loop", "background"] {
        let error = hdf5_case(|file| file.link_hard("/", name).unwrap()).unwrap_err();
        assert!(error.contains("is not a key of a case"), "{error}");
    }
}

#[test]
fn what_is_absent_is_zero_and_rigid() {
    let case =
        read(r#"{"box": [4, 5, 6], "viscosity": 1, "positions": [[1, 2, 3], [3, 2, 1]], "radii": 0.5}"#).unwrap();
    assert_eq!((case.radii(), case.rigid, case.multipoles), (vec![0.5, 0.5], true, CaseTerms::Dipole));
    assert_eq!((case.strain, case.background.velocity_gradient), (0.0, [[0.0; 3]; 3]));
}

#[test]
fn mistakes_are_named() {
    let with = |more: &str| {
        read(&format!(r#"{{"box": [4, 5, 6], "viscosity": 1, "positions": [[1, 2, 3]], "radii": [0.5]{more}}}"#))
    };
    let message = |more: &str| with(more).unwrap_err();
    assert_eq!(
        message(r#", "forces": [[1, 2, 3], [1, 2, 3]]"#),
        "can't read case.json: forces has 2 entries, but there are 1 positions; it needs one for each"
    );
    assert!(message(r#", "force": []"#).contains("force is not a key of a case; did you mean \"forces\"?"));
    assert!(message(r#", "stresslets": [[1, 0, 0, 0, 0]]"#).contains("set rigid to false"));
    assert!(message(r#", "multipoles": "monopole", "torques": [[1, 0, 0]]"#).contains("use \"dipole\""));
    assert!(message(r#", "lubrication": true, "rigid": false"#).contains("set rigid to true"));
    assert!(message(r#", "lubrication": true, "lubrication_cutoff": 9.0"#).contains("<= 8"));
    assert!(message(r#", "noise": {"draws": 0, "seed": 1}"#).contains("noise.draws needs to be 1 to"));
    assert!(message(r#", "noise": {"draws": 2}"#).contains("noise.seed is missing"));
    let drift = r#", "rigid": false, "noise": {"draws": 2, "seed": 1, "drift": true}"#;
    assert!(message(drift).contains("noise.drift is true, but only rigid particles drift"));
    assert!(message(r#", "multipoles": "quadrupole""#).contains("multipoles is \"quadrupole\""));
    let method = message(r#", "method": "spectral""#);
    assert!(method.contains("method is \"spectral\"; known here: auto, direct, split"), "{method}");
    assert!(read(r#"{"viscosity": 1}"#).unwrap_err().contains("positions is missing"));
    assert!(read(r#"{"box": [1, 2]}"#).unwrap_err().contains("found a list of length 2, expected a list of 3 numbers"));
}

#[test]
fn values_of_other_shapes_and_types_are_refused_by_key() {
    let message = |more: &str| {
        read(&format!(r#"{{"box": [4, 5, 6], "viscosity": 1, "positions": [[1, 2, 3]]{more}}}"#)).unwrap_err()
    };
    let of = |more: &str| message(&format!(r#", "radii": 0.5{more}"#));
    for (found, expected) in [
        (message(""), "radii is missing"),
        (
            message(r#", "radii": {}"#),
            "radii has the wrong type: found a section of keys, expected a number for all or",
        ),
        (message(r#", "radii": [[0.5]]"#), "radii[0] has the wrong type: found a list of length 1, expected a number"),
        (message(r#", "radii": "0.5""#), "radii has the wrong type: found \"0.5\", expected a number for all or"),
        (message(r#", "radii": true"#), "radii has the wrong type: found true"),
        (message(r#", "radii": null"#), "radii has the wrong type: found null"),
        (
            of(r#", "forces": [[1, 2, 3, 4]]"#),
            "forces[0] has the wrong type: found a list of length 4, expected a list of 3",
        ),
        (of(r#", "stresslets": [[1, 2, 3]]"#), "stresslets[0] has the wrong type: found a list of length 3"),
        (of(r#", "background": [1]"#), "background has the wrong type: found a list of length 1, expected a section"),
        (
            of(r#", "background": {"velocity_gradient": [[0, 1, 0, 0], [0, 0, 0], [0, 0, 0]]}"#),
            "velocity_gradient[0] has",
        ),
        (of(r#", "background": {"velocity_gradient": [0, 1, 0, 0, 0, 0, 0, 0, 0]}"#), "found a list of length 9"),
        (
            of(r#", "background": {"pressure_gradient": [0, 1, 0, 5]}"#),
            "background.pressure_gradient has the wrong type",
        ),
        (of(r#", "noise": [3, 1]"#), "noise has the wrong type: found a list of length 2, expected a section of keys"),
        (of(r#", "noise": {"draws": 1.5, "seed": 1}"#), "noise.draws has the wrong type: found 1.5, expected a whole"),
        (of(r#", "rigid": "yes""#), "rigid has the wrong type: found \"yes\", expected true or false"),
        (of(r#", "rigid": 1"#), "rigid has the wrong type: found 1, expected true or false"),
        (of(r#", "strain": false"#), "strain has the wrong type: found false, expected a number"),
        (of(r#", "radii": 1"#), "radii is there twice; leave one of them out"),
        (
            of(r#", "boundaries": ["open", "open", "open", "open"]"#),
            "boundaries has the wrong type: found a list of length 4",
        ),
        (
            read("[[4, 5, 6], 1]").unwrap_err(),
            "a case has the wrong type: found a list of length 2, expected a section",
        ),
        (read(r#"{"viscosity": 1, "positions": [], "radii": 1}"#).unwrap_err(), "box is missing"),
        (read(r#"{"box": [1, [1, 0, 0], 1]}"#).unwrap_err(), "box has edges beside lattice vectors"),
        (read(r#"{"box": [4, 4, 4], "viscosity": 1, "positions": [], "radii": 1}"#).unwrap_err(), "positions is empty"),
    ] {
        assert!(found.contains(expected), "{found}\n{expected}");
    }
}

#[test]
fn hdf5_of_other_shapes_and_types_is_refused_by_key() {
    let table = |shape: (usize, usize)| ndarray::Array2::<f64>::zeros(shape);
    let with = |name: &str, values: ndarray::Array2<f64>| {
        hdf5_case(|file| drop(file.new_dataset_builder().with_data(&values).create(name).unwrap())).unwrap_err()
    };
    assert!(
        with("forces", table((3, 7))).contains("the shape (3, 7), which is likely that of Julia, MATLAB or Fortran")
    );
    assert!(with("forces", table((1, 4))).contains("expected a list of 3 numbers; the dataset has the shape (1, 4)"));
    assert!(with("strain", table((1, 1))).contains("strain has the wrong type: found a list of length 1"));
    let other = |create: fn(&File)| hdf5_case(create).unwrap_err();
    let flat = other(|file| drop(file.new_dataset_builder().with_data(&[0.0; 3]).create("forces").unwrap()));
    assert!(flat.contains("forces[0] has the wrong type: found 0.0, expected a list of 3"), "{flat}");
    let bools = other(|file| {
        drop(file.new_dataset_builder().with_data(&ndarray::array![[true, true, false]]).create("forces").unwrap());
    });
    assert!(bools.contains("forces[0][0] has the wrong type: found true, expected a number"), "{bools}");
    let complex = other(|file| {
        drop(file.new_dataset_builder().with_data(&[Complex { r: 1.0, i: 2.0 }]).create("strain").unwrap());
    });
    assert!(complex.contains("strain has complex or compound values; it needs to have real numbers"), "{complex}");
    let word = other(|file| {
        file.new_dataset::<VarLenUnicode>()
            .create("rigid")
            .unwrap()
            .write_scalar(&"yes".parse::<VarLenUnicode>().unwrap())
            .unwrap();
    });
    assert!(word.contains("rigid has the wrong type: found \"yes\", expected true or false"), "{word}");
    let twice = other(|file| file.new_attr::<f64>().create("radii").unwrap().write_scalar(&1.0).unwrap());
    assert!(twice.contains("radii is both an attribute and a dataset"), "{twice}");
    let whole = hdf5_case(|file| {
        let noise = file.create_group("noise").unwrap();
        for name in ["draws", "seed"] {
            noise.new_dataset::<i32>().create(name).unwrap().write_scalar(&7).unwrap();
        }
        let word = FixedAscii::<8>::from_ascii("monopole").unwrap();
        file.new_dataset::<FixedAscii<8>>().create("multipoles").unwrap().write_scalar(&word).unwrap();
    });
    let case = whole.unwrap();
    assert_eq!((case.noise.unwrap().draws, case.multipoles), (7, CaseTerms::Monopole));
}

#[derive(hdf5::H5Type, Clone, Copy)]
#[repr(C)]
struct Complex {
    r: f64,
    i: f64,
}

#[test]
fn boxes_may_have_walls_or_be_open() {
    let with =
        |more: &str| read(&format!(r#"{{"viscosity": 1, "positions": [[1, 2, 3], [3, 2, 8]], "radii": 0.5{more}}}"#));
    let case = with(r#", "box": [4, 5, 9], "boundaries": ["periodic", "walls", "periodic"]"#).unwrap();
    let (cell, turn) = case.bounded_box().unwrap();
    assert_eq!((cell.edges().to_array(), turn), ([4.0, 9.0, 5.0], AxisRotation::to_last(1)));
    let open = with(r#", "boundaries": ["open", "open", "open"]"#).unwrap();
    assert_eq!(open.bounded_box().unwrap().0.edges(), domain::Vector::new(3.25, 1.25, 6.25));
    let error = |more: &str| with(more).unwrap_err();
    assert!(error(r#", "boundaries": ["walls", "periodic", "periodic"]"#).contains("box is missing"));
    assert!(error(r#", "box": [4, 5, 9], "boundaries": ["walls", "open", "periodic"]"#).contains("possible are"));
    assert!(
        error(r#", "box": [4, 5, 9], "boundaries": ["wand", "open", "periodic"]"#)
            .contains("boundaries[0] is \"wand\"")
    );
    assert!(
        error(r#", "box": [4, 5, 9], "strain": 0.1, "boundaries": ["periodic", "periodic", "wall"]"#)
            .contains("not sheared")
    );
}

#[test]
fn boundaries_in_hdf5_are_words() {
    let case = hdf5_case(|file| {
        let words: Vec<VarLenUnicode> =
            ["periodic", "periodic", "walls"].iter().map(|word| word.parse().unwrap()).collect();
        file.new_dataset_builder().with_data(&words).create("boundaries").unwrap();
    });
    assert_eq!(case.unwrap().boundaries[2], CaseBoundary::Walls);
}

#[test]
fn hdf5_has_the_same_names() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("case.h5");
    let file = File::create(&path).unwrap();
    let table =
        |name: &str, rows: ndarray::Array2<f64>| file.new_dataset_builder().with_data(&rows).create(name).unwrap();
    file.new_dataset_builder().with_data(&[4.0, 5.0, 6.0]).create("box").unwrap();
    table("positions", ndarray::array![[1.0, 2.0, 3.0], [3.0, 2.0, 1.0]]);
    table("forces", ndarray::array![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]);
    file.new_dataset::<f64>().create("viscosity").unwrap().write_scalar(&2.0).unwrap();
    file.new_dataset::<f64>().create("radii").unwrap().write_scalar(&0.5).unwrap();
    file.new_dataset::<bool>().create("rigid").unwrap().write_scalar(&false).unwrap();
    let group = file.create_group("background").unwrap();
    let gradient = ndarray::array![[0.0, 1.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]];
    group.new_dataset_builder().with_data(&gradient).create("velocity_gradient").unwrap();
    drop(file);
    let case = read_case(&path).unwrap();
    assert_eq!((case.cell, case.viscosity, case.rigid), (Some(CaseBox::Edges([4.0, 5.0, 6.0])), 2.0, false));
    assert_eq!(case.forces, vec![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]);
    assert!((case.background.velocity_gradient[0][1] - 1.0).abs() < 1e-15);
    let noise_velocities = Some(vec![vec![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]; 4]);
    let plan = "a plan".to_owned();
    let answer = CaseAnswer { velocities: vec![[1.0, 2.0, 3.0]; 2], noise_velocities, plan, ..CaseAnswer::default() };
    let path = folder.path().join("answer.h5");
    answer.write(&path).unwrap();
    let found = File::open(&path).unwrap().dataset("velocities").unwrap().read_raw::<f64>().unwrap();
    assert_eq!(found, [1.0, 2.0, 3.0, 1.0, 2.0, 3.0]);
    let drawn = File::open(&path).unwrap().dataset("noise_velocities").unwrap();
    assert_eq!((drawn.shape(), drawn.read_raw::<f64>().unwrap()[4]), (vec![4, 2, 3], 5.0));
}
