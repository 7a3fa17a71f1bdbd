//! Scene files that must be read, and others that must be refused with exactly the message in their first line.

#![allow(clippy::float_cmp, reason = "numbers of a file are those of the scene")]

use scene::{Kind, Scene, SceneFile, StartSource, SuspensionScene};
use simulation::Schedule;
use std::path::{Path, PathBuf};
use suspension::Start;

fn files(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|e| e == "toml"));
    files.sort();
    assert!(!files.is_empty());
    files
}

fn suspension(scene: &Scene) -> &SuspensionScene {
    let Kind::Suspension(scene) = scene.kind() else { panic!("a suspension") };
    scene
}

fn good(name: &str, overrides: &[&str]) -> Scene {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/good").join(name);
    Scene::read(&path, &overrides).unwrap()
}

#[test]
fn bad_scenes_are_refused_in_the_words_of_their_first_line() {
    let mut wrong = String::new();
    for path in files("tests/bad") {
        let text = std::fs::read_to_string(&path).unwrap();
        let expected = text.lines().next().unwrap().strip_prefix("# error: ").unwrap();
        let name = path.file_name().unwrap().to_str().unwrap();
        let found = SceneFile::parse(&text, name, &[]).expect_err(name).to_string();
        if found != expected {
            wrong = format!("{wrong}{name}\n  expected: {expected}\n  found:    {found}\n");
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
}

#[test]
fn good_scenes_are_read() {
    for path in files("tests/good").into_iter().chain(files("scenes")) {
        SceneFile::read(&path, &[]).unwrap();
    }
}

#[test]
fn what_a_scene_leaves_out_has_its_default() {
    let scene = good("least.toml", &[]);
    let scene = suspension(&scene);
    assert_eq!(scene.model.start, Start::Random { minimum_gap: 0.0 });
    assert_eq!((scene.model.hydrodynamics.tolerance, scene.model.hydrodynamics.grid), (1e-3, None));
    assert_eq!(scene.output.trajectory, Schedule::every(1));
    assert_eq!(scene.model.hydrodynamics.method, None);
    assert_eq!(scene.model.hydrodynamics.device, fcm::ComputeDevice::Cpu);
    let on_card = good("least.toml", &["hydrodynamics.device=gpu"]);
    assert_eq!(suspension(&on_card).model.hydrodynamics.device, fcm::ComputeDevice::Gpu);
    let dense = good("least.toml", &["hydrodynamics.method=dense"]);
    assert_eq!(suspension(&dense).model.hydrodynamics.method.map(fcm::Method::name), Some("dense"));
    assert_eq!(suspension(&good("duration.toml", &[])).time.steps, 10);
}

#[test]
fn a_run_of_no_steps_is_a_start() {
    for path in files("scenes").iter().filter(|path| !path.ends_with("shear-cell-continuum.toml")) {
        if let SceneFile::Scene(scene) = SceneFile::read(path, &["time.steps=0".to_owned()]).unwrap() {
            assert_eq!(scene.kind().steps(), 0);
        }
    }
}

#[test]
fn overrides_reach_the_scene_and_its_text() {
    let scene = good("least.toml", &["time.steps=20", "species[0].radius=0.5", "gravity.acceleration=[0, 0, -2]"]);
    assert_eq!(suspension(&scene).time.steps, 20);
    let again = Scene::parse(scene.text(), "again.toml", &[]).unwrap();
    assert_eq!(suspension(&again).model.species, suspension(&scene).model.species);
    assert_eq!(suspension(&again).model.gravity.z, -2.0);
}

#[test]
fn paths_start_from_the_folder_of_the_scene() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/good");
    for (overrides, path) in [(&[][..], "start.csv"), (&["particles.path=a/b.csv"], "a/b.csv")] {
        let scene = good("from-file.toml", overrides);
        let expected = Some(StartSource::last(folder.join(path)));
        assert_eq!(suspension(&scene).start, expected);
        let changed = scene.with("another seed", &["seed=3".to_owned()]).unwrap();
        assert_eq!((&suspension(&changed).start, changed.kind().seed()), (&expected, 3));
    }
}

#[test]
fn an_override_that_is_wrong_is_named() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/good/least.toml");
    let message = |set: &str| Scene::read(&path, &[set.to_owned()]).unwrap_err().to_string();
    assert!(
        message("time.step=-1")
            .ends_with("least.toml with --set time.step=-1: time.step is -1; it needs to be a finite number above 0")
    );
    assert!(message("time.stpe=1").contains("did you mean \"step\"?"));
    assert_eq!(message("time"), "--set time: write key=value, as in time.step=0.01");
}

#[test]
fn overrides_complete_a_scene() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad/missing-section.toml");
    let read = |sets: &[&str]| Scene::read(&path, &sets.iter().map(|&set| set.to_owned()).collect::<Vec<_>>());
    assert!(read(&[]).is_err());
    assert_eq!(suspension(&read(&["fluid.viscosity=2"]).unwrap()).model.viscosity, 2.0);
    assert_eq!(suspension(&read(&["fluid={viscosity=2}"]).unwrap()).model.viscosity, 2.0);
}

#[test]
fn a_line_is_that_of_the_file_where_the_key_is_not_set() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad/radius-zero.toml");
    let message = |set: &str| {
        let error = Scene::read(&path, &[set.to_owned()]).unwrap_err().to_string();
        error.rsplit('/').next().unwrap().to_owned()
    };
    let of_file =
        "radius-zero.toml:9 with --set seed=2: species[0].radius is 0; it needs to be a finite number above 0";
    assert_eq!(message("seed=2"), of_file);
    for key in ["species[0].radius", "species.0.radius"] {
        let of_override = format!(
            "radius-zero.toml with --set {key}=-1: species[0].radius is -1; it needs to be a finite number above 0"
        );
        assert_eq!(message(&format!("{key}=-1")), of_override);
    }
    let surplus = message("box.edges=[10,10,10,99]");
    assert!(
        surplus.contains("box.edges has the wrong type: found a list of length 4, expected a list of 3 numbers"),
        "{surplus}"
    );
}

#[test]
fn values_as_long_as_files_are_cut_in_messages() {
    let long = "x".repeat(6_000_000);
    let text = |kind: &str| {
        format!("kind = \"{kind}\"\n[box]\nedges = [10, 10, 10]\n[fluid]\nviscosity = 1\n[time]\nstep = 1\nsteps = 1\n")
    };
    for (text, sets) in [
        (text(&long), vec![]),
        (text("suspension"), vec![format!("time.step={long}")]),
        (text("suspension"), vec![format!("{long}=1")]),
        (text("suspension"), vec![long.clone()]),
        (
            format!(
                "{}[[traps]]\nspecies = \"{long}\"\nstiffness = 1\n[[species]]\nradius = 1\ncount = 1\n",
                text("suspension")
            ),
            vec![],
        ),
        (format!("a = {long}"), vec![]),
    ] {
        let message = Scene::parse(&text, "long.toml", &sets).unwrap_err().to_string();
        assert!(message.len() < 2000, "{}", message.len());
    }
}

#[test]
fn a_missing_file_is_named() {
    let message = Scene::read(Path::new("nowhere.toml"), &[]).unwrap_err().to_string();
    assert!(message.starts_with("can't read the scene nowhere.toml: "));
}
