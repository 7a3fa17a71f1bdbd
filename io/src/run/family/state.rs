//! The state of each member of a family, as its folder shows it.

use super::FamilyFolder;
use crate::run::WholeScene;
use crate::run::folder::is_locked;
use crate::{Checkpoints, Member, Scene};
use std::fmt::{Display, Formatter};
use std::path::Path;

/// The state of a member.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum MemberState {
    /// It was not started.
    Waiting,
    /// A program is working on it.
    Running,
    /// It has a checkpoint of this step, from which it goes on.
    Stopped(u64),
    /// It ended with an error.
    Failed(String),
    /// It is finished.
    Finished,
}

impl MemberState {
    /// The names of all.
    pub const NAMES: [&str; 5] = ["finished", "running", "stopped", "failed", "waiting"];

    /// In one word.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Waiting => "waiting",
            Self::Running => "running",
            Self::Stopped(_) => "stopped",
            Self::Failed(_) => "failed",
            Self::Finished => "finished",
        }
    }
}

impl Display for MemberState {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Stopped(step) => write!(f, "stopped at step {step}"),
            Self::Failed(why) => write!(f, "failed: {why}"),
            other => f.write_str(other.name()),
        }
    }
}

impl FamilyFolder {
    /// The state of a member, whose scene this is.
    pub fn state(&self, member: &Member, scene: &Scene) -> MemberState {
        let folder = self.member(member);
        if is_finished(&folder, scene) {
            MemberState::Finished
        } else if self.is_running(member) {
            MemberState::Running
        } else if let Some(error) = self.error(member) {
            MemberState::Failed(error)
        } else {
            last_step(&folder).map_or(MemberState::Waiting, MemberState::Stopped)
        }
    }

    /// Whether a program is working on a member.
    pub fn is_running(&self, member: &Member) -> bool {
        is_locked(&self.member(member))
    }

    /// The error with which the last attempt at a member ended.
    pub fn error(&self, member: &Member) -> Option<String> {
        let log = std::fs::read(self.log(member)).ok()?;
        let log = String::from_utf8_lossy(&log);
        log.lines().next_back()?.strip_prefix("error: ").map(str::to_owned)
    }
}

/// The step of the last checkpoint in a folder.
fn last_step(folder: &Path) -> Option<u64> {
    Checkpoints::of(folder).last_step().ok().flatten()
}

/// Whether a folder has all results of a scene.
fn is_finished(folder: &Path, scene: &Scene) -> bool {
    let kept = Scene::read(&folder.join(crate::manifest::SCENE), &[]);
    if !kept.is_ok_and(|kept| scene.is_of_run(&kept)) {
        return false;
    }
    match WholeScene::of(scene) {
        Some(work) => work.is_finished(folder),
        None => last_step(folder) >= Some(scene.kind().steps()),
    }
}
