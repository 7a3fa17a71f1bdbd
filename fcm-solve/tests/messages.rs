//! Messages of the program: printed once, with readable numbers and advice.

use std::io::Write;
use std::process::{Command, Output, Stdio};

/// Output of the program for a text on its standard input.
fn given(input: &str, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_fcm-solve"));
    command.args(arguments).env("XDG_CACHE_HOME", "/nowhere");
    let mut child =
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
    // A command that fails early does not read its input.
    let _ = child.stdin.take().expect("a pipe").write_all(input.as_bytes());
    child.wait_with_output().expect("it ends")
}

#[track_caller]
fn said(input: &str, arguments: &[&str], expected: i32) -> String {
    let output = given(input, arguments);
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).expect("text"));
    assert_eq!(output.status.code(), Some(expected), "{err}");
    out + &err
}

const CASE: &str = r#"{"box": [9, 9, 9], "viscosity": 1, "positions": [[1, 2, 3]], "radii": 1, "forces": [[1, 0, 0]]}"#;

#[test]
fn a_case_comes_from_the_standard_input() {
    let answer: serde_json::Value = serde_json::from_str(&said(CASE, &["mobility", "-"], 0)).expect("JSON");
    assert!(answer["velocities"][0][0].as_f64().expect("a number") > 0.03);
    let error = said("{}", &["mobility", "-"], 1);
    assert!(error.contains("can't read the standard input: viscosity is missing"), "{error}");
}

#[test]
fn numbers_out_of_range_are_refused_with_their_range() {
    for tolerance in ["-1", "0", "-1e-3", "nan", "1"] {
        let error = said(CASE, &["mobility", "-", "--tolerance", tolerance], 2);
        assert!(error.contains("needs to be between 1e-12 and 0.5"), "{error}");
    }
    assert!(said("", &["bench", "--volume-fraction", "-0.1"], 2).contains("above 0 and at most 0.5"));
    assert!(said("", &["two-sphere", "--ratio", "-2", "--gap", "1"], 1).contains("ratios from 0.05 to 20"));
}

#[test]
fn errors_are_said_once() {
    let error = said("", &["bench", "--particles", "20", "--grid", "7"], 1);
    assert_eq!(error.matches("the grid has 7 points").count(), 1, "{error}");
    let error = said("", &["check", "/nowhere/scene.toml"], 1);
    assert_eq!(error.matches("No such file").count(), 1, "{error}");
}

#[test]
fn a_scene_is_not_called_a_damaged_file() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, words) in [("a.toml", "is a scene, not a file of results"), ("a.h5", "it is no HDF5 file")] {
        let path = folder.path().join(name);
        std::fs::write(&path, "title = 'a scene'").expect("a file");
        let error = said("", &["info", &path.display().to_string()], 1);
        assert!(error.contains(words) && !error.contains("damaged"), "{error}");
    }
}

fn scene(unit: f64, rest: &str) -> String {
    let [edge, radius, near] = [8e-5 * unit, 5e-6 * unit, 1.01e-5 * unit];
    format!(
        "box.edges = [{edge:e}, {edge:e}, {edge:e}]\nfluid.viscosity = 1e-3\nparticles.initial = 'positions'\n\
         particles.positions = [[0.0, 0.0, 0.0], [{near:e}, 0.0, 0.0]]\nhydrodynamics.tolerance = 1e-6\n\
         [[species]]\nradius = {radius:e}\ncount = 2\n{rest}"
    )
}

/// 3 times 0.05 is 0.15000000000000002 in floating point.
#[test]
fn lengths_and_times_can_be_read_in_any_unit() {
    let steps = "[time]\nstep = 0.05\nsteps = 3\n";
    for (unit, gap) in [(1.0, "1e-7"), (1e6, "0.1"), (1e30, "1e23")] {
        let outline = said(&scene(unit, steps), &["check", "-"], 0);
        assert!(outline.contains(&format!("smallest gap {gap} (0.02 of the smallest radius)")), "{outline}");
        assert!(outline.contains("until time 0.15\n"), "{outline}");
    }
}

