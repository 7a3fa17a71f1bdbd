//! Edits of a tree of keys and values, as in TOML and JSON.

use crate::hostile;
use proptest::prelude::*;
use proptest::sample::Index;
use toml::Value;

/// An edit. Indices count the nodes of the tree in the order of its text.
#[derive(Debug, Clone)]
pub enum TreeEdit {
    /// Replaces a value.
    Replace(Index, Value),
    /// Multiplies a number of the tree.
    Scale(Index, f64),
    /// Removes a key or an item.
    Remove(Index),
    /// Replaces one value by a copy of another.
    Copy(Index, Index),
    /// Exchanges two values.
    Swap(Index, Index),
    /// Renames a key.
    Rename(Index, String),
    /// Inserts a key into a section, or an item into a list.
    Insert(Index, String, Value),
    /// Wraps a value in a number of lists.
    Nest(Index, usize),
}

/// A part of a place in a tree; a place is a path from the root.
#[derive(Debug, Clone, PartialEq)]
pub enum TreeStep {
    /// A key of a table.
    Key(String),
    /// An item of a list.
    Item(usize),
}

/// One to four edits; half of the time they preserve the shape of the tree.
pub fn edits(keys: &'static [String]) -> impl Strategy<Value = Vec<TreeEdit>> {
    let mild = prop_oneof![
        3 => (any::<Index>(), 0.3..3.0).prop_map(|(at, factor)| TreeEdit::Scale(at, factor)),
        2 => (any::<Index>(), hostile::number()).prop_map(|(at, factor)| TreeEdit::Scale(at, factor)),
        2 => (any::<Index>(), hostile::number()).prop_map(|(at, number)| TreeEdit::Replace(at, Value::Float(number))),
    ];
    prop_oneof![prop::collection::vec(mild, 1..3), prop::collection::vec(any_edit(keys), 1..4)]
}

fn any_edit(keys: &'static [String]) -> impl Strategy<Value = TreeEdit> {
    let index = any::<Index>;
    let name = || prop_oneof![4 => prop::sample::select(keys), 1 => hostile::word()];
    prop_oneof![
        6 => (index(), hostile::value()).prop_map(|(at, value)| TreeEdit::Replace(at, value)),
        3 => (index(), hostile::number()).prop_map(|(at, factor)| TreeEdit::Scale(at, factor)),
        2 => index().prop_map(TreeEdit::Remove),
        2 => (index(), index()).prop_map(|(from, to)| TreeEdit::Copy(from, to)),
        2 => (index(), index()).prop_map(|(a, b)| TreeEdit::Swap(a, b)),
        1 => (index(), name()).prop_map(|(at, name)| TreeEdit::Rename(at, name)),
        3 => (index(), name(), hostile::value()).prop_map(|(at, name, value)| TreeEdit::Insert(at, name, value)),
        1 => (index(), 1..200usize).prop_map(|(at, depth)| TreeEdit::Nest(at, depth)),
    ]
}

/// Applies an edit, if the tree has a suitable place.
pub fn apply(tree: &mut Value, edit: &TreeEdit) {
    let places = places(tree);
    if places.is_empty() {
        return;
    }
    let place = |index: &Index| &places[index.index(places.len())];
    match edit {
        TreeEdit::Replace(at, value) => put(tree, place(at), value.clone()),
        TreeEdit::Scale(at, factor) => scale(tree, &places, *at, *factor),
        TreeEdit::Remove(at) => drop(take(tree, place(at))),
        TreeEdit::Copy(from, to) => {
            if let Some(value) = find(tree, place(from)).cloned() {
                put(tree, place(to), value);
            }
        }
        TreeEdit::Swap(a, b) => {
            if let (Some(x), Some(y)) = (find(tree, place(a)).cloned(), find(tree, place(b)).cloned()) {
                put(tree, place(a), y);
                put(tree, place(b), x);
            }
        }
        TreeEdit::Rename(at, name) => {
            let place = place(at);
            if let Some(value) = take(tree, place) {
                insert(tree, &place[..place.len() - 1], name, value);
            }
        }
        TreeEdit::Insert(at, name, value) => {
            let place = place(at);
            insert(tree, &place[..place.len() - 1], name, value.clone());
        }
        TreeEdit::Nest(at, depth) => {
            if let Some(value) = find(tree, place(at)) {
                let inner = std::mem::replace(value, Value::Boolean(false));
                *value = (0..*depth).fold(inner, |inner, _| Value::Array(vec![inner]));
            }
        }
    }
}

/// Places of all values except the root.
pub fn places(tree: &Value) -> Vec<Vec<TreeStep>> {
    let mut all = Vec::new();
    collect(tree, &mut Vec::new(), &mut all);
    all
}

fn collect(value: &Value, place: &mut Vec<TreeStep>, all: &mut Vec<Vec<TreeStep>>) {
    let mut visit = |part: TreeStep, inner: &Value| {
        place.push(part);
        all.push(place.clone());
        collect(inner, place, all);
        place.pop();
    };
    match value {
        Value::Table(table) => table.iter().for_each(|(key, inner)| visit(TreeStep::Key(key.clone()), inner)),
        Value::Array(list) => list.iter().enumerate().for_each(|(i, inner)| visit(TreeStep::Item(i), inner)),
        _ => {}
    }
}

