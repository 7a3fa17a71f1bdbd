//! Checks of the positions at the end of a step.

use super::Dynamics;
use crate::error::step::StepError;
use domain::parallel::all_rows;
use domain::{Number, Particles, Vector};
use simulation::Clock;

/// Largest distance of a particle from the box at the end of a step, in edges: limited by the counting of periodic
/// images.
const FARTHEST: f64 = 1e9;

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
}
