//! Kinds of scenes, and the properties that all of them have.

use crate::OutputSchedules;
use crate::granular_disks::GranularDisksScene;
use crate::kind_names::KINDS;
use crate::shear_cell::ShearCellScene;
use crate::shear_cell_continuum::ContinuumScene;
use crate::suspension::SuspensionScene;
use std::path::Path;

/// Kind of a computation, with its checked parameters.
#[derive(Debug)]
pub enum Kind {
    /// Spheres in Stokes flow.
    Suspension(Box<SuspensionScene>),
    /// Disks that collide in a sheared liquid.
    GranularDisks(Box<GranularDisksScene>),
    /// Grains in a shear cell.
    ShearCell(Box<ShearCellScene>),
    /// The kinetic theory of a shear cell.
    Continuum(Box<ContinuumScene>),
}

impl Kind {
    /// Name of the kind in scenes.
    pub fn name(&self) -> &'static str {
        let place = match self {
            Self::Suspension(_) => 0,
            Self::GranularDisks(_) => 1,
            Self::ShearCell(_) => 2,
            Self::Continuum(_) => 3,
        };
        KINDS[place]
    }

    /// Output schedules and folder. `None` for a continuum, which is written once, when it is solved.
    pub fn output(&self) -> Option<&OutputSchedules> {
        match self {
            Self::Suspension(scene) => Some(&scene.output),
            Self::GranularDisks(scene) => Some(&scene.output),
            Self::ShearCell(scene) => Some(&scene.output),
            Self::Continuum(_) => None,
        }
    }

    /// Results folder that the scene sets.
    pub fn folder(&self) -> Option<&Path> {
        match self {
            Self::Continuum(scene) => scene.folder.as_deref(),
            _ => self.output().and_then(|output| output.folder.as_deref()),
        }
    }

    /// The time from which the answers take their means, if the scene says it.
    pub fn answers_from(&self) -> Option<f64> {
        match self {
            Self::Suspension(scene) => scene.answers_from,
            Self::GranularDisks(scene) => scene.answers_from,
            Self::ShearCell(scene) => scene.answers_from,
            Self::Continuum(_) => None,
        }
    }

    /// Seed of the random numbers.
    pub fn seed(&self) -> u64 {
        match self {
            Self::Suspension(scene) => scene.model.seed,
            Self::GranularDisks(scene) => scene.model.parameters().seed,
            Self::ShearCell(scene) => scene.experiment.seed,
            Self::Continuum(_) => 0,
        }
    }

    /// Whether random numbers are used.
    pub fn has_seed(&self) -> bool {
        !matches!(self, Self::Continuum(_))
    }

    /// Last step.
    pub fn steps(&self) -> u64 {
        match self {
            Self::Suspension(scene) => scene.time.steps,
            Self::GranularDisks(scene) => scene.time.steps,
            Self::ShearCell(scene) => scene.time.steps,
            Self::Continuum(_) => 0,
        }
    }
}
