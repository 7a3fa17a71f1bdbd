//! Snapshots of all disks.

use crate::disks::Disks;
use crate::disks::state::{Body, Identity};
use glam::DVec2;

/// One disk.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Disk {
    /// Id of the disk.
    pub id: u64,
    /// Centre, inside the cell: `0 <= y < Ly`, and `x` minus the strain times `y` likewise.
    pub position: DVec2,
    /// Velocity.
    pub velocity: DVec2,
    /// Velocity in excess of the liquid's.
    pub excess: DVec2,
    /// Radius.
    pub radius: f64,
    /// Mass.
    pub mass: f64,
    /// Species.
    pub species: u32,
    /// Whether the radius is above the geometric mean of the smallest and the largest.
    pub is_large: bool,
}

/// All disks at one time, in the order of their ids.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Snapshot {
    /// Edges of the cell.
    pub edges: [f64; 2],
    /// The disks.
    pub disks: Vec<Disk>,
}

impl Disks {
    /// Snapshot of the present state.
    pub fn snapshot(&self) -> Snapshot {
        let (law, model) = (&self.law, &self.model);
        let state = self.wrapped();
        let disk = |row: usize| {
            let Identity { id, species, radius, is_large, .. } = state.identities[row];
            let Body { position, velocity } = state.bodies[row];
            let excess = velocity - DVec2::new(law.profile.speed(position.y), 0.0);
            Disk { id, position, velocity, excess, radius, mass: model.mass(radius), species, is_large }
        };
        let mut disks: Vec<Disk> = (0..state.len()).map(disk).collect();
        disks.sort_by_key(|d| d.id);
        Snapshot { edges: model.parameters().edges, disks }
    }
}
