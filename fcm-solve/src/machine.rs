//! What evaluations cost on this machine: measured by `fcm-solve calibrate`, kept in the user's cache folder, and
//! written into the scenes that are run here, so that they are resumed anywhere by the same plan.

use crate::causes::in_full;
use crate::streams;
use anyhow::{Context, anyhow};
use domain::Comm;
use fcm::Costs;
use io::{Kind as SceneKind, Scene};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use suspension::benchmark::measured_costs;

/// The file in the cache folder.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Cached {
    stencils: f64,
    transforms: f64,
    pairs: f64,
}

/// Measures the costs, for a fraction of a second, and keeps them. Collective.
pub fn calibrate(comm: &Comm) -> anyhow::Result<()> {
    // Each rank by itself, as its share of a machine.
    let costs = measured_costs(&Comm::alone())?;
    let kept = if comm.is_first() { keep(costs) } else { Ok(PathBuf::new()) };
    let path = comm.agree(kept.map_err(|e| in_full(&e)))?;
    let Costs { stencils, transforms, pairs } = costs;
    let text = format!(
        "stencils   {stencils:.2}\ntransforms {transforms:.2}\npairs      {pairs:.2}\ntimes those of the machine that the \
         planner was made on; kept in {}\n",
        path.display()
    );
    streams::print(comm, &text)
}

fn keep(Costs { stencils, transforms, pairs }: Costs) -> anyhow::Result<PathBuf> {
    let path = file().context("there is no cache folder: neither XDG_CACHE_HOME nor HOME is set")?;
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).with_context(|| format!("can't make the folder {}", folder.display()))?;
    let text = serde_json::to_string_pretty(&Cached { stencils, transforms, pairs })?;
    io::replace_file(&path, text.as_bytes())?;
    Ok(path)
}

fn file() -> Option<PathBuf> {
    let folder = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let cache = folder("XDG_CACHE_HOME").or_else(|| folder("HOME").map(|home| home.join(".cache")))?;
    Some(cache.join("fcm-solve").join("costs.json"))
}

/// What was measured on the first rank's machine, or the planner's own costs. Collective.
pub fn costs(comm: &Comm) -> anyhow::Result<Costs> {
    let read = if comm.is_first() { kept() } else { Ok(None) };
    let kept = comm.agree(read.map_err(|e| in_full(&e)))?.unwrap_or_default();
    let mut values = vec![kept.stencils, kept.transforms, kept.pairs];
    comm.broadcast(&mut values);
    Ok(Costs { stencils: values[0], transforms: values[1], pairs: values[2] })
}

fn kept() -> anyhow::Result<Option<Costs>> {
    let Some(path) = file().filter(|path| path.exists()) else { return Ok(None) };
    let name = path.display();
    let damaged =
        |what: String| anyhow!("{name}: {what}; measure again with `fcm-solve calibrate`, or remove the file");
    let text = std::fs::read_to_string(&path).map_err(|e| damaged(e.to_string()))?;
    let Cached { stencils, transforms, pairs } = serde_json::from_str(&text).map_err(|e| damaged(e.to_string()))?;
    if ![stencils, transforms, pairs].iter().all(|factor| (0.01..=100.0).contains(factor)) {
        return Err(damaged("costs need to be between 0.01 and 100".to_owned()));
    }
    Ok(Some(Costs { stencils, transforms, pairs }))
}

/// A scene to be run here, with the costs of this machine if they were measured and it does not say otherwise.
/// Collective.
pub fn on_this_machine(scene: Scene, comm: &Comm) -> anyhow::Result<Scene> {
    let SceneKind::Suspension(checked) = scene.kind() else { return Ok(scene) };
    let costs = costs(comm)?;
    if checked.model.hydrodynamics.costs.is_some() || costs == Costs::default() {
        return Ok(scene);
    }
    let Costs { stencils, transforms, pairs } = costs;
    let key =
        format!("hydrodynamics.costs={{ stencils = {stencils:.3}, transforms = {transforms:.3}, pairs = {pairs:.3} }}");
    Ok(Scene::parse(scene.text(), "the scene with the costs of this machine", &[key])?)
}
