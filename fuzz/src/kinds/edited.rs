//! Results with a scene that was edited before they are resumed.

use crate::case_environment::{CaseEnvironment, Fault};
use crate::misfit;
use crate::surroundings::Permit;
use crate::tree::{self, TreeStep};
use crate::verdict::ProcessEnd;
use toml::Value;

/// Runs of scenes with one or several species, of disks, and of grains.
const RUNS: [&str; 6] = ["suspension", "plain", "direct", "positions", "cell", "poiseuille"];

/// Keys that may be changed when a run is resumed, according to the page on scenes.
const MAY_CHANGE: [&str; 11] = [
    "title",
    "time.steps",
    "time.duration",
    "time.strain",
    "output.folder",
    "output.trajectory_every",
    "output.observables_every",
    "output.checkpoint_every",
    "output.fields_every",
    "output.contacts_every",
    "hydrodynamics.costs",
];

fn may_change(path: &str) -> bool {
    MAY_CHANGE.iter().any(|key| path.starts_with(key)) || path.starts_with("statistics")
}

pub fn scenes(lab: &mut CaseEnvironment) -> Result<ProcessEnd, Fault> {
    let name = *lab.one_of(&RUNS);
    let folder = lab.copy_results(name)?;
    let scene = folder.join("scene.toml");
    let mut tree: Value = toml::from_str(&std::fs::read_to_string(&scene)?)?;
    let mut places = tree::places(&tree);
    places.retain(|place| matches!(tree::find(&mut tree, place), Some(Value::Float(_) | Value::Integer(_))));
    let at = lab.one_of(&places).clone();
    let factor = *lab.one_of(&[0.5, 0.9, 1.1, 2.0, 3.0, -1.0]);
    if !scale(&mut tree, &at, factor) {
        return Ok(ProcessEnd::Refused);
    }
    std::fs::write(&scene, toml::to_string(&tree)?)?;
    let command = ["resume", name, "--steps", "3"];
    if may_change(&tree::path(&at)) {
        return lab.run(&command);
    }
    let before = lab.run_within(&["check", &format!("{name}/scene.toml")], &Permit::default())?;
    let word = if before == ProcessEnd::Refused { "" } else { misfit::key(&at) };
    match lab.run_within(&command, &Permit::default())? {
        ProcessEnd::Refused if lab.stderr().contains(word) => Ok(ProcessEnd::Refused),
        ProcessEnd::Refused => Err(lab.fault_of(&command, &format!("an error that does not name {word}"))),
        _ => Err(lab.fault_of(&command, &format!("it goes on with another {}", tree::path(&at)))),
    }
}

/// Multiplies a number; returns whether it has changed.
fn scale(tree: &mut Value, at: &[TreeStep], factor: f64) -> bool {
    match tree::find(tree, at) {
        Some(Value::Float(number)) if *number != 0.0 => *number *= factor,
        Some(Value::Float(number)) => *number = 0.25,
        Some(Value::Integer(number)) => *number += 1,
        _ => return false,
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_keys_that_are_listed_may_change() {
        for path in ["title", "time.steps", "statistics.every", "output.fields_every"] {
            assert!(may_change(path), "{path}");
        }
        for path in ["time.step", "fluid.viscosity", "box.edges[0]", "species[0].count", "flow.rate"] {
            assert!(!may_change(path), "{path}");
        }
    }

    #[test]
    fn numbers_are_changed() {
        let mut tree: Value = toml::from_str("a = [0.0, 2.0]\nb = 3\n").unwrap();
        for place in tree::places(&tree) {
            let is_number = matches!(tree::find(&mut tree, &place), Some(Value::Float(_) | Value::Integer(_)));
            let before = tree.clone();
            assert_eq!(scale(&mut tree, &place, 0.5), is_number);
            assert_eq!(tree != before, is_number);
        }
    }
}
