//! Statistics accumulated during a run.

use crate::Suspension;
use crate::columns::{PAIR_MOMENT, PAIR_MOMENT_NUMBERS};
use crate::evaluation::stress::ParticleStress;
use crate::model::box_axes::UserAxes;
use crate::model::{Flow, Model, StatisticsParameters};
use crate::sampling::{Sample, Statistics, has_profile, needed_columns, needs_pair_moments};
use domain::{Comm, IdBlocks};
use simulation::{Schedule, TableSet};
use std::borrow::Cow;

/// Statistics of a scene. Samples are taken collectively, and each rank keeps its share.
pub struct Averages {
    samples: Schedule,
    from: f64,
    /// Number of species and viscosity, if the stress is part of the statistics.
    sheared: Option<(usize, f64)>,
    flow: Flow,
    /// Columns that a sample needs.
    columns: Vec<&'static str>,
    /// Whether a sample needs the first moments of forces between spheres.
    needs_pair_moments: bool,
    /// Whether there are profiles, which need the moments of registered forces as well.
    has_profile: bool,
    statistics: Statistics,
    axes: UserAxes,
    comm: Comm,
}

impl Averages {
    /// Statistics without samples. Collective.
    pub fn new(model: &Model, wanted: StatisticsParameters, suspension: &Suspension) -> Self {
        Self::in_blocks_of(IdBlocks::SIZE, model, wanted, suspension)
    }

    fn in_blocks_of(size: u64, model: &Model, wanted: StatisticsParameters, suspension: &Suspension) -> Self {
        let comm = suspension.comm().clone();
        let sheared = model.shear_rates().frequency().map(|_| (model.species.len(), model.viscosity));
        let statistics = Statistics::in_blocks_of(size, model, wanted, suspension.particles(), &comm);
        let (columns, needs_pair_moments) = (needed_columns(model), needs_pair_moments(model));
        Self {
            samples: wanted.samples,
            from: wanted.from,
            sheared,
            flow: model.flow,
            columns,
            needs_pair_moments,
            has_profile: has_profile(model),
            statistics,
            axes: model.user_axes(),
            comm,
        }
    }

    /// Whether a sample may be due at a step.
    pub fn are_due(&self, step: u64) -> bool {
        self.samples.is_due(step)
    }

    /// Takes a sample if one is due. Collective.
    pub fn sample(&mut self, suspension: &Suspension) {
        let clock = suspension.clock();
        if self.samples.is_due(clock.step()) && clock.time() >= self.from {
            let [rate, _] = suspension.shear();
            let shear_stress = self.sheared.map(|(species, viscosity)| {
                let total = ParticleStress::sum(&suspension.stress(species));
                viscosity * rate + self.flow.driving_stress(&total, suspension.cell().gradient_axis())
            });
            let mut particles = Cow::Borrowed(suspension.particles());
            let needs_pair_moments = self.needs_pair_moments || self.has_profile && suspension.has_registered_stress();
            if needs_pair_moments || !self.axes.turn().is_none() {
                let mut own = particles.with_columns(|name| self.columns.contains(&name));
                if needs_pair_moments {
                    let column = own.column(PAIR_MOMENT, PAIR_MOMENT_NUMBERS);
                    bytemuck::cast_slice_mut(&mut column.values).copy_from_slice(&suspension.pair_moments());
                }
                particles = Cow::Owned(self.axes.particles(own));
            }
            let (time, cell, particles) = (clock.time(), &self.axes.cell(suspension.cell()), &*particles);
            let (partition, pressure_gradient) = (suspension.partition(), suspension.pressure_gradient());
            self.statistics.sample(&Sample { time, rate, cell, particles, partition, shear_stress, pressure_gradient });
        }
    }

    /// Accumulated samples, in the format of [`simulation::State`]. Collective.
    pub fn state(&mut self) -> Vec<Vec<u8>> {
        self.statistics.pieces()
    }

