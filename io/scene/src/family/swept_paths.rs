//! Swept paths that hold wherever the text of a family is kept.

use std::path::Path;
use toml::{Table, Value};

/// The text with the swept values of `particles.path`, which are relative to a folder, made absolute where such a file
/// exists; the text itself if there is nothing to change, else without comments.
pub(super) fn with_absolute_paths(text: String, folder: &Path) -> String {
    let Ok(mut table) = toml::from_str::<Table>(&text) else { return text };
    let changes = table.get_mut("sweep").is_some_and(|sweep| make_absolute(sweep, "", folder));
    if changes { toml::to_string(&table).unwrap_or(text) } else { text }
}

/// Whether anything was changed.
fn make_absolute(value: &mut Value, key: &str, folder: &Path) -> bool {
    match value {
        Value::Table(table) => {
            let changed = table.iter_mut().map(|(name, inner)| {
                let key = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
                make_absolute(inner, &key, folder)
            });
            changed.filter(|changed| *changed).count() > 0
        }
        Value::Array(items) => {
            items.iter_mut().map(|item| make_absolute(item, key, folder)).filter(|changed| *changed).count() > 0
        }
        Value::String(path) if key == "particles.path" => {
            let absolute = std::fs::canonicalize(folder.join(&*path)).ok();
            match absolute.as_deref().and_then(Path::to_str).filter(|absolute| *absolute != path) {
                Some(absolute) => {
                    *path = absolute.to_owned();
                    true
                }
                None => false,
            }
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn swept_paths_are_made_absolute_where_there_is_something() {
        let folder = tempfile::tempdir().unwrap();
        let home = std::fs::canonicalize(folder.path()).unwrap();
        std::fs::write(home.join("a.csv"), "").unwrap();
        let absolute = home.join("a.csv").display().to_string();
        for text in [
            "[sweep]\n\"particles.path\" = [\"a.csv\", \"none.csv\"]\n",
            "[sweep]\nparticles.path = [\"./a.csv\", \"none.csv\"]\n",
            "[[sweep]]\n\"particles.path\" = \"a.csv\"\n[[sweep]]\nparticles.path = \"none.csv\"\n",
        ] {
            let changed = with_absolute_paths(text.to_owned(), &home);
            assert!(changed.contains(&absolute) && changed.contains("\"none.csv\""), "{changed}");
            assert_eq!(with_absolute_paths(changed.clone(), &home), changed);
        }
        let other = "[sweep] # as it is\ntitle = [\"a.csv\"]\n";
        assert_eq!(with_absolute_paths(other.to_owned(), &home), other);
    }
}
