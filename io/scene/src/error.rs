//! Errors in scenes, as messages for their authors.

use crate::document::{Node, TypeMismatch, bounded, excerpt, line};
use crate::key_error::KeyError;
use crate::overrides::{self, is_in};
use crate::written_names::FormerNames;
use std::fmt::Display;

/// Reasons why a scene is refused.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The file cannot be read.
    #[error("can't read the scene {name}: {reason}")]
    Unreadable {
        /// Name of the file.
        name: String,
        /// Cause.
        reason: std::io::Error,
    },
    /// The text is too long.
    #[error("{name} {message}")]
    TooLong {
        /// Name of the file.
        name: String,
        /// Its length and the limit.
        message: String,
    },
    /// A key has an invalid value.
    #[error("{}{with}: {message}", place(.name, *.line))]
    Invalid {
        /// Name of the file.
        name: String,
        /// Line of the key, if the file has it.
        line: Option<usize>,
        /// Settings of the command line, such as ` with --set time.step=0.1`, or the member of a
        /// family; empty if there are none.
        with: String,
        /// The key, the value found, and the values allowed.
        message: String,
    },
    /// An invalid `--set`.
    #[error("--set {message}")]
    Override {
        /// The override, and the problem.
        message: String,
    },
}

impl SceneError {
    /// The same error about a member of the family in the file `name`; `has_lines` says whether its line numbers are
    /// those of the text that was read.
    pub(super) fn of_member(self, name: &str, member: &impl Display, has_lines: bool) -> Self {
        let with = format!(", {member}");
        match self {
            Self::Invalid { name, line, message, .. } => {
                Self::Invalid { name, line: line.filter(|_| has_lines), with, message }
            }
            Self::Override { message } => {
                Self::Invalid { name: name.to_owned(), line: None, with, message: format!("sweep can't set {message}") }
            }
            other => other,
        }
    }
}

fn place(name: &str, line: Option<usize>) -> String {
    line.map_or_else(|| name.to_owned(), |line| format!("{name}:{line}"))
}

/// Formulates the errors of the parser and of the checks.
pub(super) struct ErrorContext<'a> {
    /// Text of the file, and its parsed content.
    pub(super) text: &'a str,
    pub(super) written: Option<&'a Node>,
    pub(super) name: &'a str,
    /// Keys set on the command line.
    pub(super) overrides: &'a [String],
    /// Former names in both.
    pub(super) former: &'a FormerNames,
}

impl ErrorContext<'_> {
    /// A message about a key, with its line unless it is set on the command line.
    fn about(&self, key: &str, message: &str) -> SceneError {
        let is_set = self.overrides.iter().any(|set| is_in(key, &overrides::key_of(set)));
        let place = self.written.filter(|_| !is_set).and_then(|written| written.find(key));
        self.at(place, message)
    }

    fn at(&self, place: Option<usize>, message: &str) -> SceneError {
        let line = place.map(|place| line(self.text, place));
        let with = self.overrides.iter().fold(String::new(), |with, set| with + " --set " + &excerpt(set));
        let with = if with.is_empty() { with } else { bounded(&format!(" with{with}")) };
        SceneError::Invalid { name: self.name.to_owned(), line, with, message: bounded(message) }
    }

    /// A message about a key by the name that is written.
    pub(super) fn fault(&self, fault: &KeyError) -> SceneError {
        let key = self.former.as_written(&fault.key);
        self.about(&key, &format!("{key} {}", fault.message))
    }

    /// Text that is not TOML.
    pub(super) fn syntax(&self, error: &toml::de::Error) -> SceneError {
        let message = error.message().replace('\n', ", ");
        let place = error.span().map(|s| s.start);
        let found = place.and_then(|p| self.text.lines().nth(line(self.text, p) - 1)).unwrap_or_default();
        self.at(place, &format!("this is not TOML: {message}; found: {}", excerpt(found.trim())))
    }

    /// TOML that is not a scene: unknown or missing keys, or values of the wrong type.
    pub(super) fn structure(&self, mismatch: &TypeMismatch) -> SceneError {
        let key = self.former.as_written(&mismatch.key());
        self.about(&key, &format!("{} {}", if key.is_empty() { "a scene" } else { &key }, mismatch.message("a scene")))
    }
}
