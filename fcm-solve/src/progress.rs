//! The progress of a run.

use crate::streams;
use domain::Number;
use indicatif::{ProgressBar, ProgressStyle};
use simulation::Simulation;
use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// Shortest time between two lines where there is no terminal, and the shortest as a fraction of the time so far.
const PAUSE: Duration = Duration::from_secs(5);
const PAUSE_SHARE: f64 = 0.05;

/// Progress of a run: a bar on a terminal, elsewhere a line now and then. Shown by the first rank alone.
pub struct StepProgress {
    display: Display,
    first: u64,
    last: u64,
    /// Fraction done at the start, of a limit that may end the run before its last step.
    first_part: Option<f64>,
    began: Instant,
}

enum Display {
    Bar(ProgressBar),
    Lines {
        said: Instant,
    },
    /// No progress, but other messages.
    Quiet,
    Nothing,
}

impl StepProgress {
    /// Starts the progress from the present step of a simulation to step `last`.
    pub fn start(simulation: &dyn Simulation, last: u64) -> Self {
        let (comm, clock) = (simulation.comm(), simulation.clock());
        let display = match (comm.is_first(), std::io::stderr().is_terminal()) {
            (false, _) => Display::Nothing,
            (true, _) if streams::is_quiet() => Display::Quiet,
            (true, true) => Display::Bar(bar(clock.step(), last)),
            (true, false) => Display::Lines { said: Instant::now() },
        };
        Self { display, first: clock.step(), last, first_part: simulation.progress(), began: Instant::now() }
    }

    /// Shows the present step of the simulation.
    pub fn show(&mut self, simulation: &dyn Simulation) {
        let (clock, pace) = (simulation.clock(), self.pace(simulation));
        let pause = PAUSE.max(self.began.elapsed().mul_f64(PAUSE_SHARE));
        match &mut self.display {
            Display::Bar(bar) => {
                bar.set_position(clock.step());
                bar.set_message(format!("time {:.6}, {pace}", Number(clock.time())));
            }
            Display::Lines { said } if said.elapsed() >= pause || clock.step() == self.last => {
                let time = Number(clock.time());
                streams::log(format_args!("step {} of {}, time {time:.6}, {pace}", clock.step(), self.last));
                *said = Instant::now();
            }
            Display::Lines { .. } | Display::Quiet | Display::Nothing => {}
        }
    }

    /// Steps per second, and the remaining time of the run at that pace.
    fn pace(&self, simulation: &dyn Simulation) -> String {
        let clock = simulation.clock();
        let (taken, left) = (clock.step() - self.first, self.last.saturating_sub(clock.step()));
        let seconds = self.began.elapsed().as_secs_f64();
        if taken == 0 {
            return "first step".to_owned();
        }
        let rate = taken as f64 / seconds;
        let until_last = left as f64 / rate;
        let parts = self.first_part.zip(simulation.progress()).filter(|(first, now)| now > first);
        let until_end = parts.map_or(f64::INFINITY, |(first, now)| seconds * (1.0 - now) / (now - first));
        let left = Duration::from_secs(until_last.min(until_end) as u64);
        format!("{:.3} steps/s, {} left", Number(rate), indicatif::HumanDuration(left))
    }

    /// Shows a message that is not a warning, unless the program is to be quiet.
    pub fn inform(&self, message: &str) {
        if !streams::is_quiet() {
            self.say(message);
        }
    }

    /// Shows a message together with the progress.
    pub fn say(&self, message: &str) {
        match &self.display {
            Display::Bar(bar) => bar.suspend(|| streams::log(message)),
            Display::Lines { .. } | Display::Quiet => streams::log(message),
            Display::Nothing => {}
        }
    }
}

impl Drop for StepProgress {
    fn drop(&mut self) {
        if let Display::Bar(bar) = &self.display {
            bar.abandon();
        }
    }
}

fn bar(first: u64, last: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} steps, {msg}").expect("a good template");
    ProgressBar::new(last).with_position(first).with_style(style)
}
