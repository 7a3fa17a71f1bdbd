//! Energies, stresses, works and collisions, measured and summed over a run.

use super::sums::{ContactSums, MotionSums};
use bytemuck::{Pod, Zeroable};
use domain::Vector;

/// Energies, stresses and powers at a step. Velocities are relative to the liquid.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
pub struct Measurement {
    /// Time since the stage began.
    pub time: f64,
    /// Kinetic energy of all disks.
    pub kinetic: f64,
    /// Elastic energy of all contacts.
    pub elastic: f64,
    /// xx, xy and yy of the kinetic stress, `sum m w w / area`. Pressure is positive.
    pub kinetic_stress: Vector,
    /// xx, xy and yy of the contact stress, `sum r f / area`.
    pub contact_stress: Vector,
    /// Mean speed.
    pub mean_speed: f64,
    /// Number of pairs in contact.
    pub contacts: f64,
    /// Power supplied by the flow.
    pub input: f64,
    /// Power dissipated by drag.
    pub drag: f64,
    /// Power dissipated by the contacts' damping.
    pub damping: f64,
}

impl Measurement {
    pub(super) fn of(time: f64, area: f64, count: usize, motion: &MotionSums, contact: &ContactSums) -> Self {
        let [kinetic, xx, xy, yy, speeds, drag, flow_work] = motion.terms;
        Self {
            time,
            kinetic,
            elastic: contact.spring,
            kinetic_stress: Vector::new(xx, xy, yy) / area,
            contact_stress: contact.virial / area,
            mean_speed: speeds / count as f64,
            contacts: contact.contacts,
            input: -flow_work - contact.image_work,
            drag,
            damping: contact.loss,
        }
    }

    /// xx, xy and yy of the total stress.
    pub fn stress(&self) -> Vector {
        self.kinetic_stress + self.contact_stress
    }

    /// Kinetic and elastic energy.
    pub fn energy(&self) -> f64 {
        self.kinetic + self.elastic
    }
}

/// Sums over time since the tally was started; a checkpoint has them in the order of the fields.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
pub struct DiskTally {
    /// Work done by the flow.
    pub input: f64,
    /// Work dissipated by drag.
    pub drag: f64,
    /// Work dissipated by the contacts' damping.
    pub damping: f64,
    /// Mean path length of a disk through the liquid.
    pub path: f64,
    /// Time integrals of xx, xy and yy of the stress.
    pub stress: Vector,
    /// Collisions that began: of two small disks, of a small and a large one, of two large ones.
    pub collisions: Vector,
    /// The measurement at the start.
    pub first: Measurement,
    /// The latest measurement.
    pub latest: Measurement,
}

impl DiskTally {
    /// A tally that starts at a measurement.
    pub(super) fn begin(first: Measurement) -> Self {
        Self { first, latest: first, ..Self::default() }
    }

    /// Adds the time up to a measurement, by the trapezoidal rule.
    pub(super) fn add(&mut self, now: Measurement) {
        let last = std::mem::replace(&mut self.latest, now);
        let half = 0.5 * (now.time - last.time);
        self.input += half * (last.input + now.input);
        self.drag += half * (last.drag + now.drag);
        self.damping += half * (last.damping + now.damping);
        self.path += half * (last.mean_speed + now.mean_speed);
        self.stress += (last.stress() + now.stress()) * half;
    }

    /// Time covered.
    pub fn time(&self) -> f64 {
        self.latest.time - self.first.time
    }

    /// Error of the energy balance, relative to the work of the flow and the energy at the start.
    pub fn imbalance(&self) -> f64 {
        let gained = self.latest.energy() - self.first.energy();
        (gained - self.input + self.drag + self.damping)
            / (self.input.abs() + self.first.energy()).max(f64::MIN_POSITIVE)
    }

    /// xx, xy and yy of the time-averaged stress.
    pub fn mean_stress(&self) -> Vector {
        self.stress / self.time()
    }

    /// Mean free path through the liquid between two collisions of one of `disks` disks.
    pub fn mean_free_path(&self, disks: usize) -> f64 {
        self.path * disks as f64 / (2.0 * self.collisions.element_sum())
    }
}
