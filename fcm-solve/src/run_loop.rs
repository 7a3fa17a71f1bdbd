//! The time-stepping loop of a run.

use crate::commands::resume_command;
use crate::progress::StepProgress;
use crate::signals::Signals;
use crate::stop::Stop;
use anyhow::bail;
use run::Recorder;
use simulation::Simulation;
use std::process::ExitCode;

/// Advances to step `last` or until a request to stop, and records what is due. Collective.
pub fn run_to_end(
    simulation: &mut dyn Simulation,
    recorder: &mut Recorder,
    last: u64,
    signals: &Signals,
) -> anyhow::Result<ExitCode> {
    simulation.listen(signals.interrupt());
    signals.run_begins(resume_command(recorder.folder(), None));
    let mut progress = StepProgress::start(simulation, last);
    for warning in simulation.start_warnings().iter().chain(recorder.warnings()) {
        progress.say(&format!("warning: {warning}"));
    }
    progress.inform(&format!("{}results    {}", simulation.plan(), recorder.folder().display()));
    recorder.record(simulation)?;
    let first = simulation.clock().step();
    let mut knew = simulation.settled_parameter().is_some();
    while simulation.clock().step() < last && simulation.end_reason().is_none() {
        signals.checkpoint_took(recorder.longest_checkpoint());
        if let Some(stop) = signals.received() {
            recorder.checkpoint(simulation)?;
            signals.tell_steps_taken(simulation.clock().step() - first);
            return stopped(stop, [first, simulation.clock().step(), last], &progress, &signals.command());
        }
        let due = recorder.next_due(simulation.clock().step()).map_or(last, |due| due.min(last));
        simulation.advance(due)?;
        recorder.record(simulation)?;
        if let Some(found) = simulation.settled_parameter().filter(|_| !knew) {
            progress.say(&format!("step {}: {found}", simulation.clock().step()));
            knew = true;
        }
        progress.show(simulation);
    }
    let answers = report::answers_in_lines(recorder.finish(simulation)?);
    for warning in simulation.warnings() {
        progress.say(&format!("warning: {warning}"));
    }
    if let Some(why) = simulation.end_reason() {
        progress.say(&format!("the suspension is {why}"));
    }
    if !answers.is_empty() {
        progress.say(answers.trim_end());
    }
    progress.inform(&format!(
        "finished after step {}; results in {}",
        simulation.clock().step(),
        recorder.folder().display()
    ));
    Ok(ExitCode::SUCCESS)
}

/// Ends a run that stops after step `now`. It is an error if the time limit was too short for a single step: such a job
/// would be started again and again in vain.
fn stopped(
    stop: Stop,
    [first, now, last]: [u64; 3],
    progress: &StepProgress,
    command: &str,
) -> anyhow::Result<ExitCode> {
    if stop == Stop::TimeIsUp && now == first {
        bail!(
            "the run's time is too short for a single step and its checkpoint: it stands at step {now}; give it more \
             time (--walltime, or the job's limit), or a smaller time.step"
        );
    }
    progress.say(&format!("stopped after step {now} of {last} by {stop}; go on with: {command}"));
    Ok(stop.into())
}
