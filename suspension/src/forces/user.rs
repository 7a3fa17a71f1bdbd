//! User-defined loads, in addition to those of the model.

use crate::model::box_axes::UserAxes;
use domain::{Failure, Particles, Partition, PeriodicBox, Vector};
use fcm::Loads;
use simulation::{AppliedLoads, LoadFunction};

/// Columns of the last user-defined loads: forces and torques.
pub const APPLIED: [&str; 2] = ["applied force", "applied torque"];

/// User-defined load functions, whose loads are summed, in the user's axes.
pub struct AppliedForces {
    functions: Vec<LoadFunction>,
    axes: UserAxes,
}

impl AppliedForces {
    /// No functions.
    pub fn new(axes: UserAxes) -> Self {
        Self { functions: Vec::new(), axes }
    }

    /// Adds a function.
    pub fn add(&mut self, loads: LoadFunction) {
        self.functions.push(loads);
    }

    /// Removes the function that was added last.
    pub fn remove_last(&mut self) {
        self.functions.pop();
    }

    /// Evaluates the loads at a time, adds them to those of this rank's particles, and stores them in the particles'
    /// columns. Collective.
    pub fn add_to(
        &mut self,
        loads: &mut Loads,
        particles: &mut Particles,
        (cell, partition): (&PeriodicBox, &Partition),
        time: f64,
    ) -> Result<(), Failure> {
        if self.functions.is_empty() {
            particles.columns.retain(|column| !APPLIED.contains(&column.name.as_str()));
            return Ok(());
        }
        let comm = partition.comm();
        let mut all = particles.gathered_with(partition, |_| false);
        let sums = if comm.is_first() { self.sums(unwrapped(&all, cell), time) } else { Ok([Vec::new(), Vec::new()]) };
        let sums = comm.agree(sums)?;
        comm.broadcast(&mut all.ids);
        let rows: Vec<usize> =
            particles.ids.iter().map(|id| all.ids.binary_search(id).expect("every particle was gathered")).collect();
        for (name, mut sums) in APPLIED.into_iter().zip(sums) {
            comm.broadcast(&mut sums);
            let values = particles.vectors(name);
            values.iter_mut().zip(&rows).for_each(|(value, &row)| *value = sums[row]);
        }
        add_last(loads, particles);
        Ok(())
    }

    /// Sums of forces and torques on all particles.
    fn sums(&mut self, mut positions: Vec<Vector>, time: f64) -> Result<[Vec<Vector>; 2], String> {
        let axes = self.axes;
        for position in &mut positions {
            *position = axes.place(*position);
        }
        let mut sums = [(); 2].map(|()| vec![Vector::ZERO; positions.len()]);
        for function in &mut self.functions {
            let AppliedLoads { forces, torques } = function(&positions, time).map_err(|error| error.to_string())?;
            for (sum, (what, list)) in sums.iter_mut().zip([("forces", forces), ("torques", torques)]) {
                check(what, &list, positions.len())?;
                sum.iter_mut().zip(list).for_each(|(sum, load)| *sum += axes.vector_in(load));
            }
        }
        Ok(sums)
    }
}

/// Adds the last user-defined loads, as stored in the columns, to those of this rank's particles.
pub fn add_last(loads: &mut Loads, particles: &Particles) {
    for (list, name) in [&mut loads.forces, &mut loads.torques].into_iter().zip(APPLIED) {
        let Some(column) = particles.columns.iter().find(|column| column.name == name) else { continue };
        list.resize(particles.len(), Vector::ZERO);
        let applied: &[Vector] = bytemuck::cast_slice(&column.values);
        list.iter_mut().zip(applied).for_each(|(load, &applied)| *load += applied);
    }
}

/// Whether the particles store user-defined loads of their last evaluation.
pub fn is_among(particles: &Particles) -> bool {
    particles.columns.iter().any(|column| column.name == APPLIED[0])
}

/// Unwrapped positions of all particles.
fn unwrapped(all: &Particles, cell: &PeriodicBox) -> Vec<Vector> {
    all.positions.iter().zip(&all.steps).map(|(&position, &steps)| position + cell.lattice(steps)).collect()
}

/// Refuses lists of the wrong length and loads that are not finite.
fn check(what: &str, list: &[Vector], count: usize) -> Result<(), String> {
    if ![0, count].contains(&list.len()) {
        return Err(format!("it gave {} {what} for {count} particles; it needs to give one for each", list.len()));
    }
    match list.iter().position(|load| !load.is_finite()) {
        Some(row) => Err(format!("its {what} have {} on particle {row}; they need to be finite", list[row])),
        None => Ok(()),
    }
}
