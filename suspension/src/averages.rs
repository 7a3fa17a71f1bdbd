//! Statistics in the course of a run.

use crate::Suspension;
use crate::model::{Model, Statistics as Wanted};
use crate::sampling::{COLUMNS, Statistics};
use domain::Particles;
use simulation::{Schedule, TableSet};
use statistics::State;

/// The statistics that a scene wants. The first rank has them; samples are taken by all together.
pub struct Averages {
    samples: Schedule,
    from: f64,
    statistics: Statistics,
}

impl Averages {
    /// Nothing so far; `frame` has all particles on the first rank.
    pub fn new(model: &Model, wanted: Wanted, frame: &Particles) -> Self {
        Self { samples: wanted.samples, from: wanted.from, statistics: Statistics::new(model, wanted, frame) }
    }

    /// Takes a sample if it is time for one. Collective.
    pub fn sample(&mut self, suspension: &Suspension) {
        let clock = suspension.clock();
        if self.samples.is_due(clock.step()) && clock.time() >= self.from {
            let particles = suspension.gathered(Some(&COLUMNS));
            if suspension.comm().is_first() {
                self.statistics.sample(clock.time(), suspension.cell(), &particles);
            }
        }
    }

    /// What has been taken in, as bytes.
    pub fn state(&mut self) -> Vec<u8> {
        self.statistics.save()
    }

    /// Takes up a state that was stored; none leaves the statistics without samples.
    pub fn take_up(&mut self, state: &[u8]) -> Result<(), &'static str> {
        if state.is_empty() || self.statistics.load(state) {
            return Ok(());
        }
        Err("the checkpoint's statistics do not fit the scene: leave [statistics] as it was when the run started")
    }

    /// The tables, once there was a sample.
    pub fn tables(&self) -> Option<TableSet> {
        let tables = self.statistics.tables();
        (!tables.is_empty()).then_some(TableSet { folder: Some("statistics"), name: "statistics", tables })
    }
}
