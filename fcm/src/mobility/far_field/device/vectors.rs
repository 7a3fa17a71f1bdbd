//! Vectors in the memory of a device.

use super::succeeded;
use crate::conjugate_gradients::Linear;
use gpu::{DeviceList, SplitFarField};
use std::cell::RefCell;
use std::rc::Rc;

/// A far field that vectors share, in whose memory they are.
pub(super) type SharedField = Rc<RefCell<SplitFarField>>;

/// Memory of a vector, which is released with the last of those that share it.
struct ResidentMemory {
    field: SharedField,
    list: DeviceList,
}

impl Drop for ResidentMemory {
    fn drop(&mut self) {
        self.field.borrow_mut().release(&self.list);
    }
}

/// A vector in the memory of a device. A clone has memory of its own.
pub(super) struct ResidentVector {
    memory: Rc<ResidentMemory>,
    /// Place of its values.
    pub list: DeviceList,
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
        Self { memory: Rc::new(ResidentMemory { field: field.clone(), list }), list }
    }

    fn filled(self, values: &[f64]) -> Self {
        succeeded(self.memory.field.borrow_mut().fill(&self.list, values));
        self
    }

    /// Some of the values, in the same memory.
    pub fn part(&self, first: usize, count: usize) -> Self {
        Self { memory: Rc::clone(&self.memory), list: self.list.part(first, count) }
    }

    /// The same vector in the same memory.
    pub fn shared(&self) -> Self {
        self.part(0, self.count())
    }

    /// Number of values.
    pub fn count(&self) -> usize {
        self.list.count()
    }

    /// The values.
    pub fn values(&self) -> Vec<f64> {
        succeeded(self.memory.field.borrow_mut().values_of(&self.list))
    }

    /// `self = x_factor x + y_factor self`.
    pub fn combine(&mut self, factors: [f64; 2], x: &Self) {
        succeeded(self.memory.field.borrow_mut().combine(factors, &x.list, &self.list));
    }
}

impl Clone for ResidentVector {
    fn clone(&self) -> Self {
        let list = succeeded(self.memory.field.borrow_mut().list_like(&self.list));
        let mut copy = Self::at(&self.memory.field, list);
        copy.combine([1.0, 0.0], self);
        copy
    }
}

impl Linear for ResidentVector {
    fn add(&mut self, factor: f64, other: &Self) {
        self.combine([factor, 1.0], other);
    }

    fn scale_add(&mut self, factor: f64, other: &Self) {
        self.combine([1.0, factor], other);
    }
}
