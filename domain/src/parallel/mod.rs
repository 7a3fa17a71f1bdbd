//! Parallel loops that can be measured: seconds inside and outside of them, tasks and their sizes, stage by stage.
//!
//! Every loop of an evaluation or a step ends its chain of adapters by [`MeasuredLoop::measured`] or
//! [`MeasuredLoop::moving`], and every part of it opens a [`stage`]. Unless a [`measure`] is under way, a loop costs
//! one load of an atomic more than without, and a stage another. Results have the same bits in either case.
//!
//! Lists that grow with particles, points or pairs are made, copied, compared and joined by the functions of this
//! module ([`mapped`], [`concat()`], [`SortedRows`], [`RowLists`] and others), with the same result on any number of
//! threads; several lists are made in one loop by [`FusedLoops`].

mod fused;
mod iterator;
mod lists;
mod profile;
mod recorder;
mod row_lists;
mod sorted_rows;

pub use fused::FusedLoops;
pub use iterator::{Measured, MeasuredLoop};
pub use lists::{
    ScatteredWrites, all_rows, change, change_rows, concat, copied, equal, greatest, in_blocks, least, mapped,
    mapped_mut, of_rows, overwrite, rows, split,
};
pub use profile::{LoopProfile, Machine, ParallelProfile, SerialPiece, StageProfile};
pub use recorder::{MeasuredStage, TaskClock, measure, parts, sort, stage, wall_clock};
pub use row_lists::RowLists;
pub use sorted_rows::{SortedRows, check_row_numbers};

#[cfg(test)]
mod tests;
