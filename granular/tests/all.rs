//! Tests of grains without a fluid, in one program: each file here is a module of it, or its tests do not run.

mod disks;
mod disks_input;
mod disks_lattice;
mod disks_start;
mod extremes;
mod kinetic_theory;
mod kinetic_theory_coefficients;
mod kinetic_theory_shooting;
mod runs;
mod shear_cell_collisions;
mod shear_cell_flow;
mod shear_cell_gas;
mod units;
