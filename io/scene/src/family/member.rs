//! Members of a family.

use super::shown;
use std::fmt::{Display, Formatter};
use toml::Value;

/// A member of a family: the values of the swept keys and the seed that tell it from the others.
#[derive(Debug, Clone, PartialEq)]
pub struct Member {
    /// The number of its point, from 0.
    pub point: usize,
    /// Its seed, if it has random numbers.
    pub seed: Option<u64>,
    values: Vec<Value>,
    settings: Vec<String>,
}

impl Member {
    pub(super) fn new(point: usize, keys: &[String], values: &[Value], seed: Option<u64>) -> Self {
        let swept = keys.iter().zip(values).map(|(key, value)| format!("{key}={value}"));
        let settings = swept.chain(seed.map(|seed| format!("seed={seed}"))).collect();
        Self { point, seed, values: values.to_vec(), settings }
    }

    /// The values of the swept keys.
    pub fn values(&self) -> &[Value] {
        &self.values
    }

    /// The keys that it sets in the scene, as `--set` writes them.
    pub fn settings(&self) -> &[String] {
        &self.settings
    }

    /// The name of its folder in that of the family: `point-0002/seed-0003`.
    pub fn folder(&self) -> String {
        let point = self.point_name();
        self.seed.map_or(point.clone(), |seed| format!("{point}/seed-{seed:04}"))
    }

    /// The name of its point: `point-0002`.
    pub fn point_name(&self) -> String {
        format!("point-{:04}", self.point + 1)
    }

    /// The values of the swept keys in words; empty where nothing is swept.
    pub fn described(&self) -> String {
        self.described_but(self.values.len())
    }

    /// The same without the key at a place.
    pub fn described_but(&self, place: usize) -> String {
        let values = self.settings.iter().zip(&self.values).enumerate().filter(|(other, _)| *other != place);
        let words = values.map(|(_, (set, value))| {
            let key = set.split('=').next().unwrap_or_default();
            format!("{key} = {}", shown(value))
        });
        words.collect::<Vec<_>>().join(", ")
    }
}

impl Display for Member {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let described = self.described();
        if described.is_empty() { f.write_str(&self.folder()) } else { write!(f, "{} ({described})", self.folder()) }
    }
}
