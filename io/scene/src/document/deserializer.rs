//! The strict reader of documents.

use super::{KeyValue, Node, TypeMismatch, Value};
use serde::de::value::StrDeserializer;
use serde::de::{DeserializeSeed, Deserializer, IntoDeserializer, MapAccess, SeqAccess, Visitor};

const NUMBER: &str = "a number";
const WHOLE: &str = "a whole number";
const COUNT: &str = "a whole number, 0 or more";
const BOOL: &str = "true or false";
const TEXT: &str = "text in quotes";
const LIST: &str = "a list";
const SECTION: &str = "a section of keys";

impl Node {
    fn not(&self, expected: &str) -> TypeMismatch {
        TypeMismatch::of_type(self.value.shown(), expected)
    }

    /// Items of a list.
    fn items(&self, expected: &str) -> Result<&[Node], TypeMismatch> {
        if let Value::List(items) = &self.value { Ok(items) } else { Err(self.not(expected)) }
    }

    /// The number, if it is representable exactly.
    fn number(&self) -> Result<f64, TypeMismatch> {
        match &self.value {
            Value::Real(number) => Ok(*number),
            Value::Whole(number) => number.real().ok_or_else(|| {
                let expected =
                    "a number that 64 bits hold without rounding it; write it with a decimal point to have it rounded";
                self.not(expected)
            }),
            _ => Err(self.not(NUMBER)),
        }
    }

    fn text_or(&self, expected: &str) -> Result<&str, TypeMismatch> {
        self.text().ok_or_else(|| self.not(expected))
    }
}

/// Visits all items of a list, and refuses a list with surplus items.
fn pass_all<'de, V: Visitor<'de>>(list: &[Node], visitor: V) -> Result<V::Value, TypeMismatch> {
    let mut items = Items { list, passed: 0 };
    let value = visitor.visit_seq(&mut items)?;
    if items.passed == list.len() { Ok(value) } else { Err(other_length(list, items.passed)) }
}

/// Error of a list whose length differs from the wanted one.
fn other_length(list: &[Node], wanted: usize) -> TypeMismatch {
    let things = match list.first().map(|item| &item.value) {
        Some(Value::List(_)) => " lists",
        Some(Value::Text(_)) => " words",
        Some(Value::Whole(_) | Value::Real(_)) => " numbers",
        _ => "",
    };
    TypeMismatch::of_type(format!("a list of length {}", list.len()), format!("a list of {wanted}{things}"))
}

struct Items<'a> {
    list: &'a [Node],
    passed: usize,
}

impl<'de> SeqAccess<'de> for Items<'_> {
    type Error = TypeMismatch;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, TypeMismatch> {
        let Some(item) = self.list.get(self.passed) else { return Ok(None) };
        self.passed += 1;
        seed.deserialize(item).map(Some).map_err(|mismatch| mismatch.in_item(self.passed - 1))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.list.len() - self.passed)
    }
}

struct KeyValues<'a> {
    list: std::slice::Iter<'a, KeyValue>,
    next: Option<&'a KeyValue>,
}

impl<'de> MapAccess<'de> for KeyValues<'_> {
    type Error = TypeMismatch;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, TypeMismatch> {
        self.next = self.list.next();
        let key =
            |entry: &KeyValue| seed.deserialize::<StrDeserializer<TypeMismatch>>((*entry.key).into_deserializer());
        self.next.map(key).transpose()
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, TypeMismatch> {
        let entry = self.next.expect("a key was asked for before its value");
        seed.deserialize(&entry.node).map_err(|mismatch| mismatch.in_key(&entry.key))
    }
}

/// Methods for whole numbers.
macro_rules! whole_numbers {
    ($($unsigned:ident)*; $($signed:ident)*) => {
        $(fn $unsigned<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TypeMismatch> {
            match &self.value {
                Value::Whole(number) if !number.is_negative || number.size == 0 => visitor.visit_u64(number.size),
                _ => Err(self.not(COUNT)),
            }
        })*
        $(fn $signed<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TypeMismatch> {
            let Value::Whole(number) = &self.value else { return Err(self.not(WHOLE)) };
            let size = i64::try_from(number.size).map_err(|_| self.not(WHOLE))?;
            visitor.visit_i64(if number.is_negative { -size } else { size })
        })*
    };
}

impl<'de> Deserializer<'de> for &Node {
    type Error = TypeMismatch;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TypeMismatch> {
        match &self.value {
            Value::Null => visitor.visit_unit(),
            Value::Bool(value) => visitor.visit_bool(*value),
            Value::Whole(_) | Value::Real(_) => visitor.visit_f64(self.number()?),
            Value::Text(text) | Value::Other(text) => visitor.visit_str(text),
            Value::List(items) => pass_all(items, visitor),
            Value::Section(_) => self.deserialize_map(visitor),
        }
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TypeMismatch> {
        if let Value::Bool(value) = self.value { visitor.visit_bool(value) } else { Err(self.not(BOOL)) }
    }

    whole_numbers! {
        deserialize_u8 deserialize_u16 deserialize_u32 deserialize_u64;
        deserialize_i8 deserialize_i16 deserialize_i32 deserialize_i64
    }

    fn deserialize_f32<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TypeMismatch> {
        visitor.visit_f64(self.number()?)
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TypeMismatch> {
        visitor.visit_f64(self.number()?)
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TypeMismatch> {
        visitor.visit_str(self.text_or(TEXT)?)
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TypeMismatch> {
        visitor.visit_str(self.text_or(TEXT)?)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TypeMismatch> {
        if self.value == Value::Null { visitor.visit_none() } else { visitor.visit_some(self) }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, TypeMismatch> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TypeMismatch> {
        pass_all(self.items(LIST)?, visitor)
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, length: usize, visitor: V) -> Result<V::Value, TypeMismatch> {
        let items = self.items(&format!("a list of {length}"))?;
        if items.len() == length { pass_all(items, visitor) } else { Err(other_length(items, length)) }
    }

    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        length: usize,
        visitor: V,
    ) -> Result<V::Value, TypeMismatch> {
        self.deserialize_tuple(length, visitor)
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TypeMismatch> {
        let Value::Section(entries) = &self.value else { return Err(self.not(SECTION)) };
        visitor.visit_map(KeyValues { list: entries.iter(), next: None })
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, TypeMismatch> {
        self.deserialize_map(visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        words: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, TypeMismatch> {
        let word = self.text_or(&format!("one of the words {}", words.join(", ")))?;
        visitor.visit_enum::<StrDeserializer<TypeMismatch>>(word.into_deserializer())
    }

    serde::forward_to_deserialize_any! {
        i128 u128 char bytes byte_buf unit unit_struct identifier ignored_any
    }
}