/// The value at a place.
pub fn find<'a>(tree: &'a mut Value, place: &[TreeStep]) -> Option<&'a mut Value> {
    place.iter().try_fold(tree, |value, part| match (value, part) {
        (Value::Table(table), TreeStep::Key(key)) => table.get_mut(key),
        (Value::Array(list), TreeStep::Item(item)) => list.get_mut(*item),
        _ => None,
    })
}

fn put(tree: &mut Value, place: &[TreeStep], value: Value) {
    if let Some(found) = find(tree, place) {
        *found = value;
    }
}

fn take(tree: &mut Value, place: &[TreeStep]) -> Option<Value> {
    let (last, parent) = place.split_last()?;
    match (find(tree, parent)?, last) {
        (Value::Table(table), TreeStep::Key(key)) => table.remove(key),
        (Value::Array(list), TreeStep::Item(item)) if *item < list.len() => Some(list.remove(*item)),
        _ => None,
    }
}

fn insert(tree: &mut Value, parent: &[TreeStep], name: &str, value: Value) {
    match find(tree, parent) {
        Some(Value::Table(table)) => drop(table.insert(name.to_owned(), value)),
        Some(Value::Array(list)) => list.push(value),
        _ => {}
    }
}

/// Multiplies a number. Whole numbers stay whole.
fn scale(tree: &mut Value, places: &[Vec<TreeStep>], at: Index, factor: f64) {
    let is_number =
        |place: &&Vec<TreeStep>| matches!(find(&mut tree.clone(), place), Some(Value::Float(_) | Value::Integer(_)));
    let numbers: Vec<&Vec<TreeStep>> = places.iter().filter(is_number).collect();
    if numbers.is_empty() {
        return;
    }
    match find(tree, numbers[at.index(numbers.len())]) {
        Some(Value::Float(number)) => *number *= factor,
        Some(Value::Integer(number)) => *number = (*number as f64 * factor).round() as i64,
        _ => {}
    }
}

/// All keys of a tree.
pub fn keys(tree: &Value) -> Vec<String> {
    let key = |place: Vec<TreeStep>| match place.into_iter().next_back() {
        Some(TreeStep::Key(key)) => Some(key),
        _ => None,
    };
    places(tree).into_iter().filter_map(key).collect()
}

/// Keys of a tree with their sections, such as `species[0].radius`.
pub fn paths(tree: &Value) -> Vec<String> {
    places(tree).iter().map(|place| path(place)).collect()
}

/// A place in the notation of messages and `--set`.
pub fn path(place: &[TreeStep]) -> String {
    place.iter().fold(String::new(), |path, part| match part {
        TreeStep::Key(key) if path.is_empty() => key.clone(),
        TreeStep::Key(key) => format!("{path}.{key}"),
        TreeStep::Item(item) => format!("{path}[{item}]"),
    })
}

/// The tree as JSON; values that JSON cannot represent are written all the same.
pub fn to_json(tree: &Value) -> String {
    let joined = |parts: Vec<String>| parts.join(", ");
    match tree {
        Value::Table(table) => {
            let entry = |(key, value): (&String, &Value)| format!("{}: {}", quoted(key), to_json(value));
            format!("{{{}}}", joined(table.iter().map(entry).collect()))
        }
        Value::Array(list) => format!("[{}]", joined(list.iter().map(to_json).collect())),
        Value::String(text) => quoted(text),
        Value::Float(number) if number.is_infinite() => "1e999".to_owned(),
        Value::Float(number) if number.is_nan() => "NaN".to_owned(),
        Value::Float(number) => format!("{number:e}"),
        Value::Datetime(_) => "null".to_owned(),
        other => other.to_string(),
    }
}

fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;

    fn tree() -> Value {
        toml::from_str("a = 1.5\n[b]\nc = [1, 2]\nd = 'x'\n").unwrap()
    }

    #[test]
    fn every_change_leaves_a_tree_that_can_be_written() {
        let keys: &'static [String] = keys(&tree()).leak();
        assert_eq!(keys, ["a", "b", "c", "d"]);
        let (mut runner, mut changed) = (TestRunner::deterministic(), 0);
        for _ in 0..500 {
            let mut after = tree();
            edits(keys).new_tree(&mut runner).unwrap().current().iter().for_each(|edit| apply(&mut after, edit));
            toml::to_string(&after).unwrap();
            changed += usize::from(after != tree());
        }
        assert!(changed > 400, "{changed} of 500 changes did something");
    }

    #[test]
    fn paths_lead_to_values() {
        assert_eq!(paths(&tree()), ["a", "b", "b.c", "b.c[0]", "b.c[1]", "b.d"]);
    }

    #[test]
    fn json_has_what_toml_has() {
        let json: serde_json::Value = serde_json::from_str(&to_json(&tree())).unwrap();
        assert_eq!(json, serde_json::json!({"a": 1.5, "b": {"c": [1, 2], "d": "x"}}));
    }
}
