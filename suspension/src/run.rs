//! A run of a suspension, with its time series and statistics, as a [`Simulation`].

use crate::columns::VELOCITY;
use crate::columns::{ANGULAR_VELOCITY, BODY, ORIENTATION, STRESSLET};
use crate::error::StartError;
use crate::error::step::StepError;
use crate::evaluation::velocity_field::FluidVelocity;
use crate::forces::force::Force;
use crate::forecast::warnings::cautions;
use crate::model::Model;
use crate::model::box_axes::UserAxes;
use crate::model::radii::Radii;
use crate::observables::averages::Averages;
use crate::observables::observable::Observable;
use crate::observables::{NameTaken, Observer};
use crate::start::rearranged::rearranged;
use crate::suspension::Suspension;
use domain::{Comm, GivenPositions, Interrupt, Number, Particles};
use fcm::DrawDiagnostics;
use simulation::{
    Clock, ContactForces, Frame, Quantity, Rearrangement, SettledParameter, Simulation, SimulationError, State,
    TableSet, UserLoads, VelocityField,
};

/// A suspension together with its time series and statistics.
pub struct SuspensionRun {
    suspension: Suspension,
    observer: Observer,
    averages: Option<Averages>,
    cautions: Vec<String>,
    /// Whether the stiffness of contacts is automatic, and whether it adapts.
    chooses_stiffness: [bool; 2],
    axes: UserAxes,
    model: Model,
    radii: Radii,
}

/// Columns of a frame of the trajectory.
const FRAME: [&str; 5] = [VELOCITY, ANGULAR_VELOCITY, STRESSLET, ORIENTATION, BODY];

impl SuspensionRun {
    /// Starts a run of a model at time zero, at positions provided by the first rank if the model requires them.
    /// Collective.
    pub fn start(model: &Model, placed: Option<GivenPositions>, comm: &Comm) -> Result<Self, StartError> {
        Ok(Self::of(model, Suspension::start_with(model, placed, comm)?))
    }

    /// Resumes a run from a state, see [`Suspension::resume`]; each rank restores its share of the statistics.
    /// Collective.
    pub fn resume(model: &Model, mut state: Option<State>, comm: &Comm) -> Result<Self, StartError> {
        let statistics = state.as_mut().map(|state| std::mem::take(&mut state.statistics)).unwrap_or_default();
        let mut resumed = Self::of(model, Suspension::resume(model, state, comm)?);
        let taken_up = resumed.averages.as_mut().map_or(Ok(()), |averages| averages.take_up(&statistics));
        comm.agree(taken_up)?;
        Ok(resumed)
    }

    fn of(model: &Model, suspension: Suspension) -> Self {
        let radii = Radii::shared(suspension.particles(), suspension.comm());
        let observer = Observer::new(model, &suspension, radii.smallest());
        let resumed = suspension.caution().map(str::to_owned);
        let cautions = resumed.into_iter().chain(cautions(model, &radii)).collect();
        let averages = model.statistics.map(|wanted| Averages::new(model, wanted, &suspension));
        let chosen = model.contacts.is_some_and(|contacts| contacts.stiffness.is_none());
        let chooses_stiffness = [chosen, chosen && model.contacts.is_some_and(|contacts| contacts.settles(model))];
        Self {
            suspension,
            observer,
            averages,
            cautions,
            chooses_stiffness,
            axes: model.user_axes(),
            model: model.clone(),
            radii,
        }
    }

    fn frame_of(&self, particles: Particles) -> Frame {
        let (cell, axes) = (self.suspension.cell(), &self.axes);
        let periodic = axes.list([0, 1, 2].map(|axis| cell.is_periodic(axis)));
        Frame { particles: axes.particles(particles), cell: axes.cell(cell), periodic }
    }

    /// Registers a force, see [`Suspension::add_force`], and adds its warnings to those of the start. Collective.
    pub fn add_force(&mut self, force: Box<dyn Force>) -> Result<(), StepError> {
        let warnings = force.warnings(&self.model, &self.radii);
        self.suspension.add_force(force)?;
        self.cautions.extend(warnings);
        self.observer.see_forces(&self.suspension);
        Ok(())
    }

    /// Adds a quantity to each row of the time series from now on. Refuses the name of another. Each rank adds the
    /// quantity.
    pub fn add_observable(&mut self, observable: Box<dyn Observable>) -> Result<(), NameTaken> {
        self.observer.add(observable)
    }

    /// The suspension.
    pub fn suspension(&self) -> &Suspension {
        &self.suspension
    }
}

impl Simulation for SuspensionRun {
    fn comm(&self) -> &Comm {
        self.suspension.comm()
    }

    fn clock(&self) -> &Clock {
        self.suspension.clock()
    }

