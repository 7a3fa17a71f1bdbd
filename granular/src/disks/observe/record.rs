//! Records: the observables of a run at a strain.

use super::LaneOrder;
use crate::disks::Disks;
use domain::Vector;

/// Names and units of the numbers of a record. Averages and counts are since the tally was last restarted.
pub const RECORD_COLUMNS: [(&str, &str); 14] = [
    ("strain", ""),
    ("segregation", ""),
    // Per disk, of the velocity in excess of the liquid's: the local temperature.
    ("kinetic_energy", "force*length"),
    // Averages; pressure is positive.
    ("stress_xx", "force/length"),
    ("stress_xy", "force/length"),
    ("stress_yy", "force/length"),
    // Number of pairs in contact.
    ("contacts", ""),
    // Collisions that began, by the sizes of both disks.
    ("collisions_small_small", ""),
    ("collisions_small_large", ""),
    ("collisions_large_large", ""),
    // Through the liquid; infinite without collisions.
    ("mean_free_path", "length"),
    // Of the strongest lanes.
    ("lane_peak", ""),
    ("lane_spacing", "length"),
    // Relative error of the energy balance.
    ("energy_imbalance", ""),
];

impl Disks {
    /// The numbers of a record of the present state, in the order of [`RECORD_COLUMNS`]. If the tally has just been
    /// restarted, the stress is the present one.
    pub fn record(&self) -> [f64; RECORD_COLUMNS.len()] {
        let (snapshot, tally) = (self.snapshot(), self.tally());
        let (counted, disks) = (tally.time() > 0.0, snapshot.disks.len());
        let kinetic = tally.latest.kinetic / disks as f64;
        let Vector { x: xx, y: xy, z: yy } = if counted { tally.mean_stress() } else { tally.latest.stress() };
        let (contacts, [small, mixed, large]) = (tally.latest.contacts, tally.collisions.to_array());
        let free_path = if counted { tally.mean_free_path(disks) } else { f64::INFINITY };
        let LaneOrder { peak, spacing } = snapshot.lanes();
        let (strain, segregation, imbalance) = (self.strain(), snapshot.segregation(), tally.imbalance());
        [strain, segregation, kinetic, xx, xy, yy, contacts, small, mixed, large, free_path, peak, spacing, imbalance]
    }
}
