//! The sections `[ensemble]` and `[sweep]`: lists of seeds, and of values of keys.

use super::{SECTIONS, shown};
use crate::key_error::KeyError;
use crate::overrides;
use crate::overrides::is_in;
use std::collections::HashSet;
use toml::de::{DeTable, DeValue};
use toml::{Table, Value};

/// The lists of a family.
pub(super) struct Lists {
    /// The seeds, if the scene lists some.
    pub(super) seeds: Option<Seeds>,
    /// The swept keys, in the order in which they are written.
    pub(super) keys: Vec<String>,
    /// Their values at each point; one point without values where nothing is swept.
    pub(super) points: Vec<Vec<Value>>,
}

/// The seeds of a family.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Seeds {
    /// So many, from the seed of the scene on.
    Count(u64),
    /// These.
    Listed(Vec<u64>),
}

/// Seeds that a family may have.
const MOST_SEEDS: u64 = 10_000;
/// Keys that can't be swept, and why.
const NOT_SWEPT: [(&str, &str); 5] = [
    ("seed", "is not swept: list seeds by [ensemble] seeds = [1, 2, 3], or give their number"),
    ("kind", "is not swept: write a family for each kind of scene"),
    ("output.folder", "is not swept: each run has a folder in that of the family"),
    ("title", "is not swept: a title changes nothing; leave it out"),
    ("seeds", "is not swept: list seeds by [ensemble] seeds = [1, 2, 3], or give their number"),
];

impl Lists {
    /// Reads the lists of a text that is known to be TOML.
    pub(super) fn read(text: &str) -> Result<Self, KeyError> {
        let mut table: Table = toml::from_str(text).map_err(|error| KeyError::new("sweep", error.to_string()))?;
        let seeds = table.get("ensemble").map(seeds).transpose()?;
        let (keys, points) = match table.remove("sweep") {
            None => (Vec::new(), vec![Vec::new()]),
            Some(Value::Table(lists)) => grid(in_order(lists, text))?,
            Some(Value::Array(points)) if points.iter().all(Value::is_table) => listed(points, text)?,
            Some(other) => {
                let message = format!(
                    "is {}; write a section of keys with lists of values, or [[sweep]] sections with a value for each \
                     key",
                    shown(&other)
                );
                return Err(KeyError::new("sweep", message));
            }
        };
        keys.iter().try_for_each(|key| check_key(key, &keys))?;
        check_different(&keys, &points)?;
        Ok(Self { seeds, keys, points })
    }
}

fn seeds(ensemble: &Value) -> Result<Seeds, KeyError> {
    let Some(table) = ensemble.as_table() else {
        return Err(KeyError::new(
            "ensemble",
            format!("is {}; write a section: [ensemble] seeds = 8", shown(ensemble)),
        ));
    };
    if let Some(key) = table.keys().find(|key| *key != "seeds") {
        return Err(KeyError::new(format!("ensemble.{key}"), "is not a key of a scene; known here: seeds"));
    }
    let key = "ensemble.seeds";
    let wrong = |found: &Value| KeyError::new(key, format!("has {}; seeds are whole numbers, 0 or more", shown(found)));
    let seed = |value: &Value| value.as_integer().and_then(|n| u64::try_from(n).ok()).ok_or_else(|| wrong(value));
    match table.get("seeds") {
        None => Err(KeyError::new(key, "is missing; give the number of seeds, or a list of them")),
        Some(Value::Integer(count)) => match u64::try_from(*count) {
            Ok(count) if (1..=MOST_SEEDS).contains(&count) => Ok(Seeds::Count(count)),
            _ => Err(KeyError::new(key, format!("is {count}; it needs 1 <= seeds <= {MOST_SEEDS}"))),
        },
        Some(Value::Array(list)) if list.is_empty() => Err(KeyError::new(key, EMPTY)),
        Some(Value::Array(list)) => {
            let list = list.iter().map(seed).collect::<Result<Vec<_>, _>>()?;
            let mut seen = HashSet::new();
            match list.iter().find(|seed| !seen.insert(**seed)) {
                Some(twice) => Err(KeyError::new(key, format!("has {twice} {TWICE}"))),
                None => Ok(Seeds::Listed(list)),
            }
        }
        Some(other) => {
            Err(KeyError::new(key, format!("is {}; give the number of seeds, or a list of them", shown(other))))
        }
    }
}

