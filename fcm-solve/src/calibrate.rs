//! `fcm-solve calibrate`: costs of evaluations on this machine, and the network between machines.

use crate::streams;
use domain::{Comm, Number};
use fcm::{ComputeDevice, Costs};
use std::path::PathBuf;
use suspension::benchmark::{measured_costs, measured_network};

/// Measures the costs, which takes a fraction of a second, those on a card if there is one, and the network if the
/// ranks are on several machines, and stores them. Collective.
pub fn calibrate(comm: &Comm) -> anyhow::Result<()> {
    // Each rank measures by itself, with its share of the machine.
    let costs = measured_costs(ComputeDevice::Cpu, &Comm::alone())?;
    let card = if comm.is_first() { measured_card()? } else { Err(String::new()) };
    let network = measured_network(comm);
    let stored = network.filter(|_| comm.spans_machines());
    let kept = if comm.is_first() { run::keep_costs(costs, card.clone().ok(), stored) } else { Ok(PathBuf::new()) };
    let path = comm.agree(kept.map_err(|e| scene::in_full(&e)))?;
    let Costs { stencils, transforms, pairs } = costs;
    let card = card.map_or_else(|reason| format!("not measured: {reason}"), described);
    let network = network.map_or_else(String::new, |network| {
        let [gigabytes, microseconds] = [1e-9 * network.bandwidth, 1e6 * network.latency].map(Number);
        let unused = if stored.is_some() { "" } else { "; not kept, since they share a machine" };
        format!(
            "network    {gigabytes:.3} GB/s a rank and {microseconds:.3} microseconds a message between {} ranks\
             {unused}\n",
            network.ranks
        )
    });
    let text = format!(
        "stencils   {stencils:.2}\ntransforms {transforms:.2}\npairs      {pairs:.2}\ntimes those of the machine that \
         the planner was made on; kept in {}\ncard       {card}\n{network}",
        path.display()
    );
    streams::print(comm, &text)
}

/// Costs of evaluations on the card of this machine, or the reason why there are none.
fn measured_card() -> anyhow::Result<Result<Costs, String>> {
    match ComputeDevice::Gpu.check_present() {
        Ok(()) => Ok(Ok(measured_costs(ComputeDevice::Gpu, &Comm::alone())?)),
        Err(reason) => Ok(Err(reason)),
    }
}

/// Costs on a card in words.
fn described(Costs { stencils, transforms, pairs }: Costs) -> String {
    format!("stencils {stencils:.2}, transforms {transforms:.2}, pairs {pairs:.2} times those that the planner expects")
}