    fn plan(&mut self) -> String {
        self.suspension.plan()
    }

    fn listen(&mut self, interrupt: Interrupt) {
        self.suspension.listen(interrupt);
    }

    fn add_loads(&mut self, loads: UserLoads) -> Result<(), SimulationError> {
        self.suspension.add_own_loads(loads).map_err(SimulationError::new)?;
        self.observer.see_forces(&self.suspension);
        Ok(())
    }

    fn advance(&mut self, last: u64) -> Result<(), SimulationError> {
        let next = self.suspension.clock().step() + 1;
        let is_seen = next == last || self.averages.as_ref().is_some_and(|averages| averages.are_due(next));
        match self.suspension.step_seen(is_seen) {
            Err(StepError::Interrupted(_)) => return Ok(()),
            taken => taken.map_err(SimulationError::new)?,
        }
        self.observer.see_step(&self.suspension);
        Ok(())
    }

    fn frame(&self) -> Frame {
        self.frame_of(self.suspension.gathered(Some(&FRAME)))
    }

    fn frame_share(&self) -> Frame {
        self.frame_of(self.suspension.particles().with_columns(|name| FRAME.contains(&name)))
    }

    fn quantities(&self) -> Vec<Quantity> {
        self.observer.quantities()
    }

    fn observe(&mut self) -> Vec<Vec<f64>> {
        self.observer.observe(&mut self.suspension)
    }

    fn sample(&mut self) {
        if let Some(averages) = &mut self.averages {
            averages.sample(&self.suspension);
        }
    }

    fn state(&mut self) -> State {
        let statistics = self.averages.as_mut().map(Averages::state).unwrap_or_default();
        State { statistics, ..self.suspension.state() }
    }

    fn rearranged(&self, state: State, change: &Rearrangement) -> Result<State, SimulationError> {
        let comm = self.suspension.comm();
        comm.agree(rearranged(state, change, &self.axes).map_err(|error| error.to_string()))
            .map_err(SimulationError::new)
    }

    fn settled_parameter(&self) -> Option<SettledParameter> {
        let [_, settles] = self.chooses_stiffness;
        let (value, _) = self.suspension.contact_stiffness().filter(|(_, stays)| settles && *stays)?;
        Some(SettledParameter {
            key: "contacts.adapted_stiffness",
            value,
            what: "the stiffness of contacts has adapted",
        })
    }

    fn end_reason(&self) -> Option<String> {
        if self.suspension.is_jammed() {
            let words =
                "jammed: under its stress it is sheared less than 1e-5 times as fast as the fluid alone would be";
            return Some(words.to_owned());
        }
        let [_, strain] = self.suspension.shear();
        let last = self.model.last_strain.filter(|last| strain.abs() >= *last)?;
        Some(format!("sheared by a strain of {:.6}, at which its run ends", Number(last)))
    }

    fn progress(&self) -> Option<f64> {
        let [_, strain] = self.suspension.shear();
        self.model.last_strain.map(|last| (strain.abs() / last).min(1.0))
    }

    fn start_warnings(&self) -> Vec<String> {
        self.cautions.clone()
    }

    fn warnings(&self) -> Vec<String> {
        let mut warnings = self.observer.warnings();
        let clipped = self.suspension.clipped();
        if clipped > DrawDiagnostics::NEGLIGIBLE {
            warnings.push(self.observer.remedies().left_out(clipped));
        }
        warnings
    }

    fn contact_forces(&self) -> Option<ContactForces> {
        self.suspension.contact_forces().map(|contacts| self.axes.contacts(contacts))
    }

    fn averages(&mut self) -> Option<TableSet> {
        let mut set = self.averages.as_mut().and_then(Averages::tables)?;
        let [is_chosen, _] = self.chooses_stiffness;
        if let Some((stiffness, stays)) = self.suspension.contact_stiffness().filter(|_| is_chosen) {
            let summary = set.tables.iter_mut().find(|table| table.name == "summary");
            let row = [stiffness, 0.0, f64::from(u8::from(stays))];
            if let Some(table) = summary {
                table.add(&["contact_stiffness", "all", "force/length^2"], &row);
            }
        }
        Some(set)
    }

    fn velocity_field(&mut self) -> Result<Option<VelocityField>, SimulationError> {
        let FluidVelocity { raster, values } = self.suspension.velocity_field().map_err(SimulationError::new)?;
        let (clock, cell) = (self.suspension.clock(), *self.suspension.cell());
        Ok(Some(self.axes.field(VelocityField {
            step: clock.step(),
            time: clock.time(),
            cell,
            origin: raster.first,
            spacing: raster.spacing,
            points: raster.points,
            periodic: [0, 1, 2].map(|axis| cell.is_periodic(axis)),
            values,
            note: "relative to the background flow",
        })))
    }
}
