//! Particles that are present on a rank's device: its own, and those of other ranks within reach.

use crate::mobility::loads::Loads;
use crate::plan::Plan;
use bytemuck::Pod;
use domain::{Comm, Halo, Partition, PeriodicBox, Units, Vector, block};
use gpu::{DeviceLoads, GridShare, Peers, StencilSums};
use std::ops::Range;
use std::rc::Rc;

/// Part of the reach of a particle by which it is longer on a device, where positions are rounded to fixed points.
const ROUNDING: f64 = 1e-6;

/// The part of a plan's grid that the device of this rank has.
///
/// # Panics
/// If the ranks do not divide the grid along z alone.
pub(super) fn grid_share(plan: &Plan, partition: &Partition) -> GridShare {
    assert_eq!(partition.table()[0], 1, "the ranks of devices have slabs");
    let comm = partition.comm();
    let planes = |rank: usize| -> Range<usize> { partition.owned_by(rank)[1].clone() };
    let modes = |rank: usize| block(plan.grid[1], comm.size(), rank);
    let all = 0..comm.size();
    GridShare { planes: all.clone().map(planes).collect(), modes: all.map(modes).collect(), own: comm.rank() }
}

/// Plan of the exchange of particles at some positions, which this rank owns, in internal units.
pub(super) fn halo(
    plan: &Plan,
    units: &Units,
    partition: &Partition,
    cell: &PeriodicBox,
    positions: &[Vector],
) -> Halo {
    let cutoff = plan.cutoff() / units.length;
    let reach = plan.stencil_reach(cell, units).map(|stencil| stencil.max(cutoff) * (1.0 + ROUNDING));
    Halo::plan(partition, cell, positions, reach)
}

/// Other ranks, whose devices share the grid with that of this one.
pub(super) struct RankPeers {
    pub comm: Comm,
    pub halo: Rc<Halo>,
}

impl Peers for RankPeers {
    fn exchange(&self, sent: (&[u64], &[Range<usize>]), received: (&mut [u64], &[Range<usize>])) {
        self.comm.all_to_all_ranges(sent, received);
    }

    fn collect(&self, sums: &mut Vec<StencilSums>) {
        self.halo.collect(sums);
    }
}

/// Loads of the particles present in the units of a device; a list is empty if there are no such loads on any rank.
pub(super) struct PresentLoads {
    forces: Vec<f64>,
    torques: Vec<f64>,
    stresslets: Vec<f64>,
}

impl PresentLoads {
    /// Loads of this rank's particles and those of its halo, by units of force and dipole, if there are forces, torques
    /// and stresslets on any rank. Collective.
    pub fn new(loads: &Loads, [force, dipole]: [f64; 2], [forced, twisted, strained]: [bool; 3], halo: &Halo) -> Self {
        let [of_force, of_dipole] = [force, dipole].map(f64::recip);
        Self {
            forces: present(loads.forces.iter().map(Vector::to_array), of_force, forced, halo),
            torques: present(loads.torques.iter().map(Vector::to_array), of_dipole, twisted, halo),
            stresslets: present(loads.stresslets.iter().map(|s| s.0), of_dipole, strained, halo),
        }
    }

    /// The lists.
    pub fn lists(&self) -> DeviceLoads<'_> {
        DeviceLoads { forces: &self.forces, torques: &self.torques, stresslets: &self.stresslets }
    }
}

/// Columns of the particles present as a list of numbers, if they are on any rank.
fn present<const N: usize>(own: impl Iterator<Item = [f64; N]>, factor: f64, is_there: bool, halo: &Halo) -> Vec<f64>
where
    [f64; N]: Pod,
{
    if !is_there {
        return Vec::new();
    }
    let mut columns: Vec<[f64; N]> = own.map(|column| column.map(|value| value * factor)).collect();
    columns.resize(halo.owned(), [0.0; N]);
    halo.extend(&mut columns);
    columns.into_flattened()
}
