//! Arrangement of particles on a device.

use super::DeviceFarField;
use super::images::PlacedClasses;
use super::present::{self, RankPeers};
use super::succeeded;
use super::tables::GridFrame;
use domain::parallel::{equal, mapped};
use domain::{Particles, PeriodicBox, remote_columns};
use gpu::{DeviceList, MovedParticles, PlacedParticles};
use std::rc::Rc;

impl DeviceFarField {
    /// Sets the box and the particles. Collective.
    pub(super) fn arrange_in(&mut self, cell: &PeriodicBox, particles: &Particles) {
        let own = cell.scaled(1.0 / self.units.length);
        let frame = self.tables.frame(&own);
        if self.arranged != Some(frame.lattice) {
            succeeded(self.split.borrow_mut().set_box(&self.tables.in_box(&frame.lattice)));
            self.arranged = Some(frame.lattice);
        }
        if self.particles.ids != particles.ids {
            self.places = remote_columns::places_by_id(&particles.ids);
            succeeded(self.split.borrow_mut().set_places(&self.places));
        }
        match self.moved_places(particles) {
            Some(places) => self.arrange_moved(particles, places),
            None => self.arrange_present(&frame, &own, particles),
        }
        (self.cell, self.particles) = (*cell, particles.without_columns());
        if let Some((_, is_arranged)) = &mut self.host {
            *is_arranged = false;
        }
        self.work.searches += 1;
        self.note_seconds();
    }

    /// Whether particles are arranged already as they are now. Positions that are here and on the device as well are
    /// those of the device, whose fractions of the edges are rounded there.
    pub(super) fn are_arranged(&self, particles: &Particles) -> bool {
        let Particles { positions, radii, .. } = &self.particles;
        if radii.len() != particles.len() {
            return false;
        }
        let are_here = || [&self.particles, particles].iter().all(|known| self.moved_places(known).is_none());
        let is_same =
            positions.shares_memory_with(&particles.positions) || are_here() && equal(positions, &particles.positions);
        is_same && equal(radii, &particles.radii)
    }

    /// Positions and lattice steps of particles that move on the device.
    fn moved_places(&self, particles: &Particles) -> Option<[DeviceList; 2]> {
        let (positions, steps) = (particles.positions.remote_list()?, particles.steps.remote_list()?);
        Some([self.kept.find(positions)?, self.kept.find(steps)?])
    }

    /// Arranges particles whose positions are here, and those of other ranks near them, in a frame of a box in internal
    /// units. Collective.
    fn arrange_present(&mut self, frame: &GridFrame, own: &PeriodicBox, particles: &Particles) {
        let inverse = 1.0 / self.units.length;
        let mut positions = mapped(&particles.positions, |&x| x * inverse);
        let mut classes = mapped(&particles.radii, |&a| self.plan.class_of(a));
        let halo = Rc::new(present::halo(&self.plan, &self.units, &self.partition, own, &positions));
        halo.extend(&mut positions);
        halo.extend(&mut classes);
        if !halo.is_alone() {
            let peers = RankPeers { comm: self.partition.comm().clone(), halo: Rc::clone(&halo) };
            self.split.borrow_mut().set_peers(Rc::new(peers));
        }
        let fractions = frame.all_fractions(&positions);
        let placed = PlacedParticles { fractions: fractions.as_flattened(), classes: &classes, owned: halo.owned() };
        succeeded(self.split.borrow_mut().arrange(&placed));
        if let Some(images) = &mut self.images {
            let present =
                PlacedClasses { ids: &halo.extended(&particles.ids), positions: &positions, classes: &classes };
            succeeded(self.split.borrow_mut().set_images(&images.of(own, present, halo.owned())));
        }
        self.halo = halo;
    }

    /// Arranges particles that have moved on the device.
    fn arrange_moved(&mut self, particles: &Particles, [positions, steps]: [DeviceList; 2]) {
        let Particles { ids, radii, .. } = &self.particles;
        let are_known = self.arranged.is_some() && equal(ids, &particles.ids) && equal(radii, &particles.radii);
        let classes = (!are_known).then(|| mapped(&particles.radii, |&a| self.plan.class_of(a)));
        let moved = MovedParticles { positions, steps, classes: classes.as_deref(), length: self.units.length };
        succeeded(self.split.borrow_mut().arrange_moved(&moved));
    }
}
