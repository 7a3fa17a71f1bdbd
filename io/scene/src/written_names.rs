//! Names of former versions in a scene as its author wrote it: warnings, and messages about keys by the written name.

use crate::document::{Node, Value};
use crate::former_names::{FORMER_KEYS, FORMER_WORDS, FormerKey, FormerWord, bring_up_to_date, kind_of, present_key};
use crate::key_error::KeyError;
use crate::overrides::{self, is_in};

/// The former names in a scene as its author wrote it.
#[derive(Debug, Clone, Default)]
pub(crate) struct FormerNames {
    /// Keys as they are written, such as `contacts.settling`, and their present names.
    keys: Vec<[String; 2]>,
    warnings: Vec<String>,
}

impl FormerNames {
    /// Former names in a document and in keys that are set, each `key=value`. `Err` if the document has a key by both
    /// of its names.
    pub(crate) fn of(document: &Node, overrides: &[String]) -> Result<Self, KeyError> {
        let (kind, mut found) = (kind_of(document), Self::default());
        for FormerKey { section, former, present, .. } in FORMER_KEYS.iter().filter(|one| one.kind == kind) {
            for (prefix, entries) in sections(document, section) {
                if entries.get(former).is_none() {
                    continue;
                }
                let [former, now] = [former, present].map(|name| format!("{prefix}.{name}"));
                if entries.get(present).is_some() {
                    let message = format!("is the former name of {now}, which is set too; leave one of them out");
                    return Err(KeyError::new(former, message));
                }
                found.note_key(former, now);
            }
        }
        for FormerWord { section, key, former, present, .. } in FORMER_WORDS.iter().filter(|one| one.kind == kind) {
            for (prefix, entries) in sections(document, section) {
                if entries.get(key).and_then(Node::text) == Some(former) {
                    found.note_word(&format!("{prefix}.{key}"), [former, present]);
                }
            }
        }
        for set in overrides {
            found.note_set(kind, set);
        }
        Ok(found)
    }

    /// Notes the names in a key that is set.
    fn note_set(&mut self, kind: &str, set: &str) {
        let (key, value) = (overrides::key_of(set), set.split_once('=').map_or("", |(_, value)| value));
        self.keys.retain(|[_, present]| *present != key);
        let now = present_key(kind, &key);
        if now != key {
            self.note_key(key.clone(), now);
        }
        let word = value.trim().trim_matches(['"', '\'']);
        let of_key = |one: &&FormerWord| one.kind == kind && format!("{}.{}", one.section, one.key) == key;
        if let Some(found) = FORMER_WORDS.iter().filter(of_key).find(|one| one.former == word) {
            self.note_word(&key, [found.former, found.present]);
        }
    }

    fn note_key(&mut self, former: String, present: String) {
        self.warn(format!("{former} has another name now: {present}"));
        self.keys.push([former, present]);
    }

    fn note_word(&mut self, key: &str, [former, present]: [&str; 2]) {
        self.warn(format!("{key} = \"{former}\" has another name now: \"{present}\""));
    }

    fn warn(&mut self, warning: String) {
        if !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }

    /// The document with the present names; `None` if it has no others.
    pub(crate) fn renamed(&self, document: &Node) -> Option<Node> {
        if self.warnings.is_empty() {
            return None;
        }
        let mut renamed = document.clone();
        bring_up_to_date(&mut renamed);
        Some(renamed)
    }

    /// A warning for each name.
    pub(crate) fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// The name of a key as it is written.
    pub(crate) fn as_written(&self, key: &str) -> String {
        let found = self.keys.iter().find(|[_, present]| is_in(key, present));
        found.map_or_else(|| key.to_owned(), |[former, present]| format!("{former}{}", &key[present.len()..]))
    }
}

/// Sections of a document at a path, with their keys: each item of a list of sections.
fn sections<'a>(document: &'a Node, path: &str) -> Vec<(String, &'a Node)> {
    let mut found = vec![(String::new(), document)];
    for name in path.split('.') {
        let inner = |(prefix, node): (String, &'a Node)| {
            let key = if prefix.is_empty() { name.to_owned() } else { format!("{prefix}.{name}") };
            match node.get(name) {
                None => Vec::new(),
                Some(Node { value: Value::List(items), .. }) => {
                    items.iter().enumerate().map(|(index, item)| (format!("{key}[{index}]"), item)).collect()
                }
                Some(section) => vec![(key, section)],
            }
        };
        found = found.into_iter().flat_map(inner).collect();
    }
    found
}

#[cfg(test)]
mod tests;
