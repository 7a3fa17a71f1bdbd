//! Errors of values that differ from the expected form, in words.

use super::{excerpt, known};
use serde::de::{Error, Expected, Unexpected};
use std::fmt::Display;

/// A value that differs from the expected form.
#[derive(Debug, Clone, PartialEq)]
pub struct TypeMismatch {
    /// Path to the value, innermost step first.
    steps: Vec<PathStep>,
    problem: Mismatch,
}

/// A step of a path, from a value to one inside it.
#[derive(Debug, Clone, PartialEq)]
enum PathStep {
    Key(Box<str>),
    Item(usize),
}

#[derive(Debug, Clone, PartialEq)]
enum Mismatch {
    Missing(&'static str),
    UnknownKey { key: String, known: &'static [&'static str] },
    UnknownWord { word: String, known: &'static [&'static str] },
    Type { found: String, expected: String },
    Other(String),
}

impl TypeMismatch {
    /// A value of the wrong type.
    pub(super) fn of_type(found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::of(Mismatch::Type { found: found.into(), expected: expected.into() })
    }

    fn of(problem: Mismatch) -> Self {
        Self { steps: Vec::new(), problem }
    }

    /// The same error, for a value under a key of a section.
    pub(super) fn in_key(mut self, key: &str) -> Self {
        self.steps.push(PathStep::Key(key.into()));
        self
    }

    /// The same error, for an item of a list.
    pub(super) fn in_item(mut self, index: usize) -> Self {
        self.steps.push(PathStep::Item(index));
        self
    }

    /// Outermost key.
    pub fn first_key(&self) -> Option<&str> {
        match self.steps.last() {
            Some(PathStep::Key(key)) => Some(key),
            _ => None,
        }
    }

    /// The key, such as `species[0].radius`; empty for the whole document.
    pub fn key(&self) -> String {
        let inner = match &self.problem {
            Mismatch::Missing(key) => Some(*key),
            Mismatch::UnknownKey { key, .. } => Some(key.as_str()),
            _ => None,
        };
        let outer = self.steps.iter().rev().map(|step| match step {
            PathStep::Key(key) => quoted(key),
            PathStep::Item(index) => format!("[{index}]"),
        });
        let parts = outer.chain(inner.map(quoted));
        parts.fold(String::new(), |path, part| {
            let dot = if path.is_empty() || part.starts_with('[') { "" } else { "." };
            path + dot + &part
        })
    }

    /// Message to be read after the key; `of` names the document, such as "a scene".
    pub fn message(&self, of: &str) -> String {
        match &self.problem {
            Mismatch::Missing(_) => "is missing".to_owned(),
            Mismatch::UnknownKey { key, known } => format!("is not a key of {of}; {}", self::known(key, known)),
            Mismatch::UnknownWord { word, known } => format!("is \"{}\"; {}", excerpt(word), self::known(word, known)),
            Mismatch::Type { found, expected } => format!("has the wrong type: found {found}, expected {expected}"),
            Mismatch::Other(message) => message.clone(),
        }
    }

    /// Key and message; the document itself is called `of`.
    pub fn in_words(&self, of: &str) -> String {
        let key = self.key();
        format!("{} {}", if key.is_empty() { of } else { &key }, self.message(of))
    }
}

/// A key of a path, in quotes unless it is a bare key.
fn quoted(key: &str) -> String {
    let is_bare = !key.is_empty() && key.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
    if is_bare { excerpt(key) } else { format!("\"{}\"", excerpt(key)) }
}

impl Display for TypeMismatch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.in_words("the document"))
    }
}

impl std::error::Error for TypeMismatch {}

impl Error for TypeMismatch {
    fn custom<T: Display>(message: T) -> Self {
        Self::of(Mismatch::Other(message.to_string()))
    }

    fn invalid_type(found: Unexpected, expected: &dyn Expected) -> Self {
        Self::of_type(in_words(&found), plain(&expected.to_string()))
    }

    fn invalid_value(found: Unexpected, expected: &dyn Expected) -> Self {
        Self::invalid_type(found, expected)
    }

    fn invalid_length(length: usize, expected: &dyn Expected) -> Self {
        Self::of_type(format!("a list of length {length}"), plain(&expected.to_string()))
    }

    fn unknown_variant(word: &str, known: &'static [&'static str]) -> Self {
        Self::of(Mismatch::UnknownWord { word: word.to_owned(), known })
    }

    fn unknown_field(key: &str, known: &'static [&'static str]) -> Self {
        Self::of(Mismatch::UnknownKey { key: key.to_owned(), known })
    }

    fn missing_field(key: &'static str) -> Self {
        Self::of(Mismatch::Missing(key))
    }

    fn duplicate_field(key: &'static str) -> Self {
        Self::custom("is there twice; leave one of them out").in_key(key)
    }
}

fn in_words(found: &Unexpected) -> String {
    match found {
        Unexpected::Bool(value) => value.to_string(),
        Unexpected::Unsigned(number) => number.to_string(),
        Unexpected::Signed(number) => number.to_string(),
        Unexpected::Float(number) => format!("{number:?}"),
        Unexpected::Str(text) => format!("\"{}\"", excerpt(text)),
        Unexpected::Seq => "a list".to_owned(),
        Unexpected::Map | Unexpected::StructVariant => "a section of keys".to_owned(),
        Unexpected::Unit | Unexpected::Option => "null".to_owned(),
        other => other.to_string(),
    }
}

/// Plain words for the names of types.
fn plain(expected: &str) -> String {
    match expected {
        "u8" => "a whole number from 0 to 255".to_owned(),
        "u32" => "a whole number from 0 to 4294967295".to_owned(),
        "i32" => "a whole number of at most 9 digits".to_owned(),
        "a sequence" => "a list".to_owned(),
        other => other.replace("an array of length", "a list of length"),
    }
}
