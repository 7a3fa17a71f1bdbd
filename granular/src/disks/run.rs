//! A run of sheared disks as a simulation whose steps are those of the flow.

use super::{
    AveragedProfile, AveragedStrip, DiskModel, Disks, Progress, RECORD_COLUMNS, Stage, estimated_free_path,
    viscous_length,
};
use crate::GrainStartError;
use domain::{Bytes, Comm, GivenPositions, MemoryNeed, Number, Particles, Process};
use simulation::{
    Clock, Frame, Outline, Quantity, Rearrangement, RearrangementError, Simulation, SimulationError, State, Table,
    TableSet,
};
use statistics::{State as Stored, Store};

/// A run of sheared disks. Its steps are those of the stage with flow; a random start is prepared before step 0.
pub struct DiskRun {
    disks: Disks,
    profile: AveragedProfile,
    length: RunLength,
    comm: Comm,
}

/// State of a checkpoint apart from the disks.
struct DiskCheckpoint {
    progress: Vec<f64>,
    profile: AveragedProfile,
}

impl Stored for DiskCheckpoint {
    fn visit(&mut self, store: &mut dyn Store) {
        store.numbers(&mut self.progress);
        self.profile.visit(store);
    }
}

/// Length of a run of disks and resolution of its profile.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RunLength {
    /// Last step.
    pub steps: u64,
    /// Strips over the height in the profile.
    pub profile_strips: usize,
}

impl DiskRun {
    /// Disks at the start of the flow: at given positions, or at random positions and prepared. `tell` is called from
    /// time to time with the completed fraction of the preparation.
    pub fn start(
        model: &DiskModel,
        length: RunLength,
        placed: Option<&GivenPositions>,
        comm: &Comm,
        tell: &mut dyn FnMut(f64),
    ) -> Result<Self, GrainStartError> {
        GrainStartError::unless_alone(comm)?;
        let disks = match placed {
            None => Disks::prepare_with_progress(model, tell)?,
            Some(placed) => flowing(model, length, placed, comm)?,
        };
        Ok(Self::of(disks, length, AveragedProfile::new(length.profile_strips), comm))
    }

    /// Disks in the state of a checkpoint; disks from a file have their own sizes.
    pub fn resume(
        model: &DiskModel,
        length: RunLength,
        state: &State,
        from_file: bool,
        comm: &Comm,
    ) -> Result<Self, GrainStartError> {
        GrainStartError::unless_alone(comm)?;
        if !from_file {
            return Self::in_state(model, length, state, comm);
        }
        Self::in_state(&DiskModel::with_particles(model.parameters().clone(), &state.particles)?, length, state, comm)
    }

    fn in_state(model: &DiskModel, length: RunLength, state: &State, comm: &Comm) -> Result<Self, GrainStartError> {
        let profile = AveragedProfile::new(length.profile_strips);
        let mut kept = DiskCheckpoint { progress: Vec::new(), profile };
        let fits = kept.load(&state.statistics.concat());
        let progress = Progress::from_numbers(&kept.progress).filter(|_| fits).ok_or(GrainStartError::State)?;
        Ok(Self::of(Disks::resume(model, &state.particles, &progress)?, length, kept.profile, comm))
    }

    fn of(disks: Disks, length: RunLength, profile: AveragedProfile, comm: &Comm) -> Self {
        debug_assert!(disks.stage() == Stage::Flow, "states are kept in the flow");
        Self { disks, profile, length, comm: comm.clone() }
    }
}

/// Disks at given positions, if there is enough memory for them.
fn flowing(
    model: &DiskModel,
    length: RunLength,
    placed: &GivenPositions,
    comm: &Comm,
) -> Result<Disks, GrainStartError> {
    let (parameters, particles) = (model.parameters(), given(placed));
    let refused = |source| GrainStartError::Given { name: placed.name.clone(), source };
    let model = DiskModel::with_particles(parameters.clone(), &particles).map_err(refused)?;
    let resident = Process::ALONE.resident(run_bytes(&model, length.profile_strips).most);
    let fits = comm.check_memory(MemoryNeed { resident, ..MemoryNeed::default() });
    fits.map_err(|missing| GrainStartError::Memory { disks: particles.len(), missing })?;
    Disks::flowing(parameters.clone(), &particles).map_err(refused)
}

/// Predicted memory of a run of disks with a profile of `strips` strips.
pub fn run_bytes(model: &DiskModel, strips: usize) -> Bytes {
    model.bytes(strips).then(Frame::bytes(model.sizes().len() as f64, 3))
}

