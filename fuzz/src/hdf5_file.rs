//! Edits of an HDF5 file that leave it a valid HDF5 file.

use crate::hostile;
use hdf5::types::{VarLenAscii, VarLenUnicode};
use hdf5::{Extents, File, Group, H5Type};
use proptest::prelude::*;
use proptest::sample::Index;
use std::path::Path;
use toml::Value;

/// An edit. Indices count the groups and datasets of the file.
#[derive(Debug, Clone)]
pub enum Hdf5Edit {
    /// Removes the group or dataset.
    Remove(Index),
    /// Exchanges the two.
    Swap(Index, Index),
    /// Replaces the first by a link to the second: a hard link, or a soft link by name.
    Link(Index, Index, bool),
    /// Replaces it by a link to nothing.
    Dangling(Index),
    /// Replaces it by a dataset of this type and shape.
    Replace(Index, Type, Vec<usize>, f64),
    /// Replaces it by a dataset that claims more numbers than fit on any disk.
    Huge(Index, usize),
    /// Changes one number of a dataset.
    Number(Index, Index, f64),
    /// Replaces it by a group.
    Group(Index),
    /// Removes an attribute, or gives it another type.
    Attribute(Index, String, Option<f64>),
}

/// Type of a dataset.
#[derive(Debug, Clone, Copy)]
pub enum Type {
    /// `i8`.
    Tiny,
    /// `u64`.
    Whole,
    /// `f32`.
    Single,
    /// `f64`.
    Double,
    /// Booleans.
    Bool,
    /// Text of variable length.
    Text,
    /// ASCII text of variable length.
    Ascii,
    /// Pairs of numbers.
    Compound,
}

#[derive(H5Type, Clone, Copy)]
#[repr(C)]
struct NumberPair {
    first: f64,
    second: i32,
}

/// One to three edits.
pub fn edits() -> impl Strategy<Value = Vec<Hdf5Edit>> {
    let index = any::<Index>;
    let types = prop::sample::select(vec![
        Type::Tiny,
        Type::Whole,
        Type::Single,
        Type::Double,
        Type::Bool,
        Type::Text,
        Type::Ascii,
        Type::Compound,
    ]);
    let attribute = prop::sample::select(vec!["program", "unit", "box", "seed", "boundary", "version", "viscosity"]);
    prop::collection::vec(
        prop_oneof![
            2 => index().prop_map(Hdf5Edit::Remove),
            2 => (index(), index()).prop_map(|(a, b)| Hdf5Edit::Swap(a, b)),
            2 => (index(), index(), any::<bool>()).prop_map(|(at, to, hard)| Hdf5Edit::Link(at, to, hard)),
            1 => index().prop_map(Hdf5Edit::Dangling),
            4 => (index(), types, prop::collection::vec(0..4usize, 0..4), hostile::number())
                .prop_map(|(at, kind, shape, number)| Hdf5Edit::Replace(at, kind, shape, number)),
            1 => (index(), 1..4usize).prop_map(|(at, dimensions)| Hdf5Edit::Huge(at, dimensions)),
            4 => (index(), index(), hostile::number())
                .prop_map(|(at, item, number)| Hdf5Edit::Number(at, item, number)),
            1 => index().prop_map(Hdf5Edit::Group),
            1 => (index(), attribute, prop::option::of(hostile::number()))
                .prop_map(|(at, name, number)| Hdf5Edit::Attribute(at, name.to_owned(), number)),
        ],
        1..4,
    )
}

/// Applies edits to a valid file; inapplicable ones are skipped.
pub fn apply(path: &Path, edits: &[Hdf5Edit]) -> hdf5::Result<()> {
    let file = File::open_rw(path)?;
    let mut names = Vec::new();
    collect(&file, "", &mut names)?;
    if !names.is_empty() {
        for edit in edits {
            let _ = change(&file, &names, edit);
        }
    }
    file.close()
}

fn collect(group: &Group, parent: &str, names: &mut Vec<String>) -> hdf5::Result<()> {
    for name in group.member_names()? {
        let name = format!("{parent}/{name}");
        names.push(name.clone());
        if let Ok(inner) = group.file()?.group(&name) {
            collect(&inner, &name, names)?;
        }
    }
    Ok(())
}

