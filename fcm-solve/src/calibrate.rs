//! `fcm-solve calibrate`: costs of evaluations on this machine.

use crate::streams;
use domain::Comm;
use fcm::Costs;
use std::path::PathBuf;
use suspension::benchmark::measured_costs;

/// Measures the costs, which takes a fraction of a second, and stores them. Collective.
pub fn calibrate(comm: &Comm) -> anyhow::Result<()> {
    // Each rank measures by itself, with its share of the machine.
    let costs = measured_costs(&Comm::alone())?;
    let kept = if comm.is_first() { run::keep_costs(costs) } else { Ok(PathBuf::new()) };
    let path = comm.agree(kept.map_err(|e| scene::in_full(&e)))?;
    let Costs { stencils, transforms, pairs } = costs;
    let text = format!(
        "stencils   {stencils:.2}\ntransforms {transforms:.2}\npairs      {pairs:.2}\ntimes those of the machine that \
         the planner was made on; kept in {}\n",
        path.display()
    );
    streams::print(comm, &text)
}
