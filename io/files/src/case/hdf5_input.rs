//! Cases in HDF5.

use crate::claimed_size;
use hdf5::types::{FixedAscii, FixedUnicode, TypeDescriptor, VarLenAscii, VarLenUnicode};
use hdf5::{Container, Group, H5Type};
use ndarray::{ArrayD, ArrayViewD};
use scene::Case;
use scene::document::{KeyValue, Node, TypeMismatch, Value, WholeNumber};

/// Bytes of a string of fixed length.
const WORD: usize = 256;

/// Reads the datasets and attributes of a group, and its groups; the content of these only if `counts`: a case has
/// only one level of groups, and links may form cycles.
pub(super) fn contents(group: &Group, counts: bool) -> hdf5::Result<Node> {
    let mut entries: Vec<KeyValue> = Vec::new();
    for name in group.attr_names()? {
        let node = value(&name, &*group.attr(&name)?)?;
        entries.push(KeyValue { key: name.into(), node });
    }
    for name in group.member_names()? {
        if entries.iter().any(|entry| *entry.key == *name) {
            return Err(format!("{name} is both an attribute and a dataset; leave one of them out").into());
        }
        let node = match group.dataset(&name) {
            Ok(dataset) => value(&name, &dataset)?,
            Err(_) if counts => contents(&group.group(&name)?, false)?,
            Err(_) => Value::Section(Box::default()).into(),
        };
        entries.push(KeyValue { key: name.into(), node });
    }
    Ok(Value::Section(entries.into()).into())
}

/// Message about an invalid value, with the shape of its dataset.
pub(super) fn in_words(mismatch: &TypeMismatch, file: &Group) -> String {
    let words = mismatch.in_words(Case::DOCUMENT);
    let shape = mismatch.first_key().and_then(|key| file.dataset(key).ok()).map(|dataset| dataset.shape());
    match shape.as_deref() {
        None | Some([]) => words,
        Some(&[width @ (3 | 5), count]) if count != 3 && count != 5 => format!(
            "{words}; the dataset has the shape ({width}, {count}), which is likely that of Julia, MATLAB or Fortran, \
             where the first index runs fastest: transpose it"
        ),
        Some(shape) => {
            let shape: Vec<String> = shape.iter().map(usize::to_string).collect();
            format!("{words}; the dataset has the shape ({})", shape.join(", "))
        }
    }
}

fn value(name: &str, container: &Container) -> hdf5::Result<Node> {
    claimed_size::check(container)?;
    let of_type = container.dtype()?.to_descriptor();
    match of_type.map_err(|error| format!("{name} is of a type that is unknown here: {error}"))? {
        TypeDescriptor::Boolean => all(container, |&value: &bool| Value::Bool(value)),
        TypeDescriptor::Integer(_) => all(container, |&number: &i64| whole(number.into())),
        TypeDescriptor::Unsigned(_) => all(container, |&number: &u64| whole(number.into())),
        TypeDescriptor::Float(_) => reals(name, container),
        TypeDescriptor::VarLenUnicode => all(container, |word: &VarLenUnicode| text(word)),
        TypeDescriptor::VarLenAscii => all(container, |word: &VarLenAscii| text(word)),
        TypeDescriptor::FixedAscii(bytes) if bytes <= WORD => all(container, |word: &FixedAscii<WORD>| text(word)),
        TypeDescriptor::FixedUnicode(bytes) if bytes <= WORD => all(container, |word: &FixedUnicode<WORD>| text(word)),
        TypeDescriptor::Compound(_) => {
            Err(format!("{name} has complex or compound values; it needs to have real numbers").into())
        }
        other => {
            Err(format!("{name} has values of type {other}; it needs to have numbers, words, or true or false").into())
        }
    }
}

fn text(word: &str) -> Value {
    Value::Text(word.into())
}

fn whole(number: i128) -> Value {
    Value::Whole(WholeNumber::of(number).expect("a number of 64 bits"))
}

fn reals(name: &str, container: &Container) -> hdf5::Result<Node> {
    let numbers: ArrayD<f64> = container.read_dyn()?;
    match numbers.iter().find(|number| !number.is_finite()) {
        Some(wrong) => Err(format!("{name} contains {wrong}; every number needs to be finite").into()),
        None => Ok(nested(&numbers.view(), &|&number| Value::Real(number))),
    }
}

fn all<T: H5Type>(container: &Container, value: impl Fn(&T) -> Value) -> hdf5::Result<Node> {
    Ok(nested(&container.read_dyn()?.view(), &value))
}

fn nested<T>(values: &ArrayViewD<T>, value: &dyn Fn(&T) -> Value) -> Node {
    match values.first() {
        Some(only) if values.ndim() == 0 => value(only).into(),
        _ => Value::List(values.outer_iter().map(|inner| nested(&inner, value)).collect()).into(),
    }
}
