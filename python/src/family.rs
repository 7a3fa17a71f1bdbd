//! Families of runs, whose members are run in Python processes.

use crate::error::{explained, input_error, of_scene};
use files::SCENES;
use pyo3::prelude::*;
use run::{ExistingRun, FamilyFolder, MemberState};
use scene::{Family, SceneFile};
use std::path::{Path, PathBuf};

fn family(text: &str, name: &str) -> PyResult<Family> {
    match SCENES.parse_file(text, name, &[]).map_err(|cause| of_scene(&cause))? {
        SceneFile::Family(family) => Ok(family),
        SceneFile::Scene(_) => {
            Err(input_error(format!("{name} is a scene of one run; a family has [ensemble] or [sweep]")))
        }
    }
}

/// Prepares a folder for a family, or continues the family in it. Returns name, folder and scene of each member that is
/// not finished.
#[pyfunction]
pub fn claim_family(text: &str, name: &str, out: PathBuf, force: bool) -> PyResult<Vec<(String, PathBuf, String)>> {
    let family = family(text, name)?;
    let former = if force { ExistingRun::Replace } else { ExistingRun::Continue };
    let folder = FamilyFolder::claim(&out, &family, former).map_err(|cause| explained(&cause))?;
    let mut missing = Vec::new();
    for member in family.members() {
        let scene = family.scene(member).map_err(|cause| of_scene(&cause))?;
        if folder.state(member, &scene) != MemberState::Finished {
            missing.push((member.to_string(), folder.member(member), scene.text().to_owned()));
        }
    }
    Ok(missing)
}

/// Writes the table of a family, and returns it as JSON.
#[pyfunction]
pub fn write_family(text: &str, name: &str, out: PathBuf) -> PyResult<String> {
    let (family, folder) = (family(text, name)?, FamilyFolder::of(Path::new(&out)));
    let written = folder.write_table(&family).and_then(|()| folder.table(&family));
    Ok(written.map_err(|cause| explained(&cause))?.to_json().to_string())
}