/// Summary of a system of disks in words and numbers.
pub fn outline(model: &DiskModel, steps: u64) -> Outline {
    let (p, count) = (model.parameters(), model.sizes().len());
    let (fraction, zeta) = (model.area_fraction(), viscous_length(model));
    let (free_path, end) = (estimated_free_path(fraction), steps as f64 * p.time_step);
    let strain = p.flow.rate(p.edges[1]).abs() * p.time_step * steps as f64;
    let viscous =
        if zeta.is_finite() { format!("viscous length {:.4}", Number(zeta)) } else { "no viscous length".into() };
    let [smallest, largest, percent] = [model.smallest(), model.largest(), 100.0 * fraction].map(Number);
    Outline::default()
        .line("disks", format_args!("{count}, radii {smallest:.4} to {largest:.4}, {percent:.4}% of the area"))
        .line("lengths", format_args!("{viscous}, estimated mean free path {:.4}", Number(free_path)))
        .line("steps", format_args!("{steps}, until time {:.6} and strain {:.6}", Number(end), Number(strain)))
        .value("particles", count)
        .value("area_fraction", fraction)
        .value("viscous_length", zeta)
        .value("mean_free_path", free_path)
        .value("steps", steps)
        .value("end_time", end)
        .value("strain", strain)
}

/// Disks at given positions, with no velocities of their own: they move with the liquid.
fn given(placed: &GivenPositions) -> Particles {
    let count = placed.positions.len();
    let radii = placed.radii.clone().unwrap_or_else(|| vec![1.0; count]);
    let species = placed.species.clone().unwrap_or_else(|| vec![0; count]);
    Particles::numbered(placed.positions.clone(), radii, species)
}

impl Simulation for DiskRun {
    fn comm(&self) -> &Comm {
        &self.comm
    }

    fn clock(&self) -> &Clock {
        self.disks.clock()
    }

    fn plan(&mut self) -> String {
        outline(self.disks.model(), self.length.steps).text().to_owned()
    }

    fn advance(&mut self, last: u64) -> Result<(), SimulationError> {
        self.disks.advance(self.disks.moment().min(last - self.clock().step()));
        self.disks.check().map_err(SimulationError::new)
    }

    fn frame(&self) -> Frame {
        let (particles, _) = self.disks.store();
        Frame { particles, cell: self.disks.cell(), periodic: [true, true, false] }
    }

    fn quantities(&self) -> Vec<Quantity> {
        RECORD_COLUMNS.iter().map(|(name, unit)| Quantity::number(name, unit)).collect()
    }

    /// Averages are over the time since the previous row. The profile is sampled at each row.
    fn observe(&mut self) -> Vec<Vec<f64>> {
        self.profile.add(&self.disks.snapshot());
        let row = self.present_row();
        self.disks.restart_tally();
        row
    }

    fn present_row(&mut self) -> Vec<Vec<f64>> {
        self.disks.record().map(|value| vec![value]).to_vec()
    }

    fn state(&mut self) -> State {
        let (particles, progress) = self.disks.store();
        State {
            step: self.clock().step(),
            strain: self.disks.cell().strain(),
            plan: self.plan(),
            particles,
            statistics: vec![DiskCheckpoint { progress: progress.to_numbers(), profile: self.profile.clone() }.save()],
        }
    }

    fn rearranged(&self, mut state: State, change: &Rearrangement) -> Result<State, SimulationError> {
        let refused = |error| Err(SimulationError::new(error));
        if !change.radii.is_empty() {
            return refused(RearrangementError::FixedRadii);
        }
        if !change.angular_velocities.is_empty() {
            return refused(RearrangementError::NoSpin);
        }
        if let Some(&(id, _)) = change.positions.iter().chain(&change.velocities).find(|(_, vector)| vector.z != 0.0) {
            return refused(RearrangementError::OffThePlane(id));
        }
        let then = Self::in_state(self.disks.model(), self.length, &state, &self.comm);
        let mut run = then.map_err(SimulationError::new)?;
        change.put_motions(&mut state.particles);
        run.disks = run.disks.rearranged(&state.particles).map_err(SimulationError::new)?;
        let State { particles, statistics, .. } = run.state();
        Ok(State { particles, statistics, ..state })
    }

    fn averages(&mut self) -> Option<TableSet> {
        let mut table = Table::new("profile", &[], &[("height", "length"), ("disks", "")]);
        for (name, unit) in PROFILE {
            table.columns.extend([(name.to_owned(), unit), (format!("{name}_error"), unit)]);
        }
        for AveragedStrip { height, count, velocity, excess, temperature } in self.profile.strips() {
            let [v, w, t] = [velocity, excess, temperature].map(|e| [e.mean, e.error]);
            table.add(&[], &[&[height, count.mean], &v[..], &w, &t].concat());
        }
        Some(TableSet { folder: None, name: "averages", tables: vec![table] })
    }
}

/// Names and units of the averages over a strip.
const PROFILE: [(&str, &str); 3] =
    [("velocity", "length/time"), ("excess_velocity", "length/time"), ("temperature", "length^2/time^2")];
