//! Common parts of the tests: suspensions, exact answers that share only types with the library, and measures of the
//! error.

#![allow(dead_code, unused_imports, reason = "each test uses a part of it")]

mod dense;
mod measure;
mod moments;
mod ranks;
mod reference;
mod solve;
mod suspension;
mod wavevectors;

pub use measure::{at_surfaces, difference, error, errors, tensors, vectors, worst};
pub use moments::MagnetisedSpheres;
pub use ranks::on_ranks;
pub use reference::Reference;
pub use solve::{rigid_errors, solved};
pub use suspension::Suspension;
