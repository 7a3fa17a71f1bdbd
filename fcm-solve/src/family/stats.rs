//! `fcm-solve stats` of the folder of a family: means over the seeds.

use crate::streams::json;
use anyhow::bail;
use domain::Number;
use files::SCENES;
use run::FamilyFolder;
use scene::SceneFile;
use std::fmt::Write as _;
use std::path::Path;

/// Writes the table of a family anew, and returns it in words or as JSON.
pub fn stats(path: &Path, as_json: bool) -> anyhow::Result<String> {
    let SceneFile::Family(family) = SCENES.read_file(&path.join("scene.toml"), &[])? else {
        bail!("{} holds no family", path.display());
    };
    let folder = FamilyFolder::of(path);
    folder.write_table(&family)?;
    let table = folder.table(&family)?;
    if as_json {
        return Ok(json(&table.to_json()));
    }
    let mut text = String::new();
    for (words, numbers) in &table.rows {
        let [point, values, quantity, species, verdicts, unit] = &words[..] else { continue };
        let [.., mean, error, seeds, _, claimed, _] = numbers[..] else { continue };
        let has_value = mean.is_finite();
        let [mean, error, claimed] = [mean, error, claimed].map(Number);
        let of = [values.as_str(), species]
            .into_iter()
            .filter(|words| !["", "all"].contains(words))
            .collect::<Vec<_>>()
            .join(", ");
        let about =
            if seeds > 1.0 { format!("{seeds} seeds, of which each claims {claimed:.2}; ") } else { String::new() };
        let value = if has_value { format!("{mean:.5} +- {error:.2} {unit}") } else { "has no value".to_owned() };
        writeln!(text, "{point} {of}: {quantity} {value} ({about}{verdicts})").expect("text grows");
    }
    writeln!(text, "table      {}", path.join("family.csv").display()).expect("text grows");
    Ok(text)
}
