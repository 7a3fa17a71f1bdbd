//! Contacts and springs of particles that move on a device.

use super::{DeviceFarField, by_rows, succeeded};
use crate::mobility::contacts::{ContactFarField, TouchingParticles};
use crate::mobility::coupled::{HeldLoads, MovingFlow, PredictedVelocities};
use domain::{ColumnValues, RemoteList};
use gpu::{CONTACT_NUMBERS, ContactInput, ContactLoads, DeviceList, PredictedMotion};

impl ContactFarField for DeviceFarField {
    fn loads(&mut self, touching: &TouchingParticles, steady: Option<&HeldLoads>) -> Result<HeldLoads, usize> {
        self.kept.release_unused();
        let radii = self.radii_in(touching);
        let input = self.contact_input(touching, &radii);
        let steady = steady.and_then(HeldLoads::list).map(|list| self.kept.held(list));
        let found = succeeded(self.split.borrow_mut().contact_loads(&input, steady));
        let ContactLoads { list, largest, crowded } = found;
        let loads = HeldLoads::of(Some(self.kept.keep(list)), largest);
        crowded.map_or(Ok(loads), Err)
    }

    fn ends(&mut self, touching: &TouchingParticles, motions: [&RemoteList; 2]) -> ColumnValues {
        let radii = self.radii_in(touching);
        let input = self.contact_input(touching, &radii);
        let motions = motions.map(|list| self.kept.held(list));
        let found = self.kept.list(CONTACT_NUMBERS * touching.slots * self.particles.len());
        succeeded(self.split.borrow_mut().contact_ends(&input, motions, &found));
        ColumnValues::remote(self.kept.keep(found))
    }
}

impl DeviceFarField {
    /// Radii by class in the units of a law.
    fn radii_in(&self, touching: &TouchingParticles) -> Vec<f64> {
        self.plan.radii.iter().map(|radius| radius / touching.units.length).collect()
    }

    /// Positions of the arranged particles.
    fn positions(&self) -> DeviceList {
        self.kept.held(self.particles.positions.remote_list().expect("particles that move on the device"))
    }

    fn contact_input<'a>(&'a self, touching: &TouchingParticles, radii: &'a [f64]) -> ContactInput<'a> {
        let &TouchingParticles { units, law, is_hertz, slots, times, flow: MovingFlow { flow, carried }, .. } =
            touching;
        let held = |list: &RemoteList| self.kept.held(list);
        ContactInput {
            law,
            is_hertz,
            radii,
            slots,
            times: times.map(|time| time * units.rate()),
            ids: &self.particles.ids,
            positions: self.positions(),
            expected: touching.expected.map(held),
            history: touching.history.map(held),
            previous: touching.previous.map(|lists| lists.map(held)),
            gradient: by_rows(&flow.gradient()),
            carried: by_rows(&carried.gradient()),
            factors: [units.velocity(), units.rate()].map(f64::recip),
        }
    }

    /// Predicted motions of the arranged particles, as the kernels take them.
    pub(super) fn predicted(&self, predicted: &PredictedVelocities) -> PredictedMotion {
        let &PredictedVelocities { velocities, carried, time, units } = predicted;
        PredictedMotion {
            positions: self.positions(),
            velocities: self.kept.held(velocities),
            gradient: by_rows(&carried.gradient()),
            factor: 1.0 / units.velocity(),
            time: time * units.rate(),
        }
    }
}
