//! Scenes, changes of them by `--set`, and the costs with which they are planned.

use super::{change_bytes, change_tree};
use crate::case_environment::{CaseEnvironment, Fault};
use crate::pool::SCENES;
use crate::verdict::ProcessEnd;
use crate::{hostile, tree};
use proptest::prelude::*;

/// Checks a scene, and takes a step or two if it is accepted.
pub fn check_and_run(lab: &mut CaseEnvironment, more: &[&str]) -> Result<ProcessEnd, Fault> {
    if lab.run(&[&["check", "scene.toml"], more].concat())? == ProcessEnd::Refused {
        return Ok(ProcessEnd::Refused);
    }
    let text = std::fs::read_to_string(lab.folder.join("scene.toml")).unwrap_or_default();
    let short: &[&str] = if text.contains("shear-cell-continuum") { &[] } else { &["--set", "time.steps=2"] };
    let end = lab.run(&[&["run", "scene.toml", "--out", "out"], more, short].concat())?;
    if end == ProcessEnd::Answered {
        lab.results_are_numbers("out")?;
        if lab.draw(0..4) == 0 && lab.folder.join("out/trajectory.h5").exists() {
            lab.run(&["info", "out/trajectory.h5"])?;
        }
    }
    Ok(end)
}

pub fn keys(lab: &mut CaseEnvironment) -> Result<ProcessEnd, Fault> {
    let good = lab.one_of(&lab.pool.scenes).1.clone();
    let tree = change_tree(lab, good);
    lab.write("scene.toml", toml::to_string(&tree)?)?;
    check_and_run(lab, &[])
}

pub fn bytes(lab: &mut CaseEnvironment) -> Result<ProcessEnd, Fault> {
    let good = lab.one_of(&SCENES).1;
    let bytes = change_bytes(lab, good.as_bytes());
    lab.write("scene.toml", bytes)?;
    check_and_run(lab, &[])
}

/// Sets one or two keys of a scene: half of the time keys that it has, otherwise other keys of its
/// sections, and sometimes any key.
pub fn overrides(lab: &mut CaseEnvironment) -> Result<ProcessEnd, Fault> {
    let (name, tree) = lab.one_of(&lab.pool.scenes).clone();
    let text = SCENES.iter().find(|scene| scene.0 == name).map_or("", |(_, text)| text);
    lab.write("scene.toml", text)?;
    let texts: Vec<String> = (0..lab.draw(1..3)).map(|_| set(lab, &tree)).collect();
    let arguments: Vec<&str> = texts.iter().flat_map(|text| ["--set", text]).collect();
    check_and_run(lab, &arguments)
}

fn set(lab: &mut CaseEnvironment, tree: &toml::Value) -> String {
    let own = tree::paths(tree);
    let path = lab.one_of(&own).clone();
    let section = path.rsplit_once('.').map_or("", |(section, _)| section);
    let siblings: Vec<String> = lab.pool.siblings(section);
    let path = match lab.draw(0..8) {
        0 => format!("{section}.{}", lab.one_of(lab.pool.keys)),
        1..4 if !siblings.is_empty() => lab.one_of(&siblings).clone(),
        _ => path,
    };
    let value = lab.draw(prop_oneof![
        3 => hostile::value().prop_map(|value| tree::to_json(&value)),
        6 => hostile::number().prop_map(|number| format!("{number:?}")),
        3 => hostile::whole().prop_map(|number| number.to_string()),
        1 => hostile::word(),
    ]);
    format!("{path}={}", value.replace('\0', ""))
}

pub fn costs(lab: &mut CaseEnvironment) -> Result<ProcessEnd, Fault> {
    let good = r#"{"stencils": 1.5, "transforms": 0.5, "pairs": 2.0}"#;
    let text = if lab.draw(any::<bool>()) {
        change_bytes(lab, good.as_bytes())
    } else {
        tree::to_json(&change_tree(lab, serde_json::from_str(good)?)).into_bytes()
    };
    std::fs::create_dir(lab.folder.join("fcm-solve"))?;
    lab.write("fcm-solve/costs.json", text)?;
    lab.write("scene.toml", SCENES[1].1)?;
    check_and_run(lab, &[])
}
