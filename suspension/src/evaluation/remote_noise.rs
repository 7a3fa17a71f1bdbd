//! Brownian steps of particles that move where the far field is evaluated.

use super::approach::ELSEWHERE;
use super::fluctuating::Noise;
use super::{Dynamics, Outcome, StageTime};
use crate::columns::PAST;
use crate::error::step::StepError;
use crate::forces::acting::Acting;
use domain::{ColumnValues, Particles};
use fcm::{HeldDraw, HeldLoads};
use hydrodynamics::brownian::{self, AMBIENT, AMBIENT_NUMBERS, DISPLACEMENT, DRIFT_VELOCITY};
use hydrodynamics::{Guess, HeldFluctuations, Solution};
use solver::BackgroundFlow;

impl Dynamics {
    /// [`Self::draw_velocities`] of particles that move where the far field is evaluated.
    pub(super) fn draw_remotely(&mut self, particles: &mut Particles, noise: Noise) {
        let velocities = self.drawn_in(self.moving.moving_flow().carried, particles, noise);
        particles.set_column(PAST[0], 3, velocities);
    }

    /// [`Self::draw_motions`] of particles that move where the far field is evaluated.
    pub(super) fn displace_remotely(&mut self, particles: &mut Particles, noise: Noise, time: f64) {
        let velocities = self.drawn_in(BackgroundFlow::NONE, particles, noise);
        particles.set_column(DISPLACEMENT, 3, velocities);
        let displacements = self.held_sum(particles, [DISPLACEMENT], [time]).expect(ELSEWHERE);
        particles.set_column(DISPLACEMENT, 3, ColumnValues::remote(displacements));
    }

    /// Draws random motions of the fluid. Returns their velocities with those of a flow.
    fn drawn_in(&mut self, carried: BackgroundFlow, particles: &mut Particles, noise: Noise) -> ColumnValues {
        let (tolerance, cell, carried) = (self.random_tolerance(), self.moving.cell(), &carried);
        let Noise { stream, amplitude, .. } = noise;
        let draw = HeldDraw { particles, tolerance, stream, amplitude, carried };
        let (motions, drawn) = self.hydrodynamics.draw_motions(cell, &draw).expect(ELSEWHERE);
        self.clipped = self.clipped.max(drawn.clipped);
        particles.set_column(AMBIENT, AMBIENT_NUMBERS, motions.ambient);
        motions.velocities
    }

    /// The solve of [`Self::evaluate_fluctuating`] for particles that move where the far field is evaluated, with the
    /// close pairs there. Returns its loads too.
    pub(super) fn solve_remotely(
        &mut self,
        particles: &mut Particles,
        moment: &StageTime,
        Noise { stream, amplitude, .. }: Noise,
    ) -> Result<(HeldLoads, Solution), StepError> {
        let Self { hydrodynamics, moving, overlap_monitor, .. } = self;
        if let Some(monitor) = overlap_monitor {
            let found = hydrodynamics.close_spheres(moving.cell(), particles, monitor.minimum_gap());
            monitor.note(found.expect(ELSEWHERE));
        }
        let loads = hydrodynamics.draw_loads(moving.cell(), particles, stream, amplitude).expect(ELSEWHERE);
        let ambient = particles.column(AMBIENT, AMBIENT_NUMBERS).values.clone();
        let fluctuations = Some(HeldFluctuations { ambient, loads });
        let acting = Acting { fluctuations, ..Acting::default() };
        let solved = self.solved(particles, &acting, &acting.ambient, Guess::default(), moment)?;
        let HeldFluctuations { loads, .. } = acting.fluctuations.expect(ELSEWHERE);
        Ok((loads, solved))
    }

    /// [`Self::move_at_random`] of particles that move where the far field is evaluated.
    pub(super) fn move_remotely_at_random(
        &mut self,
        particles: &mut Particles,
        moment: &StageTime,
        noise: Noise,
    ) -> Result<Outcome, StepError> {
        let (loads, solved) = self.solve_remotely(particles, moment, noise)?;
        let kept = solved.kept.as_ref().expect(ELSEWHERE);
        let [velocities, _] = kept.columns.moving.as_ref().expect(ELSEWHERE);
        particles.set_column(PAST[0], 3, velocities.clone());
        brownian::store_held_solution(&mut self.hydrodynamics, self.moving.cell(), particles, &loads, &solved);
        Ok(Outcome::of(&solved))
    }

    /// [`Self::limit_drift`] of particles that move where the far field is evaluated.
    pub(super) fn limit_remotely(&self, particles: &mut Particles, time: f64) {
        let drift = self.held_column(particles, DRIFT_VELOCITY, 3);
        let limited = self.steps().limited(&drift, brownian::FARTHEST / time);
        particles.set_column(DRIFT_VELOCITY, 3, ColumnValues::remote(limited));
    }
}
