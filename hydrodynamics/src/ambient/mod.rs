//! Flows that drive particles from outside.

mod poiseuille;
mod strain_rate;
mod walls;

pub use poiseuille::Poiseuille;
pub use strain_rate::StrainRate;
pub use walls::{FlowRefused, check_linear, check_pressure, poiseuille};
