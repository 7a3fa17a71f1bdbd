//! Values that are a number, or a list or a word instead.

use schemars::JsonSchema;
use serde::Serialize;
use serde::de::value::{SeqAccessDeserializer, StrDeserializer};
use serde::de::{Deserialize, Deserializer, Error, IntoDeserializer, SeqAccess, Unexpected, Visitor};
use std::marker::PhantomData;

/// A number, or a list or a word instead.
#[derive(Debug, Clone, Copy, PartialEq, JsonSchema, Serialize)]
#[schemars(untagged, inline)]
#[serde(untagged)]
pub enum NumberOr<T> {
    /// The number.
    Number(f64),
    /// The other value.
    Other(T),
}

/// A value that may replace a number.
pub trait Alternative {
    /// The number and the alternative in words, such as "a number or a table of times and rates".
    const WORDS: &'static str;
}

impl<'de, T: Deserialize<'de> + Alternative> Deserialize<'de> for NumberOr<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(EitherOfThem(PhantomData))
    }
}

struct EitherOfThem<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de> + Alternative> Visitor<'de> for EitherOfThem<T> {
    type Value = NumberOr<T>;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(T::WORDS)
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<Self::Value, E> {
        Ok(NumberOr::Number(number))
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Self::Value, E> {
        Ok(NumberOr::Number(number as f64))
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<Self::Value, E> {
        Ok(NumberOr::Number(number as f64))
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<Self::Value, E> {
        let deserializer: StrDeserializer<E> = word.into_deserializer();
        T::deserialize(deserializer).map(NumberOr::Other).map_err(|_: E| E::invalid_type(Unexpected::Str(word), &self))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, items: A) -> Result<Self::Value, A::Error> {
        T::deserialize(SeqAccessDeserializer::new(items)).map(NumberOr::Other)
    }
}
