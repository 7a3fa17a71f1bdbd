//! Runs of scenes: starting or resuming the simulation of a scene, and writing its results to a folder.
//!
//! A scene that comes with the program, with a key set, advanced in steps without writing anything:
//! ```
//! use domain::Comm;
//! use scene::{Scene, Template};
//!
//! let template = Template::named("pair-settling").expect("it comes with the program");
//! let scene = Scene::parse(template.text, "pair-settling.toml", &["time.steps=3".to_owned()])?;
//! let mut simulation = run::start(&scene, &Comm::alone(), &mut |_| ())?;
//! while simulation.clock().step() < scene.kind().steps() {
//!     simulation.advance(scene.kind().steps())?;
//! }
//! let velocity = simulation.frame().particles.vectors("velocity")[0];
//! assert!(velocity.z < -1.0, "side by side they fall faster than one alone, whose velocity is 1");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod calibration;
mod continuum;
mod error;
mod family;
mod folder;
mod listener;
mod machine;
mod memory;
mod open_files;
mod outline;
mod ranks;
mod recorder;
mod resumption;
mod scaled_trial;
mod start;
mod start_file;
mod strain_end;
mod trial;
mod whole_scene;

pub use calibration::with_least_repulsion;
pub use error::RunError;
pub use family::{AnswerChange, ChangeVerdict, FamilyFolder, MemberState};
pub use folder::{ExistingRun, RunFolder};
pub use listener::Listener;
pub use machine::{keep_costs, kept_costs, on_this_machine};
pub use memory::{check_memory, predicted_memory};
pub use outline::outline;
pub use ranks::check_ranks;
pub use recorder::{Recorder, provenance};
pub use resumption::Resumption;
pub use scaled_trial::ScaledTrial;
pub use start::{resume, start, start_positions};
pub use start_file::with_start_file;
pub use trial::{Trial, time_in_words, trial};
pub use whole_scene::WholeScene;
