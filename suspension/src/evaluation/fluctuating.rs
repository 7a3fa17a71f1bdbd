//! Evaluations in a fluctuating fluid.

use super::{Dynamics, Outcome, StageTime};
use crate::bodies;
use crate::columns::PAST;
use crate::error::step::StepError;
use crate::evaluation::overlap_monitor::{OverlapCounts, OverlapMonitor};
use crate::neighbourhood::PairsWithHalo;
use crate::rotation;
use domain::parallel::{FusedLoops, mapped, of_rows};
use domain::{DomainView, Interrupted, Particles, Traceless, Vector};
use fcm::{Loads, Motion, Stream};
use hydrodynamics::brownian::{self, FiniteDifference, ambient, set_ambient};
use hydrodynamics::{Guess, Solution};

/// Thermal fluctuations of a step.
#[derive(Debug, Clone, Copy)]
pub struct Noise {
    /// Random numbers of the step.
    pub stream: Stream,
    /// `sqrt(2 kT / dt)`, the factor between motions whose covariance is the mobility and the random motions of the
    /// step.
    pub amplitude: f64,
    /// The thermal energy `kT`.
    pub energy: f64,
}

/// Relative error of random motions over the tolerance.
const ROOT: f64 = 0.3;

impl Dynamics {
    /// Draws random motions of the fluid at the particles, and stores their velocities plus the background flow as the
    /// first past velocities; bodies have the means over their spheres. Collective.
    pub fn draw_velocities(&mut self, particles: &mut Particles, noise: Noise) {
        if particles.are_remote() {
            self.draw_remotely(particles, noise);
        } else {
            self.fluctuate(particles, noise);
            self.store_drawn_velocities(particles);
        }
    }

    /// Draws random motions of the fluid at the particles, and stores displacements and rotations by them over a time.
    /// Collective.
    pub fn draw_motions(&mut self, particles: &mut Particles, noise: Noise, time: f64) {
        if particles.are_remote() {
            self.displace_remotely(particles, noise, time);
        } else {
            self.fluctuate(particles, noise);
            brownian::displace(particles, time);
            rotation::store_random(particles, time);
        }
    }

    /// Draws random motions of the fluid at the particles. Collective.
    fn fluctuate(&mut self, particles: &mut Particles, noise: Noise) {
        let (cell, tolerance) = (*self.moving.cell(), self.random_tolerance());
        let (motion, drawn) = self.hydrodynamics.noise(&cell, particles, tolerance, noise.stream);
        self.clipped = self.clipped.max(drawn.clipped);
        set_ambient(particles, &motion, noise.amplitude);
    }

    /// Relative error of random motions.
    pub(super) fn random_tolerance(&self) -> f64 {
        ROOT * self.tolerance
    }

    /// Stores the velocities of the drawn motions plus the background flow as the first past velocities; bodies have
    /// the means over their spheres.
    fn store_drawn_velocities(&self, particles: &mut Particles) {
        let drawn = ambient(particles);
        let drawn = self.rigid_means(particles, drawn);
        self.note_carried(particles, PAST[0], &drawn.velocities);
        self.note_rotating(particles, &drawn.angular_velocities);
        self.note_centres(particles, &drawn);
    }

    /// Angular velocities plus those of the background flow at the particles.
    pub(super) fn with_rotation_of_flow(&self, particles: &Particles, own: &[Vector]) -> Vec<Vector> {
        let (positions, moving) = (&particles.positions, &self.moving);
        of_rows(own.len(), |row| own[row] + moving.angular_velocity_at(positions[row]))
    }

    /// Stores angular velocities plus those of the background flow, for spheres of bodies at the centre of their body,
    /// as the first past ones, for orientations.
    fn note_rotating(&self, particles: &mut Particles, own: &[Vector]) {
        if let Some([past]) = rotation::angular(particles, [PAST[0]]) {
            let arms = bodies::arms(particles);
            let arm = |row: usize| arms.get(row).copied().unwrap_or_default();
            let (moving, positions) = (&self.moving, &particles.positions);
            let flow = |row: usize| moving.angular_velocity_at(positions[row] - arm(row));
            let rotating = of_rows(own.len(), |row| own[row] + flow(row));
            particles.vectors(past).copy_from_slice(&rotating);
        }
    }

    /// [`Self::evaluate`] in the fluctuating fluid: with the drawn motions, the drift near walls, and lubrication noise
    /// from the same random numbers. Collective; fails on every rank or on none.
    pub fn evaluate_fluctuating(
        &mut self,
        particles: &mut Particles,
        moment: &StageTime,
        noise: Noise,
    ) -> Result<Outcome, StepError> {
        self.begin_solve(particles, moment)?;
        let solved = if particles.are_remote() {
            self.solve_remotely(particles, moment, noise)?.1
        } else {
            self.solve_fluctuating(particles, moment, noise, noise.energy)?.1
        };
        self.record(particles, &solved);
        Ok(Outcome::of(&solved))
    }

    /// Wraps particles into the box and migrates them to their ranks, unless a rank is asked to stop. Collective.
    fn begin_solve(&mut self, particles: &mut Particles, moment: &StageTime) -> Result<(), StepError> {
        self.unless_interrupted()?;
        self.wrap_and_migrate(particles, moment)
    }

