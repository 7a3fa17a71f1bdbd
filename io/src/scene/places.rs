//! The position of each key in the text of a scene.

use std::ops::Range;
use toml::de::{DeTable, DeValue, Error};

/// Every key of a TOML text by its path, such as `species[1].radius`, with its place in the text.
pub(super) struct Places {
    entries: Vec<Entry>,
}

struct Entry {
    path: String,
    key: Range<usize>,
    value: Range<usize>,
    text: Option<String>,
}

impl Places {
    pub(super) fn of(text: &str) -> Result<Self, Error> {
        let mut places = Self { entries: Vec::new() };
        places.add_table("", DeTable::parse(text)?.get_ref());
        Ok(places)
    }

    fn add_table(&mut self, parent: &str, table: &DeTable) {
        for (key, value) in table {
            let dot = if parent.is_empty() { "" } else { "." };
            let path = format!("{parent}{dot}{}", key.get_ref());
            self.add(&path, key.span(), (value.span(), value.get_ref()));
        }
    }

    fn add(&mut self, path: &str, key: Range<usize>, (span, value): (Range<usize>, &DeValue)) {
        let text = value.as_str().map(str::to_owned);
        self.entries.push(Entry { path: path.to_owned(), key, value: span, text });
        match value {
            DeValue::Table(table) => self.add_table(path, table),
            DeValue::Array(array) => {
                for (i, item) in array.iter().enumerate() {
                    self.add(&format!("{path}[{i}]"), item.span(), (item.span(), item.get_ref()));
                }
            }
            _ => {}
        }
    }

    /// The string that a key holds.
    pub(super) fn text_at(&self, path: &str) -> Option<String> {
        self.entries.iter().find(|e| e.path == path)?.text.clone()
    }

    /// The path of the innermost key whose name or value covers a place.
    pub(super) fn path_at(&self, place: &Range<usize>) -> Option<&str> {
        let covers = |span: &Range<usize>| span.start <= place.start && place.end <= span.end;
        let entry = self.entries.iter().rfind(|e| covers(&e.key) || covers(&e.value))?;
        Some(&entry.path)
    }

    /// Where a key stands, or the innermost of its parents that the text has.
    pub(super) fn find(&self, path: &str) -> Option<usize> {
        let mut wanted = path;
        loop {
            if let Some(entry) = self.entries.iter().find(|e| e.path == wanted) {
                return Some(entry.key.start);
            }
            wanted = &wanted[..wanted.rfind(['.', '['])?];
        }
    }
}

/// The number of the line, from 1, that a place in a text is on.
pub(super) fn line(text: &str, place: usize) -> usize {
    text.bytes().take(place).filter(|&b| b == b'\n').count() + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_have_places() {
        let text = "a = 1\n[b]\nc = [1, 2]\n[[d]]\ne = 'x'\n[[d]]\ne = 'y'\n";
        let places = Places::of(text).unwrap();
        assert_eq!(places.text_at("d[1].e").as_deref(), Some("y"));
        let line_of = |path: &str| places.find(path).map(|p| line(text, p));
        assert_eq!(line_of("b.c"), Some(3));
        assert_eq!(line_of("d[1].e"), Some(7));
        assert_eq!(line_of("b.missing"), line_of("b"), "the parent's");
        assert_eq!(line_of("missing"), None);
        let place = text.find('y').unwrap();
        assert_eq!(places.path_at(&(place..place + 1)), Some("d[1].e"));
    }
}
