//! Statistics in the course of a run.

use crate::Suspension;
use crate::model::{Flow, Model, Statistics as Wanted};
use crate::sampling::{Sample, Statistics, needed_columns};
use crate::stress::ParticleStress;
use crate::user_axes::UserAxes;
use domain::Particles;
use simulation::{Schedule, TableSet};
use statistics::State;

/// The statistics that a scene wants. The first rank has them; samples are taken by all together.
pub struct Averages {
    samples: Schedule,
    from: f64,
    /// Species and viscosity, where the stress is a part of the statistics.
    sheared: Option<(usize, f64)>,
    flow: Flow,
    /// Columns that a sample needs.
    columns: Vec<&'static str>,
    statistics: Statistics,
    axes: UserAxes,
}

impl Averages {
    /// Nothing so far; `frame` has all particles on the first rank.
    pub fn new(model: &Model, wanted: Wanted, frame: &Particles) -> Self {
        let sheared = model.shear_rates().frequency().map(|_| (model.species.len(), model.viscosity));
        let statistics = Statistics::new(model, wanted, frame);
        let columns = needed_columns(model);
        let (samples, from, axes) = (wanted.samples, wanted.from, model.user_axes());
        Self { samples, from, sheared, flow: model.flow, columns, statistics, axes }
    }

    /// Takes a sample if it is time for one. Collective.
    pub fn sample(&mut self, suspension: &Suspension) {
        let clock = suspension.clock();
        if self.samples.is_due(clock.step()) && clock.time() >= self.from {
            let particles = self.axes.particles(suspension.gathered(Some(&self.columns)));
            let [rate, _] = suspension.shear();
            let shear_stress = self.sheared.map(|(species, viscosity)| {
                let total = ParticleStress::sum(&suspension.stress(species));
                viscosity * rate + self.flow.driving_stress(&total, suspension.cell().gradient_axis())
            });
            if suspension.comm().is_first() {
                let (time, cell, particles) = (clock.time(), &self.axes.cell(suspension.cell()), &particles);
                let pressure_gradient = suspension.pressure_gradient();
                self.statistics.sample(&Sample { time, rate, cell, particles, shear_stress, pressure_gradient });
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Parameters, Species};
    use domain::{Comm, PeriodicBox, Vector};

    /// What is taken up again gives the same bytes and tables; of another scene's it is refused.
    #[test]
    fn a_state_is_taken_up_whole() {
        let model = |count| {
            let cell = PeriodicBox::new(Vector::splat(12.0)).unwrap();
            let species = vec![Species::new("one", 1.0, count)];
            let statistics = Some(Wanted::ALL);
            Model::new(Parameters { statistics, ..Parameters::new(cell, 1.0, species, (0.1, 4)) }).unwrap()
        };
        let scene = model(3);
        let suspension = Suspension::start(&scene, &Comm::alone()).unwrap();
        let frame = suspension.gathered(None);
        let none = || Averages::new(&scene, Wanted::ALL, &frame);
        let (mut first, mut second) = (none(), none());
        first.sample(&suspension);
        let state = first.state();
        assert_eq!(second.take_up(&state), Ok(()));
        assert_eq!(second.state(), state);
        assert!(second.tables().is_some() && none().tables().is_none());
        assert!(none().take_up(&[1]).is_err());
        assert_eq!(none().take_up(&[]), Ok(()));
    }
}
