//! `fcm-solve info` of the folder of a family: its members and their states.

use anyhow::bail;
use files::SCENES;
use run::{FamilyFolder, MemberState};
use scene::SceneFile;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::Path;

/// The states of a family's members, in words and as JSON.
pub fn info(path: &Path) -> anyhow::Result<(String, Value)> {
    let SceneFile::Family(family) = SCENES.read_file(&path.join("scene.toml"), &[])? else {
        bail!("{} holds no family", path.display());
    };
    let folder = FamilyFolder::of(path);
    let mut states = Vec::new();
    for member in family.members() {
        states.push((member, folder.state(member, &family.scene(member)?)));
    }
    let count = |state: &str| states.iter().filter(|(_, other)| other.name() == state).count();
    let counts = MemberState::NAMES.iter().filter(|name| count(name) > 0).map(|name| format!("{} {name}", count(name)));
    let counts = counts.collect::<Vec<_>>().join(", ");
    let mut text = format!("family     {} runs at {} points: {counts}\n", states.len(), family.points().count());
    for (member, state) in &states {
        writeln!(text, "{member}: {state}").expect("text grows");
    }
    let values = states.iter().map(|(member, state)| {
        json!({
            "folder": member.folder(),
            "values": member.described(),
            "seed": member.seed,
            "state": state.name(),
            "step": if let MemberState::Stopped(step) = state { Some(step) } else { None },
            "error": if let MemberState::Failed(error) = state { Some(error) } else { None },
        })
    });
    Ok((text, json!({ "kind": "family", "members": values.collect::<Vec<_>>() })))
}
