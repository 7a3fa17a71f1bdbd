//! Time, counted in steps.

/// How far a run has come. Times are the step's number times the time step, so that they do not drift and a resumed run
/// has the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clock {
    step: u64,
    dt: f64,
}

impl Clock {
    /// A clock that shows the start of step `step`.
    pub fn at(step: u64, dt: f64) -> Self {
        Self { step, dt }
    }

    /// Steps taken.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// The time step.
    pub fn dt(&self) -> f64 {
        self.dt
    }

    /// The time now.
    pub fn time(&self) -> f64 {
        self.time_at(0.0)
    }

    /// The time when a fraction of the step that begins now is over.
    pub fn time_at(&self, fraction: f64) -> f64 {
        (self.step as f64 + fraction) * self.dt
    }

    /// Counts a step.
    pub fn tick(&mut self) {
        self.step += 1;
    }
}
