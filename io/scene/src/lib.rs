//! Scenes, the input files of runs, and cases, the input of single evaluations: their keys, checks and messages.
//!
//! A scene that comes with the program, with a key set:
//! ```
//! use scene::{Scene, Template};
//!
//! let template = Template::named("pair-settling").expect("it comes with the program");
//! let scene = Scene::parse(template.text, "pair-settling.toml", &["time.steps=3".to_owned()])?;
//! assert_eq!(scene.kind().steps(), 3);
//! # Ok::<(), scene::SceneError>(())
//! ```

mod answers;
mod case;
mod causes;
mod changes;
mod checks;
mod differences;
pub mod document;
mod error;
mod family;
mod family_sections;
mod former_names;
mod granular_disks;
mod kept_paths;
mod key_error;
mod kind;
mod kind_names;
mod overrides;
mod reader;
mod scene;
mod schema;
mod shear_cell;
mod shear_cell_continuum;
mod start_box;
mod start_source;
mod suspension;
mod template;
mod text_size;
mod time_and_output;
mod written_names;

pub use self::suspension::SuspensionScene;
pub use case::{
    BoundariesError, Case, CaseBackground, CaseBoundary, CaseBox, CaseBoxError, CaseDevice, CaseMethod, CaseNoise,
    CaseTerms, NOISE_NUMBERS, OneOrAll, UnknownBoundary, UnknownMethod,
};
pub use causes::in_full;
pub use changes::{Rule, SceneChange, check_accepted, is_none, rule, some_of};
pub use differences::{Difference, differences_of};
pub use error::SceneError;
pub use family::{Convergence, Family, Member, SceneFile};
pub use granular_disks::GranularDisksScene;
pub use kind::Kind;
pub use reader::SceneReader;
pub use scene::Scene;
pub use schema::scene_schema;
pub use shear_cell::ShearCellScene;
pub use shear_cell_continuum::ContinuumScene;
pub use start_box::EdgesOfStartFile;
pub use start_source::StartSource;
pub use template::{TEMPLATES, Template};
pub use time_and_output::{OutputSchedules, Time};
