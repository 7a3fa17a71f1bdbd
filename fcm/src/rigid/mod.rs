//! Rigid spheres: their stresslets, by conjugate gradients.

pub(crate) mod stresslet_solver;