    /// Solves for the motions under all loads, lubrication noise included, in the drawn motions plus `energy` times the
    /// divergence of the mobility.
    fn solve_fluctuating(
        &mut self,
        particles: &mut Particles,
        moment: &StageTime,
        noise: Noise,
        energy: f64,
    ) -> Result<(Loads, Solution), StepError> {
        let near = self.forces.shared_near(particles, self.domain());
        if let Some(near) = &near {
            self.monitor_overlaps(particles, near);
        }
        let mut acting = self.acting(particles, near.as_ref(), moment, None, &Motion::default())?;
        drop(near);
        let noise = self.pair_noise(particles, noise);
        let (loads, mut loops) = (&mut acting.loads, FusedLoops::default());
        for (loads, noise) in [(&mut loads.forces, &noise.forces), (&mut loads.torques, &noise.torques)] {
            loads.resize(particles.len(), Vector::ZERO);
            loops.change(loads, noise, |load, &noise| *load += noise);
        }
        loops.run();
        let mut ambient = ambient(particles);
        if energy > 0.0 {
            self.add_divergence_of_free(particles, energy, &mut ambient);
        }
        add_ambient(&mut ambient, &acting.ambient);
        let solved = self.solved(particles, &acting, &ambient, Guess::induced_by(&ambient), moment)?;
        Ok((acting.loads, solved))
    }

    /// [`Self::evaluate_fluctuating`] with results that are intermediate: the velocities are stored as the first past
    /// ones, and the motions are stored for their finite difference, see [`brownian::store_solution`]. Collective;
    /// fails on every rank or on none.
    pub fn move_at_random(
        &mut self,
        particles: &mut Particles,
        moment: &StageTime,
        noise: Noise,
    ) -> Result<Outcome, StepError> {
        self.begin_solve(particles, moment)?;
        if particles.are_remote() {
            return self.move_remotely_at_random(particles, moment, noise);
        }
        let (loads, solved) = self.solve_fluctuating(particles, moment, noise, 0.0)?;
        let (outcome, cell) = (Outcome::of(&solved), *self.moving.cell());
        self.note_carried(particles, PAST[0], &solved.motion.velocities);
        self.note_rotating(particles, &solved.motion.angular_velocities);
        if self.rigid {
            let solved = self.hydrodynamics.with_lists(solved, particles);
            let noted = brownian::store_solution(&mut self.hydrodynamics, &cell, particles, &loads, &solved);
            noted.map_err(|source| self.unsolved(source, particles, moment.clock.step()))?;
        }
        Ok(outcome)
    }

    /// Stores the drift of the random motions from a finite difference at the present positions, see
    /// [`brownian::store_drift`]. For particles without resistance to strain it is the divergence of the mobility.
    /// Collective; fails on every rank or on none.
    pub fn store_drift(
        &mut self,
        particles: &mut Particles,
        moment: &StageTime,
        change: FiniteDifference,
    ) -> Result<(), StepError> {
        let cell = *self.moving.cell();
        if !self.rigid {
            brownian::store_divergence(&mut self.hydrodynamics, &cell, particles, change.energy);
            return Ok(());
        }
        let store = if particles.are_remote() { brownian::store_held_drift } else { brownian::store_drift };
        let noted = store(&mut self.hydrodynamics, &cell, particles, change);
        noted.map_err(|source| self.unsolved(source, particles, moment.clock.step()))
    }

    /// Limits the drift in a time, see [`brownian::limit_drift`].
    pub fn limit_drift(&self, particles: &mut Particles, time: f64) {
        if particles.are_remote() {
            self.limit_remotely(particles, time);
        } else {
            brownian::limit_drift(particles, time);
            rotation::limit_drift(particles, time);
        }
    }

    /// Pairs that were too close in the last solve for random motions; `None` without Brownian motion.
    pub fn overlap_counts(&self) -> Option<OverlapCounts> {
        self.overlap_monitor.as_ref().map(OverlapMonitor::last)
    }

    fn monitor_overlaps(&mut self, particles: &Particles, near: &PairsWithHalo) {
        let Self { moving, partition, overlap_monitor, .. } = self;
        let domain = DomainView { cell: moving.cell(), partition };
        if let Some(overlap_monitor) = overlap_monitor {
            overlap_monitor.look(particles, domain, near);
        }
    }

    /// Random loads between near pairs. Collective.
    fn pair_noise(&mut self, particles: &mut Particles, Noise { amplitude, stream, .. }: Noise) -> Loads {
        let (cell, bodies) = (*self.moving.cell(), bodies::of(particles, self.partition.comm()));
        let Loads { forces, torques, .. } = self.hydrodynamics.pair_noise(&cell, particles, bodies.as_ref(), stream);
        let times = |list: &[Vector]| mapped(list, |&load| load * amplitude);
        Loads { forces: times(&forces), torques: times(&torques), stresslets: Vec::new() }
    }

    /// Fails if any rank is asked to stop. Collective.
    fn unless_interrupted(&self) -> Result<(), StepError> {
        let is_requested = self.partition.comm().any(self.hydrodynamics.interrupt().is_requested());
        if is_requested { Err(Interrupted.into()) } else { Ok(()) }
    }
}

/// Adds ambient motions by forces, whose empty lists stand for none.
fn add_ambient(ambient: &mut Motion, by_forces: &Motion) {
    ambient.velocities.resize(by_forces.velocities.len().max(ambient.velocities.len()), Vector::ZERO);
    let turning = by_forces.angular_velocities.len().max(ambient.angular_velocities.len());
    ambient.angular_velocities.resize(turning, Vector::ZERO);
    ambient.strain_rates.resize(by_forces.strain_rates.len().max(ambient.strain_rates.len()), Traceless::ZERO);
    ambient.add(1.0, by_forces);
}
