//! Dynamics in a flow that a stress drives.

use super::{Dynamics, Moment, Outcome};
use crate::applied;
use crate::columns::{STRESSLET, VELOCITY};
use crate::driven::Search;
use crate::forces::{Ahead, Surface};
use crate::hydrodynamics::Guess;
use crate::integrator::EXPECTED;
use crate::step_error::StepError;
use domain::{Particles, Tensor, Traceless};
use fcm::Motion;

impl Dynamics {
    /// Solves for the rate of shear with which the stress is what it is to be, and for the motions at that rate. Collective.
    pub(super) fn drive(
        &mut self,
        particles: &mut Particles,
        (mut search, mut guess, before): (Search, Guess, &Motion),
        moment: &Moment,
    ) -> Result<Outcome, StepError> {
        loop {
            self.moving.set_rate(search.rate());
            let (outcome, of_contacts) = self.solve_at(particles, (&guess, before), moment)?;
            let stress = self.stress_at(particles, of_contacts, moment);
            if !search.goes_on(stress) {
                if let Some(driven) = self.moving.driven() {
                    driven.learn(&search);
                }
                return Ok(outcome);
            }
            guess = self.warm_start.found(particles);
        }
    }

    /// The shear stress of the whole suspension, with short-range forces as they will be where those are in the solve; `moment`s
    /// of contacts are those of this rank. Collective.
    fn stress_at(&self, particles: &mut Particles, of_contacts: f64, moment: &Moment) -> f64 {
        let beyond = moment.implicit.map(|time| {
            let expected = particles.vectors(EXPECTED).to_vec();
            (
                time,
                particles.vectors(VELOCITY).iter().zip(expected).map(|(&v, expected)| v - expected).collect::<Vec<_>>(),
            )
        });
        let strain_rate = self.moving.expected_besides() * -1.0;
        let beyond = beyond.as_ref().map(|(time, velocities)| Ahead { time: *time, velocities, strain_rate });
        let place = (self.moving.cell(), &self.partition);
        let shear = |which, beyond| {
            let moments = self.forces.moments(which, particles, place, beyond);
            moments.iter().map(|moment: &Tensor| moment.y_axis.x).sum::<f64>()
        };
        let of_surfaces = shear(Surface::Repulsion, beyond.as_ref()) + shear(Surface::Attraction, None);
        let bonds = self.tethers.moments(particles, place, beyond.as_ref());
        let of_bonds: f64 = bonds.iter().map(|moment| moment.y_axis.x).sum();
        let stresslets: &[Traceless] = bytemuck::cast_slice(&particles.column(STRESSLET, 5).values);
        let of_fluid: f64 = stresslets.iter().map(|stresslet| stresslet.tensor().y_axis.x).sum();
        let of_user: f64 = applied::moments(particles).iter().map(|moment| moment.y_axis.x).sum();
        let mut sum = [of_surfaces + of_fluid + of_contacts + of_bonds + of_user];
        self.partition.comm().sum(&mut sum);
        self.viscosity * self.flow().shear_rate() + sum[0] / self.cell().volume()
    }

    /// Expects the rate at the end of a substep that weights of that of now and the one before give, and the strain that
    /// weights of those and of the mean of the last substep do.
    pub fn expect_flow(&mut self, rate: [f64; 2], strain: [f64; 3]) {
        if let Some(driven) = self.moving.driven() {
            driven.expect(rate, strain);
        }
    }

    /// The strain that is missing with the rate that was found, where a substep has `implicit` of it.
    pub fn correct_flow(&mut self, implicit: f64) -> f64 {
        let rate = self.flow().shear_rate();
        self.moving.driven().map_or(0.0, |driven| driven.correct(rate, implicit))
    }

    /// Ends a substep in which the rate at its end had a share.
    pub fn end_flow(&mut self, share: f64) {
        if let Some(driven) = self.moving.driven() {
            driven.end(share);
        }
    }
}
