//! Measured costs of evaluations on this machine, and its network: stored in the user's cache folder, and written into
//! the scenes that are run here, so that they are resumed with the same plan on any machine.

use crate::RunError;
use domain::Comm;
use fcm::{Costs, Network};
use files::replace_file;
use scene::{Kind, Scene};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use suspension::Hydrodynamics;

/// Content of the file in the cache folder.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Cached {
    stencils: f64,
    transforms: f64,
    pairs: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    network: Option<CachedNetwork>,
}

/// Bytes per second that a rank sends while all do, and seconds of a message.
#[derive(Serialize, Deserialize, Clone, Copy)]
#[serde(deny_unknown_fields)]
struct CachedNetwork {
    bandwidth: f64,
    latency: f64,
}

/// Stores measured costs and the measured network, if there is one, in the user's cache folder; a network measured
/// before is kept. Returns the path of the file.
pub fn keep_costs(costs: Costs, network: Option<Network>) -> Result<PathBuf, RunError> {
    let Costs { stencils, transforms, pairs } = costs;
    let nowhere = || RunError::Refused("there is no cache folder: neither XDG_CACHE_HOME nor HOME is set".to_owned());
    let path = file().ok_or_else(nowhere)?;
    let folder = path.parent().unwrap_or(Path::new("."));
    let failed = |source| RunError::Folder { what: "make the folder", path: folder.to_owned(), source };
    std::fs::create_dir_all(folder).map_err(failed)?;
    let before = || kept().ok().flatten().and_then(|cached| cached.network);
    let measured = network.map(|Network { bandwidth, latency, .. }| CachedNetwork { bandwidth, latency });
    let cached = Cached { stencils, transforms, pairs, network: measured.or_else(before) };
    let text = serde_json::to_string_pretty(&cached).expect("a few numbers");
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
    kept_on_first(comm).map(|(costs, _)| costs)
}

/// The costs, and the network between the present ranks if it was measured. Collective.
fn kept_on_first(comm: &Comm) -> Result<(Costs, Option<Network>), RunError> {
    let read = if comm.is_first() { kept() } else { Ok(None) };
    let cached = comm.agree(read)?;
    let Costs { stencils, transforms, pairs } = Costs::default();
    let cached = cached.unwrap_or(Cached { stencils, transforms, pairs, network: None });
    let mut values = vec![cached.stencils, cached.transforms, cached.pairs];
    values.extend(cached.network.iter().flat_map(|network| [network.bandwidth, network.latency]));
    comm.broadcast(&mut values);
    let network = values.get(3..5).map(|of| Network {
        ranks: comm.size(),
        threads: rayon::current_num_threads(),
        bandwidth: of[0],
        latency: of[1],
    });
    Ok((Costs { stencils: values[0], transforms: values[1], pairs: values[2] }, network))
}

fn kept() -> Result<Option<Cached>, String> {
    let Some(path) = file().filter(|path| path.exists()) else { return Ok(None) };
    let name = path.display();
    let damaged =
        |what: String| format!("{name}: {what}; measure again with `fcm-solve calibrate`, or remove the file");
    let text = std::fs::read_to_string(&path).map_err(|e| damaged(e.to_string()))?;
    let cached: Cached = serde_json::from_str(&text).map_err(|e| damaged(e.to_string()))?;
    if ![cached.stencils, cached.transforms, cached.pairs].iter().all(|factor| (0.01..=100.0).contains(factor)) {
        return Err(damaged("costs need to be between 0.01 and 100".to_owned()));
    }
    let is_network = |of: &CachedNetwork| (1e3..=1e15).contains(&of.bandwidth) && (0.0..=1.0).contains(&of.latency);
    if cached.network.is_some_and(|network| !is_network(&network)) {
        return Err(damaged("the network needs a bandwidth of 1e3 to 1e15 and a latency of 0 to 1".to_owned()));
    }
    Ok(Some(cached))
}

/// The scene with the costs of this machine, if these were measured and the scene has none, and with the network
/// between the machines of its ranks. Collective.
pub fn on_this_machine(scene: Scene, comm: &Comm) -> Result<Scene, RunError> {
    let Kind::Suspension(checked) = scene.kind() else { return Ok(scene) };
    let (costs, network) = kept_on_first(comm)?;
    let network = network.filter(|_| comm.spans_machines());
    let keys = keys(&checked.model.hydrodynamics, costs, network);
    if keys.is_empty() { Ok(scene) } else { Ok(scene.with("the costs of this machine", &keys)?) }
}

/// Keys of what was measured, unless the scene has them.
fn keys(chosen: &Hydrodynamics, costs: Costs, network: Option<Network>) -> Vec<String> {
    let mut keys = Vec::new();
    if chosen.costs.is_none() && costs != Costs::default() {
        let Costs { stencils, transforms, pairs } = costs;
        let numbers = format!("stencils = {stencils:.3}, transforms = {transforms:.3}, pairs = {pairs:.3}");
        keys.push(format!("hydrodynamics.costs={{ {numbers} }}"));
    }
    if let Some(Network { ranks, threads, bandwidth, latency }) = network.filter(|_| chosen.network.is_none()) {
        let numbers =
            format!("ranks = {ranks}, threads = {threads}, bandwidth = {bandwidth:.3e}, latency = {latency:.2e}");
        keys.push(format!("hydrodynamics.network={{ {numbers} }}"));
    }
    keys
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_measured_is_written_unless_the_scene_says_it() {
        let network = Network { ranks: 64, threads: 2, bandwidth: 2.5e8, latency: 1.5e-6 };
        let costs = Costs { stencils: 1.2, ..Costs::default() };
        let none = Hydrodynamics::default();
        assert!(keys(&none, Costs::default(), None).is_empty());
        let both = keys(&none, costs, Some(network));
        assert_eq!(both[0], "hydrodynamics.costs={ stencils = 1.200, transforms = 1.000, pairs = 1.000 }");
        let expected = "hydrodynamics.network={ ranks = 64, threads = 2, bandwidth = 2.500e8, latency = 1.50e-6 }";
        assert_eq!(both[1..], [expected]);
        let set = Hydrodynamics { network: Some(network), costs: Some([1.0; 3]), ..none };
        assert!(keys(&set, costs, Some(Network { ranks: 8, ..network })).is_empty());
    }
}
