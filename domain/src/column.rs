//! Columns of a particle store: named properties, whose numbers copies share until one of them changes.

use crate::parallel::copied;
use std::ops::{Deref, DerefMut};
use std::sync::Arc;

/// A named property of every particle: `width` numbers each, row by row. Everything that has to follow a particle to
/// another rank or survive a restart, such as its past velocities, is a column.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Name in checkpoints.
    pub name: String,
    /// Numbers per particle.
    pub width: usize,
    /// `width` numbers for each particle, in the store's order.
    pub values: ColumnValues,
}

/// A column whose length does not fit the number of particles.
#[derive(Debug, thiserror::Error, PartialEq)]
#[error("particle column '{name}' has {found} values for {particles} particles; it needs {width} each")]
pub struct ColumnError {
    /// Name of the column.
    pub name: String,
    /// Values found.
    pub found: usize,
    /// Values needed per particle.
    pub width: usize,
    /// Number of particles.
    pub particles: usize,
}

/// Numbers of a column: a list of which copies share the memory until one of them is changed.
///
/// ```
/// let first = domain::ColumnValues::from(vec![1.0, 2.0]);
/// let mut second = first.clone();
/// assert!(first.shares_memory_with(&second));
/// second[0] = 3.0;
/// assert_eq!((&first[..], &second[..]), (&[1.0, 2.0][..], &[3.0, 2.0][..]));
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ColumnValues(Arc<Vec<f64>>);

impl ColumnValues {
    /// Whether two lists are one in memory.
    pub fn shares_memory_with(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    /// The list.
    pub fn into_vec(self) -> Vec<f64> {
        Arc::try_unwrap(self.0).unwrap_or_else(|shared| copied(&shared))
    }
}

impl From<Vec<f64>> for ColumnValues {
    fn from(values: Vec<f64>) -> Self {
        Self(Arc::new(values))
    }
}

impl FromIterator<f64> for ColumnValues {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        Vec::from_iter(values).into()
    }
}

impl IntoIterator for ColumnValues {
    type Item = f64;
    type IntoIter = std::vec::IntoIter<f64>;

    fn into_iter(self) -> Self::IntoIter {
        self.into_vec().into_iter()
    }
}

impl Deref for ColumnValues {
    type Target = Vec<f64>;

    fn deref(&self) -> &Vec<f64> {
        &self.0
    }
}

impl DerefMut for ColumnValues {
    fn deref_mut(&mut self) -> &mut Vec<f64> {
        if Arc::get_mut(&mut self.0).is_none() {
            self.0 = Arc::new(copied(&self.0));
        }
        Arc::get_mut(&mut self.0).expect("a list of one owner")
    }
}
