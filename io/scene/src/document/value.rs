//! The values of a document.

use super::{TypeMismatch, excerpt};
use serde::de::DeserializeOwned;
use std::num::NonZeroU32;

/// A value and its position in the text.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// The value.
    pub value: Value,
    /// Number of bytes before it or its key, plus one.
    place: Option<NonZeroU32>,
}

/// A value.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// No value (JSON `null`).
    Null,
    /// True or false.
    Bool(bool),
    /// A whole number.
    Whole(WholeNumber),
    /// A number with a fraction or an exponent.
    Real(f64),
    /// Text.
    Text(Box<str>),
    /// A date, or a number that is not representable, as it is written.
    Other(Box<str>),
    /// A list.
    List(Box<[Node]>),
    /// Keys and their values.
    Section(Box<[KeyValue]>),
}

/// A whole number of 64 bits and a sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WholeNumber {
    /// Whether it is below zero.
    pub is_negative: bool,
    /// Absolute value.
    pub size: u64,
}

/// A key and its value.
#[derive(Debug, Clone, PartialEq)]
pub struct KeyValue {
    /// Key.
    pub key: Box<str>,
    /// Value.
    pub node: Node,
}

impl From<Value> for Node {
    fn from(value: Value) -> Self {
        Self { value, place: None }
    }
}

impl Node {
    /// A value at a position in a text.
    pub(super) fn at(place: usize, value: Value) -> Self {
        Self { value, place: u32::try_from(place + 1).ok().and_then(NonZeroU32::new) }
    }

    /// Deserialises the value as a type. The error names the key.
    pub fn read<T: DeserializeOwned>(&self) -> Result<T, TypeMismatch> {
        T::deserialize(self)
    }

    /// The value of a key, if this is a section that has it.
    pub fn get(&self, key: &str) -> Option<&Node> {
        let Value::Section(entries) = &self.value else { return None };
        entries.iter().find(|entry| *entry.key == *key).map(|entry| &entry.node)
    }

    /// The same, to be changed.
    pub fn get_mut(&mut self, key: &str) -> Option<&mut Node> {
        let Value::Section(entries) = &mut self.value else { return None };
        entries.iter_mut().find(|entry| *entry.key == *key).map(|entry| &mut entry.node)
    }

    /// The text, if the value is a text.
    pub fn text(&self) -> Option<&str> {
        if let Value::Text(text) = &self.value { Some(text) } else { None }
    }

    /// Position in the text of a key such as `species[1].radius`, or of its innermost parent that the text has.
    pub fn find(&self, key: &str) -> Option<usize> {
        let (mut node, mut place) = (self, None);
        for part in key.split(['.', '[']) {
            let inner = match (&node.value, part.strip_suffix(']')) {
                (Value::List(items), Some(index)) => index.parse().ok().and_then(|index: usize| items.get(index)),
                (_, None) => node.get(part),
                _ => None,
            };
            let Some(inner) = inner else { break };
            (node, place) = (inner, inner.place.map_or(place, |place| Some(place.get() as usize - 1)));
        }
        place
    }
}

impl Value {
    /// The value as messages show it.
    pub(super) fn shown(&self) -> String {
        match self {
            Self::Null => "null".to_owned(),
            Self::Bool(value) => value.to_string(),
            Self::Whole(number) => number.to_string(),
            Self::Real(number) => format!("{number:?}"),
            Self::Text(text) => format!("\"{}\"", excerpt(text)),
            Self::Other(text) => excerpt(text),
            Self::List(items) => format!("a list of length {}", items.len()),
            Self::Section(_) => "a section of keys".to_owned(),
        }
    }
}

impl WholeNumber {
    /// A number, if it has at most 64 bits and a sign.
    pub fn of(number: i128) -> Option<Self> {
        let size = u64::try_from(number.unsigned_abs()).ok()?;
        Some(Self { is_negative: number < 0, size })
    }

    /// The number as a float, if it is represented exactly.
    pub(super) fn real(self) -> Option<f64> {
        let size = self.size as f64;
        let is_exact = size as u128 == u128::from(self.size);
        is_exact.then_some(if self.is_negative { -size } else { size })
    }
}

impl std::fmt::Display for WholeNumber {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}{}", if self.is_negative { "-" } else { "" }, self.size)
    }
}
