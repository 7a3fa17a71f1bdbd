//! Brownian steps of particles that move where the far field is evaluated.

use super::approach::ELSEWHERE;
use super::fluctuating::Noise;
use super::{Dynamics, StageTime};
use crate::columns::PAST;
use crate::error::step::StepError;
use crate::forces::acting::Acting;
use domain::Particles;
use fcm::HeldDraw;
use hydrodynamics::brownian::{AMBIENT, AMBIENT_NUMBERS};
use hydrodynamics::{Guess, HeldFluctuations, Solution};

impl Dynamics {
    /// [`Self::draw_velocities`] of particles that move where the far field is evaluated.
    pub(super) fn draw_remotely(&mut self, particles: &mut Particles, noise: Noise) {
        let (tolerance, cell) = (self.random_tolerance(), self.moving.cell());
        let Noise { stream, amplitude, .. } = noise;
        let carried = &self.moving.moving_flow().carried;
        let draw = HeldDraw { particles, tolerance, stream, amplitude, carried };
        let (motions, drawn) = self.hydrodynamics.draw_motions(cell, &draw).expect(ELSEWHERE);
        self.clipped = self.clipped.max(drawn.clipped);
        particles.set_column(AMBIENT, AMBIENT_NUMBERS, motions.ambient);
        particles.set_column(PAST[0], 3, motions.velocities);
    }

    /// The solve of [`Self::evaluate_fluctuating`] for particles that move where the far field is evaluated, with the
    /// close pairs there.
    pub(super) fn solve_remotely(
        &mut self,
        particles: &mut Particles,
        moment: &StageTime,
        Noise { stream, amplitude, .. }: Noise,
    ) -> Result<Solution, StepError> {
        let Self { hydrodynamics, moving, overlap_monitor, .. } = self;
        if let Some(monitor) = overlap_monitor {
            let found = hydrodynamics.close_spheres(moving.cell(), particles, monitor.minimum_gap());
            monitor.note(found.expect(ELSEWHERE));
        }
        let loads = hydrodynamics.draw_loads(moving.cell(), particles, stream, amplitude).expect(ELSEWHERE);
        let ambient = particles.column(AMBIENT, AMBIENT_NUMBERS).values.clone();
        let fluctuations = Some(HeldFluctuations { ambient, loads });
        let acting = Acting { fluctuations, ..Acting::default() };
        self.solved(particles, &acting, &acting.ambient, Guess::default(), moment)
    }
}
