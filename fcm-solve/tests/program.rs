//! The program as users run it.

use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

const SCENE: &str = r#"
seed = 3
box.edges = [14.0, 14.0, 14.0]
fluid.viscosity = 1.0
flow = { kind = "shear", rate = 0.5, lees_edwards = false }
repulsion = { strength = 20.0, range = 0.1 }
hydrodynamics = { tolerance = 1e-2, method = "direct" }
time = { step = 0.02, steps = 30 }
output = { trajectory_every = 2, observables_every = 1, checkpoint_every = 4, fields_every = 10 }
statistics = { every = 2, from = 0.05 }
[[species]]
name = "heavy"
radius = 1.0
count = 25
force = [0.0, 0.0, -18.85]
"#;

fn program(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_fcm-solve"));
    // Ignores costs that the user of this machine may have measured.
    command.args(arguments).stdin(Stdio::null()).env("XDG_CACHE_HOME", "/nowhere");
    command
}

fn output(arguments: &[&str]) -> Output {
    program(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

#[track_caller]
fn succeeds(arguments: &[&str]) -> String {
    let output = output(arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    text(&output.stdout)
}

#[track_caller]
fn fails(arguments: &[&str]) -> String {
    let output = output(arguments);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    text(&output.stderr)
}

/// A folder with the scene, and the names of a scene and of a result folder in it.
fn place() -> (tempfile::TempDir, String, String) {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    std::fs::write(&scene, SCENE).unwrap();
    let out = folder.path().join("out");
    (folder, scene.display().to_string(), out.display().to_string())
}

/// A checkpoint without its scene, whose end may have been moved, and without the checksum of the whole file.
fn state_of(checkpoint: &[u8]) -> Vec<u8> {
    let start = b"fcm-solve checkpoint 1\n".len() + 8;
    let length = u64::from_le_bytes(checkpoint[start - 8..start].try_into().unwrap()) as usize;
    let mut header: serde_json::Value = serde_json::from_slice(&checkpoint[start..start + length]).unwrap();
    assert!(header.as_object_mut().unwrap().remove("scene").is_some(), "a checkpoint has its scene");
    let arrays = &checkpoint[start + length..checkpoint.len() - 8];
    [header.to_string().as_bytes(), arrays].concat()
}

/// Everything in a result folder that is determined by the run: the last checkpoint, the trajectory, the time series
/// except the seconds that steps took, and the statistics.
fn results(out: &str) -> (Vec<u8>, Vec<f64>, String) {
    let checkpoint = state_of(&std::fs::read(Path::new(out).join("checkpoint-0000000030.bin")).unwrap());
    let trajectory = hdf5::File::open(Path::new(out).join("trajectory.h5")).unwrap();
    let positions = trajectory.dataset("particles/all/position/value").unwrap().read_raw().unwrap();
    let csv = std::fs::read_to_string(Path::new(out).join("observables.csv")).unwrap();
    let without_seconds: String = csv.lines().map(|line| line.rsplit_once(',').unwrap().0.to_owned() + "\n").collect();
    let statistics = ["summary", "lags", "pairs"].map(|name| {
        std::fs::read_to_string(Path::new(out).join("statistics").join(name).with_extension("csv")).unwrap()
    });
    (checkpoint, positions, without_seconds + &statistics.concat())
}

#[test]
fn a_bad_scene_is_refused_once_and_by_name() {
    let (folder, scene, out) = place();
    std::fs::write(&scene, SCENE.replace("radius", "raduis")).unwrap();
    let message = fails(&["run", &scene, "--out", &out]);
    assert!(message.starts_with("error: ") && message.contains("did you mean \"radius\"?"), "{message}");
    assert_eq!(message.lines().count(), 1);
    assert!(!Path::new(&out).exists(), "nothing is made");
    let missing = folder.path().join("missing.toml").display().to_string();
    assert!(fails(&["check", &missing]).contains("can't read the scene"));
}

#[test]
fn steps_too_long_for_the_repulsion_are_told_before_they_are_taken() {
    let (_folder, scene, out) = place();
    assert!(!succeeds(&["check", &scene]).contains("warning: time.step"));
    let told = "warning: time.step = 0.2 is longer than the 0.031 with which pairs are steady";
    assert!(succeeds(&["check", &scene, "--set", "time.step=0.2"]).contains(told));
    let ran = output(&["run", &scene, "--out", &out, "--set", "time.step=0.2", "--set", "time.steps=1"]);
    assert!(text(&ran.stderr).contains(told), "{}", text(&ran.stderr));
}

#[test]
fn a_run_leaves_what_its_scene_says() {
    let (_folder, scene, out) = place();
    succeeds(&["run", &scene, "--out", &out, "--set", "time.steps=10"]);
    let info = succeeds(&["info", &format!("{out}/trajectory.h5")]);
    assert!(info.contains("6, steps 0 to 10, times 0 to 0.2"), "{info}");
    assert!(info.contains("/particles/all/position/value") && info.contains("6 x 25 x 3"), "{info}");
    assert!(succeeds(&["info", "--scene", &format!("{out}/observables.h5")]).contains("steps = 10"));
    let info = succeeds(&["info", &out]);
    assert!(info.contains("trajectory.h5") && info.contains("frames 6, steps 0 to 10, times 0 to 0.2"), "{info}");
    let csv = std::fs::read_to_string(format!("{out}/observables.csv")).unwrap();
    assert_eq!(csv.lines().count(), 12);
    assert!(std::fs::read_to_string(format!("{out}/fields.xdmf")).unwrap().contains("velocity-0000000010.h5"));
}

/// Samples of the run are frames of its trajectory here, so both ways give the same statistics.
#[test]
fn statistics_in_a_run_are_those_of_its_trajectory() {
    let (_folder, scene, out) = place();
    succeeds(&["run", &scene, "--out", &out]);
    let said = succeeds(&["stats", &out, "--from", "0.05"]);
    assert!(said.contains("D_slope_y") && said.contains("T_yy"), "{said}");
    for name in ["summary", "velocity_density", "lags", "pairs", "pairs_by_angle", "concentration"] {
        let [during, afterwards] =
            ["statistics", "stats"].map(|place| std::fs::read_to_string(format!("{out}/{place}/{name}.csv")).unwrap());
        assert_eq!(during, afterwards, "{name}");
    }
    let summary = std::fs::read_to_string(format!("{out}/stats/summary.csv")).unwrap();
    assert!(summary.contains("first_time,all,time,0.08,") && summary.contains("samples,all,,14.0,"), "{summary}");
    assert!(fails(&["stats", &out, "--from", "7"]).contains("has no whole frame in that span"));
    let one = format!("{out}/one");
    succeeds(&["stats", &out, "--from", "0.2", "--to", "0.2", "--out", &one]);
    assert!(hdf5::File::open(format!("{one}/statistics.h5")).unwrap().dataset("pairs/g").is_ok());
}

#[test]
fn results_are_not_overwritten_unless_forced() {
    let (_folder, scene, out) = place();
    let run = ["run", &scene, "--out", &out, "--set", "time.steps=1"];
    succeeds(&run);
    let before = std::fs::read(format!("{out}/observables.csv")).unwrap();
    assert!(fails(&run).contains("already holds the results of a run"));
    assert_eq!(std::fs::read(format!("{out}/observables.csv")).unwrap(), before);
    succeeds(&[&run[..], &["--force"]].concat());
    assert!(fails(&["resume", &format!("{out}/fields")]).contains("holds no run to go on with"));
}

#[test]
fn a_resumed_run_is_an_uninterrupted_one_bit_for_bit() {
    let (folder, scene, out) = place();
    succeeds(&["run", &scene, "--out", &out, "--threads", "1"]);
    let parts = folder.path().join("parts").display().to_string();
    // The first part ends during the Runge-Kutta steps, the second after them.
    succeeds(&["run", &scene, "--out", &parts, "--set", "time.steps=2"]);
    succeeds(&["resume", &parts, "--steps", "17", "--threads", "2"]);
    succeeds(&["resume", &parts, "--steps", "30"]);
    assert_eq!(results(&out), results(&parts));
}

#[test]
fn a_killed_run_goes_on_to_the_same_end() {
    let (folder, scene, out) = place();
    succeeds(&["run", &scene, "--out", &out]);
    let whole = results(&out);
    for attempt in 0..4 {
        let out = folder.path().join(format!("killed-{attempt}")).display().to_string();
        let mut child = program(&["run", &scene, "--out", &out]).stderr(Stdio::null()).spawn().unwrap();
        while !Path::new(&out).join("checkpoint-0000000000.bin").exists() {
            assert!(child.try_wait().unwrap().is_none(), "it runs");
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(Duration::from_millis(37 * attempt));
        child.kill().unwrap();
        child.wait().unwrap();
        succeeds(&["resume", &out]);
        assert_eq!(results(&out), whole);
    }
}

#[test]
fn a_signal_ends_a_run_after_its_step_with_a_checkpoint() {
    let (_folder, scene, out) = place();
    let run = ["run", &scene, "--out", &out, "--set", "time.steps=100000", "--set", "output.trajectory_every=0"];
    let child = program(&run).stderr(Stdio::piped()).spawn().unwrap();
    while !Path::new(&out).join("checkpoint-0000000004.bin").exists() {
        std::thread::sleep(Duration::from_millis(2));
    }
    for _ in 0..3 {
        assert!(Command::new("kill").arg(child.id().to_string()).status().unwrap().success());
    }
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(128 + 15));
    let message = text(&output.stderr);
    let step: u64 = message.split("stopped after step ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!(message.contains(&format!("go on with: fcm-solve resume {out}")), "{message}");
    assert!(Path::new(&out).join(format!("checkpoint-{step:010}.bin")).exists());
    succeeds(&["resume", &out, "--steps", &(step + 2).to_string()]);
}

#[test]
fn a_damaged_checkpoint_is_passed_over_and_a_damaged_trajectory_is_named() {
    let (_folder, scene, out) = place();
    succeeds(&["run", &scene, "--out", &out, "--set", "time.steps=9"]);
    std::fs::write(format!("{out}/checkpoint-0000000009.bin"), "no checkpoint").unwrap();
    let resumed = output(&["resume", &out, "--steps", "10"]);
    assert!(resumed.status.success(), "{}", text(&resumed.stderr));
    assert!(text(&resumed.stderr).contains("checkpoint-0000000009.bin is damaged"), "{}", text(&resumed.stderr));
    assert!(text(&resumed.stderr).contains("going on from the checkpoint before, step 8"));
    std::fs::write(format!("{out}/trajectory.h5"), "no trajectory").unwrap();
    assert!(fails(&["resume", &out]).contains("trajectory.h5 is damaged"));
}

/// A limit on the size of files simulates a full disk.
#[test]
fn a_file_that_cannot_grow_ends_the_run_with_its_name() {
    let (_folder, scene, out) = place();
    let run = format!("trap '' XFSZ; ulimit -f 64; exec {} run {scene} --out {out}", env!("CARGO_BIN_EXE_fcm-solve"));
    let output = Command::new("sh").args(["-c", &run]).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let message = text(&output.stderr);
    assert!(message.contains(&format!("error: can't write {out}/")), "{message}");
    assert!(message.contains("file too large"), "{message}");
}

#[test]
fn a_second_run_keeps_off_a_folder_in_use() {
    let (_folder, scene, out) = place();
    let run = ["run", &scene, "--out", &out, "--set", "time.steps=100000", "--set", "output.trajectory_every=0"];
    let mut child = program(&run).stderr(Stdio::null()).spawn().unwrap();
    while !Path::new(&out).join("checkpoint-0000000000.bin").exists() {
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(fails(&["resume", &out]).contains("another run is writing to"));
    child.kill().unwrap();
    child.wait().unwrap();
}

#[test]
fn new_scenes_pass_their_check() {
    for kind in ["suspension", "settling", "silica-in-water", "pair-settling", "shear"] {
        let scene = succeeds(&["new", kind]);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, scene).unwrap();
        let plan = succeeds(&["check", &path.display().to_string()]);
        for line in ["particles", "grid", "support", "memory", "cost"] {
            assert!(plan.lines().any(|l| l.starts_with(line)), "{plan}");
        }
    }
}

#[test]
fn help_and_completions_are_there() {
    assert!(succeeds(&["--help"]).contains("mpirun -n 4 fcm-solve run"));
    for shell in ["bash", "zsh", "fish"] {
        assert!(succeeds(&["completions", shell]).contains("fcm-solve"));
    }
    let unknown = output(&["resum"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(text(&unknown.stderr).contains("tip: a similar subcommand exists"), "{}", text(&unknown.stderr));
}

/// A launcher announces several processes to a program that was built for a single one.
#[test]
#[cfg(not(feature = "mpi"))]
fn ranks_without_mpi_are_refused() {
    let run = |rank: &str| {
        let envs = [("OMPI_COMM_WORLD_SIZE", "2"), ("OMPI_COMM_WORLD_RANK", rank)];
        let output = program(&["new", "shear"]).envs(envs).output().unwrap();
        assert_eq!(output.status.code(), Some(1));
        text(&output.stderr)
    };
    assert!(run("0").contains("built without MPI"));
    assert_eq!(run("1"), "");
}

/// The measured costs of a machine become part of the scenes that are run on it, so they hold for resumed runs, too.
#[test]
fn the_costs_of_a_machine_stay_with_a_run() {
    let (folder, scene, out) = place();
    let on_machine = |arguments: &[&str]| program(arguments).env("XDG_CACHE_HOME", folder.path()).output().unwrap();
    let measured = on_machine(&["calibrate"]);
    assert!(measured.status.success(), "{}", text(&measured.stderr));
    let kept = folder.path().join("fcm-solve/costs.json");
    assert!(text(&measured.stdout).contains(&kept.display().to_string()));
    let of_card = text(&measured.stdout).lines().find_map(|line| line.strip_prefix("card").map(str::to_owned)).unwrap();
    // With a card, its costs; without one, the reason.
    assert!(of_card.contains("times those") || of_card.contains("not measured: "), "{of_card}");
    let stored: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(&kept).unwrap()).unwrap();
    assert_eq!(stored.get("card").is_some(), of_card.contains("times those"));
    std::fs::write(&kept, r#"{"stencils": 2.5, "transforms": 0.5, "pairs": 1.0}"#).unwrap();
    assert!(on_machine(&["run", &scene, "--out", &out]).status.success());
    let copy: String = std::fs::read_to_string(Path::new(&out).join("scene.toml")).unwrap();
    let costs: Vec<&str> =
        copy.lines().filter(|line| line.contains("stencils") || line.contains("transforms")).collect();
    assert!(costs.join(" ").contains("2.5") && costs.join(" ").contains("0.5"), "{copy}");
    std::fs::write(&kept, "{").unwrap();
    let refused = text(&on_machine(&["check", &scene]).stderr);
    assert!(refused.contains("costs.json") && refused.contains("fcm-solve calibrate"), "{refused}");
}

#[test]
fn two_sphere_functions_are_those_of_the_literature() {
    let text = succeeds(&["two-sphere", "--ratio", "2", "--gap", "1e-4", "--json"]);
    let functions: serde_json::Value = serde_json::from_str(&text).unwrap();
    // Values by multipole collocation.
    for (name, exact) in [("XA11", 4447.95949244901), ("XA12", -2965.06317868803)] {
        assert!((functions[name].as_f64().unwrap() / exact - 1.0).abs() < 1e-7, "{name}: {}", functions[name]);
    }
    assert!(fails(&["two-sphere", "--ratio", "2", "--gap", "0"]).contains("give a gap above 0"));
}

#[test]
fn a_lubricated_case_is_the_same_on_any_threads() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("case.json");
    let text = r#"{"box": [12, 12, 12], "viscosity": 1, "radii": [1, 1.5, 1], "lubrication": true,
        "positions": [[3, 3, 3], [5.51, 3, 3], [3, 5.002, 3]],
        "background": {"velocity_gradient": [[0, 1, 0], [0, 0, 0], [0, 0, 0]]}}"#;
    std::fs::write(&case, text).unwrap();
    let answer = |threads: &str| -> serde_json::Value {
        let text = succeeds(&["mobility", &case.display().to_string(), "--threads", threads]);
        let mut answer: serde_json::Value = serde_json::from_str(&text).unwrap();
        answer["seconds"].take();
        answer
    };
    let one = answer("1");
    assert_eq!(one, answer("3"));
    let xy = |name: &str| one[name][0][1].as_f64().unwrap();
    assert!(xy("stresslets") > 1.05 * xy("stresslets_far"), "{} of {}", xy("stresslets_far"), xy("stresslets"));
}

/// Dense enough for every sphere to have near neighbours, among them images beyond the sheared faces.
#[test]
fn a_lubricated_run_has_the_same_bits_on_any_threads_and_in_parts() {
    let (folder, scene, _) = place();
    let text = SCENE
        .replace("[14.0, 14.0, 14.0]", "[8.5, 8.5, 8.5]")
        .replace("lees_edwards = false", "lees_edwards = true")
        .replace("tolerance = 1e-2,", "tolerance = 1e-2, lubrication = true,");
    std::fs::write(&scene, text).unwrap();
    for integrator in ["adams-bashforth", "adaptive"] {
        let out = |name: &str| folder.path().join(format!("{integrator}-{name}")).display().to_string();
        let (whole, parts) = (out("whole"), out("parts"));
        let chosen = format!("time.integrator={integrator}");
        let run = ["run", &scene, "--set", &chosen];
        succeeds(&[&run[..], &["--out", &whole, "--threads", "1"]].concat());
        succeeds(&[&run[..], &["--out", &parts, "--threads", "3", "--set", "time.steps=7"]].concat());
        succeeds(&["resume", &parts, "--steps", "30", "--threads", "2"]);
        assert_eq!(results(&whole), results(&parts), "{integrator}");
    }
}
