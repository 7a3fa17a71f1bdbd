//! What goes in and out: scenes, the files of a run, and runs from scenes to files.
//!
//! A scene that comes with the program, with a key set, advanced in steps without writing anything:
//! ```
//! use domain::Comm;
//! use io::{Scene, Template};
//!
//! let template = Template::named("pair-settling").expect("it comes with the program");
//! let scene = Scene::parse(template.text, "pair-settling.toml", &["time.steps=3".to_owned()])?;
//! let mut simulation = io::start(&scene, &Comm::alone(), &mut |_| ())?;
//! while simulation.clock().step() < scene.kind().steps() {
//!     simulation.advance(scene.kind().steps())?;
//! }
//! let velocity = simulation.frame().particles.vectors("velocity")[0];
//! assert!(velocity.z < -1.0, "side by side they fall faster than one alone, whose velocity is 1");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod case;
mod causes;
mod checkpoint;
mod checksum;
mod contents;
mod durable;
mod error;
mod export;
mod fields;
mod frames;
mod placed;
mod provenance;
mod recorded;
mod report;
mod run;
mod scene;
mod series;
mod sized;
mod tables;
mod text;
mod trajectory;
mod verified;
mod whole;

pub use case::{Answer, Background, Case, OneOrAll, Terms};
pub use causes::in_full;
pub use checkpoint::Checkpoints;
pub use contents::{Contents, DatasetShape, FrameSpan};
pub use durable::replace as replace_file;
pub use error::FileError;
pub use export::{Format, FrameRange, export};
pub use fields::{drop_fields_after, write_field};
pub use frames::Damage;
pub use placed::read_placed;
pub use provenance::Provenance;
pub use recorded::{Recorded, Snapshot};
pub use report::{ReportError, write_report};
pub use run::{
    Former, Listener, Recorder, RunError, RunFolder, WholeScene, check_room, keep_costs, kept_costs, on_this_machine,
    outline, placed, provenance, resume, start, with_least_repulsion,
};
pub use scene::{
    ContinuumScene, Difference, GranularDisksScene, Kind, Output, Scene, SceneError, ShearCellScene, SuspensionScene,
    TEMPLATES, Template, Time, scene_schema,
};
pub use series::Series;
pub use tables::{read_rows, write_tables};
pub use trajectory::Trajectory;
