//! Columns of a particle store: named properties, whose numbers copies share until one of them changes.

use crate::parallel::copied;
use crate::remote_list::RemoteList;
use std::ops::{Deref, DerefMut};
use std::sync::{Arc, OnceLock};

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
///
/// The list may be where it was computed, as a [`RemoteList`]. It is read as any other once
/// [`crate::Particles::fetch`] has brought a copy; numbers that are changed here are no longer those of the remote
/// list.
#[derive(Debug, Clone)]
pub struct ColumnValues(Arc<Stored>);

/// A list, of which at least one of both is there.
#[derive(Debug, Clone, Default)]
struct Stored {
    here: OnceLock<Vec<f64>>,
    remote: Option<RemoteList>,
}

impl ColumnValues {
    /// A list that is elsewhere.
    pub fn remote(list: RemoteList) -> Self {
        Self(Arc::new(Stored { here: OnceLock::new(), remote: Some(list) }))
    }

    /// The list elsewhere with the same numbers, if there is one.
    pub fn remote_list(&self) -> Option<&RemoteList> {
        self.0.remote.as_ref()
    }

    /// Whether the numbers are here.
    pub fn is_here(&self) -> bool {
        self.0.here.get().is_some()
    }

    /// Keeps a copy of the numbers of a remote list here, unless there is one.
    pub fn receive(&self, values: Vec<f64>) {
        _ = self.0.here.set(values);
    }

    /// The numbers in another order of the rows; those of a remote list are in the order of ids in any case.
    pub(crate) fn rearranged(&self, of: impl FnOnce(&[f64]) -> Vec<f64>) -> Self {
        let here = self.0.here.get().map(|values| of(values).into()).unwrap_or_default();
        Self(Arc::new(Stored { here, remote: self.0.remote.clone() }))
    }

    /// Whether two lists are one in memory.
    pub fn shares_memory_with(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    /// The list.
    pub fn into_vec(self) -> Vec<f64> {
        match Arc::try_unwrap(self.0) {
            Ok(stored) => stored.here.into_inner().expect(MISSING),
            Err(shared) => copied(shared.here.get().expect(MISSING)),
        }
    }
}

/// Message of a panic, which would be a mistake in the program.
const MISSING: &str = "the numbers of a remote list are fetched before they are read";

impl Default for ColumnValues {
    fn default() -> Self {
        Vec::new().into()
    }
}

impl PartialEq for ColumnValues {
    fn eq(&self, other: &Self) -> bool {
        self.shares_memory_with(other) || **self == **other
    }
}

impl From<Vec<f64>> for ColumnValues {
    fn from(values: Vec<f64>) -> Self {
        Self(Arc::new(Stored { here: values.into(), remote: None }))
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
        self.0.here.get().expect(MISSING)
    }
}

impl DerefMut for ColumnValues {
    fn deref_mut(&mut self) -> &mut Vec<f64> {
        if Arc::get_mut(&mut self.0).is_none_or(|stored| stored.remote.is_some()) {
            *self = copied(self).into();
        }
        Arc::get_mut(&mut self.0).and_then(|stored| stored.here.get_mut()).expect("a list of one owner")
    }
}
