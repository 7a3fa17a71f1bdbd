//! Keys set on the command line.

use crate::document::excerpt;
use crate::former_names::{bring_up_to_date, kind_of, present_key};
use toml::{Table, Value};

/// The text of a scene with the keys of `overrides` set, each `key=value` with a dotted key such as
/// `species[0].radius` and a TOML value; a bare word is a string. The sections in `without` and comments are removed,
/// and former names are replaced by the present ones.
pub(super) fn apply(text: &str, overrides: &[String], without: &[&str]) -> Result<String, String> {
    let mut table: Table = toml::from_str(text).map_err(|e| e.to_string())?;
    table.retain(|key, _| !without.contains(&key));
    let mut root = Value::Table(table);
    bring_up_to_date(&mut root);
    for item in overrides {
        let shown = excerpt(item);
        let (key, value) =
            item.split_once('=').ok_or_else(|| format!("{shown}: write key=value, as in time.step=0.01"))?;
        let key = present_key(kind_of(&root), key.trim());
        set(&mut root, &key, value_of(value.trim())).map_err(|message| format!("{shown}: {message}"))?;
    }
    bring_up_to_date(&mut root);
    toml::to_string(&root).map_err(|e| e.to_string())
}

/// Key that an override sets, in the form `species[0].radius`.
pub(super) fn key_of(item: &str) -> String {
    let key = item.split_once('=').map_or(item, |(key, _)| key).trim();
    let mut written = String::new();
    for part in parts(key).into_iter().flatten() {
        match part {
            KeyPart::Key(name) if written.is_empty() => name.clone_into(&mut written),
            KeyPart::Key(name) => written = format!("{written}.{name}"),
            KeyPart::Item(index) => written = format!("{written}[{index}]"),
        }
    }
    written
}

/// Whether a key is equal to another one or inside it.
pub(crate) fn is_in(key: &str, other: &str) -> bool {
    key.strip_prefix(other).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
}

/// Value of a key, if there is one.
pub(super) fn get<'a>(root: &'a Value, key: &str) -> Option<&'a Value> {
    parts(key).ok()?.into_iter().try_fold(root, |place, part| match part {
        KeyPart::Key(name) => place.get(name),
        KeyPart::Item(index) => place.get(index),
    })
}

/// `Err` for a key that is not of the form `species[0].radius`.
pub(super) fn check_key(key: &str) -> Result<(), String> {
    parts(key).map(drop)
}

fn value_of(text: &str) -> Value {
    let parsed = toml::from_str::<Table>(&format!("value = {text}")).ok();
    let value = parsed.filter(|table| table.len() == 1).and_then(|mut table| table.remove("value"));
    value.unwrap_or_else(|| Value::String(text.to_owned()))
}

fn set(root: &mut Value, key: &str, value: Value) -> Result<(), String> {
    let is_stress = get(root, "flow.control").and_then(Value::as_str) == Some("stress");
    if let (Some(end), Some(time)) = (key.strip_prefix("time."), root.get_mut("time").and_then(Value::as_table_mut)) {
        let go_together = |other: &str| is_stress && [end, other].iter().all(|end| ENDS[1..].contains(end));
        let replaced = ENDS.iter().filter(|other| ENDS.contains(&end) && **other != end && !go_together(other));
        replaced.for_each(|other| drop(time.remove(*other)));
    }
    let mut place = root;
    for part in parts(key)? {
        place = match (place, part) {
            (Value::Table(table), KeyPart::Key(name)) => {
                table.entry(name).or_insert_with(|| Value::Table(Table::new()))
            }
            (Value::Array(list), KeyPart::Item(index)) => {
                let count = list.len();
                list.get_mut(index).ok_or_else(|| format!("there is no item {index}; the scene has {count}, from 0"))?
            }
            (Value::Table(table), KeyPart::Item(_)) if table.is_empty() => {
                return Err(format!("there is no list in the scene in which {} could be an item", excerpt(key)));
            }
            (found, part) => {
                let (part, found) = (part.shown(), found.type_str());
                return Err(format!(
                    "{} is not a key; {part} has nothing to stand in but a value of type {found}",
                    excerpt(key)
                ));
            }
        };
    }
    *place = value;
    Ok(())
}

