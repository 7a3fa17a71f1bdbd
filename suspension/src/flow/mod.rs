//! Background flow: the periodic cell that it deforms, controlled stress, constant flux.

pub mod constant_flux;
pub mod deformation;
pub mod kraynik_reinelt;
pub mod open_cell;
pub mod periodic_cell;
pub mod stress_control;
