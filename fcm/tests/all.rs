//! Tests of evaluations in one program: each file here has to be a module of it to run.

mod at_walls;
mod common;
mod dense;
mod dipoles;
mod errors;
mod flow;
mod flow_at_walls;
mod grids;
mod isolated;
mod lattices;
mod long_boxes;
mod open_dipoles;
mod overlaps;
mod properties;
mod quadrupoles;
mod ranks;
mod rigid;
mod skips;
mod tolerance;
mod units;
mod wall_drift;
mod walls;
