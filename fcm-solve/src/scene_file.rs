//! Reading scene files on the first rank.

use crate::causes::in_full;
use crate::streams;
use anyhow::{Context, bail, ensure};
use domain::Comm;
use files::SCENES;
use scene::{Scene, SceneError, SceneFile};
use std::path::Path;

/// Reads a scene on the first rank and shares it. Collective.
pub fn read(path: &Path, overrides: &[String], comm: &Comm) -> anyhow::Result<Scene> {
    match read_any(path, overrides, comm)? {
        SceneFile::Scene(scene) => Ok(*scene),
        SceneFile::Family(_) => bail!("{} is a family of runs; name one of its runs", path.display()),
    }
}

/// Reads a scene file on the first rank. A scene is sent to the other ranks; a family of scenes stays on the first rank
/// and needs a run on a single rank. Collective.
pub fn read_any(path: &Path, overrides: &[String], comm: &Comm) -> anyhow::Result<SceneFile> {
    let read = if comm.is_first() { read_here(path, overrides, comm).map(Some) } else { Ok(None) };
    let read = comm.agree(read.map_err(|e| in_full(&e)))?;
    let text = comm.broadcast_text(match &read {
        Some(SceneFile::Scene(scene)) => scene.text(),
        _ => "",
    });
    let shared = || SCENES.parse(&text, &path.display().to_string(), &[]).context("as the first rank sent it");
    read.map_or_else(|| Ok(SceneFile::Scene(Box::new(shared()?))), Ok)
}

fn read_here(path: &Path, overrides: &[String], comm: &Comm) -> anyhow::Result<SceneFile> {
    let file = any_of(path, overrides)?;
    if let SceneFile::Family(family) = &file {
        ensure!(
            comm.size() == 1,
            "{} is a family of {} runs, which one process makes side by side on its cores: start it without mpirun, \
             or as one task with many cores; on several machines start a --part K/N on each",
            path.display(),
            family.members().len()
        );
    }
    let warnings = match &file {
        SceneFile::Scene(scene) => scene.warnings(),
        SceneFile::Family(family) => family.warnings(),
    };
    for warning in warnings {
        streams::log(format_args!("warning: {warning}"));
    }
    Ok(file)
}

fn any_of(path: &Path, overrides: &[String]) -> Result<SceneFile, SceneError> {
    if path != Path::new("-") {
        return SCENES.read_file(path, overrides);
    }
    SCENES.read_file_from(std::io::stdin(), "standard input", overrides)
}
