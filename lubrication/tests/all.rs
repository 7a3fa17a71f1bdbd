//! Tests of resistance functions, in one program: each file here is a module of it, or it is not run.

mod pair_force;
mod properties;
mod reference;
mod wall_force;
mod wall_reference;
