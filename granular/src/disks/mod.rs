//! Disks in a plane that collide in a sheared liquid: Santra, Schwarzer & Herrmann, Fluid-induced particle-size
//! segregation in sheared granular assemblies, Phys. Rev. E 54, 5066 (1996).

mod contact;
mod flow;
mod forces;
mod gear;
mod memory;
mod motion;
mod observe;
mod parameters;
mod progress;
mod run;
mod simulation;
mod sizes;
mod stage;
mod state;
mod store;
mod sums;
mod tally;
mod verlet_list;

use rayon::prelude::*;

pub use self::simulation::Disks;
pub use contact::SpringContact;
pub use flow::DiskFlow;
pub use gear::Gear;
pub use observe::{
    AveragedProfile, AveragedStrip, Disk, LaneOrder, ProfileStrip, RECORD_COLUMNS, Snapshot, Strips,
    estimated_free_path, segment, viscous_length,
};
pub use parameters::{DiskModel, DiskParameters, Preparation};
pub use progress::Progress;
pub use run::{DiskRun, RunLength, outline, run_bytes};
pub use sizes::{DiskSpecies, LengthUnit, Size, Sizes};
use stage::Law;
pub use stage::Stage;
pub use tally::{DiskTally, Measurement};

/// Works on parts one by one, on several threads if there are several parts.
fn for_each_part<T: Send>(parts: &mut [T], work: impl Fn(&mut T) + Sync + Send) {
    if let [only] = parts { work(only) } else { parts.par_iter_mut().for_each(work) }
}
