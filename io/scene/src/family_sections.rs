//! Sections of a scene file that make a family of it.

use crate::document::Node;
use toml::Table;

/// Names of the sections.
pub(crate) const SECTIONS: [&str; 2] = ["ensemble", "sweep"];

/// Whether a text has a section of families.
pub(crate) fn has_sections(text: &str) -> bool {
    // Long texts without either word are not read twice.
    let may_be = SECTIONS.iter().any(|section| text.contains(section));
    may_be && toml::from_str::<Table>(text).is_ok_and(|table| is_family(&table))
}

fn is_family(table: &Table) -> bool {
    SECTIONS.iter().any(|section| table.contains_key(*section))
}

/// Whether a key is in a section of families.
pub(crate) fn is_of_family(key: &str) -> bool {
    SECTIONS.iter().any(|section| key == *section || key.starts_with(&format!("{section}.")))
}

/// The section that makes a family of a document, if there is one.
pub(crate) fn section_of(document: &Node, text: &str) -> Option<&'static str> {
    let is_there = |section: &&&str| document.get(section).is_some();
    SECTIONS.iter().find(is_there).copied().filter(|_| has_sections(text))
}
