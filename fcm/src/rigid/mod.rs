//! Rigid spheres: conjugate gradients for their stresslets.

pub(crate) mod conjugate_gradients;
pub(crate) mod stresslet_solver;
