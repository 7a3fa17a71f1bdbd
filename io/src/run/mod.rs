//! Runs of scenes: what a scene computes is started, or goes on, and its results are written into a folder.

mod calibration;
mod continuum;
mod error;
mod folder;
mod machine;
mod memory;
mod outline;
mod recorder;
mod start;
mod stored_cases;
mod sweep;
mod whole_scene;

pub use calibration::with_least_repulsion;
pub use error::RunError;
pub use folder::{Former, RunFolder};
pub use machine::{keep_costs, kept_costs, on_this_machine};
pub use memory::check_room;
pub use outline::outline;
pub use recorder::{Recorder, provenance};
pub use start::{placed, resume, start};
pub use whole_scene::{Listener, WholeScene};
