//! Tests of resistance functions in one program: each file here has to be a module of it to run.

mod pair_force;
mod properties;
mod reference;
mod wall_force;
mod wall_reference;
