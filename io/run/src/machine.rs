//! Measured costs of evaluations on this machine, and its network: stored in the user's cache folder, and written into
//! the scenes that are run here, so that they are resumed with the same plan on any machine.

use crate::RunError;
use domain::Comm;
use fcm::{ComputeDevice, Costs, Network};
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
    /// Costs on a card.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    card: Option<CachedCosts>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    network: Option<CachedNetwork>,
}

/// Costs of the parts of an evaluation over those that the planner expects.
#[derive(Debug, Serialize, Deserialize, Clone, Copy, PartialEq)]
#[serde(deny_unknown_fields)]
struct CachedCosts {
    stencils: f64,
    transforms: f64,
    pairs: f64,
}

impl From<Costs> for CachedCosts {
    fn from(Costs { stencils, transforms, pairs }: Costs) -> Self {
        Self { stencils, transforms, pairs }
    }
}

impl CachedCosts {
    fn numbers(self) -> [f64; 3] {
        [self.stencils, self.transforms, self.pairs]
    }
}

impl Cached {
    fn new(costs: Costs, card: Option<CachedCosts>, network: Option<CachedNetwork>) -> Self {
        let Costs { stencils, transforms, pairs } = costs;
        Self { stencils, transforms, pairs, card, network }
    }

    /// Costs on a device; those that the planner expects of a card that was not measured.
    fn costs_on(&self, device: ComputeDevice) -> CachedCosts {
        let &Self { stencils, transforms, pairs, .. } = self;
        match device {
            ComputeDevice::Cpu => CachedCosts { stencils, transforms, pairs },
            ComputeDevice::Gpu => self.card.unwrap_or(Costs::default().into()),
        }
    }
}

/// Bytes per second that a rank sends while all do, and seconds of a message.
#[derive(Serialize, Deserialize, Clone, Copy)]
#[serde(deny_unknown_fields)]
struct CachedNetwork {
    bandwidth: f64,
    latency: f64,
}

/// Stores measured costs, those of a card and the measured network, if there are any, in the user's cache folder; a
/// card and a network measured before are kept. Returns the path of the file.
pub fn keep_costs(costs: Costs, card: Option<Costs>, network: Option<Network>) -> Result<PathBuf, RunError> {
    let nowhere = || RunError::Refused("there is no cache folder: neither XDG_CACHE_HOME nor HOME is set".to_owned());
    let path = file().ok_or_else(nowhere)?;
    let folder = path.parent().unwrap_or(Path::new("."));
    let failed = |source| RunError::Folder { what: "make the folder", path: folder.to_owned(), source };
    std::fs::create_dir_all(folder).map_err(failed)?;
    let before = kept().ok().flatten();
    let (known, linked) = before.map_or((None, None), |cached| (cached.card, cached.network));
    let measured = network.map(|Network { bandwidth, latency, .. }| CachedNetwork { bandwidth, latency });
    let cached = Cached::new(costs, card.map(CachedCosts::from).or(known), measured.or(linked));
    let text = serde_json::to_string_pretty(&cached).expect("a few numbers");
    replace_file(&path, text.as_bytes())?;
    Ok(path)
}

fn file() -> Option<PathBuf> {
    let folder = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let cache = folder("XDG_CACHE_HOME").or_else(|| folder("HOME").map(|home| home.join(".cache")))?;
    Some(cache.join("fcm-solve").join("costs.json"))
}

/// The costs measured on a device of the first rank's machine, or the planner's default costs. Collective.
pub fn kept_costs(device: ComputeDevice, comm: &Comm) -> Result<Costs, RunError> {
    kept_on_first(device, comm).map(|(costs, _)| costs)
}

/// The costs on a device, and the network between the present ranks if it was measured. Collective.
fn kept_on_first(device: ComputeDevice, comm: &Comm) -> Result<(Costs, Option<Network>), RunError> {
    let read = if comm.is_first() { kept() } else { Ok(None) };
    let cached = comm.agree(read)?.unwrap_or_else(|| Cached::new(Costs::default(), None, None));
    let mut values = cached.costs_on(device).numbers().to_vec();
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
    let mut costs = [ComputeDevice::Cpu, ComputeDevice::Gpu].into_iter().flat_map(|on| cached.costs_on(on).numbers());
    if !costs.all(|factor| (0.01..=100.0).contains(&factor)) {
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
    let (costs, network) = kept_on_first(checked.model.hydrodynamics.device, comm)?;
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

    /// A file of a version before cards were measured, and one that has a card, as they are written and read.
    #[test]
    fn costs_are_those_of_the_device() {
        let text = r#"{"stencils": 2.5, "transforms": 0.5, "pairs": 1.5}"#;
        let known: Cached = serde_json::from_str(text).unwrap();
        let host = CachedCosts { stencils: 2.5, transforms: 0.5, pairs: 1.5 };
        assert_eq!(known.costs_on(ComputeDevice::Cpu), host);
        assert_eq!(known.costs_on(ComputeDevice::Gpu), Costs::default().into());
        let card = CachedCosts { stencils: 0.8, transforms: 1.25, pairs: 3.0 };
        let written = serde_json::to_string(&Cached { card: Some(card), ..known }).unwrap();
        let read: Cached = serde_json::from_str(&written).unwrap();
        assert_eq!([ComputeDevice::Cpu, ComputeDevice::Gpu].map(|device| read.costs_on(device)), [host, card]);
        assert!(serde_json::from_str::<Cached>(r#"{"stencils": 1, "transforms": 1, "pairs": 1, "cards": 1}"#).is_err());
    }
}
