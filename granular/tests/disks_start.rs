//! A start made by an independent program (plain C, and Python for the numbers): 1460 disks
//! with the paper's parameters.

use domain::{Particles, Vector};
use granular::disks::{DiskParameters, Disks};

fn start() -> Particles {
    let mut particles = Particles::default();
    for (id, row) in include_str!("../../validation/data/disks-start.csv").lines().skip(1).enumerate() {
        let n: Vec<f64> = row.split(',').map(|word| word.parse().unwrap()).collect();
        particles.push(id as u64, Vector::new(n[0], n[1], 0.0), n[3], n[4] as u32);
    }
    particles
}

/// Segregation by exact areas at the start, and at a strain of 1 according to that program and LAMMPS.
#[test]
fn segregation_is_that_of_an_independent_program() {
    for (time_step, tolerance) in [(0.15, 1e-3), (0.05, 5e-4)] {
        let parameters = DiskParameters { time_step, ..DiskParameters::default() };
        let mut disks = Disks::flowing(parameters, &start()).unwrap();
        assert!((disks.snapshot().segregation() - 0.1156721570684007).abs() < 1e-12);
        disks.advance((100.0 / time_step) as u64);
        let found = disks.snapshot().segregation();
        assert!((found - 0.1197).abs() < tolerance, "{time_step}: {found}");
    }
}
