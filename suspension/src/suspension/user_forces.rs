//! Forces of the user, in addition to those of the model.

use super::Suspension;
use crate::error::step::StepError;
use crate::forces::force::Force;
use simulation::{LoadFunction, UserLoads};

impl Suspension {
    /// Adds loads to those of the model: every later evaluation of the mobility includes the loads of the function at
    /// its own positions and time. The present velocities are evaluated again with them; only if the suspension was
    /// resumed from a state with user-defined loads, which its velocities already include, the function takes effect
    /// with the next step. The stresses of [`Self::stress`] include the moments that the function returns. If the
    /// function fails, nothing is added. Collective: each rank provides the function, and the first one calls it.
    ///
    /// A sphere on a spring:
    /// ```
    /// use domain::{Comm, PeriodicBox, Vector};
    /// use simulation::AppliedLoads;
    /// use suspension::{Model, Parameters, Species, Start, Suspension};
    ///
    /// let (cell, place) = (PeriodicBox::new(Vector::splat(16.0))?, Vector::splat(8.0));
    /// let start = Start::Positions(vec![place]);
    /// let species = vec![Species::new("on a spring", 1.0, 1)];
    /// let model = Model::new(Parameters { start, ..Parameters::new(cell, 1.0, species, 0.1, 10) })?;
    /// let mut suspension = Suspension::start(&model, &Comm::alone())?;
    /// let anchor = place + Vector::X;
    /// suspension.add_loads(Box::new(move |positions: &[Vector], _time| {
    ///     let forces = positions.iter().map(|&position| 5.0 * (anchor - position)).collect();
    ///     Ok(AppliedLoads { forces, ..AppliedLoads::default() })
    /// }))?;
    /// suspension.step()?;
    /// let moved = suspension.particles().positions[0] - place;
    /// assert!(moved.x > 0.0 && moved.x < 5.0 / (6.0 * std::f64::consts::PI) * 0.1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn add_loads(&mut self, loads: LoadFunction) -> Result<(), StepError> {
        self.add_own_loads(UserLoads::OfPositions(loads))
    }

    /// [`Self::add_loads`] for any kind of user-defined loads. Collective.
    pub fn add_own_loads(&mut self, loads: UserLoads) -> Result<(), StepError> {
        self.dynamics.forces_mut().applied.add(loads);
        if self.has_applied_loads {
            return Ok(());
        }
        let evaluated = self.or_as_before(|suspension| {
            suspension.outcome = suspension.dynamics.evaluate_now(&mut suspension.particles, &suspension.clock)?;
            Ok(())
        });
        if evaluated.is_err() {
            self.dynamics.forces_mut().applied.remove_last();
        }
        evaluated
    }

    /// Registers a force besides those of the model. Every later evaluation includes it, and its contributions to the
    /// stress are in [`Self::stress`] and in the time series; implicit steps are implicit in it if it gives
    /// resistances. The present velocities are evaluated again, unless the suspension was resumed from a state whose
    /// velocities include a force of this name. If that fails, nothing is registered. Collective: each rank registers
    /// the force.
    ///
    /// A pair with a constant repulsion up to a distance:
    /// ```
    /// use domain::{Comm, PeriodicBox, Vector};
    /// use lubrication::PairKind;
    /// use suspension::{Model, PairLaw, PairwiseForce, Parameters, Species, Start, Suspension};
    ///
    /// struct Push;
    ///
    /// impl PairLaw for Push {
    ///     fn name(&self) -> &'static str {
    ///         "push"
    ///     }
    ///
    ///     fn reach(&self, _: PairKind) -> f64 {
    ///         4.0
    ///     }
    ///
    ///     fn force(&self, separation: Vector, _: PairKind) -> Vector {
    ///         if separation.length() < 4.0 { -separation.normalize() } else { Vector::ZERO }
    ///     }
    /// }
    ///
    /// let cell = PeriodicBox::new(Vector::splat(16.0))?;
    /// let start = Start::Positions(vec![Vector::new(6.5, 8.0, 8.0), Vector::new(9.5, 8.0, 8.0)]);
    /// let species = vec![Species::new("pushed", 1.0, 2)];
    /// let model = Model::new(Parameters { start, ..Parameters::new(cell, 1.0, species, 0.1, 10) })?;
    /// let mut suspension = Suspension::start(&model, &Comm::alone())?;
    /// suspension.add_force(Box::new(PairwiseForce::new(Push)))?;
    /// suspension.step()?;
    /// let positions = &suspension.particles().positions;
    /// assert!((positions[1] - positions[0]).x > 3.0);
    /// assert!(suspension.stress(1)[0].of("push").x_axis.x < 0.0, "a pressure");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn add_force(&mut self, force: Box<dyn Force>) -> Result<(), StepError> {
        let (name, step) = (force.name(), self.clock.step());
        if self.dynamics.forces().all().any(|other| other.name() == name) {
            let taken = self.comm.agree(Err::<(), _>(format!("there is another force with the name \"{name}\"")));
            return taken.map_err(|source| StepError::Applied { step, source });
        }
        self.dynamics.register(force);
        if self.known_forces.iter().any(|known| known == name) {
            return Ok(());
        }
        let evaluated = self.or_as_before(|suspension| {
            suspension.outcome = suspension.dynamics.evaluate_now(&mut suspension.particles, &suspension.clock)?;
            Ok(())
        });
        if evaluated.is_err() {
            self.dynamics.remove_last_force();
        }
        evaluated
    }
}
