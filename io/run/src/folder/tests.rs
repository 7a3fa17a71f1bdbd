use super::*;
use std::os::unix::fs::symlink;

/// A folder with these files.
fn with(files: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for file in files {
        put(folder.path(), file);
    }
    folder
}

fn put(folder: &Path, file: &str) {
    let path = folder.join(file);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, "mine").unwrap();
}

fn claim(folder: &Path, former: ExistingRun) -> Result<RunFolder, String> {
    RunFolder::claim(folder, &Comm::alone(), former).map_err(|e| scene::in_full(&e))
}

/// Makes a run that writes these files.
fn run(folder: &Path, files: &[&str]) {
    let mut run = claim(folder, ExistingRun::Keep).unwrap();
    run.start_with("first").unwrap();
    for file in files {
        let path = folder.join(file);
        if path.parent() != Some(folder) {
            run.manifest().make_folder(path.parent().unwrap()).unwrap();
        }
        run.manifest().enter(&path).unwrap();
        write_result(&path);
    }
}

fn write_result(path: &Path) {
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("h5") => {
            let [scene, program, plan] = ["a = 1", "fcm-solve 0.2.0", "none"].map(str::to_owned);
            let provenance = files::Provenance { scene, program, plan, ranks: 1, seed: 2 };
            let mut particles = domain::Particles::default();
            particles.push(0, domain::Vector::ZERO, 1.0, 0);
            let cell = domain::PeriodicBox::new(domain::Vector::ONE).unwrap();
            let frame = simulation::Frame { particles, cell, periodic: [true; 3] };
            files::Trajectory::create(path, &provenance, &frame, 1).unwrap();
        }
        _ => std::fs::write(path, "fcm-solve checkpoint 1\n").unwrap(),
    }
}

fn is_mine(folder: &Path, file: &str) -> bool {
    std::fs::read(folder.join(file)).is_ok_and(|content| content == b"mine")
}

const STRANGERS: [&str; 9] = [
    "scene.toml",
    "cases/pair.json",
    "fields/wheat.txt",
    "stats/table.csv",
    "report.html",
    "checkpoint-0000000099.bin",
    "trajectory.h5",
    "force-chains/x",
    "contacts",
];

#[test]
fn files_of_others_are_refused_and_named() {
    for file in STRANGERS {
        let folder = with(&[file, "notes.txt"]);
        for former in [ExistingRun::Keep, ExistingRun::Replace, ExistingRun::Continue] {
            let error = claim(folder.path(), former).err().unwrap();
            assert!(error.contains(file.split('/').next().unwrap()), "{file}: {error}");
        }
        assert!(is_mine(folder.path(), file) && is_mine(folder.path(), "notes.txt"));
    }
    let folder = with(&STRANGERS);
    assert!(claim(folder.path(), ExistingRun::Replace).err().unwrap().contains("fields/"));
}

#[test]
fn a_new_run_removes_what_the_former_one_made_and_nothing_else() {
    let folder = with(&["notes.txt"]);
    let path = folder.path();
    run(path, &["trajectory.h5", "fields/velocity-0000000001.h5", "stats/summary.csv", "checkpoint-0000000001.bin"]);
    put(path, "fields/wheat.txt");
    let error = claim(path, ExistingRun::Keep).err().unwrap();
    assert!(error.contains("already holds the results of a run: go on with it by --continue"), "{error}");
    claim(path, ExistingRun::Replace).unwrap().start_with("second").unwrap();
    assert!(is_mine(path, "notes.txt") && is_mine(path, "fields/wheat.txt"));
    assert_eq!(std::fs::read(path.join("scene.toml")).unwrap(), b"second");
    let left: Vec<_> = ["trajectory.h5", "fields/velocity-0000000001.h5", "stats", "checkpoint-0000000001.bin"]
        .into_iter()
        .filter(|name| path.join(name).exists())
        .collect();
    assert!(left.is_empty(), "{left:?}");
    let again = claim(path, ExistingRun::Replace).unwrap();
    again.manifest().make_folder(&path.join("fields")).unwrap();
}

#[test]
fn what_the_user_puts_under_a_name_of_results_stays() {
    let folder = with(&[]);
    let path = folder.path();
    run(path, &["trajectory.h5", "fields/velocity-0000000001.h5"]);
    for file in ["report.html", "checkpoint-0000000099.bin", "fields/velocity-0000000007.h5", "cases/a"] {
        put(path, file);
        let error = claim(path, ExistingRun::Replace).err().unwrap();
        assert!(error.contains(file.strip_suffix("/a").unwrap_or(file)), "{error}");
        assert!(is_mine(path, file) && path.join("trajectory.h5").exists());
        std::fs::remove_file(path.join(file)).unwrap();
        let _ = std::fs::remove_dir(path.join("cases"));
    }
    assert!(claim(path, ExistingRun::Replace).is_ok());
}

