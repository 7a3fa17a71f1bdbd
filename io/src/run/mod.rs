//! Runs of scenes: what a scene computes is started, or goes on, and its results are written into a folder.

mod continuum;
mod error;
mod folder;
mod memory;
mod outline;
mod recorder;
mod start;
mod stored_cases;
mod sweep;
mod whole_scene;

pub use error::RunError;
pub use folder::{Former, RunFolder};
pub use memory::check_room;
pub use outline::outline;
pub use recorder::{Recorder, provenance};
pub use start::{placed, resume, start};
pub use whole_scene::{Listener, WholeScene};
