//! Scenes, what `--set` makes of them, and the costs that they are planned with.

use super::{change_bytes, change_tree};
use crate::lab::{Fault, Lab};
use crate::pool::SCENES;
use crate::verdict::End;
use crate::{hostile, tree};
use proptest::prelude::*;

/// Checks a scene, and takes a step or two of one that passes.
pub fn check_and_run(lab: &mut Lab, more: &[&str]) -> Result<End, Fault> {
    if lab.ask(&[&["check", "scene.toml"], more].concat())? == End::Refused {
        return Ok(End::Refused);
    }
    let text = std::fs::read_to_string(lab.folder.join("scene.toml")).unwrap_or_default();
    let short: &[&str] = if text.contains("shear-cell-continuum") { &[] } else { &["--set", "time.steps=2"] };
    let end = lab.ask(&[&["run", "scene.toml", "--out", "out"], more, short].concat())?;
    if end == End::Answered {
        lab.tables_are_finite("out")?;
        if lab.draw(0..4) == 0 && lab.folder.join("out/trajectory.h5").exists() {
            lab.ask(&["info", "out/trajectory.h5"])?;
        }
    }
    Ok(end)
}

pub fn keys(lab: &mut Lab) -> Result<End, Fault> {
    let good = lab.one_of(&lab.pool.scenes).1.clone();
    let tree = change_tree(lab, good);
    lab.write("scene.toml", toml::to_string(&tree)?)?;
    check_and_run(lab, &[])
}

pub fn bytes(lab: &mut Lab) -> Result<End, Fault> {
    let good = lab.one_of(&SCENES).1;
    let bytes = change_bytes(lab, good.as_bytes());
    lab.write("scene.toml", bytes)?;
    check_and_run(lab, &[])
}

/// Sections of scenes, with items of lists.
const SECTIONS: [&str; 20] = [
    "",
    "box",
    "fluid",
    "species[0]",
    "species.1",
    "particles",
    "flow",
    "repulsion",
    "hydrodynamics",
    "time",
    "output",
    "statistics",
    "contact",
    "preparation",
    "cell",
    "grains",
    "walls",
    "top",
    "measure",
    "sweep",
];

pub fn overrides(lab: &mut Lab) -> Result<End, Fault> {
    let text = lab.one_of(&SCENES).1;
    lab.write("scene.toml", text)?;
    let keys = lab.pool.keys;
    let value = prop_oneof![
        4 => hostile::value().prop_map(|value| tree::to_json(&value)),
        4 => hostile::number().prop_map(|number| format!("{number:?}")),
        2 => hostile::word(),
    ];
    let item = (prop::sample::select(&SECTIONS[..]), prop::sample::select(keys), value);
    let items = lab.draw(prop::collection::vec(item, 1..3));
    let texts: Vec<String> = items
        .iter()
        .map(|(section, key, value)| {
            let dot = if section.is_empty() { "" } else { "." };
            format!("{section}{dot}{key}={}", value.replace('\0', ""))
        })
        .collect();
    let arguments: Vec<&str> = texts.iter().flat_map(|text| ["--set", text]).collect();
    check_and_run(lab, &arguments)
}

pub fn costs(lab: &mut Lab) -> Result<End, Fault> {
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
