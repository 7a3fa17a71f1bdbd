//! The JSON Schema of scenes.

use crate::kind_names::KINDS;
use crate::{granular_disks, shear_cell, shear_cell_continuum, suspension};
use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, SchemaGenerator};
use serde_json::{Value, json};

/// JSON Schema (draft 7) of scenes, with which editors complete and check keys. It has names, types and required
/// keys; ranges of numbers and exclusive keys are checked when a scene is read.
pub fn scene_schema() -> Value {
    let mut generator = SchemaSettings::draft07().into_generator();
    let kinds = [
        of_kind::<suspension::SuspensionSections>(KINDS[0], &mut generator),
        of_kind::<granular_disks::DisksSections>(KINDS[1], &mut generator),
        of_kind::<shear_cell::ShearCellSections>(KINDS[2], &mut generator),
        of_kind::<shear_cell_continuum::ContinuumSections>(KINDS[3], &mut generator),
    ];
    json!({
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "A scene of fcm-solve",
        "anyOf": kinds,
        "definitions": generator.take_definitions(true),
    })
}

/// Schema of the keys of a kind of scene with this name.
fn of_kind<Raw: JsonSchema>(name: &str, generator: &mut SchemaGenerator) -> Value {
    let mut schema = Raw::json_schema(generator).to_value();
    schema["title"] = name.into();
    schema["properties"]["ensemble"] = json!({
        "type": "object",
        "description": "Many runs that differ in the seed.",
        "additionalProperties": false,
        "required": ["seeds"],
        "properties": { "seeds": {
            "description": "The number of seeds, from that of the scene on, or a list of them.",
            "type": ["integer", "array"],
            "items": { "type": "integer", "minimum": 0 },
        }},
    });
    schema["properties"]["sweep"] = json!({
        "description": "Many runs: keys in quotes with lists of values, or [[sweep]] with a value for each key.",
        "type": ["object", "array"],
        "additionalProperties": { "type": ["array", "object"] },
        "items": { "type": "object" },
    });
    schema["properties"]["kind"] = json!({ "const": name, "description": "What the scene is of." });
    schema
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TEMPLATES;

    /// The schema that a reference points to, or the alternative that is not null.
    fn resolved<'a>(root: &'a Value, schema: &'a Value) -> &'a Value {
        if let Some(name) = schema["$ref"].as_str() {
            return resolved(root, &root["definitions"][name.trim_start_matches("#/definitions/")]);
        }
        let alternatives = schema["anyOf"].as_array().or(schema["allOf"].as_array());
        let not_null = alternatives.and_then(|list| list.iter().find(|one| one["type"] != "null"));
        not_null.map_or(schema, |one| resolved(root, one))
    }

    fn check(root: &Value, schema: &Value, value: &toml::Value, key: &str) {
        let schema = resolved(root, schema);
        match value {
            toml::Value::Table(table) => {
                assert_eq!(schema["additionalProperties"], false, "{key}");
                for (name, value) in table {
                    let key = format!("{key}.{name}");
                    let property = &schema["properties"][name];
                    // Its keys are those of the scene.
                    if name == "sweep" {
                        continue;
                    }
                    assert!(property["description"].is_string(), "{key} has no description");
                    check(root, property, value, &key);
                }
                for name in schema["required"].as_array().into_iter().flatten() {
                    assert!(table.contains_key(name.as_str().unwrap()), "{key} has no {name}");
                }
            }
            toml::Value::Array(items) => items.iter().for_each(|item| {
                if schema["items"].is_object() {
                    check(root, &schema["items"], item, key);
                }
            }),
            toml::Value::String(text) => {
                let names = schema["enum"].as_array().cloned().unwrap_or_default();
                let consts = schema["oneOf"].as_array().into_iter().flatten().map(|one| one["const"].clone());
                let names: Vec<Value> = names.into_iter().chain(consts).collect();
                assert!(names.is_empty() || names.contains(&json!(text)), "{key} = {text}: {names:?}");
            }
            _ => {}
        }
    }

    #[test]
    fn templates_have_the_keys_of_the_schema() {
        let schema = scene_schema();
        for template in TEMPLATES {
            let scene: toml::Value = toml::from_str(template.text).unwrap();
            let kind = scene.get("kind").map_or(KINDS[0], |kind| kind.as_str().unwrap());
            let place = KINDS.iter().position(|&name| name == kind).unwrap();
            check(&schema, &schema["anyOf"][place], &scene, template.name);
        }
    }

    #[test]
    fn a_kind_is_known_by_its_name() {
        let schema = scene_schema();
        for (kind, name) in schema["anyOf"].as_array().unwrap().iter().zip(KINDS) {
            assert_eq!(kind["properties"]["kind"]["const"], name);
            let is_required = kind["required"].as_array().unwrap().contains(&json!("kind"));
            assert_eq!(is_required, name != KINDS[0], "a scene without a kind is a suspension");
        }
    }
}
