//! The folder of a family, in which each member has its own folder. Any number of processes may work in it at the
//! same time, on different members.

use super::table;
use crate::folder::{RunFolder, lock_when_free};
use crate::{ExistingRun, RunError};
use domain::Comm;
use files::{FileError, MANIFEST, Manifest, SCENE, SCENES};
use scene::{Family, Member, Rule, SceneFile, differences_of, is_none, rule, some_of};
use simulation::Table;
use std::path::{Path, PathBuf};

/// The folder of a family's results.
#[derive(Debug, Clone)]
pub struct FamilyFolder {
    path: PathBuf,
}

/// Name of the log in the folder of a member.
const LOG: &str = "run.log";

impl FamilyFolder {
    /// Prepares the folder for a family: stores its scene, and creates a folder for each member.
    pub fn claim(path: &Path, family: &Family, former: ExistingRun) -> Result<Self, RunError> {
        let mut run = RunFolder::claim_when_free(path, former)?;
        let kept = std::fs::read_to_string(run.scene()).ok().filter(|_| former == ExistingRun::Continue);
        if let Some(kept) = kept {
            refuse_another(family, &kept, path)?;
            if kept != family.text() {
                run.keep(family.text())?;
            }
        } else {
            clear_members(run.manifest())?;
            run.start_with(family.text())?;
        }
        let mut folders: Vec<String> = family.members().iter().map(Member::folder).collect();
        let logs = folders.iter().map(|folder| format!("{folder}/{LOG}"));
        let files: Vec<String> = logs.chain(table::FILES.map(str::to_owned)).collect();
        folders
            .extend(folders.iter().filter_map(|folder| Some(folder.split_once('/')?.0.to_owned())).collect::<Vec<_>>());
        folders.sort();
        folders.dedup();
        run.manifest().make_folders(&folders, &files)?;
        Ok(Self { path: path.to_owned() })
    }

    /// Folder of a family, for reading.
    pub fn of(path: &Path) -> Self {
        Self { path: path.to_owned() }
    }

    /// The family in a folder; `None` if it holds none, or no results at all.
    pub fn family(path: &Path) -> Option<Family> {
        match SCENES.read_file(&path.join(SCENE), &[]).ok()? {
            SceneFile::Family(family) => Some(family),
            SceneFile::Scene(_) => None,
        }
    }

    /// Whether a folder holds a family.
    pub fn holds_family(path: &Path) -> bool {
        std::fs::read_to_string(path.join(SCENE)).is_ok_and(|text| Family::is_text_of_one(&text))
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Folder of a member.
    pub fn member(&self, member: &Member) -> PathBuf {
        self.path.join(member.folder())
    }

    /// Path of the log of a member.
    pub fn log(&self, member: &Member) -> PathBuf {
        self.member(member).join(LOG)
    }

    /// Table of means over the seeds, for the members that have answers so far.
    pub fn table(&self, family: &Family) -> Result<Table, RunError> {
        Ok(table::table(self, family)?)
    }

    /// Writes the table of means over the seeds, for the members that have answers so far.
    pub fn write_table(&self, family: &Family) -> Result<(), RunError> {
        let _lock = lock_when_free(&self.path)?;
        Ok(table::write(self, family, &Manifest::of(&self.path)?)?)
    }
}

/// Removes the results of the members of a former family.
fn clear_members(manifest: &Manifest) -> Result<(), RunError> {
    let of_members = manifest.folders().into_iter().filter(|folder| folder.join(MANIFEST).is_file());
    of_members
        .into_iter()
        .try_for_each(|folder| RunFolder::claim(&folder, &Comm::alone(), ExistingRun::Replace)?.clear())
}

/// Refuses to continue a family other than the stored one. Values and seeds may be added and removed.
fn refuse_another(family: &Family, kept: &str, path: &Path) -> Result<(), RunError> {
    let all = differences_of(family.text(), kept).map_err(|e| FileError::damaged(&path.join(SCENE), &e))?;
    let is_of_lists = |key: &str| ["ensemble", "sweep"].contains(&key.split(['.', '[']).next().unwrap_or_default());
    let stays = all.iter().filter(|d| !is_of_lists(&d.key) && rule(&d.key) == Rule::Fixed && !is_none(d));
    let other: Vec<String> = stays.map(ToString::to_string).collect();
    let what = match (Family::is_text_of_one(kept), &other[..]) {
        (true, []) => return Ok(()),
        (true, other) => format!("another family: {}", some_of(other)),
        (false, _) => "a single run".to_owned(),
    };
    Err(RunError::Refused(format!(
        "{} holds {what}; name another folder with --out, or replace that with --force",
        path.display()
    )))
}
