//! Documents in which keys can be renamed: those that keep the positions of values, and tables.

use crate::document::{Node, Value as NodeValue};
use toml::Value;

/// A value with sections of keys inside.
pub(crate) trait Tree {
    /// The text of a key, if the value is a section with such a key.
    fn word(&self, key: &str) -> Option<&str>;

    /// Replaces the text of a key.
    fn set_word(&mut self, key: &str, word: &str);

    /// Renames a key of a section.
    fn rename(&mut self, former: &str, present: &str);

    /// Calls a function with the value of a key, or with each item of a list there.
    fn in_section(&mut self, name: &str, call: &mut dyn FnMut(&mut Self));

    /// Calls a function with all sections at a path.
    fn in_sections(&mut self, path: &str, call: &mut dyn FnMut(&mut Self)) {
        match path.split_once('.') {
            None => self.in_section(path, call),
            Some((first, rest)) => self.in_section(first, &mut |inner| inner.in_sections(rest, call)),
        }
    }
}

impl Tree for Node {
    fn word(&self, key: &str) -> Option<&str> {
        self.get(key).and_then(Node::text)
    }

    fn set_word(&mut self, key: &str, word: &str) {
        if let Some(node) = self.get_mut(key) {
            node.value = NodeValue::Text(word.into());
        }
    }

    fn rename(&mut self, former: &str, present: &str) {
        if let NodeValue::Section(entries) = &mut self.value {
            entries.iter_mut().filter(|entry| *entry.key == *former).for_each(|entry| entry.key = present.into());
        }
    }

    fn in_section(&mut self, name: &str, call: &mut dyn FnMut(&mut Self)) {
        match self.get_mut(name) {
            Some(Node { value: NodeValue::List(items), .. }) => items.iter_mut().for_each(call),
            Some(section) => call(section),
            None => {}
        }
    }
}

impl Tree for Value {
    fn word(&self, key: &str) -> Option<&str> {
        self.get(key).and_then(Value::as_str)
    }

    fn set_word(&mut self, key: &str, word: &str) {
        if let Some(value) = self.get_mut(key) {
            *value = Value::String(word.to_owned());
        }
    }

    fn rename(&mut self, former: &str, present: &str) {
        let Some(table) = self.as_table_mut() else { return };
        if let Some(value) = table.remove(former) {
            table.insert(present.to_owned(), value);
        }
    }

    fn in_section(&mut self, name: &str, call: &mut dyn FnMut(&mut Self)) {
        match self.get_mut(name) {
            Some(Value::Array(items)) => items.iter_mut().for_each(call),
            Some(section) => call(section),
            None => {}
        }
    }
}
