//! Differences between two scenes.

use crate::Scene;
use crate::document::excerpt;
use crate::former_names::bring_up_to_date;
use toml::{Table, Value};

/// A key with different values in two scenes.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// The key, such as `species[0].radius`.
    pub key: String,
    /// Value in either scene; `None` if absent.
    pub values: [Option<String>; 2],
}

impl std::fmt::Display for Difference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [one, other] = self.values.each_ref().map(|value| value.as_deref().unwrap_or("absent"));
        write!(f, "{} is {} here and {} there", self.key, excerpt(one), excerpt(other))
    }
}

impl Scene {
    /// Keys whose values differ from those of another scene, in alphabetical order. Comments, order, and the notation
    /// of numbers make no difference; an explicit default value does. Former names of keys are
    /// taken as the present ones.
    pub fn differences(&self, other: &Self) -> Vec<Difference> {
        differences_of(self.text(), other.text()).expect("the scenes were read from these texts")
    }
}

/// Differences between the texts of two scenes. `Err` if one of them is not TOML.
pub fn differences_of(here: &str, there: &str) -> Result<Vec<Difference>, toml::de::Error> {
    let leaves = |text: &str| {
        let mut leaves = Vec::new();
        let mut table = Value::Table(toml::from_str::<Table>(text)?);
        bring_up_to_date(&mut table);
        collect(table, String::new(), &mut leaves);
        Ok::<_, toml::de::Error>(leaves)
    };
    let [mut here, mut there] = [leaves(here)?, leaves(there)?];
    let mut keys: Vec<String> = here.iter().chain(&there).map(|(key, _)| key.clone()).collect();
    keys.sort();
    keys.dedup();
    let mut take = |key: &String| [&mut here, &mut there].map(|leaves| remove(leaves, key));
    let pairs = keys.into_iter().map(|key| (take(&key), key)).collect::<Vec<_>>();
    let differ = pairs.into_iter().filter(|([one, other], _)| !is_same(one.as_ref(), other.as_ref()));
    Ok(differ.map(|(values, key)| Difference { key, values: values.map(|v| v.map(|v| v.to_string())) }).collect())
}

fn remove(leaves: &mut Vec<(String, Value)>, key: &str) -> Option<Value> {
    let place = leaves.iter().position(|(other, _)| other == key)?;
    Some(leaves.swap_remove(place).1)
}

/// Collects all values that are neither tables nor arrays of tables, with their keys.
fn collect(value: Value, key: String, leaves: &mut Vec<(String, Value)>) {
    match value {
        Value::Table(table) => {
            for (name, value) in table {
                let key = if key.is_empty() { name } else { format!("{key}.{name}") };
                collect(value, key, leaves);
            }
        }
        Value::Array(items) if items.iter().any(Value::is_table) => {
            for (index, item) in items.into_iter().enumerate() {
                collect(item, format!("{key}[{index}]"), leaves);
            }
        }
        leaf => leaves.push((key, leaf)),
    }
}

fn is_same(one: Option<&Value>, other: Option<&Value>) -> bool {
    match (one, other) {
        (Some(one), Some(other)) => is_equal(one, other),
        _ => false,
    }
}

/// Whether values are equal; whole numbers may be written with or without a point.
fn is_equal(one: &Value, other: &Value) -> bool {
    match (one, other) {
        (Value::Integer(n), Value::Float(x)) | (Value::Float(x), Value::Integer(n)) => (*n as f64).total_cmp(x).is_eq(),
        (Value::Array(one), Value::Array(other)) => {
            one.len() == other.len() && one.iter().zip(other).all(|(one, other)| is_equal(one, other))
        }
        _ => one == other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"
box.edges = [14.0, 14.0, 14.0]
fluid.viscosity = 1.0
time = { step = 0.02, steps = 30 }
[[species]]
name = "a"
radius = 1.0
count = 25
"#;

    fn differences(other: &str) -> Vec<String> {
        let scene = |text: &str| Scene::parse(text, "scene.toml", &[]).unwrap();
        scene(TEXT).differences(&scene(other)).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn what_means_the_same_does_not_differ() {
        let other = "[[species]]\ncount = 25\nradius = 1\nname = 'a' # a comment\n[time]\nsteps = 30\nstep = 2e-2\n\
            [fluid]\nviscosity = 1\n[box]\nedges = [14, 14.0, 14]\n";
        assert_eq!(differences(other), [""; 0]);
    }

    #[test]
    fn what_differs_is_named_with_both_values() {
        let changed =
            TEXT.replace("0.02", "0.03").replace("[14.0,", "[15.0,") + "[[species]]\nradius = 2.0\ncount = 1\n";
        let expected = [
            "box.edges is [14.0, 14.0, 14.0] here and [15.0, 14.0, 14.0] there",
            "species[1].count is absent here and 1 there",
            "species[1].radius is absent here and 2.0 there",
            "time.step is 0.02 here and 0.03 there",
        ];
        assert_eq!(differences(&changed), expected);
    }
}