const EMPTY: &str = "is empty; list at least one value, or leave it out";
const TWICE: &str = "more than once; the runs would be the same: list each value once";

impl Seeds {
    /// The seeds of a scene whose own is `first`.
    pub(super) fn from(self, first: u64) -> Result<Vec<u64>, KeyError> {
        match self {
            Self::Listed(seeds) => Ok(seeds),
            Self::Count(count) => match first.checked_add(count - 1).filter(|last| i64::try_from(*last).is_ok()) {
                Some(last) => Ok((first..=last).collect()),
                None => {
                    Err(KeyError::new("ensemble.seeds", format!("is {count}; from seed {first} there are not so many")))
                }
            },
        }
    }
}

type Points = (Vec<String>, Vec<Vec<Value>>);

/// Every combination of the values of some keys; the last key changes first.
fn grid(lists: Vec<(String, Value)>) -> Result<Points, KeyError> {
    if lists.is_empty() {
        return Err(KeyError::new(
            "sweep",
            "has no keys; write a key in quotes and a list of its values, or leave it out",
        ));
    }
    let mut points = vec![Vec::new()];
    for (key, values) in &lists {
        let Value::Array(values) = values else {
            let message = format!("is {0}; list its values, as in [{0}]", shown(values));
            return Err(KeyError::new(named(key), message));
        };
        if values.is_empty() {
            return Err(KeyError::new(named(key), EMPTY));
        }
        check_different(
            std::slice::from_ref(key),
            &values.iter().map(|value| vec![value.clone()]).collect::<Vec<_>>(),
        )?;
        if points.len().saturating_mul(values.len()) > super::MOST {
            return Err(KeyError::new("sweep", format!("has more than {} points; list fewer values", super::MOST)));
        }
        let with = |point: &Vec<Value>| {
            values.iter().map(|value| [&point[..], std::slice::from_ref(value)].concat()).collect::<Vec<_>>()
        };
        points = points.iter().flat_map(with).collect();
    }
    Ok((lists.into_iter().map(|(key, _)| key).collect(), points))
}

/// Points that are listed one by one, each with all keys.
fn listed(points: Vec<Value>, text: &str) -> Result<Points, KeyError> {
    let points: Vec<Table> = points.into_iter().filter_map(|point| point.try_into().ok()).collect();
    if points.is_empty() {
        return Err(KeyError::new("sweep", EMPTY));
    }
    let keys: Vec<String> = in_order(points[0].clone(), text).into_iter().map(|(key, _)| key).collect();
    if keys.is_empty() {
        return Err(KeyError::new("sweep[0]", "has no keys; write a key in quotes and its value"));
    }
    let values = |(place, point): (usize, Table)| {
        let mut leaves = leaves(point);
        let taken = keys.iter().map(|key| {
            let found = leaves.iter().position(|(other, _)| other == key);
            let missing =
                || KeyError::new(format!("sweep[{place}]"), format!("has no {key}; each point sets the same keys"));
            found.map(|found| leaves.swap_remove(found).1).ok_or_else(missing)
        });
        let values = taken.collect::<Result<Vec<_>, _>>()?;
        match leaves.first() {
            Some((key, _)) => Err(KeyError::new(
                format!("sweep[{place}]"),
                format!("has {key} besides; each point sets the same keys"),
            )),
            None => Ok(values),
        }
    };
    let values = points.into_iter().enumerate().map(values).collect::<Result<_, _>>()?;
    Ok((keys, values))
}

