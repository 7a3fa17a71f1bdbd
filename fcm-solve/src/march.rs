//! From step to step.

use crate::output::Recorder;
use crate::progress::Progress;
use crate::signals::Signals;
use crate::suspension::Suspension;
use std::process::ExitCode;

/// Steps until step `last` or a signal, and records what is due. Collective.
pub fn march(suspension: &mut Suspension, recorder: &mut Recorder, last: u64) -> anyhow::Result<ExitCode> {
    let signals = Signals::watch(suspension.comm())?;
    let mut progress = Progress::start(suspension.comm(), suspension.clock(), last);
    progress.say(&format!("{}results    {}", suspension.plan(), recorder.folder().display()));
    recorder.record(suspension)?;
    while suspension.clock().step() < last {
        if let Some(stop) = signals.received() {
            recorder.checkpoint(suspension)?;
            progress.say(&format!(
                "stopped after step {} of {last}; go on with: fcm-solve resume {}",
                suspension.clock().step(),
                recorder.folder().display()
            ));
            return Ok(stop.exit_code());
        }
        suspension.step()?;
        recorder.record(suspension)?;
        progress.show(suspension.clock());
    }
    recorder.checkpoint(suspension)?;
    progress.say(&format!(
        "finished after step {}; results in {}",
        suspension.clock().step(),
        recorder.folder().display()
    ));
    Ok(ExitCode::SUCCESS)
}
