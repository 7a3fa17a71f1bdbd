//! Errors in scenes, as messages for their authors.

use super::names;
use super::places::{Places, line};
use domain::ParameterError;

/// Why a scene was refused.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The file can't be read.
    #[error("can't read the scene {name}: {reason}")]
    Unreadable {
        /// The file.
        name: String,
        /// Why not.
        reason: std::io::Error,
    },
    /// A key is wrong.
    #[error("{}: {message}", place(.name, *.line))]
    Invalid {
        /// The file.
        name: String,
        /// The line that the key stands on, where the file has it.
        line: Option<usize>,
        /// The key, what was found, what is allowed.
        message: String,
    },
    /// A `--set` that can't be carried out.
    #[error("--set {message}")]
    Override {
        /// The override and what is wrong with it.
        message: String,
    },
}

fn place(name: &str, line: Option<usize>) -> String {
    line.map_or_else(|| name.to_owned(), |line| format!("{name}:{line}"))
}

impl SceneError {
    /// The same, of a text whose lines are not those of the file.
    pub(super) fn without_line(self) -> Self {
        match self {
            Self::Invalid { name, message, .. } => Self::Invalid { name, line: None, message },
            other => other,
        }
    }
}

/// A key and what is wrong with it.
#[derive(Debug)]
pub(super) struct Fault {
    key: String,
    message: String,
}

impl Fault {
    pub(super) fn new(key: impl Into<String>, message: impl Into<String>) -> Self {
        Self { key: key.into(), message: message.into() }
    }
}

/// The message of a library about one of its parameters.
impl From<ParameterError> for Fault {
    fn from(ParameterError { key, message }: ParameterError) -> Self {
        Self { key, message }
    }
}

/// Puts what the parser and the checks found into words.
pub(super) struct Explain<'a> {
    pub(super) text: &'a str,
    pub(super) name: &'a str,
}

impl Explain<'_> {
    fn at(&self, place: Option<usize>, message: String) -> SceneError {
        SceneError::Invalid { name: self.name.to_owned(), line: place.map(|p| line(self.text, p)), message }
    }

    pub(super) fn fault(&self, places: &Places, fault: &Fault) -> SceneError {
        self.at(places.find(&fault.key), format!("{} {}", fault.key, fault.message))
    }

    /// Text that is no TOML.
    pub(super) fn syntax(&self, error: &toml::de::Error) -> SceneError {
        let message = error.message().replace('\n', ", ");
        let place = error.span().map(|s| s.start);
        let found = place.and_then(|p| self.text.lines().nth(line(self.text, p) - 1)).unwrap_or_default();
        self.at(place, format!("this is not TOML: {message}; found: {}", found.trim()))
    }

    /// TOML that is no scene: unknown or missing keys and values of the wrong type.
    pub(super) fn structure(&self, places: &Places, error: &toml::de::Error) -> SceneError {
        let span = error.span();
        let path = span.as_ref().and_then(|s| places.path_at(s)).unwrap_or("");
        let named = quoted(error.message());
        let message = match error.message() {
            m if m.starts_with("unknown field") => {
                format!("{path} is not a key of a scene; {}", names::known(named[0], &named[1..]))
            }
            m if m.starts_with("unknown variant") => {
                format!("{path} is \"{}\"; {}", named[0], names::known(named[0], &named[1..]))
            }
            m if m.starts_with("missing field") => {
                let dot = if path.is_empty() { "" } else { "." };
                format!("{path}{dot}{} is missing", named[0])
            }
            m => format!("{path} has the wrong type: {}", plain(m)),
        };
        let place = span.filter(|_| !path.is_empty()).map(|s| s.start);
        self.at(place, message)
    }
}

/// The names that a message has in backticks.
fn quoted(message: &str) -> Vec<&str> {
    message.split('`').skip(1).step_by(2).collect()
}

/// Plain words for the parser's names of types.
fn plain(message: &str) -> String {
    let words = [
        ("invalid type: ", "found "),
        ("invalid value: ", "found "),
        ("invalid length ", "found a list of length "),
        ("an array of length 3", "a list of 3 numbers"),
        ("an array of size 3", "a list of 3 numbers"),
        ("tuple of 3 elements", "a list of 3 numbers"),
        ("expected f64", "expected a number"),
        ("expected u64", "expected a whole number, 0 or more"),
        ("expected usize", "expected a whole number, 0 or more"),
        ("expected u32", "expected a whole number, 0 or more"),
        ("a boolean", "true or false"),
        ("a sequence", "a list"),
    ];
    let simpler = words.iter().fold(message.to_owned(), |m, (from, to)| m.replace(from, to));
    match simpler.find("expected struct ") {
        Some(start) => format!("{}expected a section of keys", &simpler[..start]),
        None => simpler,
    }
}
