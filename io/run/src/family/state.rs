//! State of each member of a family, according to its folder.

use super::FamilyFolder;
use crate::WholeScene;
use crate::folder::is_locked;
use files::{Checkpoints, SCENE, SCENES};
use scene::{Member, Scene};
use std::fmt::{Display, Formatter};
use std::path::Path;

/// The state of a member.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum MemberState {
    /// Not started.
    Waiting,
    /// A process is working on it.
    Running,
    /// Stopped; it can continue from a checkpoint of this step.
    Stopped(u64),
    /// Ended with an error.
    Failed(String),
    /// Finished.
    Finished,
}

impl MemberState {
    /// Names of all states.
    pub const NAMES: [&str; 5] = ["finished", "running", "stopped", "failed", "waiting"];

    /// Name of the state.
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

/// Beginning of the log line with which a run reports that it is finished.
const FINISHED: &str = "finished";
/// Beginnings of the log lines with which a run reports its end.
const ENDS: [&str; 3] = [FINISHED, "stopped", "error: "];

impl FamilyFolder {
    /// State of a member with this scene.
    pub fn state(&self, member: &Member, scene: &Scene) -> MemberState {
        let folder = self.member(member);
        if self.is_finished(member, scene) {
            MemberState::Finished
        } else if self.is_running(member) {
            MemberState::Running
        } else if let Some(error) = self.error(member) {
            MemberState::Failed(error)
        } else {
            last_step(&folder).map_or(MemberState::Waiting, MemberState::Stopped)
        }
    }

    /// Whether a process is working on a member.
    pub fn is_running(&self, member: &Member) -> bool {
        is_locked(&self.member(member))
    }

    /// Error with which the last attempt at a member ended.
    pub fn error(&self, member: &Member) -> Option<String> {
        self.last_said(member)?.strip_prefix("error: ").map(str::to_owned)
    }

    /// Line of a member's log that reports the end of its last attempt.
    fn last_said(&self, member: &Member) -> Option<String> {
        let log = std::fs::read(self.log(member)).ok()?;
        let log = String::from_utf8_lossy(&log);
        log.lines().rev().find(|line| ENDS.iter().any(|end| line.starts_with(end))).map(str::to_owned)
    }

    /// Whether a member has all results, at its last step or at an earlier end, such as that of a jammed suspension.
    fn is_finished(&self, member: &Member, scene: &Scene) -> bool {
        let folder = self.member(member);
        let Ok(kept) = SCENES.read(&folder.join(SCENE), &[]) else { return false };
        if !scene.is_of_run(&kept) {
            return false;
        }
        if let Some(work) = WholeScene::of(scene) {
            return work.is_finished(&folder);
        }
        let is_same_time = || scene.differences(&kept).iter().all(|difference| !difference.key.starts_with("time."));
        let has_ended = || self.last_said(member).is_some_and(|line| line.starts_with(FINISHED));
        last_step(&folder) >= Some(scene.kind().steps()) || has_ended() && is_same_time()
    }
}

/// Step of the last checkpoint in a folder.
fn last_step(folder: &Path) -> Option<u64> {
    Checkpoints::of(folder).last_step().ok().flatten()
}
