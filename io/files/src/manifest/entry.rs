//! Lines of a manifest, each a JSON object.

use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::path::{Component, Path};

/// First word of a manifest, which distinguishes it from files of other programs.
pub(super) const FORMAT: &str = "fcm-solve results";
/// Version of the layout.
const SCHEMA: u32 = 1;

/// A line.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum Entry {
    /// The first line.
    Manifest {
        /// [`FORMAT`].
        format: String,
        /// [`SCHEMA`].
        schema: u32,
        /// Name and version of the program that wrote it.
        program: String,
    },
    /// Checksum of the text of `scene.toml`; the last such line holds.
    Scene(String),
    /// Mark of a process that writes here, which identifies its temporary files.
    Writer(String),
    /// A folder, relative to that of the manifest.
    Folder(String),
    /// A file.
    File(String),
    /// A file that the program has removed.
    Removed(String),
}

impl Entry {
    pub(super) fn first() -> Self {
        let program = concat!("fcm-solve ", env!("CARGO_PKG_VERSION")).to_owned();
        Self::Manifest { format: FORMAT.to_owned(), schema: SCHEMA, program }
    }

    /// The line including its end.
    pub(super) fn line(&self) -> String {
        serde_json::to_string(self).expect("words and numbers are JSON") + "\n"
    }
}

/// The entries of a manifest, combined.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Entries {
    pub(super) files: BTreeSet<String>,
    pub(super) folders: BTreeSet<String>,
    pub(super) writers: BTreeSet<String>,
    pub(super) scene: Option<String>,
}

impl Entries {
    /// Parses the complete lines of a manifest; a last line without an end was cut short, and its file was not made.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        if !text.starts_with("{\"manifest\":") || !text.contains('\n') {
            return Err("it does not begin as a manifest of this program".to_owned());
        }
        let mut entries = Self::default();
        let whole = text.split_inclusive('\n').filter_map(|line| line.strip_suffix('\n'));
        for (number, line) in whole.enumerate() {
            let place = number + 1;
            let entry: Entry = serde_json::from_str(line).map_err(|e| format!("line {place}: {e}"))?;
            if (number == 0) != matches!(entry, Entry::Manifest { .. }) {
                return Err(format!("line {place} is not the line that stands there in a manifest"));
            }
            entries.take(entry).map_err(|reason| format!("line {place} {reason}"))?;
        }
        Ok(entries)
    }

    fn take(&mut self, entry: Entry) -> Result<(), String> {
        match entry {
            Entry::Manifest { format, schema, .. } if format == FORMAT && schema == SCHEMA => {}
            Entry::Manifest { format, schema, .. } => {
                return Err(format!(
                    "is of the format `{format}`, version {schema}; this program knows {FORMAT}, version {SCHEMA}"
                ));
            }
            Entry::Scene(digest) => self.scene = Some(digest),
            Entry::Writer(mark) => drop(self.writers.insert(mark)),
            Entry::Folder(name) => drop(self.folders.insert(inside(name)?)),
            Entry::File(name) => drop(self.files.insert(inside(name)?)),
            Entry::Removed(name) => drop(self.files.remove(&name)),
        }
        Ok(())
    }

    /// Text of the manifest with these entries.
    pub(super) fn text(&self) -> String {
        let scene = self.scene.iter().cloned().map(Entry::Scene);
        let writers = self.writers.iter().cloned().map(Entry::Writer);
        let folders = self.folders.iter().cloned().map(Entry::Folder);
        let files = self.files.iter().cloned().map(Entry::File);
        let rest = scene.chain(writers).chain(folders).chain(files);
        [Entry::first()].into_iter().chain(rest).map(|entry| entry.line()).collect()
    }
}

/// Accepts a name that stays inside the folder.
fn inside(name: String) -> Result<String, String> {
    let mut parts = Path::new(&name).components().peekable();
    let is_inside = parts.peek().is_some() && parts.all(|part| matches!(part, Component::Normal(_)));
    if is_inside { Ok(name) } else { Err(format!("names `{name}`, which is not in the folder of the manifest")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_read_as_they_were_written() {
        let mut entries = Entries { scene: Some("0f".to_owned()), ..Entries::default() };
        entries.files.extend(["trajectory.h5", "fields/velocity-0000000000.h5"].map(str::to_owned));
        entries.folders.insert("fields".to_owned());
        entries.writers.insert("12ab".to_owned());
        let text = entries.text();
        assert_eq!(Entries::parse(&text).unwrap(), entries);
        let torn = text.clone() + "{\"file\":\"obser";
        assert_eq!(Entries::parse(&torn).unwrap(), entries, "a line that was cut short names nothing");
        let removed = text + &Entry::Removed("trajectory.h5".to_owned()).line();
        assert!(!Entries::parse(&removed).unwrap().files.contains("trajectory.h5"));
    }

    #[test]
    fn names_that_lead_out_of_the_folder_are_refused() {
        for name in ["../x", "/etc/passwd", "fields/../../x", "", ".", "./x", "fields/.."] {
            for entry in [Entry::File(name.to_owned()), Entry::Folder(name.to_owned())] {
                let error = Entries::parse(&(Entry::first().line() + &entry.line())).unwrap_err();
                assert!(error.starts_with(&format!("line 2 names `{name}`")), "{error}");
            }
        }
    }

    #[test]
    fn files_of_others_are_no_manifests() {
        let other = Entry::first().line().replace("fcm-solve", "another program");
        for text in
            ["mine", "", "{\"name\": \"my app\"}\n", "{\"file\":\"a\"}\n", "[]\n", "\n", &other, "{\"manifest\":1}\n"]
        {
            assert!(Entries::parse(text).is_err(), "{text}");
        }
        let torn = Entry::first().line().trim_end().to_owned();
        assert!(Entries::parse(&torn).is_err(), "a manifest appears with its first line whole");
        let newer = Entry::Manifest { format: FORMAT.to_owned(), schema: 2, program: "fcm-solve 9".to_owned() };
        assert!(Entries::parse(&newer.line()).unwrap_err().contains("version 2"));
    }
}
