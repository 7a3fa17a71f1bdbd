//! Tables of spheres with their loads and motions.

use super::Suspension;
use domain::{PeriodicBox, Traceless, Vector};
use fcm::{Loads, Motion};

/// Rigid spheres with radius, position, force and torque, and their velocities, angular velocities and stresslets.
pub struct Reference {
    pub suspension: Suspension,
    pub loads: Loads,
    pub motion: Motion,
    pub stresslets: Vec<Traceless>,
}

impl Reference {
    /// Parses the text of a table of spheres in a box.
    pub fn read(text: &str, cell: PeriodicBox) -> Self {
        let rows: Vec<Vec<f64>> = text
            .lines()
            .filter(|line| !line.starts_with(['#', 'r']))
            .map(|line| line.split(',').map(|number| number.trim().parse().unwrap()).collect())
            .collect();
        let vectors = |first: usize| rows.iter().map(|row| Vector::from_slice(&row[first..first + 3])).collect();
        // Columns xx, xy, xz, yy and yz of six.
        let stresslets = rows.iter().map(|row| Traceless(std::array::from_fn(|i| row[16 + i]))).collect();
        Self {
            suspension: Suspension {
                cell,
                viscosity: 1.0,
                positions: vectors(1),
                radii: rows.iter().map(|row| row[0]).collect(),
            },
            loads: Loads { forces: vectors(4), torques: vectors(7), stresslets: Vec::new() },
            motion: Motion { velocities: vectors(10), angular_velocities: vectors(13), strain_rates: Vec::new() },
            stresslets,
        }
    }
}
