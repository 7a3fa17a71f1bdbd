//! From step to step.

use crate::output::Recorder;
use crate::progress::Progress;
use crate::signals::Signals;
use crate::simulation::Simulation;
use std::process::ExitCode;

/// Steps until step `last` or a signal, and records what is due. Collective.
pub fn march(simulation: &mut dyn Simulation, recorder: &mut Recorder, last: u64) -> anyhow::Result<ExitCode> {
    let signals = Signals::watch(simulation.comm())?;
    simulation.listen(signals.heard());
    let mut progress = Progress::start(simulation.comm(), simulation.clock(), last);
    progress.say(&format!("{}results    {}", simulation.plan(), recorder.folder().display()));
    recorder.record(simulation)?;
    while simulation.clock().step() < last {
        if let Some(stop) = signals.received() {
            recorder.checkpoint(simulation)?;
            progress.say(&format!(
                "stopped after step {} of {last}; go on with: fcm-solve resume {}",
                simulation.clock().step(),
                recorder.folder().display()
            ));
            return Ok(stop.exit_code());
        }
        let due = recorder.next_due(simulation.clock().step()).map_or(last, |due| due.min(last));
        simulation.advance(due)?;
        recorder.record(simulation)?;
        progress.show(simulation.clock());
    }
    recorder.checkpoint(simulation)?;
    for warning in simulation.warnings() {
        progress.say(&format!("warning: {warning}"));
    }
    progress.say(&format!(
        "finished after step {}; results in {}",
        simulation.clock().step(),
        recorder.folder().display()
    ));
    Ok(ExitCode::SUCCESS)
}
