//! The values of a file in TOML, JSON or HDF5, and one strict reader for all of them: a list must have exactly the
//! expected length, a section is not a list, and no value is converted to another type if anything is lost.

mod deserializer;
mod excerpt;
mod json;
mod misfit;
mod names;
mod number_or;
mod toml_text;
mod value;

pub(crate) use excerpt::{bounded, excerpt};
pub(crate) use misfit::Misfit;
pub(crate) use names::known;
pub(crate) use number_or::{Alternative, NumberOr};
pub(crate) use toml_text::line;
pub(crate) use value::{Entry, Node, Value, Whole};

#[cfg(test)]
mod tests;
