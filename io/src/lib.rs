//! What goes in and out: scenes, and the files of a run.

mod case;
mod checkpoint;
mod checksum;
mod contents;
mod durable;
mod error;
mod fields;
mod frames;
mod memory;
mod placed;
mod provenance;
mod recorded;
mod scene;
mod schedule;
mod series;
mod sized;
mod tables;
mod text;
mod trajectory;
mod whole;

pub use case::{Answer, Background, Case, OneOrAll, Terms};
pub use checkpoint::Checkpoint;
pub use contents::{Contents, FrameSpan};
pub use durable::replace as replace_file;
pub use error::FileError;
pub use fields::{VelocityField, drop_fields_after};
pub use frames::Damage;
pub use memory::frame_bytes;
pub use placed::Placed;
pub use provenance::Provenance;
pub use recorded::Recorded;
pub use scene::{
    Adaptive, Axis, ContinuumScene, Difference, Evaluation, Flow, GranularDisksScene, Hydrodynamics, Integrator, Kind,
    Lattice, Multipoles, Output, Repulsion, Scene, SceneError, ShearCellScene, Species, Start, Statistics,
    SuspensionScene, Time,
};
pub use schedule::Schedule;
pub use series::{Quantity, Series};
pub use tables::{Table, write_tables};
pub use trajectory::{Frame, Trajectory};
