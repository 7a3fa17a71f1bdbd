//! A key of a scene and the problem with it.

use domain::ParameterError;

/// A key and the problem with it.
#[derive(Debug)]
pub(crate) struct KeyError {
    pub(crate) key: String,
    pub(crate) message: String,
}

impl KeyError {
    pub(crate) fn new(key: impl Into<String>, message: impl Into<String>) -> Self {
        Self { key: key.into(), message: message.into() }
    }

    pub(crate) fn key(&self) -> &str {
        &self.key
    }

    /// The same of the key by another name.
    pub(crate) fn of_key(self, key: impl Into<String>) -> Self {
        Self { key: key.into(), ..self }
    }
}

/// Message of a library about one of its parameters.
impl From<ParameterError> for KeyError {
    fn from(ParameterError { key, message }: ParameterError) -> Self {
        Self { key, message }
    }
}
