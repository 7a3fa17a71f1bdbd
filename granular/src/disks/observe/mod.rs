//! Observables of a system of disks.

mod averages;
mod lanes;
mod lengths;
mod profile;
mod record;
mod snapshot;
mod strips;

pub use averages::{AveragedProfile, MeanProfileStrip};
pub use lanes::Lanes;
pub use lengths::{estimated_free_path, viscous_length};
pub use profile::ProfileStrip;
pub use record::Record;
pub use snapshot::{Disk, Snapshot};
pub use strips::{Strips, segment};
