//! Results of runs: checkpoints, HDF5 files, tables, and their folders.

use super::change_bytes;
use crate::case_environment::{CaseEnvironment, Fault, files};
use crate::pool::SCENES;
use crate::verdict::ProcessEnd;
use crate::{checkpoint, hdf5_file, hostile, tree};
use proptest::prelude::*;
use proptest::sample::Index;
use std::path::Path;

/// Scenes whose runs leave checkpoints; the first ones are suspensions.
const RUNS: [&str; 8] = ["suspension", "plain", "direct", "positions", "disks", "poiseuille", "cell", "stepped-cell"];

pub fn checkpoint_bytes(lab: &mut CaseEnvironment) -> Result<ProcessEnd, Fault> {
    with_checkpoints(lab, |lab, good| Some(change_bytes(lab, good)))
}

pub fn checkpoint_numbers(lab: &mut CaseEnvironment) -> Result<ProcessEnd, Fault> {
    with_checkpoints(lab, |lab, good| {
        let header = if lab.draw(any::<bool>()) { lab.draw(tree::edits(lab.pool.keys)) } else { vec![] };
        let numbers = lab.draw(prop::collection::vec((any::<Index>(), hostile::number()), 0..3));
        checkpoint::changed(good, &checkpoint::Edits { header, numbers })
    })
}

/// Resumes a run whose only checkpoint was edited.
fn with_checkpoints(
    lab: &mut CaseEnvironment,
    change: impl Fn(&mut CaseEnvironment, &[u8]) -> Option<Vec<u8>>,
) -> Result<ProcessEnd, Fault> {
    let name = *lab.one_of(&RUNS);
    let folder = lab.copy_results(name)?;
    let mut checkpoints = files(&folder);
    checkpoints.retain(|path| path.extension().is_some_and(|extension| extension == "bin"));
    let Some(last) = checkpoints.pop() else { return Err(Fault::new("the run left no checkpoint")) };
    for other in &checkpoints {
        std::fs::remove_file(other)?;
    }
    let good = std::fs::read(&last)?;
    let changed = change(lab, &good).ok_or_else(|| Fault::new("checkpoints have another form now"))?;
    std::fs::write(&last, changed)?;
    lab.run(&["resume", name, "--steps", "5"])
}

pub fn hdf5(lab: &mut CaseEnvironment) -> Result<ProcessEnd, Fault> {
    with_results(
        lab,
        |lab, path| {
            let edits = lab.draw(hdf5_file::edits());
            Ok(hdf5_file::apply(path, &edits)?)
        },
        &["h5"],
    )
}

pub fn bytes(lab: &mut CaseEnvironment) -> Result<ProcessEnd, Fault> {
    with_results(
        lab,
        |lab, path| {
            let good = std::fs::read(path)?;
            Ok(std::fs::write(path, change_bytes(lab, &good))?)
        },
        &["h5", "csv", "toml", "xdmf"],
    )
}

/// Gives all commands on a folder of results in which one file was edited.
fn with_results(
    lab: &mut CaseEnvironment,
    change: impl Fn(&mut CaseEnvironment, &Path) -> Result<(), Fault>,
    extensions: &[&str],
) -> Result<ProcessEnd, Fault> {
    let name = lab.one_of(&SCENES).0;
    let folder = lab.copy_results(name)?;
    let mut candidates = files(&folder);
    candidates.retain(|path| path.extension().and_then(|e| e.to_str()).is_some_and(|e| extensions.contains(&e)));
    let path = lab.one_of(&candidates).clone();
    change(lab, &path)?;
    let file = path.strip_prefix(&lab.folder).unwrap_or(&path).to_string_lossy().into_owned();
    let mut end = lab.run(&["info", &file])?;
    if RUNS[..4].contains(&name) && file.contains("trajectory") {
        end = lab.run(&["stats", name])?;
        if end == ProcessEnd::Answered {
            lab.results_are_numbers(&format!("{name}/stats"))?;
        }
    }
    lab.run(&["report", name])?;
    let format = *lab.one_of(&["xyz", "gsd", "vtp"]);
    lab.run(&["export", name, "--to", format])?;
    lab.run(&["resume", name]).map(|resumed| if resumed == ProcessEnd::Answered { resumed } else { end })
}

pub fn folders(lab: &mut CaseEnvironment) -> Result<ProcessEnd, Fault> {
    let name = lab.one_of(&SCENES).0;
    let folder = lab.copy_results(name)?;
    let path = lab.one_of(&files(&folder)).clone();
    std::fs::remove_file(&path)?;
    match lab.draw(0..6) {
        0 => std::fs::create_dir(&path),
        1 => std::os::unix::fs::symlink(&path, &path),
        2 => std::fs::write(&path, ""),
        3 => std::fs::File::create(&path).and_then(|file| file.set_len(1 << 40)),
        4 => std::os::unix::fs::symlink("/dev/zero", &path),
        _ => Ok(()),
    }?;
    let file = path.strip_prefix(&lab.folder).unwrap_or(&path).to_string_lossy().into_owned();
    lab.run(&["info", &file])?;
    lab.run(&["stats", name])?;
    lab.run(&["report", name])?;
    lab.run(&["export", name, "--to", "xyz"])?;
    lab.run(&["check", &format!("{name}/scene.toml")])?;
    lab.run(&["resume", name])
}