/// A part of a key.
enum KeyPart<'a> {
    Key(&'a str),
    Item(usize),
}

impl KeyPart<'_> {
    fn shown(&self) -> String {
        match self {
            Self::Key(name) => format!("\"{}\"", excerpt(name)),
            Self::Item(index) => format!("[{index}]"),
        }
    }
}

/// Parts of a key such as `species[0].radius`, which may be written `species.0.radius`.
fn parts(key: &str) -> Result<Vec<KeyPart<'_>>, String> {
    let wrong = || format!("{} is not a key; write it as in species[0].radius", excerpt(key));
    let mut parts = Vec::new();
    for part in key.split('.') {
        let (name, items) = part.find('[').map_or((part, ""), |start| part.split_at(start));
        match name.parse() {
            Ok(index) => parts.push(KeyPart::Item(index)),
            Err(_) if name.is_empty() => return Err(wrong()),
            Err(_) => parts.push(KeyPart::Key(name)),
        }
        if !items.is_empty() {
            let inside = items.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')).ok_or_else(wrong)?;
            for index in inside.split("][") {
                parts.push(KeyPart::Item(index.parse().map_err(|_| wrong())?));
            }
        }
    }
    Ok(parts)
}

/// Keys that set the end of a run: each replaces the others, except for a strain together with the longest
/// duration under a given stress.
const ENDS: [&str; 3] = ["steps", "duration", "strain"];

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "title = 'a'\n[time]\nstep = 1\n[[species]]\nradius = 1.0\n[[species]]\nradius = 2.0\n";

    fn with(item: &str) -> Result<Table, String> {
        apply(TEXT, &[item.to_owned()], &[]).map(|text| toml::from_str(&text).unwrap())
    }

    #[test]
    fn keys_are_set_where_they_are_or_made() {
        assert_eq!(with("time.step=0.5").unwrap()["time"]["step"], Value::Float(0.5));
        assert_eq!(with("species[1].radius = 3").unwrap()["species"][1]["radius"], Value::Integer(3));
        assert_eq!(with("species.0.force=[0, 0, -1]").unwrap()["species"][0]["force"].as_array().unwrap().len(), 3);
        assert_eq!(with("hydrodynamics.method=direct").unwrap()["hydrodynamics"]["method"].as_str(), Some("direct"));
        let ended = apply("[time]\nduration = 2.0\n", &["time.steps=3".to_owned()], &[]).unwrap();
        assert_eq!(ended.trim(), "[time]\nsteps = 3");
        let sets = ["time.strain=2", "time.duration=9.0"].map(str::to_owned);
        let ended = |text: &str, sets: &[String]| apply(text, sets, &[]).unwrap().trim().to_owned();
        assert_eq!(ended("[time]\nsteps = 5\n", &sets), "[time]\nduration = 9.0");
        let stress = "[flow]\ncontrol = \"stress\"\n\n[time]\n";
        assert_eq!(ended(&format!("{stress}steps = 5\n"), &sets), format!("{stress}duration = 9.0\nstrain = 2"));
        let steps = ended(&format!("{stress}duration = 9.0\nstrain = 2"), &["time.steps=3".to_owned()]);
        assert_eq!(steps, format!("{stress}steps = 3"));
        assert_eq!(with("title=two words").unwrap()["title"].as_str(), Some("two words"));
    }

    #[test]
    fn what_cannot_be_set_is_said() {
        assert!(with("time.step").unwrap_err().contains("write key=value"));
        assert!(with("species[5].radius=1").unwrap_err().contains("no item 5"));
        assert!(with("title.x=1").unwrap_err().contains("nothing to stand in"));
        assert!(with("bonds[0].stiffness=1").unwrap_err().contains("there is no list"));
        for key in ["species[0", "species[x].radius", "species[0]radius", "time[step]", "", "time..step", "time."] {
            assert!(with(&format!("{key}=1")).unwrap_err().contains("write it as in species[0].radius"), "{key}");
        }
    }
}
