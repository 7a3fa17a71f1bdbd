//! Results folders with files that no run has made.

use crate::case_environment::{CaseEnvironment, Fault};
use crate::pool::SCENES;
use crate::surroundings::Permit;
use crate::verdict::ProcessEnd;
use std::collections::BTreeSet;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};

/// Names that the program uses, or might use.
const NAMES: [&str; 24] = [
    "cases",
    "cases/mine.csv",
    "fields",
    "fields/mine.h5",
    "stats",
    "stats/notes.txt",
    "statistics/a.csv",
    "contacts/a.h5",
    "trajectory/a.xyz",
    "force-chains/a.png",
    "report.html",
    "checkpoint-0000000000.bin",
    "checkpoint-0000000099.bin",
    "checkpoint-mine.bin",
    "trajectory.h5",
    "trajectory.xdmf",
    "observables.csv",
    "observables.h5",
    "scene.toml",
    "scene.toml.tmp",
    "trajectory.h5.tmp",
    "observables.csv.tmp",
    "manifest.jsonl.tmp",
    "thesis.txt",
];

/// Commands on the folder.
const COMMANDS: [&[&str]; 8] = [
    &["run", "plain.toml", "--out", "FOLDER"],
    &["run", "plain.toml", "--out", "FOLDER", "--force"],
    &["run", "plain.toml", "--out", "FOLDER", "--continue"],
    &["run", "inside.toml", "--force"],
    &["resume", "FOLDER", "--steps", "4"],
    &["stats", "FOLDER"],
    &["report", "FOLDER"],
    &["export", "FOLDER", "--to", "xyz"],
];

pub fn folders(lab: &mut CaseEnvironment) -> Result<ProcessEnd, Fault> {
    std::fs::create_dir(lab.folder.join("outside.d"))?;
    lab.write("outside.d/kept.txt", "kept")?;
    let text = SCENES[1].1;
    lab.write("plain.toml", text)?;
    let folder = *lab.one_of(&["plain", "plain", "plain", "out.d", "outside.d"]);
    let inside = format!("folder = \"outside.d/../{folder}\"");
    lab.write("inside.toml", text.replace("[output]", &format!("[output]\n{inside}")))?;
    let mut made = BTreeSet::new();
    if folder == "plain" {
        lab.copy_results("plain")?;
        made = listed(&lab.folder, folder);
        damage(lab, &mut made)?;
    }
    for _ in 0..lab.draw(1..4usize) {
        let name = *lab.one_of(&NAMES);
        plant(lab, &Path::new(folder).join(name))?;
    }
    let strange: BTreeSet<PathBuf> = crate::case_environment::files(&lab.folder.join(folder))
        .iter()
        .filter_map(|path| path.strip_prefix(&lab.folder).ok().map(Path::to_owned))
        .filter(|path| !made.contains(path))
        .collect();
    let mut end = ProcessEnd::Refused;
    for _ in 0..lab.draw(1..4usize) {
        let words = lab.one_of(&COMMANDS).iter().map(|word| if *word == "FOLDER" { folder } else { word });
        let words: Vec<&str> = words.collect();
        let permit = Permit { made: made.clone(), into: Some(folder.into()) };
        end = lab.run_within(&words, &permit)?;
        made.extend(listed(&lab.folder, folder).difference(&strange).cloned());
    }
    Ok(end)
}

/// The files and folders that the manifest of a folder lists, and the manifest itself.
fn listed(place: &Path, folder: &str) -> BTreeSet<PathBuf> {
    let manifest = place.join(folder).join("manifest.jsonl");
    let Ok(text) = std::fs::read_to_string(manifest) else { return BTreeSet::new() };
    let lines = text.lines().filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok());
    let names = lines.filter_map(|line| Some(line.get("file").or(line.get("folder"))?.as_str()?.to_owned()));
    names.chain(["manifest.jsonl".to_owned()]).map(|name| Path::new(folder).join(name)).collect()
}

/// Sometimes removes the scene, or lists a file outside of the folder in the manifest.
fn damage(lab: &mut CaseEnvironment, made: &mut BTreeSet<PathBuf>) -> Result<(), Fault> {
    match lab.draw(0..4) {
        0 => {
            std::fs::remove_file(lab.folder.join("plain/scene.toml"))?;
            made.remove(Path::new("plain/scene.toml"));
        }
        1 => {
            let path = lab.folder.join("plain/manifest.jsonl");
            let text = std::fs::read_to_string(&path)?;
            std::fs::write(&path, format!("{text}{{\"file\": \"../outside.d/kept.txt\"}}\n"))?;
        }
        _ => {}
    }
    Ok(())
}

/// Creates a file, a folder or a link where nothing exists.
fn plant(lab: &mut CaseEnvironment, name: &Path) -> Result<(), Fault> {
    let path = lab.folder.join(name);
    let Some(parent) = path.parent() else { return Ok(()) };
    if path.symlink_metadata().is_ok()
        || parent.exists() && !parent.is_dir()
        || std::fs::create_dir_all(parent).is_err()
    {
        return Ok(());
    }
    let outside = lab.folder.join("outside.d");
    match lab.draw(0..6) {
        0 => symlink(outside.join("kept.txt"), &path)?,
        1 => symlink(outside.join("new.txt"), &path)?,
        2 => symlink(&outside, &path)?,
        3 => {
            std::fs::create_dir(&path)?;
            std::fs::write(path.join("mine.txt"), "mine")?;
        }
        _ => std::fs::write(&path, "mine")?,
    }
    Ok(())
}
