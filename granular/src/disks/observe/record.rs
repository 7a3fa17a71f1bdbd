//! Records: the observables of a run at a strain.

use super::Lanes;
use crate::disks::Disks;
use domain::Vector;

/// The system at one time, and averages since the tally was last restarted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Record {
    /// The strain.
    pub strain: f64,
    /// The segregation parameter.
    pub segregation: f64,
    /// Mean kinetic energy per disk of the excess velocity: the local temperature.
    pub kinetic: f64,
    /// Averages of xx, xy and yy of the stress. Pressure is positive.
    pub stress: Vector,
    /// Pairs in contact.
    pub contacts: f64,
    /// Collisions that began since the tally was restarted: of two small disks, of a small and a
    /// large one, of two large ones.
    pub collisions: [f64; 3],
    /// Mean free path through the liquid since then; infinite without collisions.
    pub free_path: f64,
    /// The strongest lanes.
    pub lanes: Lanes,
    /// Relative error of the energy balance since then.
    pub imbalance: f64,
}

impl Record {
    /// Names and units of the numbers of a record.
    pub const COLUMNS: [(&str, &str); 14] = [
        ("strain", ""),
        ("segregation", ""),
        ("kinetic_energy", "force*length"),
        ("stress_xx", "force/length"),
        ("stress_xy", "force/length"),
        ("stress_yy", "force/length"),
        ("contacts", ""),
        ("collisions_small_small", ""),
        ("collisions_small_large", ""),
        ("collisions_large_large", ""),
        ("mean_free_path", "length"),
        ("lane_peak", ""),
        ("lane_spacing", "length"),
        ("energy_imbalance", ""),
    ];

    /// The values in the order of [`Self::COLUMNS`].
    pub fn values(&self) -> [f64; Self::COLUMNS.len()] {
        let Self { strain, segregation, kinetic, stress, contacts, collisions, free_path, lanes, imbalance } = *self;
        let [[xx, xy, yy], [small, mixed, large]] = [stress.to_array(), collisions];
        let Lanes { peak, spacing } = lanes;
        [strain, segregation, kinetic, xx, xy, yy, contacts, small, mixed, large, free_path, peak, spacing, imbalance]
    }

    /// The record with these values.
    pub fn of(values: [f64; Self::COLUMNS.len()]) -> Self {
        let [
            strain,
            segregation,
            kinetic,
            xx,
            xy,
            yy,
            contacts,
            small,
            mixed,
            large,
            free_path,
            peak,
            spacing,
            imbalance,
        ] = values;
        Self {
            strain,
            segregation,
            kinetic,
            stress: Vector::new(xx, xy, yy),
            contacts,
            collisions: [small, mixed, large],
            free_path,
            lanes: Lanes { peak, spacing },
            imbalance,
        }
    }
}

impl Disks {
    /// Record of the present state. If the tally has just been restarted, the stress is the present one.
    pub fn record(&self) -> Record {
        let (snapshot, tally) = (self.snapshot(), self.tally());
        let counted = tally.time() > 0.0;
        Record {
            strain: self.strain(),
            segregation: snapshot.segregation(),
            kinetic: tally.latest.kinetic / snapshot.disks.len() as f64,
            stress: if counted { tally.mean_stress() } else { tally.latest.stress() },
            contacts: tally.latest.contacts as f64,
            collisions: tally.collisions.map(|n| n as f64),
            free_path: if counted { tally.mean_free_path(snapshot.disks.len()) } else { f64::INFINITY },
            lanes: snapshot.lanes(),
            imbalance: tally.imbalance(),
        }
    }
}
