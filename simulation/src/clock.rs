//! Time, counted in steps.

/// Step and time of a run. The time is the number of steps times the time step: it does not drift, and is the same in
/// a resumed run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clock {
    step: u64,
    dt: f64,
}

impl Clock {
    /// Clock after `step` steps.
    pub fn at(step: u64, dt: f64) -> Self {
        Self { step, dt }
    }

    /// Number of steps taken.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// Time step.
    pub fn dt(&self) -> f64 {
        self.dt
    }

    /// Present time.
    pub fn time(&self) -> f64 {
        self.time_at(0.0)
    }

    /// Time at a fraction of the step that begins now.
    pub fn time_at(&self, fraction: f64) -> f64 {
        (self.step as f64 + fraction) * self.dt
    }

    /// Counts a step.
    pub fn tick(&mut self) {
        self.step += 1;
    }
}