fn change(file: &File, names: &[String], edit: &Hdf5Edit) -> hdf5::Result<()> {
    let name = |index: &Index| names[index.index(names.len())].as_str();
    match edit {
        Hdf5Edit::Remove(at) => file.unlink(name(at)),
        Hdf5Edit::Swap(a, b) => {
            file.relink(name(a), "/moved")?;
            file.relink(name(b), name(a))?;
            file.relink("/moved", name(b))
        }
        Hdf5Edit::Link(at, to, hard) => link(file, name(at), name(to), *hard),
        Hdf5Edit::Dangling(at) => {
            file.unlink(name(at))?;
            file.link_soft("/nowhere", name(at))
        }
        Hdf5Edit::Replace(at, kind, shape, number) => {
            file.unlink(name(at))?;
            replacement(file, name(at), (*kind, shape), *number)
        }
        Hdf5Edit::Huge(at, dimensions) => {
            file.unlink(name(at))?;
            let shape = [vec![1 << 40], vec![3; dimensions - 1]].concat();
            let chunk = [vec![1024], vec![3; dimensions - 1]].concat();
            file.new_dataset::<f64>().chunk(chunk).shape(shape).create(name(at)).map(drop)
        }
        Hdf5Edit::Number(at, item, number) => {
            let dataset = file.dataset(name(at))?;
            if dataset.storage_size() == 0 {
                return Ok(());
            }
            let mut values = dataset.read_dyn::<f64>()?;
            let count = values.len().max(1);
            values.iter_mut().skip(item.index(count)).take(1).for_each(|value| *value = *number);
            dataset.write(&values)
        }
        Hdf5Edit::Group(at) => {
            file.unlink(name(at))?;
            file.create_group(name(at)).map(drop)
        }
        Hdf5Edit::Attribute(at, attribute, number) => set_attribute(file, name(at), attribute, *number),
    }
}

/// Replaces an object by a link. A link to a group that contains it makes the file endless.
fn link(file: &File, at: &str, to: &str, hard: bool) -> hdf5::Result<()> {
    let parent = at.rsplit_once('/').map_or("/", |(parent, _)| if parent.is_empty() { "/" } else { parent });
    let to = if hard { parent } else { to };
    file.unlink(at)?;
    if hard { file.link_hard(to, at) } else { file.link_soft(to, at) }
}

fn set_attribute(file: &File, at: &str, name: &str, number: Option<f64>) -> hdf5::Result<()> {
    let group = file.group(at)?;
    drop(group.delete_attr(name));
    match number {
        Some(number) => group.new_attr::<f64>().create(name)?.write_scalar(&number),
        None => Ok(()),
    }
}

fn replacement(group: &Group, name: &str, form: (Type, &[usize]), number: f64) -> hdf5::Result<()> {
    match form.0 {
        Type::Tiny => filled(group, name, form.1, number as i8),
        Type::Whole => filled(group, name, form.1, number as u64),
        Type::Single => filled(group, name, form.1, number as f32),
        Type::Double => filled(group, name, form.1, number),
        Type::Bool => filled(group, name, form.1, number > 0.0),
        Type::Text => filled(group, name, form.1, "a text".parse::<VarLenUnicode>().expect("text")),
        Type::Ascii => filled(group, name, form.1, VarLenAscii::from_ascii("a text").expect("ASCII")),
        Type::Compound => filled(group, name, form.1, NumberPair { first: number, second: 1 }),
    }
}

fn filled<T: H5Type + Clone>(group: &Group, name: &str, shape: &[usize], value: T) -> hdf5::Result<()> {
    let values = ndarray::ArrayD::from_elem(shape.to_vec(), value);
    let extents = if shape.is_empty() { Extents::Scalar } else { Extents::simple(shape.to_vec()) };
    group.new_dataset::<T>().shape(extents).create(name)?.write(&values)
}

/// Writes a tree of keys and values as groups and datasets, like cases in HDF5.
pub fn write_tree(path: &Path, tree: &Value) -> hdf5::Result<()> {
    let file = File::create(path)?;
    write_members(&file, tree);
    file.close()
}

fn write_members(group: &Group, tree: &Value) {
    let Value::Table(table) = tree else { return };
    for (name, value) in table {
        // A name that HDF5 does not allow is skipped.
        let _ = write_member(group, name, value);
    }
}

fn write_member(group: &Group, name: &str, value: &Value) -> hdf5::Result<()> {
    match value {
        Value::Table(_) => {
            write_members(&group.create_group(name)?, value);
            Ok(())
        }
        Value::Boolean(truth) => filled(group, name, &[], *truth),
        Value::Integer(number) => filled(group, name, &[], *number),
        Value::Float(number) => filled(group, name, &[], *number),
        Value::Array(_) => {
            let numbers = flat(value);
            let shape = regular_shape(value).filter(|shape| shape.iter().product::<usize>() == numbers.len());
            let values = ndarray::ArrayD::from_shape_vec(shape.unwrap_or(vec![numbers.len()]), numbers)
                .map_err(|e| hdf5::Error::from(e.to_string()))?;
            group.new_dataset_builder().with_data(&values).create(name).map(drop)
        }
        other => {
            let text: VarLenUnicode = other.as_str().unwrap_or("text").parse().map_err(|_| "a zero byte")?;
            filled(group, name, &[], text)
        }
    }
}

fn flat(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(list) => list.iter().flat_map(flat).collect(),
        Value::Float(number) => vec![*number],
        Value::Integer(number) => vec![*number as f64],
        _ => vec![],
    }
}

fn regular_shape(value: &Value) -> Option<Vec<usize>> {
    let Value::Array(list) = value else { return Some(vec![]) };
    let inner = list.first().map_or(Some(vec![]), regular_shape)?;
    Some([vec![list.len()], inner].concat())
}