/// The keys in a table with their values, with those in its tables as `flow.rate`.
fn leaves(table: Table) -> Vec<(String, Value)> {
    let of = |(name, value): (String, Value)| match value {
        Value::Table(inner) => leaves(inner).into_iter().map(|(key, value)| (format!("{name}.{key}"), value)).collect(),
        value => vec![(name, value)],
    };
    table.into_iter().flat_map(of).map(|(key, value)| (overrides::key_of(&key), value)).collect()
}

/// The same in the order in which the text has them.
fn in_order(table: Table, text: &str) -> Vec<(String, Value)> {
    let mut leaves = leaves(table);
    let written = DeTable::parse(text).ok();
    let mut places = Vec::new();
    match written.as_ref().and_then(|table| table.get_ref().get("sweep")).map(toml::Spanned::get_ref) {
        Some(DeValue::Table(sweep)) => collect_places(sweep, "", &mut places),
        Some(DeValue::Array(points)) => {
            if let Some(DeValue::Table(first)) = points.first().map(toml::Spanned::get_ref) {
                collect_places(first, "", &mut places);
            }
        }
        _ => {}
    }
    leaves.sort_by_key(|(key, _)| places.iter().find(|(other, _)| other == key).map(|(_, place)| *place));
    leaves
}

fn collect_places(table: &DeTable, path: &str, places: &mut Vec<(String, usize)>) {
    for (name, value) in table {
        let key = if path.is_empty() { name.get_ref().to_string() } else { format!("{path}.{}", name.get_ref()) };
        match value.get_ref() {
            DeValue::Table(inner) => collect_places(inner, &key, places),
            _ => places.push((overrides::key_of(&key), name.span().start)),
        }
    }
}

/// Refuses a key that makes no member of its own, or is in another swept key.
fn check_key(key: &str, keys: &[String]) -> Result<(), KeyError> {
    overrides::check_key(key)
        .map_err(|message| KeyError::new("sweep", format!("has a key that is none: {message}")))?;
    if let Some((_, why)) = NOT_SWEPT.iter().find(|(other, _)| is_in(key, other)) {
        return Err(KeyError::new(named(key), *why));
    }
    if SECTIONS.iter().any(|section| is_in(key, section)) {
        return Err(KeyError::new(named(key), "is not swept: a member of a family is no family"));
    }
    match keys.iter().filter(|other| is_in(key, other)).count() {
        1 => Ok(()),
        _ => Err(KeyError::new(named(key), "is swept twice, by itself or as a part of another key; list it once")),
    }
}

/// Refuses points of the same values.
fn check_different(keys: &[String], points: &[Vec<Value>]) -> Result<(), KeyError> {
    let mut seen = HashSet::new();
    let twice = points.iter().find(|point| !seen.insert(point.iter().map(canonical).collect::<Vec<_>>()));
    match (twice, keys) {
        (None, _) => Ok(()),
        (Some(point), [key]) => Err(KeyError::new(named(key), format!("has {} {TWICE}", shown(&point[0])))),
        (Some(point), _) => {
            let values: Vec<String> =
                keys.iter().zip(point).map(|(key, value)| format!("{key} = {}", shown(value))).collect();
            Err(KeyError::new("sweep", format!("has the point {} {TWICE}", values.join(", "))))
        }
    }
}

/// A value as text that is the same however its numbers are written.
fn canonical(value: &Value) -> String {
    match value {
        Value::Integer(number) if number.unsigned_abs() < 1 << 53 => format!("{:?}", *number as f64),
        Value::Float(number) => format!("{:?}", if *number == 0.0 { 0.0 } else { *number }),
        Value::Array(items) => items.iter().map(canonical).collect::<Vec<_>>().join(","),
        other => other.to_string(),
    }
}

/// A swept key in messages.
fn named(key: &str) -> String {
    format!("sweep.\"{key}\"")
}
