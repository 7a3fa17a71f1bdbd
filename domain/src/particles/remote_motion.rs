//! Positions in a remote memory, where particles move.

use super::Particles;
use crate::column::{Column, ColumnValues, ParticleValues};
use crate::parallel::{mapped, of_rows};
use crate::{RemoteDisplacement, RemoteFrame, RemoteHolder, RemoteList, Vector, remote_columns};

/// Message of a panic, which would be a mistake in the program.
const HERE: &str = "these particles do not move in a remote memory";

impl Particles {
    /// Whether positions are in a memory where the particles move.
    pub fn are_remote(&self) -> bool {
        self.positions.remote_list().is_some()
    }

    /// Copies positions and lattice steps to a memory, where the particles move from now on. Sorts the particles by
    /// their ids, the order of its lists.
    pub fn move_to(&mut self, holder: &dyn RemoteHolder) {
        if !self.ids.is_sorted() {
            let mut order: Vec<usize> = (0..self.len()).collect();
            order.sort_unstable_by_key(|&row| self.ids[row]);
            self.arrange(&order);
        }
        let list = holder.hold(bytemuck::cast_slice(&self.positions));
        self.positions = std::mem::take(&mut self.positions).held_as(list);
        let steps = mapped(&self.steps, |steps| steps.map(f64::from)).into_flattened();
        self.steps = std::mem::take(&mut self.steps).held_as(holder.hold(&steps));
    }

    /// Copies the positions of particles that moved in another memory, and moves them here from now on.
    pub fn move_from(&mut self, holder: &dyn RemoteHolder) {
        self.fetch(holder);
        self.positions = std::mem::take(&mut self.positions).detached();
        self.steps = std::mem::take(&mut self.steps).detached();
        self.displacements.clear();
    }

    /// Moves particles in a memory by displacements in a list there, once they are [advanced](Self::advance_remotely).
    ///
    /// # Panics
    ///
    /// Unless the particles [have moved](Self::move_to) to that memory.
    pub fn displace_remotely(&mut self, displacements: RemoteList) {
        let list = self.positions.remote_list().expect(HERE).clone();
        self.positions = ParticleValues::remote(list);
        self.displacements.push((ColumnValues::remote(displacements), 1.0));
    }

    /// The list of a column in the memory where the particles move, to which it is copied unless it is there. A column
    /// that is missing is made, of zeros.
    pub fn held_column(&mut self, name: &str, width: usize, holder: &dyn RemoteHolder) -> RemoteList {
        let column = self.column(name, width);
        if let Some(list) = column.values.remote_list() {
            return list.clone();
        }
        let list = holder.hold(&column.values);
        column.values = std::mem::take(&mut column.values).held_as(list.clone());
        list
    }

    /// The same particles, whose values have been fetched, without a remote memory.
    #[must_use]
    pub fn detached(self) -> Self {
        let detached = |column: Column| Column { values: column.values.detached(), ..column };
        let columns = self.columns.into_iter().map(detached).collect();
        let (positions, steps) = (self.positions.detached(), self.steps.detached());
        Self { positions, steps, displacements: Vec::new(), columns, saved: None, ..self }
    }

    /// Moves particles in a memory by their displacements and with the flow of a frame, and wraps them into its box.
    /// Columns of velocities, by their names, change with the frame of reference of a particle and with the flow.
    /// Returns `false`, with no other effect, if a particle is lost.
    ///
    /// # Panics
    ///
    /// Unless the particles [have moved](Self::move_to) to that memory.
    pub fn advance_remotely(
        &mut self,
        frame: RemoteFrame,
        are_velocities: impl Fn(&str) -> bool,
        holder: &dyn RemoteHolder,
    ) -> bool {
        let held = |values: &ColumnValues| values.remote_list().cloned().unwrap_or_else(|| holder.hold(values));
        let (Some(positions), Some(steps)) = (self.positions.remote_list(), self.steps.remote_list()) else {
            panic!("{HERE}");
        };
        let terms: Vec<_> = self.displacements.iter().map(|(values, weight)| (held(values), *weight)).collect();
        let columns = || (0..self.columns.len()).filter(|&k| are_velocities(&self.columns[k].name));
        let velocities: Vec<RemoteList> = columns().map(|k| held(&self.columns[k].values)).collect();
        let displaced = RemoteDisplacement { positions, steps, terms: &terms, velocities: &velocities, frame };
        let Some(moved) = holder.advance(&displaced) else { return false };
        let columns: Vec<usize> = columns().collect();
        for (k, list) in columns.into_iter().zip(moved.velocities) {
            self.columns[k].values = ParticleValues::remote(list);
        }
        self.positions = ParticleValues::remote(moved.positions);
        self.steps = ParticleValues::remote(moved.steps);
        self.displacements.clear();
        true
    }

