//! Residual of a known solution of near pairs and far field, and its change, see `gpu/kernels/coupled.h`.

use crate::assembly::MOMENTS;
use crate::coupled::{CoupledVectors, KnownInput, StartInput};
use crate::device::DeviceError;
use crate::far_field::{Orders, SplitFarField};
use crate::lists::DeviceList;
use crate::pair_rows::PairSet;
use crate::tables::NumberFormat;
use crate::task::{DeviceAddress, KernelTask};

/// Numbers of a particle in a motion, and in a motion with minus the stresslet.
const MOTION: usize = 6;
const CHANGED: usize = MOTION + MOMENTS;

impl SplitFarField {
    /// Unknowns and residual of motions and stresslets as they are, with the loads of near pairs in these motions,
    /// which are stored in the list of the start.
    pub fn start_at(
        &mut self,
        lists: [&DeviceList; 2],
        start: &StartInput,
        known: &KnownInput,
        orders: &Orders,
    ) -> Result<(), DeviceError> {
        self.launch_rows(PairSet::All, false, [&start.motions, &start.loads])?;
        self.start_coupled(lists, start, known, orders)
    }

    /// Makes the unknowns zero.
    pub fn clear_unknowns(&mut self, unknowns: &DeviceList) -> Result<(), DeviceError> {
        self.device.zero(unknowns.address, unknowns.count * unknowns.numbers.size())
    }

    /// Motions and rates of strain of a residual, and first moments of near pairs by motions: six, five and five
    /// numbers a particle.
    pub fn copy_residual(&mut self, residual: &DeviceList, motions: &DeviceList) -> Result<[Vec<f64>; 3], DeviceError> {
        let (count, moments) = (self.task.particles as usize, self.place_of_moments()?);
        self.launch_moments(motions, moments)?;
        let [rigid, strain] = [residual.address, residual.part(2 * MOTION * count, MOMENTS * count).address];
        let lists = [(rigid, MOTION * count), (strain, MOMENTS * count), (moments, MOMENTS * count)];
        self.download_lists(lists, NumberFormat::Double)
    }

    /// Solution after a change of the unknowns from a start, with the preconditioned residual as a last correction:
    /// motions, minus the stresslets, and first moments of near pairs by the motions, six, five and five numbers a
    /// particle.
    pub fn copy_changed(&mut self, at: &CoupledVectors, start: &StartInput) -> Result<[Vec<f64>; 3], DeviceError> {
        let count = self.task.particles as usize;
        let (changed, moments) = self.gather_changed(at, start)?;
        let of_far = changed.part(MOTION * count, MOMENTS * count).address;
        let lists = [(changed.address, MOTION * count), (of_far, MOMENTS * count), (moments, MOMENTS * count)];
        let found = self.download_lists(lists, NumberFormat::Double)?;
        self.release(&changed);
        Ok(found)
    }

    /// The lists of [`Self::copy_changed`] on the card: motions, then minus the stresslets, in one list; first moments
    /// in another.
    pub(crate) fn gather_changed(
        &mut self,
        at: &CoupledVectors,
        start: &StartInput,
    ) -> Result<(DeviceList, DeviceAddress), DeviceError> {
        let (count, moments) = (self.task.particles as usize, self.place_of_moments()?);
        let changed = self.wide_list(CHANGED * count)?;
        let [unknowns, preconditioned, image] = [at.unknowns, at.preconditioned, changed].map(|list| list.address);
        let [direction, list_x] = [start.motions, start.moments].map(|list| list.address);
        let task = KernelTask { list_x, unknowns, preconditioned, direction, image, ..self.task };
        self.launch_particles("gather_all_changed", &task)?;
        self.launch_moments(&changed, moments)?;
        Ok((changed, moments))
    }
}
