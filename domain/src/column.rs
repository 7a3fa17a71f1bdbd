//! Columns of a particle store: named properties, whose numbers copies share until one of them changes.

use crate::parallel::{FusedLoops, copied};
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

/// Values of particles: a list of which copies share the memory until one of them is changed.
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
/// [`crate::Particles::fetch`] has brought a copy; values that are changed here are no longer those of the remote list.
#[derive(Debug, Clone)]
pub struct ParticleValues<T>(Arc<Stored<T>>);

/// Numbers of a column.
pub type ColumnValues = ParticleValues<f64>;

/// A list, of which at least one of both is there.
#[derive(Debug, Clone)]
struct Stored<T> {
    here: OnceLock<Vec<T>>,
    remote: Option<RemoteList>,
}

impl<T> ParticleValues<T> {
    /// A list that is elsewhere.
    pub fn remote(list: RemoteList) -> Self {
        Self(Arc::new(Stored { here: OnceLock::new(), remote: Some(list) }))
    }

    /// The list elsewhere with the same values, if there is one.
    pub fn remote_list(&self) -> Option<&RemoteList> {
        self.0.remote.as_ref()
    }

    /// Whether the values are here.
    pub fn is_here(&self) -> bool {
        self.0.here.get().is_some()
    }

    /// The values, if they are here.
    pub(crate) fn here(&self) -> Option<&[T]> {
        self.0.here.get().map(Vec::as_slice)
    }

    /// Keeps a copy of the values of a remote list here, unless there is one.
    pub fn receive(&self, values: Vec<T>) {
        _ = self.0.here.set(values);
    }

    /// The same values, which are in a remote list as well.
    #[must_use]
    pub fn held_as(self, list: RemoteList) -> Self
    where
        T: Copy + Send + Sync,
    {
        Self(Arc::new(Stored { here: self.into_vec().into(), remote: Some(list) }))
    }

    /// The values in another order of the rows; those of a remote list are in the order of ids in any case.
    pub(crate) fn rearranged(&self, of: impl FnOnce(&[T]) -> Vec<T>) -> Self {
        let here = self.0.here.get().map_or_else(OnceLock::new, |values| of(values).into());
        Self(Arc::new(Stored { here, remote: self.0.remote.clone() }))
    }

    /// Whether two lists are one in memory.
    pub fn shares_memory_with(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl<T: Copy + Send + Sync> ParticleValues<T> {
    /// Makes the values of some rows of a list, as one of several loops; those of a remote list are in the order of ids
    /// in any case.
    pub(crate) fn arrange_in<'a>(&'a mut self, loops: &mut FusedLoops<'a>, from: &'a Self, order: &'a [usize]) {
        *self = from.rearranged(|_| Vec::new());
        let stored = Arc::get_mut(&mut self.0).expect("a list of one owner");
        if let (Some(arranged), Some(values)) = (stored.here.get_mut(), from.here()) {
            loops.mapped(arranged, order, |&row| values[row]);
        }
    }

    /// The values here, which are no longer those of a remote list.
    #[must_use]
    pub fn detached(self) -> Self {
        if self.remote_list().is_some() { self.into_vec().into() } else { self }
    }

    /// The list.
    pub fn into_vec(self) -> Vec<T> {
        match Arc::try_unwrap(self.0) {
            Ok(stored) => stored.here.into_inner().expect(MISSING),
            Err(shared) => copied(shared.here.get().expect(MISSING)),
        }
    }
}

/// Message of a panic, which would be a mistake in the program.
const MISSING: &str = "the values of a remote list are fetched before they are read";

impl<T> Default for ParticleValues<T> {
    fn default() -> Self {
        Vec::new().into()
    }
}

impl<T: PartialEq> PartialEq for ParticleValues<T> {
    fn eq(&self, other: &Self) -> bool {
        self.shares_memory_with(other) || **self == **other
    }
}

impl<T> From<Vec<T>> for ParticleValues<T> {
    fn from(values: Vec<T>) -> Self {
        Self(Arc::new(Stored { here: values.into(), remote: None }))
    }
}

impl<T> FromIterator<T> for ParticleValues<T> {
    fn from_iter<I: IntoIterator<Item = T>>(values: I) -> Self {
        Vec::from_iter(values).into()
    }
}

impl<T: Copy + Send + Sync> IntoIterator for ParticleValues<T> {
    type Item = T;
    type IntoIter = std::vec::IntoIter<T>;

    fn into_iter(self) -> Self::IntoIter {
        self.into_vec().into_iter()
    }
}

impl<'a, T> IntoIterator for &'a ParticleValues<T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl<'a, T: Copy + Send + Sync> IntoIterator for &'a mut ParticleValues<T> {
    type Item = &'a mut T;
    type IntoIter = std::slice::IterMut<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter_mut()
    }
}

impl<T> Deref for ParticleValues<T> {
    type Target = Vec<T>;

    fn deref(&self) -> &Vec<T> {
        self.0.here.get().expect(MISSING)
    }
}

impl<T: Copy + Send + Sync> DerefMut for ParticleValues<T> {
    fn deref_mut(&mut self) -> &mut Vec<T> {
        if Arc::get_mut(&mut self.0).is_none_or(|stored| stored.remote.is_some()) {
            *self = copied(self).into();
        }
        Arc::get_mut(&mut self.0).and_then(|stored| stored.here.get_mut()).expect("a list of one owner")
    }
}
