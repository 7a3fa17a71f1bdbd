//! Families of runs: their folder, the state of each member, and the table of means over the seeds.

mod answers;
mod changes;
mod disks;
mod folder;
mod spread;
mod state;
mod table;
#[cfg(test)]
mod tests;

pub use changes::{AnswerChange, ChangeVerdict};
pub use folder::FamilyFolder;
pub use state::MemberState;
