//! Relative motion of near pairs, here or where the particles move.

use super::Dynamics;
use crate::evaluation::gap_control::{Change, MOST_ROUNDS, RelativeMotion, SLACK, WATCHED};
use crate::evaluation::orders::ErrorEstimate;
use crate::flow::deformation::Deformation;
use domain::{Comm, Particles, RemoteList, Vector};
use fcm::{
    DISPLACED, DisplacementError, DisplacementOrders, DisplacementWeights, GapChanges, HeldSteps, HeldVelocities,
    Separation, SeparationLimits,
};
use solver::BackgroundFlow;
use std::rc::Rc;

/// Relative motion of near pairs, with `N` velocities of each.
pub enum Approach<const N: usize> {
    /// Of particles that move here.
    Here(RelativeMotion<N>),
    /// Of particles that move where the far field is evaluated.
    Held(HeldApproach),
}

/// Near pairs of particles where the far field is evaluated, in a flow that does not advect them.
pub struct HeldApproach {
    steps: Rc<dyn HeldSteps>,
    positions: RemoteList,
    columns: Vec<RemoteList>,
    /// The flow by which images move relative to their particles.
    flow: BackgroundFlow,
    /// Distance of centres up to which pairs are considered.
    reach: f64,
}

/// Displacements of all particles that keep near pairs apart.
pub enum Separated {
    /// Nobody moves.
    Apart,
    /// Displacements here.
    Here(Vec<Vector>),
    /// Displacements where the far field is evaluated.
    Held(RemoteList),
}

impl<const N: usize> Approach<N> {
    /// Lets the flow deform separations as well, after they changed by displacements.
    pub fn advected_by(&mut self, advection: Deformation) -> &Self {
        match self {
            Self::Here(motion) => _ = motion.advected_by(advection),
            Self::Held(_) => assert_eq!(advection, Deformation::NONE, "no flow advects particles that move elsewhere"),
        }
        self
    }

    /// [`RelativeMotion::after`]. Collective.
    pub fn after(&self, both: [[f64; N]; 2], least: [f64; 2], comm: &Comm) -> Change {
        match self {
            Self::Here(motion) => motion.after(both, least, comm),
            Self::Held(held) => held.changes(&DisplacementOrders::Two(&both.map(padded)), least),
        }
    }

    /// [`RelativeMotion::after_orders`]. Collective.
    pub fn after_orders(&self, orders: [[f64; N]; 4], least: [f64; 2], comm: &Comm) -> Change {
        match self {
            Self::Here(motion) => motion.after_orders(orders, least, comm),
            Self::Held(held) => {
                let weights = &orders.map(padded);
                held.changes(&DisplacementOrders::Four { weights, smooth: ErrorEstimate::SMOOTH }, least)
            }
        }
    }

    /// [`RelativeMotion::apart`]. Collective.
    pub fn apart(&self, weights: [f64; N], closest: f64, comm: &Comm) -> Option<Separated> {
        match self {
            Self::Here(motion) => motion.apart(weights, closest, comm).map(Separated::Here),
            Self::Held(held) => {
                let limits = SeparationLimits { closest, slack: SLACK, rounds: MOST_ROUNDS, reach: held.reach };
                match held.steps.moved_apart(&held.velocities(), &padded(weights), &limits) {
                    Separation::Apart => Some(Separated::Apart),
                    Separation::By(displacements) => Some(Separated::Held(displacements)),
                    Separation::Fails => None,
                }
            }
        }
    }
}

impl HeldApproach {
    fn velocities(&self) -> HeldVelocities<'_> {
        HeldVelocities { positions: &self.positions, columns: &self.columns, flow: &self.flow }
    }

    fn changes(&self, orders: &DisplacementOrders, least: [f64; 2]) -> Change {
        let GapChanges { gap, loss, error, roughness } =
            self.steps.gap_changes(&self.velocities(), orders, least, self.reach);
        Change { gap, loss, error, roughness }
    }
}

/// Weights of up to the largest number of columns.
fn padded<const N: usize>(weights: [f64; N]) -> DisplacementWeights {
    let mut padded = [0.0; DISPLACED];
    padded[..N].copy_from_slice(&weights);
    padded
}

/// Message of a panic, which would be a mistake in the program.
pub(super) const ELSEWHERE: &str = "the far field moves these particles";

impl Dynamics {
    /// Relative motion of near pairs with the velocities of the named columns. Collective.
    pub fn approach<const N: usize>(&mut self, particles: &mut Particles, columns: [&str; N]) -> Approach<N> {
        let reach = WATCHED * self.largest_radius;
        if particles.are_remote() {
            return Approach::Held(self.held_approach(particles, columns, reach));
        }
        let near = self.forces.lists().pairs(particles, self.domain(), reach);
        Approach::Here(RelativeMotion::new(near, particles, &self.moving, columns))
    }

    fn held_approach<const N: usize>(
        &mut self,
        particles: &mut Particles,
        columns: [&str; N],
        reach: f64,
    ) -> HeldApproach {
        self.hydrodynamics.mobility().follow(self.moving.cell(), particles);
        let positions = particles.positions.remote_list().expect(ELSEWHERE).clone();
        let columns = columns.map(|name| self.held_column(particles, name, 3)).into();
        HeldApproach { steps: self.steps(), positions, columns, flow: self.moving.flow_of_images(), reach }
    }

    /// Measures of displacements where particles move.
    pub(super) fn steps(&self) -> Rc<dyn HeldSteps> {
        Rc::clone(self.hydrodynamics.steps().expect(ELSEWHERE))
    }

    /// The list of a column of particles that move where the far field is evaluated.
    pub(super) fn held_column(&self, particles: &mut Particles, name: &str, width: usize) -> RemoteList {
        particles.held_column(name, width, self.hydrodynamics.holder().expect(ELSEWHERE))
    }

    /// Weighted sum of columns of vectors of particles that move where the far field is evaluated; `None` for others.
    pub fn held_sum<const N: usize>(
        &self,
        particles: &mut Particles,
        columns: [&str; N],
        weights: [f64; N],
    ) -> Option<RemoteList> {
        if !particles.are_remote() {
            return None;
        }
        let columns = columns.map(|name| self.held_column(particles, name, 3));
        Some(self.steps().combined(&columns.into_iter().zip(weights).collect::<Vec<_>>()))
    }

    /// Largest displacement over the radius of particles that move where the far field is evaluated, by a weighted sum
    /// of columns; `None` for others.
    pub fn held_displacement<const N: usize>(
        &self,
        particles: &mut Particles,
        columns: [&str; N],
        weights: [f64; N],
    ) -> Option<f64> {
        let orders = [padded(weights), [0.0; DISPLACED]];
        self.held_error(particles, columns, &DisplacementOrders::Two(&orders)).map(|found| found.error)
    }

    /// Error of displacements over the radius of particles that move where the far field is evaluated; `None` for
    /// others.
    pub fn held_error<const N: usize>(
        &self,
        particles: &mut Particles,
        columns: [&str; N],
        orders: &DisplacementOrders,
    ) -> Option<DisplacementError> {
        if !particles.are_remote() {
            return None;
        }
        let columns = columns.map(|name| self.held_column(particles, name, 3));
        Some(self.steps().displacement_error(&columns, orders))
    }
}
