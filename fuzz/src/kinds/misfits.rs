//! Lists and tables of scenes and cases with a wrong length or type. All of them must be refused by key.

use crate::case_environment::{CaseEnvironment, Fault};
use crate::pool::SCENES;
use crate::verdict::ProcessEnd;
use crate::{hdf5_file, misfit, tree};
use proptest::prelude::*;
use toml::Value;

/// Keys with lists that the valid scenes lack, for the scene with given positions.
const MORE: &str = "[[bonds]]\npairs = [[0, 1]]\nstiffness = 10.0\n[flow]\nkind = 'shear'\n\
    rate = [[0.0, 1.0], [0.1, -0.5]]\n[gravity]\nacceleration = [0.0, 0.0, -1.0]\n\
    [repulsion]\nstrength = 1.0\n[[traps]]\nparticles = [0]\nstiffness = 1.0\n";

pub fn scenes(lab: &mut CaseEnvironment) -> Result<ProcessEnd, Fault> {
    let place = lab.draw(0..=SCENES.len());
    let text = SCENES.get(place).map_or_else(with_more_lists, |(_, text)| (*text).to_owned());
    let good = toml::from_str(&text)?;
    let (tree, at) = changed(lab, &good);
    let Some(at) = at else { return Ok(ProcessEnd::Refused) };
    let key = misfit::key(&at).to_owned();
    let name = tree::path(&at);
    if lab.draw(any::<bool>()) && !name.contains('[') {
        let mut tree = tree;
        let value = tree::find(&mut tree, &at).map_or(String::new(), |value| value.to_string());
        lab.write("scene.toml", text)?;
        return refused(lab, &["--set", &format!("{name}={value}")], &key);
    }
    lab.write("scene.toml", toml::to_string(&tree)?)?;
    refused(lab, &[], &key)
}

fn with_more_lists() -> String {
    SCENES[3].1.replace("[hydrodynamics]", &format!("{MORE}[hydrodynamics]"))
}

/// Requires that both `check` and `run` refuse the scene.
fn refused(lab: &CaseEnvironment, more: &[&str], key: &str) -> Result<ProcessEnd, Fault> {
    lab.run_refused(&[&["check", "scene.toml"], more].concat(), key)?;
    lab.run_refused(&[&["run", "scene.toml", "--out", "out"], more].concat(), key)
}

pub fn cases(lab: &mut CaseEnvironment) -> Result<ProcessEnd, Fault> {
    let good = lab.one_of(&lab.pool.cases).clone();
    let (tree, at) = changed(lab, &good);
    let Some(at) = at else { return Ok(ProcessEnd::Refused) };
    let key = misfit::key(&at).to_owned();
    if lab.draw(any::<bool>()) {
        lab.write("case.json", tree::to_json(&tree))?;
        return lab.run_refused(&["mobility", "case.json"], &key);
    }
    hdf5_file::write_tree(&lab.folder.join("case.h5"), &tree)?;
    lab.run_refused(&["mobility", "case.h5"], &key)
}

fn changed(lab: &mut CaseEnvironment, good: &Value) -> (Value, Option<Vec<tree::TreeStep>>) {
    let misfit = lab.draw(misfit::any_misfit());
    let candidates = misfit::candidates(good, misfit);
    let mut tree = good.clone();
    if candidates.is_empty() {
        return (tree, None);
    }
    let at = lab.one_of(&candidates).clone();
    misfit::apply(&mut tree, &at, misfit);
    (tree, Some(at))
}
