//! Input and output: scenes, the files of a run, and runs that read a scene and write their results.
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

mod answers;
mod atomic_file;
mod atomic_hdf5;
mod case;
mod causes;
mod checkpoint;
mod checksum;
mod claimed_size;
mod contacts;
mod contents;
mod document;
mod error;
mod export;
mod fields;
mod folder_contents;
mod frames;
mod manifest;
mod missing_steps;
mod observables;
mod origin;
mod positions;
mod provenance;
mod report;
mod run;
mod scene;
mod scene_history;
mod series;
mod stored_inside;
mod tables;
mod text;
mod trajectory;
mod trajectory_reader;
mod verified;
mod watched_file;

pub use answers::{
    ANSWERS, AnswerRange, RunAnswer, answers_in_json, answers_in_lines, read_answers, run_answers, value_in_words,
    verdict_in_words, write_answers,
};
pub use atomic_file::replace as replace_file;
pub use case::{
    Answer, Background, BoundariesError, Case, CaseBoundary, CaseBox, CaseBoxError, CaseMethod, NOISE_NUMBERS, Noise,
    OneOrAll, Terms, UnknownBoundary, UnknownMethod,
};
pub use causes::in_full;
pub use checkpoint::{Checkpoints, Latest, SceneRecord};
pub use contacts::{RecordedContacts, drop_contacts_after, write_contacts};
pub use contents::{Contents, DatasetShape, FrameSpan};
pub use error::FileError;
pub use export::{ContactFormat, Format, FrameRange, export, export_contacts};
pub use fields::{drop_fields_after, write_field};
pub use folder_contents::{FolderContents, FolderFile};
pub use frames::Damage;
pub use manifest::{MANIFEST, Manifest, Obstacles};
pub use missing_steps::MissingSteps;
pub use positions::{FileBox, StartFile, StartSource, TakenFrame};
pub use provenance::Provenance;
pub use report::{ReportError, write_report};
pub use run::{
    AnswerChange, ChangeVerdict, ExistingRun, FamilyFolder, Listener, MemberState, Recorder, Resumption, RunError,
    RunFolder, ScaledTrial, Trial, WholeScene, check_memory, check_ranks, keep_costs, kept_costs, on_this_machine,
    outline, predicted_memory, provenance, resume, start, start_positions, time_in_words, trial, with_least_repulsion,
    with_start_file,
};
pub use scene::{
    ContinuumScene, Convergence, Difference, Family, GranularDisksScene, Kind, Member, Output, Scene, SceneChange,
    SceneError, SceneFile, ShearCellScene, SuspensionScene, TEMPLATES, Template, Time, check_accepted, scene_schema,
    some_of,
};
pub use series::Series;
pub use tables::{read_rows, write_tables};
pub use trajectory::Trajectory;
pub use trajectory_reader::{Snapshot, TrajectoryReader};
