//! User-defined loads, in addition to those of the model.

use crate::forces::acting::{Acting, Configuration, Instant, Prediction};
use crate::forces::force::{Force, StressName};
use crate::model::box_axes::UserAxes;
use domain::{Failure, Particles, PeriodicBox, Tensor, Vector};
use fcm::Loads;
use simulation::{AppliedLoads, NeighbourList, PairForceFunction, UserLoads};

/// Columns of the last user-defined loads: forces and torques.
pub const APPLIED: [&str; 2] = ["applied force", "applied torque"];

/// Column of each particle's share of the first moments of these forces, if they contribute to the stress.
pub const APPLIED_MOMENT: &str = "applied moment";

/// Name of these forces in the stress.
pub const NAME: &str = "applied";

/// User functions whose loads are summed, in the user's axes.
pub struct AppliedForces {
    functions: Vec<UserLoads>,
    axes: UserAxes,
}

/// Sums of the forces, torques and moments of all particles; moments are empty if no function returns any.
#[derive(Default)]
struct LoadSums {
    loads: [Vec<Vector>; 2],
    moments: Vec<Tensor>,
}

impl AppliedForces {
    /// No functions.
    pub fn new(axes: UserAxes) -> Self {
        Self { functions: Vec::new(), axes }
    }

    /// Whether there are no functions.
    pub fn is_empty(&self) -> bool {
        self.functions.is_empty()
    }

    /// Adds a function.
    pub fn add(&mut self, loads: UserLoads) {
        self.functions.push(loads);
    }

    /// Removes the function that was added last.
    pub fn remove_last(&mut self) {
        self.functions.pop();
    }

    /// Loads of all particles, summed over all functions.
    fn sums(&mut self, all: &Particles, cell: &PeriodicBox, time: f64) -> Result<LoadSums, String> {
        let (axes, count) = (self.axes, all.len());
        let positions: Vec<Vector> = unwrapped(all, cell).into_iter().map(|position| axes.place(position)).collect();
        let mut sums = LoadSums { loads: [(); 2].map(|()| vec![Vector::ZERO; count]), moments: Vec::new() };
        for function in &mut self.functions {
            let AppliedLoads { forces, torques, moments } = match function {
                UserLoads::OfPositions(function) => function(&positions, time).map_err(|error| error.to_string())?,
                UserLoads::OfPairs { cutoff, function } => of_pairs(all, cell, *cutoff, function, &axes, time)?,
            };
            for (sum, (what, list)) in sums.loads.iter_mut().zip([("forces", forces), ("torques", torques)]) {
                check(what, &list, count)?;
                sum.iter_mut().zip(list).for_each(|(sum, load)| *sum += axes.vector_in(load));
            }
            check_moments(&moments, count)?;
            if !moments.is_empty() {
                sums.moments.resize(count, Tensor::ZERO);
                sums.moments.iter_mut().zip(&moments).for_each(|(sum, moment)| *sum += axes.tensor_in(moment));
            }
        }
        Ok(sums)
    }
}

impl Force for AppliedForces {
    fn name(&self) -> &'static str {
        NAME
    }

    /// The loads of the last evaluation.
    fn add_present_loads(&self, at: &Configuration, loads: &mut Loads) {
        add_last(loads, at.particles);
    }

    /// Evaluates the loads, adds them to those of this rank's particles, and stores them in the particles' columns.
    fn add_loads(&mut self, at: &mut Instant, acting: &mut Acting) -> Result<(), Failure> {
        let (particles, domain) = (&mut *at.particles, at.domain);
        particles.columns.retain(|column| column.name != APPLIED_MOMENT);
        if self.functions.is_empty() {
            particles.columns.retain(|column| !APPLIED.contains(&column.name.as_str()));
            return Ok(());
        }
        let comm = domain.comm();
        let mut all = particles.gathered_with(domain.partition, |_| false);
        let sums = if comm.is_first() { self.sums(&all, domain.cell, at.time) } else { Ok(LoadSums::default()) };
        let LoadSums { loads: sums, mut moments } = comm.agree(sums)?;
        comm.broadcast(&mut all.ids);
        let rows: Vec<usize> =
            particles.ids.iter().map(|id| all.ids.binary_search(id).expect("every particle was gathered")).collect();
        for (name, mut sums) in APPLIED.into_iter().zip(sums) {
            comm.broadcast(&mut sums);
            let values = particles.vectors(name);
            values.iter_mut().zip(&rows).for_each(|(value, &row)| *value = sums[row]);
        }
        comm.broadcast(&mut moments);
        if !moments.is_empty() {
            let values: &mut [Tensor] = bytemuck::cast_slice_mut(&mut particles.column(APPLIED_MOMENT, 9).values);
            values.iter_mut().zip(&rows).for_each(|(value, &row)| *value = moments[row]);
        }
        add_last(&mut acting.loads, particles);
        Ok(())
    }

    fn stresses(&self) -> Vec<StressName> {
        vec![StressName::symmetric(NAME)]
    }

    fn moments(&self, at: &Configuration, _beyond: Option<&Prediction>) -> Vec<Vec<Tensor>> {
        vec![moments(at.particles).to_vec()]
    }
}

