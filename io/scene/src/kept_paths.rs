//! Absolute paths in the text of a scene, which hold wherever the text is stored.

use std::path::Path;
use toml::Value;
use toml::de::{DeTable, DeValue};

/// The text with `particles.path`, which is relative to a folder, made absolute, if that file exists; `None` if there
/// is nothing to change. The original path is kept in a comment if its line has room for one.
pub(super) fn with_absolute_paths(text: &str, folder: &Path) -> Option<String> {
    let document = DeTable::parse(text).ok()?;
    let DeValue::Table(particles) = document.get_ref().get("particles")?.get_ref() else { return None };
    let path = particles.get("path")?;
    let (written, span) = (path.get_ref().as_str()?, path.span());
    let absolute = std::fs::canonicalize(folder.join(written)).ok()?;
    let absolute = absolute.to_str().filter(|absolute| *absolute != written)?;
    let (before, after) = (&text[..span.start], &text[span.end..]);
    let has_room = after.lines().next().is_none_or(|rest| rest.trim().is_empty());
    let comment = if has_room { format!("  # was {}", &text[span]) } else { String::new() };
    Some(format!("{before}{}{comment}{after}", Value::String(absolute.to_owned())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_made_absolute_where_there_is_something() {
        let folder = tempfile::tempdir().unwrap();
        let home = std::fs::canonicalize(folder.path()).unwrap();
        std::fs::write(home.join("it's.csv"), "").unwrap();
        let absolute = home.join("it's.csv").display().to_string();
        let changed = |text: &str| with_absolute_paths(text, folder.path());
        let path =
            |text: &str| toml::from_str::<toml::Table>(text).unwrap()["particles"]["path"].as_str().map(str::to_owned);
        for text in [
            "[particles]\ninitial = \"file\"\npath = \"it's.csv\"\n[time]\nstep = 1\n",
            "particles = { path = \"./it's.csv\", initial = \"file\" }\n",
            "particles.path = \"it's.csv\"",
        ] {
            let kept = changed(text).unwrap();
            assert_eq!(path(&kept).as_deref(), Some(absolute.as_str()), "{kept}");
            assert_eq!(kept.contains("# was \"it's.csv\""), !text.contains('{'), "{kept}");
            assert_eq!(changed(&kept), None);
        }
        assert_eq!(changed("particles.path = \"missing.csv\""), None);
        assert_eq!(changed("title = \"a\""), None);
    }
}
