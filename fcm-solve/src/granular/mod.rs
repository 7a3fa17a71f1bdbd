//! Scenes of grains without a fluid grid: sheared disks, the shear cell and its kinetic theory. They run in one
//! process, on any number of threads.

mod cell;
mod cell_tables;
mod continuum;
mod disks;
mod keeper;
mod memory;
mod outline;
mod sweep;

use anyhow::ensure;
pub use cell::CellRun;
pub use continuum::{is_solved, solve};
pub use disks::DiskRun;
use domain::Comm;
pub use memory::check_room;
pub use outline::outline;
pub use sweep::sweep;

/// Refuses several processes. Collective.
pub fn on_one_rank(comm: &Comm) -> anyhow::Result<()> {
    ensure!(
        comm.size() == 1,
        "scenes of grains run in one process, on as many threads as there are cores; start this one without mpirun"
    );
    Ok(())
}
