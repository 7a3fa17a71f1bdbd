//! Evaluations under stress control.

use super::{Dynamics, Outcome, PreviousSolutions, StageTime};
use crate::bodies;
use crate::columns::{self, EXPECTED, STRESSLET, VELOCITY};
use crate::error::step::StepError;
use crate::flow::stress_control::Search;
use crate::forces::acting::{Configuration, Prediction};
use domain::{Particles, Traceless, Vector};

impl Dynamics {
    /// Solves for the shear rate at which the stress has its given value, and for the motions at that rate. Collective.
    pub(super) fn drive(
        &mut self,
        particles: &mut Particles,
        mut search: Search,
        PreviousSolutions { mut guess, motion }: PreviousSolutions,
        moment: &StageTime,
    ) -> Result<Outcome, StepError> {
        loop {
            self.moving.set_rate(search.rate());
            let (outcome, _) = self.solve_at(particles, PreviousSolutions { guess, motion }, moment)?;
            self.fetch(particles);
            let stress = self.stress_at(particles, moment);
            if !search.goes_on(stress) {
                if let Some(driven) = self.moving.driven() {
                    driven.learn(&search);
                }
                return Ok(outcome);
            }
            guess = self.warm_start.found(particles);
        }
    }

    /// Shear stress of the whole suspension, with implicit forces at their predicted values. Collective.
    fn stress_at(&self, particles: &mut Particles, moment: &StageTime) -> f64 {
        let beyond = moment.implicit.map(|time| {
            let velocities = difference(particles, [VELOCITY, EXPECTED]);
            let turned = self.forces.have_beams().then(|| [VELOCITY, EXPECTED].map(columns::angular));
            (time, velocities, turned.map_or_else(Vec::new, |columns| difference(particles, columns)))
        });
        let strain_rate = self.moving.predicted_strain_rate_change() * -1.0;
        let beyond = beyond.as_ref().map(|(time, velocities, angular_velocities)| Prediction {
            time: *time,
            velocities,
            angular_velocities,
            strain_rate,
        });
        let stresslets: &[Traceless] = bytemuck::cast_slice(&particles.column(STRESSLET, 5).values);
        let of_fluid: f64 = stresslets.iter().map(|stresslet| stresslet.tensor().y_axis.x).sum();
        let of_fluid = of_fluid + bodies::shear_moment(particles);
        let (domain, time) = (self.domain(), moment.clock.time_at(moment.fraction));
        let near = self.forces.near(particles, domain);
        let at = Configuration { particles, domain, near: near.as_ref(), time, lists: self.forces.lists() };
        let mut sum = [self.forces.add_shear_moments(of_fluid, &at, beyond.as_ref())];
        self.partition.comm().sum(&mut sum);
        self.viscosity * self.flow().shear_rate() + sum[0] / self.cell().volume()
    }

    /// Predicts the rate at the end of a substep from weights of the present and past rates, and the strain from
    /// weights of these and of the mean over the last substep.
    pub fn predict_flow(&mut self, rate: [f64; 2], strain: [f64; 3]) {
        if let Some(driven) = self.moving.driven() {
            driven.predict(rate, strain);
        }
    }

    /// Correction of the strain for the rate that was found; `implicit` is the weight of this rate in the strain of the
    /// substep.
    pub fn correct_flow(&mut self, implicit: f64) -> f64 {
        let rate = self.flow().shear_rate();
        self.moving.driven().map_or(0.0, |driven| driven.correct(rate, implicit))
    }

    /// Ends a substep in whose mean the rate at its end has the weight `share`.
    pub fn end_flow(&mut self, share: f64) {
        if let Some(driven) = self.moving.driven() {
            driven.end(share);
        }
    }
}

/// The first column of vectors minus the second.
fn difference(particles: &mut Particles, [first, second]: [&str; 2]) -> Vec<Vector> {
    let second = particles.vectors(second).to_vec();
    particles.vectors(first).iter().zip(second).map(|(&first, second)| first - second).collect()
}
