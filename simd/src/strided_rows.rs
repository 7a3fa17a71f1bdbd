//! Rows in memory at equal distances.

/// Rows in memory: the first value of the first row, and the distance in values from one row to the next.
#[derive(Debug, Clone, Copy)]
pub struct StridedRows<P> {
    /// Pointer to the first value.
    pub first: P,
    /// Distance from one row to the next.
    pub stride: usize,
}

impl<T> StridedRows<*mut T> {
    /// The rows from a column on.
    ///
    /// # Safety
    /// The rows have that column.
    #[inline(always)]
    #[must_use]
    pub unsafe fn from_column(self, column: usize) -> Self {
        // SAFETY: guaranteed by the caller.
        Self { first: unsafe { self.first.add(column) }, stride: self.stride }
    }

    /// The same rows to read.
    #[inline(always)]
    pub fn cast_const(self) -> StridedRows<*const T> {
        StridedRows { first: self.first.cast_const(), stride: self.stride }
    }
}