#[test]
fn shear_is_in_a_box_that_shears_or_is_warned_of() {
    let flow = |key: &str| format!("[flow]\nkind = 'shear'\nrate = 1.0\n{key}\n[time]\nstep = 0.05\nsteps = 3\n");
    assert!(!said(&scene(1.0, &flow("")), &["check", "-"], 0).contains("warning"));
    let warned = said(&scene(1.0, &flow("lees_edwards = false")), &["check", "-"], 0);
    assert!(warned.contains("warning: flow.lees_edwards = false: the box stays rectangular"), "{warned}");
}

#[test]
fn runs_without_an_end_are_refused() {
    for (time, key) in
        [("step = 1e308\nsteps = 30", "time.step is 1e308"), ("step = 1e-30\nduration = 1.0", "time.duration makes")]
    {
        let error = said(&scene(1.0, &format!("[time]\n{time}\n")), &["check", "-"], 1);
        assert!(error.contains(key), "{error}");
    }
}

/// Numbers of the scenes that come with the program: 502 grains of 0.787 mm in 8 mm x 4 mm x 8 mm; the cost is the
/// number of steps times that of disks or grains, over the speed of a core.
#[test]
fn outlines_of_grains_are_those_of_their_scenes() {
    let [cell, disks] =
        [include_str!("../../scenes/shear-cell.toml"), include_str!("../../scenes/granular-disks.toml")];
    let continuum = include_str!("../../scenes/shear-cell-continuum.toml");
    let contains = |outline: &str, lines: &[&str]| {
        for line in lines {
            assert!(outline.contains(&format!("{line}\n")), "{outline}");
        }
    };
    let grains = "grains     502, solid fraction 0.5005\ntop        fixed\ncollisions at their exact times\n\
                  steps      30, until time 0.03; measured from time 0.01";
    let exact = said(cell, &["check", "-"], 0);
    contains(&exact, &[grains]);
    assert!(!exact.contains("cost"), "hits can't be foretold: {exact}");
    let stepped = ["check", "-", "--set", "collisions=time-stepped", "--set", "time.collision_step=5e-7"];
    contains(&said(cell, &stepped, 0), &["collisions on a time step of 5e-7", "cost       about 1.2 s of one core"]);
    let free = ["check", "-", "--set", "top={kind='free',pressure=300.0,mass_per_area=0.2}"];
    contains(&said(cell, &free, 0), &["top        free under its load"]);
    let lines = [
        "disks      1460, radii 0.875 to 3.5, 60.01% of the area",
        "lengths    viscous length 0.1911, estimated mean free path 0.3087",
        "steps      13334, until time 2000.1 and strain 20.001",
        "cost       about 0.78 s of one core",
    ];
    contains(&said(disks, &["check", "-"], 0), &lines);
    contains(&said(continuum, &["check", "-"], 0), &["problems   3, radial distribution of SinclairJackson"]);
}

/// With a card the scene is checked and run on it; without one both commands end with the same sentence.
#[test]
fn commands_agree_on_whether_there_is_a_card() {
    let scene = include_str!("../../scenes/settling.toml");
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out").display().to_string();
    let on_card = ["--set", "hydrodynamics.device=gpu", "--set", "time.steps=1", "--set", "species[0].count=20"];
    let checked = given(scene, &[&["check", "-", "--no-trial"][..], &on_card].concat());
    let run = given(scene, &[&["run", "-", "--out", &out][..], &on_card].concat());
    let bench = given("", &["bench", "--device", "gpu", "--particles", "20", "--repeats", "1"]);
    let mobility = given(&CASE.replace('}', ", \"device\": \"gpu\"}"), &["mobility", "-"]);
    if checked.status.success() {
        let checked = String::from_utf8_lossy(&checked.stdout);
        assert!(checked.contains("\ndevice     gpu\n") && checked.contains("\ncard       "), "{checked}");
        assert!([run, bench, mobility].iter().all(|output| output.status.success()));
        return;
    }
    for output in [checked, run, bench, mobility] {
        let error = String::from_utf8(output.stderr).expect("text");
        let (_, sentence) = error.split_once("hydrodynamics.device is \"gpu\", but ").expect("the key");
        assert!(sentence.ends_with("; leave it out, or write \"cpu\"\n") && sentence.lines().count() == 1, "{error}");
        assert_eq!(output.status.code(), Some(1), "{error}");
    }
}
