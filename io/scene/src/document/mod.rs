//! The values of a file in TOML, JSON or HDF5, and one strict reader for all of them: a list must have exactly the
//! expected length, a section is not a list, and no value is converted to another type if anything is lost.

mod deserializer;
mod excerpt;
mod json;
mod names;
mod number_or;
mod toml_text;
mod type_mismatch;
mod value;

pub use excerpt::{bounded, excerpt};
pub use names::known;
pub use number_or::{Alternative, NumberOr};
pub use toml_text::line;
pub use type_mismatch::TypeMismatch;
pub use value::{KeyValue, Node, Value, WholeNumber};

#[cfg(test)]
mod tests;