#[test]
fn what_the_user_puts_in_the_place_of_a_result_stays() {
    let folder = with(&[]);
    let path = folder.path();
    let files = ["trajectory.h5", "checkpoint-0000000001.bin", "report.html", "fields/velocity-0000000001.h5"];
    run(path, &files[..2]);
    Manifest::of(path).unwrap().enter(&path.join(files[2])).unwrap();
    Manifest::of(path).unwrap().make_folder(&path.join("fields")).unwrap();
    Manifest::of(path).unwrap().enter(&path.join(files[3])).unwrap();
    for file in files {
        let _ = std::fs::remove_file(path.join(file));
        put(path, file);
        let error = claim(path, ExistingRun::Replace).err().unwrap();
        assert!(error.contains(file) && is_mine(path, file), "{error}");
    }
}

#[test]
fn a_folder_without_its_scene_keeps_its_results() {
    let folder = with(&[]);
    run(folder.path(), &["trajectory.h5"]);
    std::fs::remove_file(folder.path().join("scene.toml")).unwrap();
    for former in [ExistingRun::Keep, ExistingRun::Continue] {
        let error = claim(folder.path(), former).err().unwrap();
        assert!(error.contains("its scene.toml is gone"), "{error}");
    }
    std::fs::remove_file(folder.path().join(MANIFEST)).unwrap();
    let error = claim(folder.path(), ExistingRun::Replace).err().unwrap();
    assert!(error.contains("trajectory.h5"), "{error}");
}

#[test]
fn nothing_outside_is_removed() {
    let outside = with(&["velocity-0000000001.h5", "trajectory.h5"]);
    let folder = with(&[]);
    let path = folder.path();
    run(path, &["fields/velocity-0000000001.h5", "trajectory.h5"]);
    std::fs::remove_dir_all(path.join("fields")).unwrap();
    std::fs::remove_file(path.join("trajectory.h5")).unwrap();
    symlink(outside.path(), path.join("fields")).unwrap();
    symlink(outside.path().join("trajectory.h5"), path.join("trajectory.h5")).unwrap();
    let error = claim(path, ExistingRun::Replace).err().unwrap();
    assert!(error.contains("fields") && error.contains("trajectory.h5"), "{error}");
    let manifest = Manifest::open(path).unwrap().unwrap();
    assert!(manifest.remove_all().is_err());
    assert!(manifest.remove(&path.join("fields/velocity-0000000001.h5")).is_err());
    assert!(is_mine(outside.path(), "velocity-0000000001.h5") && is_mine(outside.path(), "trajectory.h5"));
    let victim = outside.path().join("trajectory.h5").display().to_string();
    for name in [victim.as_str(), "../x", "fields/../../x"] {
        let folder = with(&[]);
        run(folder.path(), &[]);
        let manifest = folder.path().join(MANIFEST);
        let text = std::fs::read_to_string(&manifest).unwrap();
        std::fs::write(&manifest, text + &format!("{{\"file\":\"{name}\"}}\n")).unwrap();
        let error = claim(folder.path(), ExistingRun::Replace).err().unwrap();
        assert!(error.contains("manifest.jsonl is damaged") && error.contains(name), "{error}");
    }
    assert!(is_mine(outside.path(), "trajectory.h5"));
}

#[test]
fn the_lock_of_another_program_is_neither_followed_nor_cut() {
    let folder = with(&["mine", ".lock"]);
    drop(claim(folder.path(), ExistingRun::Keep).unwrap());
    assert!(is_mine(folder.path(), ".lock"));
    std::fs::remove_file(folder.path().join(".lock")).unwrap();
    symlink(folder.path().join("mine"), folder.path().join(".lock")).unwrap();
    let error = claim(folder.path(), ExistingRun::Keep).err().unwrap();
    assert!(error.contains(".lock") && is_mine(folder.path(), "mine"), "{error}");
}

#[test]
fn temporary_files_of_killed_programs_go_and_those_of_others_stay() {
    let folder = with(&["trajectory.h5.tmp", "fields.xdmf.0123456789abcdef.tmp"]);
    let path = folder.path();
    run(path, &["fields/velocity-0000000001.h5"]);
    let text = std::fs::read_to_string(path.join(MANIFEST)).unwrap();
    let killed = "00000000000000aa";
    std::fs::write(path.join(MANIFEST), text + &format!("{{\"writer\":\"{killed}\"}}\n")).unwrap();
    let ours = [format!("observables.csv.{killed}.tmp"), format!("fields/velocity-0000000002.h5.{killed}.tmp")];
    let unplaced = format!("{MANIFEST}.00000000000000bb.tmp");
    for file in &ours {
        put(path, file);
    }
    std::fs::write(path.join(&unplaced), "{\"manifest\":{\"format\":\"fcm").unwrap();
    claim(path, ExistingRun::Replace).unwrap().start_with("second").unwrap();
    assert!(ours.iter().chain([&unplaced]).all(|file| !path.join(file).exists()));
    assert!(is_mine(path, "trajectory.h5.tmp") && is_mine(path, "fields.xdmf.0123456789abcdef.tmp"));
}
