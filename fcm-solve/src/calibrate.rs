//! `fcm-solve calibrate`: what evaluations cost on this machine.

use crate::streams;
use domain::Comm;
use fcm::Costs;
use std::path::PathBuf;
use suspension::benchmark::measured_costs;

/// Measures the costs, for a fraction of a second, and keeps them. Collective.
pub fn calibrate(comm: &Comm) -> anyhow::Result<()> {
    // Each rank by itself, as its share of a machine.
    let costs = measured_costs(&Comm::alone())?;
    let kept = if comm.is_first() { io::keep_costs(costs) } else { Ok(PathBuf::new()) };
    let path = comm.agree(kept.map_err(|e| io::in_full(&e)))?;
    let Costs { stencils, transforms, pairs } = costs;
    let text = format!(
        "stencils   {stencils:.2}\ntransforms {transforms:.2}\npairs      {pairs:.2}\ntimes those of the machine that \
         the planner was made on; kept in {}\n",
        path.display()
    );
    streams::print(comm, &text)
}
