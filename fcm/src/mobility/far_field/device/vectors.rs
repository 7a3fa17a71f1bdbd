//! Vectors in the memory of a device.

use super::succeeded;
use gpu::{DeviceList, SplitFarField};
use std::cell::RefCell;
use std::rc::Rc;

/// A far field that vectors share, in whose memory they are.
pub(super) type SharedField = Rc<RefCell<SplitFarField>>;

/// A vector in the memory of a device, which is released with it.
pub(super) struct ResidentVector {
    field: SharedField,
    /// Place of its values.
    pub list: DeviceList,
}

impl Drop for ResidentVector {
    fn drop(&mut self) {
        self.field.borrow_mut().release(&self.list);
    }
}

impl ResidentVector {
    /// Values in the precision of the grid that are undefined.
    pub fn new(field: &SharedField, count: usize) -> Self {
        let list = succeeded(field.borrow_mut().list(count));
        Self::at(field, list)
    }

    /// Values in `f64` that are undefined.
    pub fn wide(field: &SharedField, count: usize) -> Self {
        let list = succeeded(field.borrow_mut().wide_list(count));
        Self::at(field, list)
    }

    /// These values in the precision of the grid.
    pub fn of(field: &SharedField, values: &[f64]) -> Self {
        Self::new(field, values.len()).filled(values)
    }

    /// These values in `f64`.
    pub fn wide_of(field: &SharedField, values: &[f64]) -> Self {
        Self::wide(field, values.len()).filled(values)
    }

    fn at(field: &SharedField, list: DeviceList) -> Self {
        Self { field: field.clone(), list }
    }

    fn filled(self, values: &[f64]) -> Self {
        succeeded(self.field.borrow_mut().fill(&self.list, values));
        self
    }

    /// Number of values.
    pub fn count(&self) -> usize {
        self.list.count()
    }

    /// The values.
    pub fn values(&self) -> Vec<f64> {
        succeeded(self.field.borrow_mut().values_of(&self.list))
    }
}
