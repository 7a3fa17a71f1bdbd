//! Parallel loops that can be measured: seconds inside and outside of them, tasks and their sizes, stage by stage.
//!
//! Every loop of an evaluation or a step ends its chain of adapters by [`MeasuredLoop::measured`] or
//! [`MeasuredLoop::moving`], and every part of it opens a [`stage`]. Unless a [`measure`] is under way, a loop costs
//! one load of an atomic more than without, and a stage another. Results have the same bits in either case.

mod iterator;
mod profile;
mod recorder;

pub use iterator::{Measured, MeasuredLoop};
pub use profile::{LoopProfile, Machine, ParallelProfile, SerialPiece, StageProfile};
pub use recorder::{MeasuredStage, TaskClock, measure, parts, sort, stage, wall_clock};

#[cfg(test)]
mod tests;
