//! Commands that are the same each time, run from a recording.

use crate::task::{DeviceAddress, KernelTask};

/// Lists of commands that are recorded, by what they do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CommandList {
    /// Order of the particles by bins, and the number of neighbours.
    Order,
    /// Numbers of near pairs.
    CountPairs,
    /// Rows of near pairs.
    Assemble,
    /// The first measure of a residual for stresslets, and an iteration.
    MeasureStrain,
    IterateStrain,
    /// A step of Lanczos' iteration.
    Krylov,
    /// Solve with all near pairs from the start of a solve, and further steps.
    AllPairs,
    MoreOfAllPairs,
    /// The first residual.
    Residual,
    /// The first measure of the residual, an iteration, and further steps of the preconditioner in both.
    Measure,
    Iteration,
    MoreSteps,
    /// The last solve of the preconditioner, and further steps.
    LastPairs,
    MoreOfLastPairs,
    /// The result.
    Result,
}

/// Number of recordings.
pub(crate) const COMMAND_LISTS: usize = CommandList::Result as usize + 1;

/// All on which commands depend, but for the contents of memory.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CommandKey {
    pub task: Box<KernelTask>,
    /// Addresses, and other numbers.
    pub addresses: Vec<DeviceAddress>,
}

/// Commands that run again and again with the same arguments.
#[derive(Debug, Default, PartialEq)]
pub(crate) enum Repeated {
    /// They have not run yet.
    #[default]
    New,
    /// They have run once, so that all memory and plans that they need are there.
    Tried(CommandKey),
    /// They are the last recording.
    Recorded(CommandKey),
    /// The device does not record them.
    Plain(CommandKey),
}