/// Loads of a pair force, and its moments, divided between the two particles in proportion to their radii.
fn of_pairs(
    all: &Particles,
    cell: &PeriodicBox,
    cutoff: f64,
    function: &mut PairForceFunction,
    axes: &UserAxes,
    time: f64,
) -> Result<AppliedLoads, String> {
    let periodic = [0, 1, 2].map(|axis| cell.is_periodic(axis));
    let near = NeighbourList::find(all, cell, periodic, cutoff).map_err(|error| error.to_string())?;
    let near = near.turned(|separation| axes.vector(separation));
    let on_first = function(&near, time).map_err(|error| error.to_string())?;
    if on_first.len() != near.pairs.len() {
        let (found, pairs) = (on_first.len(), near.pairs.len());
        return Err(format!("it gave {found} forces for {pairs} pairs; it needs to give one for each"));
    }
    let mut loads = AppliedLoads { forces: vec![Vector::ZERO; all.len()], ..AppliedLoads::default() };
    loads.moments = vec![Tensor::ZERO; all.len()];
    for ((&[i, j], &separation), force) in near.pairs.iter().zip(&near.separations).zip(on_first) {
        let (i, j) = (i as usize, j as usize);
        loads.forces[i] += force;
        loads.forces[j] -= force;
        let moment = symmetric(separation, force);
        let share = all.radii[i] / (all.radii[i] + all.radii[j]);
        loads.moments[i] += moment * share;
        loads.moments[j] += moment * (1.0 - share);
    }
    Ok(loads)
}

/// The symmetric part of `a b`.
fn symmetric(a: Vector, b: Vector) -> Tensor {
    let outer = Tensor::from_cols(a * b.x, a * b.y, a * b.z);
    (outer + outer.transpose()) * 0.5
}

/// Adds the last user-defined loads, as stored in the columns, to the loads of this rank's particles.
fn add_last(loads: &mut Loads, particles: &Particles) {
    for (list, name) in [&mut loads.forces, &mut loads.torques].into_iter().zip(APPLIED) {
        let Some(column) = particles.columns.iter().find(|column| column.name == name) else { continue };
        list.resize(particles.len(), Vector::ZERO);
        let applied: &[Vector] = bytemuck::cast_slice(&column.values);
        list.iter_mut().zip(applied).for_each(|(load, &applied)| *load += applied);
    }
}

/// Contributions of this rank's particles to the first moments of the user's forces; empty if these do not contribute
/// to the stress.
fn moments(particles: &Particles) -> &[Tensor] {
    let column = particles.columns.iter().find(|column| column.name == APPLIED_MOMENT);
    column.map_or(&[], |column| bytemuck::cast_slice(&column.values))
}

/// Whether the particles' columns have moments of user-defined forces from the last evaluation.
pub fn have_moments(particles: &Particles) -> bool {
    particles.columns.iter().any(|column| column.name == APPLIED_MOMENT)
}

/// Whether the particles' columns have user-defined loads from the last evaluation.
pub fn is_among(particles: &Particles) -> bool {
    particles.columns.iter().any(|column| column.name == APPLIED[0])
}

/// Unwrapped positions of all particles.
fn unwrapped(all: &Particles, cell: &PeriodicBox) -> Vec<Vector> {
    all.positions.iter().zip(&all.steps).map(|(&position, &steps)| position + cell.lattice(steps)).collect()
}

/// Refuses moments whose number is neither zero nor that of the particles, or that are not finite.
fn check_moments(moments: &[Tensor], count: usize) -> Result<(), String> {
    if ![0, count].contains(&moments.len()) {
        return Err(format!("it gave {} moments for {count} particles; it needs to give one for each", moments.len()));
    }
    match moments.iter().position(|moment| !moment.is_finite()) {
        Some(row) => Err(format!("its moments have a number that is not finite, of particle {row}")),
        None => Ok(()),
    }
}

/// Refuses loads whose number is neither zero nor that of the particles, or that are not finite.
fn check(what: &str, list: &[Vector], count: usize) -> Result<(), String> {
    if ![0, count].contains(&list.len()) {
        return Err(format!("it gave {} {what} for {count} particles; it needs to give one for each", list.len()));
    }
    match list.iter().position(|load| !load.is_finite()) {
        Some(row) => Err(format!("its {what} have {} on particle {row}; they need to be finite", list[row])),
        None => Ok(()),
    }
}
