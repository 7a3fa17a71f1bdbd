//! Random motions and loads of particles that move on a device.

use super::{DeviceFarField, succeeded};
use crate::lanczos::DrawDiagnostics;
use crate::mobility::coupled::{ChangeLimits, HeldLoads};
use crate::mobility::fluctuating::{
    ExactConditions, FluctuatingFarField, HeldDraw, HeldMotions, HeldSolution, LoadDraw, SolutionChange,
};
use crate::mobility::noise::NoiseRequest;
use crate::mobility::noise_root::factors_of_units;
use gpu::{CloseSpheres, NearTables, OverlapLimits, PairDraw};

impl FluctuatingFarField for DeviceFarField {
    fn draw_motions(&mut self, draw: &HeldDraw) -> (HeldMotions, DrawDiagnostics) {
        let &HeldDraw { particles, tolerance, stream, amplitude, carried } = draw;
        let drawn = self.draw_on_device(&NoiseRequest { ids: &particles.ids, tolerance, stream });
        let factors = factors_of_units(&self.units).map(|factor| factor * amplitude);
        self.kept.release_unused();
        let positions = particles.positions.remote_list().expect("particles that move on the device");
        let (lists, [ambient, velocities]) = self.kept.drawn(positions, carried, factors);
        succeeded(self.split.borrow_mut().store_drawn(&lists));
        (HeldMotions { ambient, velocities }, drawn)
    }

    fn draw_loads(&mut self, tables: &dyn Fn() -> NearTables, loads: &HeldLoads, draw: &LoadDraw) -> HeldLoads {
        self.copy_near_tables(tables);
        let &LoadDraw { ids, seed, amplitude, units } = draw;
        // That of loads and of the resistance of single spheres to random motions.
        let factor = amplitude * (units.length * units.viscosity).sqrt();
        let largest = loads.largest().max(factor.abs() * self.largest_resistance.sqrt());
        if !self.split.borrow().has_lubrication() {
            return HeldLoads::of(loads.list().cloned(), largest);
        }
        let given = loads.list().map(|list| self.kept.held(list));
        let draw = PairDraw { ids, places: None, seed, factor, given };
        let list = succeeded(self.split.borrow_mut().random_pair_loads(&draw));
        HeldLoads::of(Some(self.kept.keep(list)), largest)
    }

    fn exact_conditions(&mut self, found: &HeldSolution, loads: &HeldLoads) -> ExactConditions {
        self.exact_conditions_of(found, loads)
    }

    fn change_over(
        &mut self,
        found: &HeldSolution,
        exact: &ExactConditions,
        divisor: f64,
        limits: &ChangeLimits,
    ) -> SolutionChange {
        self.change_of_held(found, exact, divisor, limits)
    }

    fn close_spheres(&mut self, minimum_gap: Option<f64>) -> CloseSpheres {
        let (radii, length) = (&self.plan.radii, self.units.length);
        let contacts = radii.iter().flat_map(|own| radii.iter().map(move |other| (own + other) / length));
        let at_minimum_gap = |contact: f64| minimum_gap.map_or(0.0, |gap| contact + gap * 0.5 * contact);
        let limits = OverlapLimits(contacts.map(|contact| [contact, at_minimum_gap(contact)]).collect());
        let found = succeeded(self.split.borrow_mut().count_overlaps(&limits));
        CloseSpheres { depth: found.depth * length, ..found }
    }
}
