//! Loads on the particles and their motions.

use crate::plan::problem::Multipoles;
use domain::parallel::FusedLoops;
use domain::{Comm, Tensor, Traceless, Vector};

/// Loads that the particles apply to the fluid, one entry per particle; an empty list stands for zeros and costs
/// nothing.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Loads {
    /// Forces.
    pub forces: Vec<Vector>,
    /// Torques.
    pub torques: Vec<Vector>,
    /// Stresslets, positive along the rate of strain that they resist.
    pub stresslets: Vec<Traceless>,
}

impl Loads {
    /// Largest component of these loads, with torques and stresslets divided by a length; NaN is ignored.
    pub(crate) fn largest(&self, length: f64) -> f64 {
        let [mut forces, mut torques, mut stresslets] = [0.0; 3];
        let mut loops = FusedLoops::default();
        loops.greatest(&mut forces, &self.forces, |force| force.abs().max_element());
        loops.greatest(&mut torques, &self.torques, |torque| torque.abs().max_element());
        loops.greatest(&mut stresslets, &self.stresslets, |s| s.0.into_iter().map(f64::abs).fold(0.0, f64::max));
        loops.run();
        forces.max(torques.max(stresslets) / length)
    }

    /// Whether there are forces, torques and stresslets on any rank, and the largest of the sizes that ranks pass. A
    /// rank without particles has empty lists. Collective.
    pub(crate) fn kinds_on_ranks(&self, size: f64, comm: &Comm) -> ([bool; 3], f64) {
        let [forced, twisted, strained] =
            [!self.forces.is_empty(), !self.torques.is_empty(), !self.stresslets.is_empty()]
                .map(|some| f64::from(u8::from(some)));
        let mut all = [forced, twisted, strained, size];
        comm.max(&mut all);
        let [kinds @ .., largest] = all;
        (kinds.map(|kind| kind > 0.0), largest)
    }
}

/// Motions that an evaluation returns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Output {
    /// Velocities alone: no dipole is interpolated.
    Velocities,
    /// Angular velocities and rates of strain alone.
    Gradients,
    /// Velocities, angular velocities and rates of strain.
    All,
}

/// Motions of the particles relative to the background flow, one entry per particle; empty if not requested.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Motion {
    /// Velocities.
    pub velocities: Vec<Vector>,
    /// Angular velocities.
    pub angular_velocities: Vec<Vector>,
    /// Rates of strain of the disturbance flow, averaged over the dipole envelopes.
    pub strain_rates: Vec<Traceless>,
}

impl Motion {
    /// Adds `factor` times another motion of the same particles.
    pub fn add(&mut self, factor: f64, other: &Self) {
        let mut loops = FusedLoops::default();
        loops.change(&mut self.velocities, &other.velocities, move |v, &w| *v += w * factor);
        loops.change(&mut self.angular_velocities, &other.angular_velocities, move |v, &w| *v += w * factor);
        loops.change(&mut self.strain_rates, &other.strain_rates, move |e, &d| *e += d * factor);
        loops.run();
    }

    /// The motion without what a plan of these multipoles has not: with monopoles, velocities alone.
    pub(crate) fn of(self, multipoles: Multipoles) -> Self {
        match multipoles {
            Multipoles::Monopole | Multipoles::Moments => Self { velocities: self.velocities, ..Self::default() },
            Multipoles::Dipole => self,
        }
    }

    /// The power `sum (F . U + T . Omega - S : E)` of loads of the same particles in this motion; lists that are
    /// empty in either contribute nothing.
    pub fn power(&self, loads: &Loads) -> f64 {
        let of = |a: &[Vector], b: &[Vector]| a.iter().zip(b).map(|(&a, &b)| a.dot(b)).sum::<f64>();
        let strained = loads.stresslets.iter().zip(&self.strain_rates).map(|(&s, &e)| s.contract(e)).sum::<f64>();
        of(&loads.forces, &self.velocities) + of(&loads.torques, &self.angular_velocities) - strained
    }
}

/// The dipole `G = S + A` of a stresslet and a torque. `f = 1/2 curl(T Delta')` is `G_ij d_j Delta'` with
/// `A_ij = 1/2 epsilon_ijk T_k`.
pub(crate) fn dipole(stresslet: Traceless, torque: Vector) -> Tensor {
    let t = 0.5 * torque;
    let rotation =
        Tensor::from_cols(Vector::new(0.0, -t.z, t.y), Vector::new(t.z, 0.0, -t.x), Vector::new(-t.y, t.x, 0.0));
    stresslet.tensor() + rotation
}

/// Half the curl of a flow whose gradient is `D_ij = d_j u_i`.
pub(crate) fn angular_velocity(gradient: &Tensor) -> Vector {
    let d = |i: usize, j: usize| gradient.col(j)[i];
    0.5 * Vector::new(d(2, 1) - d(1, 2), d(0, 2) - d(2, 0), d(1, 0) - d(0, 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The power of a torque is `T . Omega`, and `G_ij D_ij` with `G` from the torque alone is minus that.
    #[test]
    fn torque_and_angular_velocity_are_adjoint() {
        let torque = Vector::new(1.0, -2.0, 0.5);
        let gradient = Tensor::from_cols_array(&[0.3, 0.1, -0.7, 1.1, -0.5, 0.2, 0.9, -1.3, 0.2]);
        let g = dipole(Traceless::ZERO, torque);
        let contraction: f64 = (0..3).flat_map(|j| (0..3).map(move |i| g.col(j)[i] * gradient.col(j)[i])).sum();
        assert!((contraction + torque.dot(angular_velocity(&gradient))).abs() < 1e-14);
    }
}
