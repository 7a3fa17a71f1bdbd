//! Documents in TOML.

use super::{KeyValue, Node, Value, WholeNumber};
use toml::de::{DeTable, DeValue, Error};

impl Node {
    /// Parses a TOML text; every value has the position of its key, or its own position in a list.
    pub fn of_toml(text: &str) -> Result<Self, Error> {
        Ok(Self::at(0, section(DeTable::parse(text)?.get_ref())))
    }
}

fn section(table: &DeTable) -> Value {
    let entry =
        |key: &str, place: usize, held: &DeValue| KeyValue { key: key.into(), node: Node::at(place, value(held)) };
    Value::Section(table.iter().map(|(key, held)| entry(key.get_ref(), key.span().start, held.get_ref())).collect())
}

fn value(held: &DeValue) -> Value {
    match held {
        DeValue::String(text) => Value::Text(text.as_ref().into()),
        DeValue::Integer(number) => whole(number.as_str(), number.radix()),
        DeValue::Float(number) => {
            number.as_str().parse().map_or_else(|_| Value::Other(number.as_str().into()), Value::Real)
        }
        DeValue::Boolean(value) => Value::Bool(*value),
        DeValue::Datetime(date) => Value::Other(date.to_string().into()),
        DeValue::Array(items) => {
            Value::List(items.iter().map(|item| Node::at(item.span().start, value(item.get_ref()))).collect())
        }
        DeValue::Table(table) => section(table),
    }
}

fn whole(text: &str, radix: u32) -> Value {
    let number = i128::from_str_radix(text, radix).ok().and_then(WholeNumber::of);
    number.map_or_else(|| Value::Other(text.into()), Value::Whole)
}

/// Line number, from 1, of a position in a text.
pub fn line(text: &str, place: usize) -> usize {
    text.bytes().take(place).filter(|&b| b == b'\n').count() + 1
}
