//! Checks of the positions at the end of a step, and errors of failed solves.

use super::Dynamics;
use crate::error::gap::Gap;
use crate::error::step::StepError;
use domain::parallel::all_rows;
use domain::{Number, Particles, Vector};
use fcm::SolveError;
use simulation::Clock;

/// Largest distance of a particle from the box at the end of a step, in edges: limited by the counting of periodic
/// images.
pub(super) const FARTHEST: f64 = 1e9;

/// Distance of a sphere's centre from a wall, in radii, below which the step is refused: at 0.8 the mobility of the
/// envelopes is no longer positive.
const MIN_WALL_DISTANCE: f64 = 0.85;

impl Dynamics {
    /// Refuses positions that are not finite or too far from the box, and spheres in walls. Collective.
    pub(super) fn check_positions(&self, particles: &Particles, clock: &Clock) -> Result<(), StepError> {
        let edges = self.cell().edges();
        let is_somewhere = |p: &Vector| (*p / edges).abs().max_element() < FARTHEST;
        let positions = &particles.positions;
        let are_somewhere = all_rows(positions.len(), |row| is_somewhere(&positions[row]));
        let lost = if are_somewhere { None } else { positions.iter().position(|p| !is_somewhere(p)) };
        let message = |row: usize| {
            format!(
                "step {}: particle {} is at {}, which is no place; the time step is probably too large for the forces \
                 between particles: try a smaller time.step",
                clock.step(),
                particles.ids[row],
                self.axes.place(particles.positions[row])
            )
        };
        self.partition.comm().agree(lost.map_or(Ok(()), |row| Err(message(row)))).map_err(StepError::NotFinite)?;
        self.check_walls(particles, clock)
    }

    /// Refuses spheres whose centres are too near a wall for the mobility of their envelopes to be positive.
    fn check_walls(&self, particles: &Particles, clock: &Clock) -> Result<(), StepError> {
        let is_in_wall = |row: &usize| {
            let walls = self.cell().to_walls(particles.positions[*row]);
            walls.into_iter().any(|to| to.distance < MIN_WALL_DISTANCE * particles.radii[*row])
        };
        let message = |row: usize| {
            format!(
                "step {}: particle {} of radius {} was driven into a wall: its centre is at {} = {}; give the scene a \
                 [repulsion], or a larger repulsion.strength, hydrodynamics.lubrication = true, or a smaller time.step",
                clock.step(),
                particles.ids[row],
                Number(particles.radii[row]),
                self.axes.name(2),
                Number(particles.positions[row].z)
            )
        };
        let found = (0..particles.len()).find(is_in_wall).map_or(Ok(()), |row| Err(message(row)));
        self.partition.comm().agree(found).map_err(StepError::IntoWall)
    }

    /// The error for a failed solve: an overlap, if there is one. Collective.
    pub(super) fn unsolved(&self, source: SolveError, particles: &Particles, step: u64) -> StepError {
        if let SolveError::Interrupted(interrupted) = source {
            return interrupted.into();
        }
        self.fetch(particles);
        let gap = self.smallest_gap(particles);
        if gap < 0.0 { StepError::Overlap { step, overlap: self.gap(-gap) } } else { StepError::Solve { step, source } }
    }

    /// A gap or an overlap, for messages.
    pub fn gap(&self, length: f64) -> Gap {
        Gap { length, radius: self.smallest_radius }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::prepared::Setup;
    use crate::model::{Model, Parameters, Species, Start};
    use domain::{Comm, PeriodicBox};
    use std::error::Error;

    /// A failed solve is explained by an overlap, or by another reason.
    #[test]
    fn spheres_that_overlap_are_named_where_no_flow_is_found() {
        let cell = PeriodicBox::new(Vector::splat(14.0)).unwrap();
        let usual = Parameters::new(cell, 1.0, vec![Species::new("one", 1.0, 2)], 0.05, 6);
        let start = Start::Positions(vec![Vector::splat(3.0), Vector::new(6.5, 3.0, 3.0)]);
        let model = Model::new(Parameters { start, ..usual }).unwrap();
        let (dynamics, mut particles) =
            Dynamics::new(&model, Setup::start(&model, None, &Comm::alone()).unwrap()).unwrap();
        for (distance, said) in
            [(3.5, "step 7: the motion"), (1.5, "step 7: spheres overlap by 0.5 (0.5 of the smallest radius), and")]
        {
            particles.positions[1] = particles.positions[0] + Vector::X * distance;
            let error = dynamics.unsolved(SolveError::NotFinite, &particles, 7);
            let cause = error.source().map_or_else(String::new, |cause| format!(": {cause}"));
            let message = format!("{error}{cause}");
            assert!(message.starts_with(said), "{message}");
        }
    }
}
