//! A case in HDF5, as if it were JSON.

use crate::claimed_size;
use hdf5::types::{TypeDescriptor, VarLenAscii, VarLenUnicode};
use hdf5::{Container, Group};
use serde_json::{Map, Value, json};

/// The datasets and attributes of a group as a JSON object, with its groups, and their content if `counts`: a case has
/// only one level of groups, and links may form cycles.
pub(super) fn contents(group: &Group, counts: bool) -> hdf5::Result<Value> {
    let mut object = Map::new();
    for name in group.attr_names()? {
        object.insert(name.clone(), value(&name, &*group.attr(&name)?)?);
    }
    for name in group.member_names()? {
        let value = match group.dataset(&name) {
            Ok(dataset) => value(&name, &dataset)?,
            Err(_) if counts => contents(&group.group(&name)?, false)?,
            Err(_) => json!({}),
        };
        object.insert(name, value);
    }
    Ok(Value::Object(object))
}

fn value(name: &str, container: &Container) -> hdf5::Result<Value> {
    claimed_size::check(container)?;
    match container.dtype()?.to_descriptor()? {
        TypeDescriptor::Boolean => return Ok(json!(container.read_scalar::<bool>()?)),
        TypeDescriptor::VarLenUnicode if container.ndim() == 1 => {
            let words = container.read_raw::<VarLenUnicode>()?;
            return Ok(json!(words.iter().map(VarLenUnicode::as_str).collect::<Vec<_>>()));
        }
        TypeDescriptor::VarLenUnicode => return Ok(json!(container.read_scalar::<VarLenUnicode>()?.as_str())),
        TypeDescriptor::VarLenAscii => return Ok(json!(container.read_scalar::<VarLenAscii>()?.as_str())),
        _ => {}
    }
    let numbers = container.read_dyn::<f64>()?;
    if let Some(wrong) = numbers.iter().find(|number| !number.is_finite()) {
        // JSON has no such numbers; without this they would count as absent.
        return Err(format!("{name} contains {wrong}; every number needs to be finite").into());
    }
    Ok(nested(&numbers.view()))
}

fn nested(numbers: &ndarray::ArrayViewD<f64>) -> Value {
    if numbers.ndim() == 0 {
        return json!(numbers.first());
    }
    Value::Array(numbers.outer_iter().map(|inner| nested(&inner)).collect())
}
