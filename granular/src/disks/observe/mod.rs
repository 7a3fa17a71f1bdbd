//! Observables of a system of disks.

mod lanes;
mod lengths;
mod profile;
mod record;
mod snapshot;
mod strips;

pub use lanes::LaneOrder;
pub use lengths::{estimated_free_path, viscous_length};
pub use profile::{AveragedProfile, AveragedStrip, ProfileStrip};
pub use record::RECORD_COLUMNS;
pub use snapshot::{Disk, Snapshot};
pub use strips::{Strips, segment};
