//! Scenes that are read on the first rank.

use anyhow::Context;
use domain::Comm;
use io::{Scene, SceneError};
use std::path::Path;

/// Reads a scene on the first rank and shares it. Collective.
pub fn read(path: &Path, overrides: &[String], comm: &Comm) -> anyhow::Result<Scene> {
    let read = if comm.is_first() { read_here(path, overrides).map(Some) } else { Ok(None) };
    let read = comm.agree(read)?;
    let text = comm.broadcast_text(read.as_ref().map_or("", |scene| scene.text()));
    read.map_or_else(|| Scene::parse(&text, &path.display().to_string(), &[]).context("as the first rank sent it"), Ok)
}

fn read_here(path: &Path, overrides: &[String]) -> Result<Scene, SceneError> {
    if path != Path::new("-") {
        return Scene::read(path, overrides);
    }
    Scene::read_from(std::io::stdin(), "standard input", overrides)
}
