//! Lists of `[sweep]` in scenes of sheared disks by their names in former versions.

use crate::key_error::KeyError;
use crate::kind_names::KINDS;
use toml::{Table, Value};

/// Former names, and the keys of now: seeds are listed in the section `[ensemble]`.
const FORMER: [(&str, &str); 4] = [
    ("seeds", "ensemble.seeds"),
    ("viscosities", "fluid.viscosity"),
    ("rates", "flow.rate"),
    ("area_fractions", "particles.area_fraction"),
];

/// The text of a family with the keys of now.
pub(super) struct Renamed {
    /// The text; that which was given where it has no former names, else without comments.
    pub(super) text: String,
    /// Former names that it had, with the keys of now.
    names: Vec<(&'static str, &'static str)>,
}

impl Renamed {
    /// Renames the lists of a text that has some.
    pub(super) fn of(text: String) -> Result<Self, KeyError> {
        let unchanged = |text| Ok(Self { text, names: Vec::new() });
        let Ok(mut table) = toml::from_str::<Table>(&text) else { return unchanged(text) };
        let is_of_disks = table.get("kind").and_then(Value::as_str) == Some(KINDS[1]);
        let Some(Value::Table(mut sweep)) = table.remove("sweep").filter(|_| is_of_disks) else {
            return unchanged(text);
        };
        let mut names = Vec::new();
        for (former, key) in FORMER {
            let Some(list) = sweep.remove(former) else { continue };
            check(former, &list, &table)?;
            let twice = if former == "seeds" { ensemble(&mut table, list) } else { sweep.insert(key.to_owned(), list) };
            if twice.is_some() {
                let message = format!("is the former name of {}, which is set too; leave one of them out", shown(key));
                return Err(KeyError::new(format!("sweep.{former}"), message));
            }
            names.push((former, key));
        }
        if names.is_empty() {
            return unchanged(text);
        }
        if !sweep.is_empty() {
            table.insert("sweep".to_owned(), Value::Table(sweep));
        }
        let text = toml::to_string(&table).map_err(|error| KeyError::new("sweep", error.to_string()))?;
        Ok(Self { text, names })
    }

    /// A warning for each former name.
    pub(super) fn warnings(&self) -> Vec<String> {
        let warning = |(former, key): &(&str, &str)| format!("sweep.{former} has another name now: {}", shown(key));
        self.names.iter().map(warning).collect()
    }

    /// A fault in the renamed text with the name of the key that was written.
    pub(super) fn as_written(&self, fault: KeyError) -> KeyError {
        let written = |(former, key): &(&str, &str)| {
            let quoted = fault.key().strip_prefix("sweep.\"").and_then(|key| key.strip_suffix('"'));
            let within = quoted.unwrap_or(fault.key()).strip_prefix(key)?;
            (within.is_empty() || within.starts_with('.')).then(|| format!("sweep.{former}{within}"))
        };
        match self.names.iter().find_map(written) {
            Some(key) => fault.of_key(key),
            None => fault,
        }
    }
}

/// Puts seeds into their section; the list that was there before.
fn ensemble(table: &mut Table, seeds: Value) -> Option<Value> {
    let section = table.entry("ensemble").or_insert_with(|| Value::Table(Table::new()));
    section.as_table_mut()?.insert("seeds".to_owned(), seeds)
}

/// Former sweeps of the rate ended at one strain, however their length was given.
fn check(former: &str, list: &Value, table: &Table) -> Result<(), KeyError> {
    let is_one = list.as_array().is_none_or(|rates| rates.len() < 2);
    let has_strain = table.get("time").and_then(|time| time.get("strain")).is_some();
    if former != "rates" || is_one || has_strain {
        return Ok(());
    }
    let message = "is the former name of \"flow.rate\", whose runs end at the same strain by time.strain only; set \
        that in place of time.steps or time.duration";
    Err(KeyError::new("sweep.rates", message))
}

/// A key as it is written: swept ones in quotes.
fn shown(key: &str) -> String {
    if key.starts_with("ensemble") { "[ensemble] seeds".to_owned() } else { format!("[sweep] \"{key}\"") }
}
