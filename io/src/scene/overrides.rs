//! Keys set on the command line.

use toml::{Table, Value};

/// The text of a scene with the keys of `overrides` set, each `key=value` with a dotted key such as
/// `species[0].radius` and a TOML value; a bare word is a string. Comments are lost.
pub(super) fn apply(text: &str, overrides: &[String]) -> Result<String, String> {
    let table: Table = toml::from_str(text).map_err(|e| e.to_string())?;
    let mut root = Value::Table(table);
    for item in overrides {
        let (key, value) =
            item.split_once('=').ok_or_else(|| format!("{item}: write key=value, as in time.step=0.01"))?;
        set(&mut root, key.trim(), value_of(value.trim())).map_err(|message| format!("{item}: {message}"))?;
    }
    toml::to_string(&root).map_err(|e| e.to_string())
}

fn value_of(text: &str) -> Value {
    let parsed = toml::from_str::<Table>(&format!("value = {text}")).ok();
    let value = parsed.filter(|table| table.len() == 1).and_then(|mut table| table.remove("value"));
    value.unwrap_or_else(|| Value::String(text.to_owned()))
}

fn set(root: &mut Value, key: &str, value: Value) -> Result<(), String> {
    if let (Some(end), Some(time)) = (key.strip_prefix("time."), root.get_mut("time").and_then(Value::as_table_mut)) {
        let replaced = ENDS.iter().filter(|other| ENDS.contains(&end) && **other != end);
        replaced.for_each(|other| drop(time.remove(*other)));
    }
    let dotted = key.replace('[', ".").replace(']', "");
    let mut place = root;
    for part in dotted.split('.') {
        place = match place {
            Value::Table(table) if !part.is_empty() => table.entry(part).or_insert_with(|| Value::Table(Table::new())),
            Value::Array(array) => {
                let count = array.len();
                let item = part.parse().ok().and_then(|i: usize| array.get_mut(i));
                item.ok_or_else(|| format!("there is no item {part} in {key}; the scene has {count}, from 0"))?
            }
            _ => return Err(format!("{key} is not a key; {part:?} has nothing to stand in")),
        };
    }
    *place = value;
    Ok(())
}

/// Ways to say when a run ends: one takes the place of another.
const ENDS: [&str; 3] = ["steps", "duration", "strain"];

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "title = 'a'\n[time]\nstep = 1\n[[species]]\nradius = 1.0\n[[species]]\nradius = 2.0\n";

    fn with(item: &str) -> Result<Table, String> {
        apply(TEXT, &[item.to_owned()]).map(|text| toml::from_str(&text).unwrap())
    }

    #[test]
    fn keys_are_set_where_they_are_or_made() {
        assert_eq!(with("time.step=0.5").unwrap()["time"]["step"], Value::Float(0.5));
        assert_eq!(with("species[1].radius = 3").unwrap()["species"][1]["radius"], Value::Integer(3));
        assert_eq!(with("species.0.force=[0, 0, -1]").unwrap()["species"][0]["force"].as_array().unwrap().len(), 3);
        assert_eq!(with("hydrodynamics.method=direct").unwrap()["hydrodynamics"]["method"].as_str(), Some("direct"));
        let ended = apply("[time]\nduration = 2.0\n", &["time.steps=3".to_owned()]).unwrap();
        assert_eq!(ended.trim(), "[time]\nsteps = 3");
        assert_eq!(with("title=two words").unwrap()["title"].as_str(), Some("two words"));
    }

    #[test]
    fn what_cannot_be_set_is_said() {
        assert!(with("time.step").unwrap_err().contains("write key=value"));
        assert!(with("species[5].radius=1").unwrap_err().contains("no item 5"));
        assert!(with("title.x=1").unwrap_err().contains("nothing to stand in"));
    }
}