    /// Restores a stored state; if no rank has one, the statistics stay without samples. Collective.
    pub fn take_up(&mut self, state: &[Vec<u8>]) -> Result<(), &'static str> {
        if !self.comm.any(!state.is_empty()) || self.statistics.restore(state) {
            return Ok(());
        }
        Err("the checkpoint's statistics do not fit the scene: leave [statistics] as it was when the run started; \
             those of more than 65,536 spheres that a version before this one has written are not taken up: finish \
             the run with that version")
    }

    /// Tables of the statistics, on the first rank; `None` before the first sample. Collective.
    pub fn tables(&mut self) -> Option<TableSet> {
        let tables = self.statistics.tables();
        (!tables.is_empty()).then_some(TableSet { folder: Some("statistics"), name: "statistics", tables })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Parameters, Repulsion, Species, Start};
    use domain::{AxisRotation, Boundaries, PeriodicBox, Vector};
    use simulation::Table;

    /// Spheres in a box: the user's axes are those of the box, or with walls, these are across the user's x axis.
    fn model(count: u64, boundaries: Boundaries) -> Model {
        let cell = PeriodicBox::new(Vector::splat(12.0)).unwrap().with_boundaries(boundaries).unwrap();
        let species = vec![Species::new("one", 1.0, count)];
        let turn = if boundaries == Boundaries::Walls { AxisRotation::to_last(0) } else { AxisRotation::default() };
        let statistics = Some(StatisticsParameters::ALL);
        Model::new(Parameters { turn, statistics, ..Parameters::new(cell, 1.0, species, 0.1, 4) }).unwrap()
    }

    /// A column of a profile, for all species together.
    fn numbers<'a>(profile: &'a Table, name: &str) -> impl Iterator<Item = f64> + 'a {
        let index = profile.columns.iter().position(|(column, _)| column == name).unwrap();
        profile.rows.iter().filter(|(words, _)| words[0] == "all").map(move |(_, numbers)| numbers[index])
    }

    /// Forces between spheres and at a wall across x: the mean over the bins of a profile equals the stress of the box,
    /// in the user's axes, and only bins with spheres contribute.
    #[test]
    fn profiles_have_the_stress_of_forces_between_spheres() {
        let start =
            Start::Positions(vec![Vector::new(4.0, 4.0, 4.0), Vector::new(5.2, 5.2, 5.2), Vector::new(9.0, 9.0, 10.9)]);
        let repulsion = Some(Repulsion { range: Some(0.5), ..Repulsion::new(3.0) });
        let scene =
            Model::new(Parameters { start, repulsion, ..Parameters::clone(&model(3, Boundaries::Walls)) }).unwrap();
        for ranks in [1, 3] {
            let found = Comm::threads(ranks, |comm| {
                let suspension = Suspension::start(&scene, &comm).unwrap();
                let mut averages = Averages::new(&scene, StatisticsParameters::ALL, &suspension);
                averages.sample(&suspension);
                let repulsion = scene.user_axes().tensor(&suspension.stress(1)[0].of("repulsion"));
                (repulsion, averages.tables())
            });
            let (repulsion, tables) = found.into_iter().next().unwrap();
            let tables = tables.unwrap().tables;
            let profile = tables.iter().find(|table| table.name == "profile").unwrap();
            for (name, (i, j)) in
                [("xx", (0, 0)), ("xy", (0, 1)), ("xz", (0, 2)), ("yy", (1, 1)), ("yz", (1, 2)), ("zz", (2, 2))]
            {
                let of_bins: Vec<f64> = numbers(profile, &format!("pair_stress_{name}")).collect();
                let mean = of_bins.iter().sum::<f64>() / of_bins.len() as f64;
                let expected = repulsion.col(i)[j];
                assert!((mean - expected).abs() < 1e-12, "{name}: {mean}, not {expected}");
                let is_pressed = |&(x, stress): &(f64, f64)| stress != 0.0 && (x < 2.5 || (6.7..9.5).contains(&x));
                assert_eq!(numbers(profile, "x").zip(of_bins).find(is_pressed), None, "{name}");
            }
            assert!(repulsion.x_axis.x < 0.0 && repulsion.y_axis.x < 0.0);
        }
    }

    /// Without forces between spheres the profile has no column for them.
    #[test]
    fn profiles_are_without_forces_that_there_are_not() {
        let scene = model(3, Boundaries::Walls);
        let suspension = Suspension::start(&scene, &Comm::alone()).unwrap();
        let mut averages = Averages::new(&scene, StatisticsParameters::ALL, &suspension);
        averages.sample(&suspension);
        let tables = averages.tables().unwrap().tables;
        let profile = tables.iter().find(|table| table.name == "profile").unwrap();
        assert!(profile.columns.iter().all(|(name, _)| !name.starts_with("pair_stress")));
        assert_eq!(profile.rows[0].1.len(), profile.columns.len());
    }

    /// A restored state gives the same bytes and tables; a state of another scene is refused.
    #[test]
    fn a_state_is_taken_up_whole() {
        let scene = model(3, Boundaries::Periodic);
        let suspension = Suspension::start(&scene, &Comm::alone()).unwrap();
        let none = || Averages::new(&scene, StatisticsParameters::ALL, &suspension);
        let (mut first, mut second) = (none(), none());
        first.sample(&suspension);
        let state = first.state();
        assert_eq!(second.take_up(&state), Ok(()));
        assert_eq!(second.state(), state);
        assert!(second.tables().is_some() && none().tables().is_none());
        assert!(none().take_up(&[vec![1]]).is_err());
        assert_eq!(none().take_up(&[]), Ok(()));
    }

    /// For ranks with several blocks of ids, one, or none.
    #[test]
    fn ranks_take_their_pieces_up() {
        for (boundaries, ranks) in [(Boundaries::Periodic, 2), (Boundaries::Walls, 2), (Boundaries::Walls, 5)] {
            let scene = model(13, boundaries);
            let tables = Comm::threads(ranks, |comm| {
                let mut suspension = Suspension::start(&scene, &comm).unwrap();
                let none =
                    |suspension: &Suspension| Averages::in_blocks_of(4, &scene, StatisticsParameters::ALL, suspension);
                let (mut whole, mut half) = (none(&suspension), none(&suspension));
                for step in 0..4 {
                    if step == 2 {
                        let state = half.state();
                        assert_eq!(state.len(), (comm.rank()..4).step_by(ranks).count());
                        half = none(&suspension);
                        assert_eq!(half.take_up(&state), Ok(()));
                    }
                    whole.sample(&suspension);
                    half.sample(&suspension);
                    suspension.step().unwrap();
                }
                assert!(whole.state() == half.state());
                let text = |set: TableSet| set.tables.iter().map(Table::to_csv).collect::<String>();
                [&mut whole, &mut half].map(|averages| averages.tables().map(text))
            });
            assert!(tables[0][0].is_some() && tables[0][0] == tables[0][1]);
            assert!(tables[1..].iter().flatten().all(Option::is_none));
        }
    }
}