    /// Copies positions and lattice steps from the memory that holds them, those of the saved state as well; columns
    /// and displacements are here.
    pub(super) fn fetch_positions(&self, holder: &dyn RemoteHolder) {
        let saved = self.saved.as_ref().map(|saved| saved.places());
        let are_here = |(positions, steps): &(&ParticleValues<Vector>, &ParticleValues<[i32; 3]>)| {
            positions.is_here() && steps.is_here()
        };
        if are_here(&(&self.positions, &self.steps)) && saved.as_ref().is_none_or(are_here) {
            return;
        }
        let places = remote_columns::places_by_id(&self.ids);
        let displacement = |row: usize| {
            let of_term = |(values, weight): &(ColumnValues, f64)| Vector::from_slice(&values[3 * row..]) * *weight;
            self.displacements.iter().map(of_term).sum::<Vector>()
        };
        receive(&self.positions, &places, holder, |row, place| Vector::from_array(place) + displacement(row));
        receive(&self.steps, &places, holder, whole);
        if let Some((positions, steps)) = saved {
            receive(positions, &places, holder, |_, place| Vector::from_array(place));
            receive(steps, &places, holder, whole);
        }
    }
}

/// Lattice steps as a memory holds them.
fn whole(_: usize, steps: [f64; 3]) -> [i32; 3] {
    steps.map(|count| count as i64 as i32)
}

/// Copies values of three numbers each from the memory that holds them, unless they are here.
fn receive<T: Copy + Send + Sync>(
    values: &ParticleValues<T>,
    places: &[u32],
    holder: &dyn RemoteHolder,
    value: impl Fn(usize, [f64; 3]) -> T + Sync,
) {
    if let Some(list) = values.remote_list().filter(|_| !values.is_here()) {
        let copy = holder.copies(&[list]).concat();
        let rows = copy.as_chunks::<3>().0;
        values.receive(of_rows(places.len(), |row| value(row, rows[places[row] as usize])));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::remote_memory::RemoteMemory;
    use crate::{Comm, PeriodicBox, Tensor};

    const GRADIENT: Tensor = Tensor::from_cols(Vector::ZERO, Vector::new(2.0, 0.0, 0.0), Vector::ZERO);

    fn cell() -> PeriodicBox {
        PeriodicBox::sheared(Vector::new(4.0, 5.0, 6.0), 0.3).unwrap()
    }

    /// Particles whose ids are in no order, with velocities that carry most of them across faces.
    fn particles() -> Particles {
        let mut particles = Particles::default();
        for (row, id) in [9, 4, 70, 1, 33].into_iter().enumerate() {
            let turn = row as f64;
            particles.push(id, cell().wrap(Vector::new(turn.sin(), turn.cos(), -turn) * 3.0).0, 1.0, 0);
        }
        let vector = |row: usize| Vector::new(1.0, -2.0, 3.0) * (row as f64 - 2.0);
        for name in ["velocity", "past"] {
            for row in 0..5 {
                particles.vectors(name)[row] = vector(row) + Vector::splat(name.len() as f64);
            }
        }
        particles
    }

    fn frame(cell: &PeriodicBox) -> RemoteFrame<'_> {
        RemoteFrame::new(cell, GRADIENT, 1e3)
    }

    fn displace(particles: &mut Particles) {
        particles.displace_by(["velocity", "past"], [0.9, -0.2]);
    }

    /// Displacements are added where the particles are, once they are wrapped, or here, if positions are read before.
    #[test]
    fn particles_move_as_they_do_here() {
        let (cell, memory, mut here) = (cell(), RemoteMemory::default(), particles());
        displace(&mut here);
        let displaced = here.positions.clone();
        here.wrap(&cell);
        for is_read in [false, true] {
            let mut there = particles();
            there.move_to(&memory);
            assert_eq!(there.ids, [1, 4, 9, 33, 70]);
            displace(&mut there);
            assert!(there.are_remote() && !there.positions.is_here());
            if is_read {
                there.fetch(&memory);
                assert_eq!(
                    there.positions,
                    ParticleValues::from(vec![3, 1, 0, 4, 2].into_iter().map(|row| displaced[row]).collect::<Vec<_>>())
                );
            }
            assert!(there.advance_remotely(frame(&cell), |name| name == "velocity", &memory));
            there.fetch(&memory);
            for (row, from) in [3, 1, 0, 4, 2].into_iter().enumerate() {
                assert!((there.positions[row] - here.positions[from]).length() < 1e-13);
                assert_eq!(there.steps[row], here.steps[from]);
                let jump = GRADIENT * cell.lattice(here.steps[from]);
                assert!((there.vectors("velocity")[row] - (here.vectors("velocity")[from] - jump)).length() < 1e-13);
                assert_eq!(there.vectors("past")[row], here.vectors("past")[from]);
            }
            there.move_from(&memory);
            assert!(!there.are_remote());
        }
        assert!(here.steps.iter().filter(|steps| **steps != [0; 3]).count() > 2);
    }

    /// A particle that is lost leaves the others where they were, to be read, and the state before can be restored.
    #[test]
    fn lost_particles_move_nobody() {
        let (cell, memory, mut particles) = (cell(), RemoteMemory::default(), particles());
        particles.move_to(&memory);
        let before = particles.positions.clone();
        particles.save(&Comm::alone());
        particles.vectors("velocity")[2] = Vector::splat(f64::NAN);
        displace(&mut particles);
        assert!(!particles.advance_remotely(frame(&cell), |_| false, &memory));
        particles.move_from(&memory);
        assert!(particles.positions[2].is_nan() && particles.positions[1] != before[1]);
        particles.restore(&Comm::alone());
        assert!(particles.are_remote() && particles.positions == before);
    }
}
