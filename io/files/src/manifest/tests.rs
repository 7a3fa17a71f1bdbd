use super::*;

#[test]
fn names_are_listed_before_their_files_and_by_every_program_that_comes_later() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let manifest = Manifest::begin(path, "a = 1", None).unwrap();
    manifest.make_folder(&path.join("fields")).unwrap();
    for file in ["trajectory.h5", "fields/velocity-0000000000.h5"] {
        manifest.enter(&path.join(file)).unwrap();
        manifest.enter(&path.join(file)).unwrap();
        std::fs::write(path.join(file), "").unwrap();
    }
    let other = Manifest::of(path).unwrap();
    other.enter(&path.join("report.html")).unwrap();
    other.enter(Path::new("/elsewhere/report.html")).unwrap();
    let names = |manifest: &Manifest| {
        manifest.files().iter().map(|f| f.strip_prefix(path).unwrap().display().to_string()).collect::<Vec<_>>()
    };
    let read = Manifest::of(path).unwrap();
    assert_eq!(names(&read), ["fields/velocity-0000000000.h5", "report.html", "trajectory.h5"]);
    manifest.remove(&path.join("trajectory.h5")).unwrap();
    assert_eq!(names(&Manifest::of(path).unwrap()), ["fields/velocity-0000000000.h5", "report.html"]);
    let text = std::fs::read_to_string(path.join(MANIFEST)).unwrap();
    let twice = text.lines().filter(|line| text.matches(line).count() > 1).count();
    assert_eq!(twice, 0, "{text}");
    assert!(text.contains(&format!("{{\"scene\":\"{}\"}}", checksum::of_text("a = 1"))), "{text}");
}

#[test]
fn a_line_that_was_cut_short_is_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    drop(Manifest::begin(path, "", None).unwrap());
    let whole = std::fs::read_to_string(path.join(MANIFEST)).unwrap();
    std::fs::write(path.join(MANIFEST), whole.clone() + "{\"file\":\"traj").unwrap();
    let manifest = Manifest::of(path).unwrap();
    manifest.enter(&path.join("averages.h5")).unwrap();
    let text = std::fs::read_to_string(path.join(MANIFEST)).unwrap();
    assert_eq!(text, whole + "{\"file\":\"averages.h5\"}\n");
}

#[test]
fn what_is_there_and_not_listed_is_in_the_way() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let manifest = Manifest::begin(path, "", None).unwrap();
    std::fs::create_dir(path.join("fields")).unwrap();
    std::fs::write(path.join("report.html"), "mine").unwrap();
    std::os::unix::fs::symlink("/nowhere", path.join("trajectory.xyz")).unwrap();
    for error in [
        manifest.make_folder(&path.join("fields")),
        manifest.enter(&path.join("report.html")),
        manifest.enter(&path.join("trajectory.xyz")),
        manifest.remove(&path.join("report.html")),
    ] {
        let error = error.unwrap_err().to_string();
        assert!(error.contains("manifest.jsonl does not list it; move it away"), "{error}");
    }
    assert!(manifest.remove(&path.join("averages.h5")).is_ok(), "there is none");
}

#[test]
fn a_manifest_of_another_program_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(MANIFEST);
    for text in ["{\"name\": \"my app\"}\n", "[1, 2]\n", "mine"] {
        std::fs::write(&path, text).unwrap();
        let error = Manifest::of(folder.path()).err().unwrap().to_string();
        assert!(error.contains("manifest.jsonl is damaged: it does not begin as a manifest"), "{error}");
    }
    std::fs::remove_file(&path).unwrap();
    std::fs::create_dir(&path).unwrap();
    assert!(Manifest::of(folder.path()).is_err());
}

#[test]
fn results_of_older_versions_are_known_by_what_they_contain() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let provenance = crate::Provenance {
        scene: "a = 1".into(),
        program: "fcm-solve 0.1.0".into(),
        plan: "none".into(),
        ranks: 1,
        seed: 2,
    };
    std::fs::write(path.join(SCENE), "a = 1").unwrap();
    std::fs::write(path.join("checkpoint-0000000003.bin"), "mine").unwrap();
    assert!(Manifest::of_older_version(path).unwrap().is_none(), "a scene alone is the user's");
    let table = simulation::Table::new("summary", &[], &[("a", "")]);
    let statistics = path.join("statistics");
    std::fs::create_dir(&statistics).unwrap();
    let tables = [table];
    crate::write_tables(&statistics, "statistics", &provenance, &tables, &Manifest::none(&statistics)).unwrap();
    std::fs::write(statistics.join("mine.csv"), "mine").unwrap();
    std::fs::write(path.join("checkpoint-0000000002.bin"), "fcm-solve checkpoint 1\n...").unwrap();
    let manifest = Manifest::of_older_version(path).unwrap().unwrap();
    let known = ["checkpoint-0000000002.bin", "scene.toml", "statistics/statistics.h5", "statistics/summary.csv"];
    assert_eq!(manifest.files(), known.map(|name| path.join(name)));
    assert!(!path.join(MANIFEST).exists(), "nothing is written before it is needed");
    manifest.enter(&path.join("observables.csv")).unwrap();
    assert_eq!(Manifest::of(path).unwrap().files().len(), 5);
}
