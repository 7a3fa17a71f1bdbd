//! The scene of a run, as the report needs it.

use crate::playback::Colours;
use domain::Vector;
use files::SCENES;
use granular::disks::DiskFlow;
use scene::{Family, Kind, Scene, SceneFile};
use suspension::Flow;
use toml::Table;

/// The scene of a run. If this version cannot read it, e.g. because it is from a later version, only its text.
pub(super) struct About {
    file: Option<SceneFile>,
    table: Table,
}

impl About {
    /// Reads the text of a scene.
    pub(super) fn of(text: &str) -> Self {
        let file = SCENES.parse_file(text, "the scene of the run", &[]).ok();
        Self { file, table: text.parse().unwrap_or_default() }
    }

    /// The scene, if this version can read it.
    pub(super) fn scene(&self) -> Option<&Scene> {
        match self.file.as_ref()? {
            SceneFile::Scene(scene) => Some(scene),
            SceneFile::Family(_) => None,
        }
    }

    /// Kind of the scene.
    pub(super) fn kind(&self) -> Option<&Kind> {
        self.scene().map(Scene::kind)
    }

    /// The family, if the scene is one.
    pub(super) fn family(&self) -> Option<&Family> {
        match self.file.as_ref()? {
            SceneFile::Family(family) => Some(family),
            SceneFile::Scene(_) => None,
        }
    }

    /// Name of the kind.
    pub(super) fn kind_name(&self) -> &str {
        self.text("kind").unwrap_or("suspension")
    }

    /// The title, if it has one.
    pub(super) fn title(&self) -> Option<&str> {
        self.text("title").filter(|title| !title.is_empty())
    }

    fn text(&self, key: &str) -> Option<&str> {
        self.table.get(key).and_then(toml::Value::as_str)
    }

    /// Word for the particles.
    pub(super) fn particles(&self) -> &'static str {
        match self.kind() {
            Some(Kind::GranularDisks(_)) => "disks",
            Some(Kind::ShearCell(_)) => "grains",
            _ => "spheres",
        }
    }

    /// Names of the species; empty if they have none.
    pub(super) fn species(&self) -> Vec<String> {
        match self.kind() {
            Some(Kind::Suspension(scene)) => scene.model.species.iter().map(|species| species.name.clone()).collect(),
            Some(Kind::GranularDisks(_)) => ["small", "large"].map(String::from).to_vec(),
            Some(Kind::ShearCell(_)) => vec!["grains".to_owned()],
            _ => Vec::new(),
        }
    }

    /// Axis of the largest applied force, and its name; `None` without forces.
    pub(super) fn force_axis(&self) -> Option<(usize, char)> {
        let Some(Kind::Suspension(scene)) = self.kind() else { return None };
        let axes = scene.model.user_axes();
        scene.model.force_axis().map(|axis| (axes.axis(axis), axes.name(axis)))
    }

    /// Axis that is drawn upwards, y or z: normal to the walls, along the gradient of a shear flow, or
    /// along the height of a cell.
    pub(super) fn up(&self) -> char {
        match self.kind() {
            Some(Kind::Suspension(scene)) if scene.model.cell.boundaries().walls() > 0 => {
                if scene.model.user_axes().name(2) == 'y' { 'y' } else { 'z' }
            }
            Some(Kind::Suspension(scene)) if matches!(scene.model.flow, Flow::None) => match self.force_axis() {
                Some((1, _)) => 'y',
                _ => 'z',
            },
            _ => 'y',
        }
    }

    /// Data of the scene for colouring particles.
    pub(super) fn colours(&self) -> Colours {
        Colours { species: self.species(), flow: self.flow() }
    }

    /// The flow relative to which velocities are shown.
    fn flow(&self) -> Option<Box<dyn Fn(Vector) -> Vector>> {
        match self.kind()? {
            Kind::Suspension(scene) => match scene.model.flow {
                Flow::Shear { rate, .. } if scene.model.shear_rates().is_constant() => {
                    let axes = scene.model.user_axes();
                    let (along, gradient) = (axes.vector(Vector::X), axes.axis(scene.model.cell.gradient_axis()));
                    Some(Box::new(move |place| along * (rate * place[gradient])))
                }
                flow @ Flow::Extension { rate, .. } if scene.model.shear_rates().is_constant() => {
                    Some(Box::new(move |place| flow.at_rate(rate).velocity(place)))
                }
                _ => None,
            },
            Kind::GranularDisks(scene) => {
                let parameters = scene.model.parameters();
                let (flow, height) = (parameters.flow, parameters.edges[1]);
                let moves = !matches!(flow, DiskFlow::Still);
                moves.then(|| Box::new(move |place: Vector| Vector::X * flow.velocity(place.y, height)) as Box<_>)
            }
            _ => None,
        }
    }
}
