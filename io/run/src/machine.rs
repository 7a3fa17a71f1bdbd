//! Measured costs of evaluations on this machine: stored in the user's cache folder, and written into the scenes that
//! are run here, so that they are resumed with the same plan on any machine.

use crate::RunError;
use domain::Comm;
use fcm::Costs;
use files::replace_file;
use scene::{Kind, Scene};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Content of the file in the cache folder.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Cached {
    stencils: f64,
    transforms: f64,
    pairs: f64,
}

/// Stores measured costs in the user's cache folder; returns the path of the file.
pub fn keep_costs(Costs { stencils, transforms, pairs }: Costs) -> Result<PathBuf, RunError> {
    let nowhere = || RunError::Refused("there is no cache folder: neither XDG_CACHE_HOME nor HOME is set".to_owned());
    let path = file().ok_or_else(nowhere)?;
    let folder = path.parent().unwrap_or(Path::new("."));
    let failed = |source| RunError::Folder { what: "make the folder", path: folder.to_owned(), source };
    std::fs::create_dir_all(folder).map_err(failed)?;
    let text = serde_json::to_string_pretty(&Cached { stencils, transforms, pairs }).expect("three numbers");
    replace_file(&path, text.as_bytes())?;
    Ok(path)
}

fn file() -> Option<PathBuf> {
    let folder = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let cache = folder("XDG_CACHE_HOME").or_else(|| folder("HOME").map(|home| home.join(".cache")))?;
    Some(cache.join("fcm-solve").join("costs.json"))
}

/// The costs measured on the first rank's machine, or the planner's default costs. Collective.
pub fn kept_costs(comm: &Comm) -> Result<Costs, RunError> {
    let read = if comm.is_first() { kept() } else { Ok(None) };
    let kept = comm.agree(read)?.unwrap_or_default();
    let mut values = vec![kept.stencils, kept.transforms, kept.pairs];
    comm.broadcast(&mut values);
    Ok(Costs { stencils: values[0], transforms: values[1], pairs: values[2] })
}

fn kept() -> Result<Option<Costs>, String> {
    let Some(path) = file().filter(|path| path.exists()) else { return Ok(None) };
    let name = path.display();
    let damaged =
        |what: String| format!("{name}: {what}; measure again with `fcm-solve calibrate`, or remove the file");
    let text = std::fs::read_to_string(&path).map_err(|e| damaged(e.to_string()))?;
    let Cached { stencils, transforms, pairs } = serde_json::from_str(&text).map_err(|e| damaged(e.to_string()))?;
    if ![stencils, transforms, pairs].iter().all(|factor| (0.01..=100.0).contains(factor)) {
        return Err(damaged("costs need to be between 0.01 and 100".to_owned()));
    }
    Ok(Some(Costs { stencils, transforms, pairs }))
}

/// The scene with the costs of this machine, if these were measured and the scene has none. Collective.
pub fn on_this_machine(scene: Scene, comm: &Comm) -> Result<Scene, RunError> {
    let Kind::Suspension(checked) = scene.kind() else { return Ok(scene) };
    let costs = kept_costs(comm)?;
    if checked.model.hydrodynamics.costs.is_some() || costs == Costs::default() {
        return Ok(scene);
    }
    let Costs { stencils, transforms, pairs } = costs;
    let key =
        format!("hydrodynamics.costs={{ stencils = {stencils:.3}, transforms = {transforms:.3}, pairs = {pairs:.3} }}");
    Ok(scene.with("the costs of this machine", &[key])?)
}
