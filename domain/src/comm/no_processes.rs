//! Replacement for the processes of MPI in a program built without it.

use super::window::Segment;
use super::{Comm, CommError, Incoming, Job, Launcher, Outgoing};
use bytemuck::Pod;
use std::ops::Range;
use std::sync::Arc;

/// No value of this type exists.
#[derive(Clone)]
pub(super) enum ProcessRank {}

impl ProcessRank {
    pub(super) fn world(launcher: &Launcher) -> Result<Self, CommError> {
        let Job::Of(found) = launcher.job else { return Err(CommError::BuiltWithout { found: None }) };
        Err(CommError::BuiltWithout { found: Some(found) })
    }

    pub(super) fn rank(&self) -> usize {
        match *self {}
    }

    pub(super) fn size(&self) -> usize {
        match *self {}
    }

    pub(super) fn split(&self, _colour: usize) -> Self {
        match *self {}
    }

    pub(super) fn barrier(&self) {
        match *self {}
    }

    pub(super) fn on_this_machine(&self) -> Self {
        match *self {}
    }

    pub(super) fn share(&self, _bytes: usize, _machine: &Comm) -> Option<Vec<Arc<Segment>>> {
        match *self {}
    }

    pub(super) fn all_to_all<T: Pod>(&self, _send: (&[T], &[Range<usize>]), _receive: (&mut [T], &[Range<usize>])) {
        match *self {}
    }

    pub(super) fn exchange<T: Pod>(&self, _send: &[Vec<T>]) -> Vec<Vec<T>> {
        match *self {}
    }

    pub(super) fn send_receive<T: Pod>(&self, _send: Outgoing<T>, _receive: Incoming<T>) {
        match *self {}
    }

    pub(super) fn all_gather_equal<T: Pod>(&self, _values: &[T]) -> Vec<T> {
        match *self {}
    }

    pub(super) fn all_gather<T: Pod>(&self, _values: &[T], _counts: &[usize]) -> Vec<T> {
        match *self {}
    }

    pub(super) fn gather<T: Pod>(&self, _values: &[T], _counts: &[usize]) -> Vec<T> {
        match *self {}
    }

    pub(super) fn broadcast<T: Pod>(&self, _values: &mut [T]) {
        match *self {}
    }

    pub(super) fn any(&self, _yes: bool) -> bool {
        match *self {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A launcher announces several processes to a program that was built for a single one.
    #[test]
    fn ranks_without_mpi_are_refused() {
        let refused = |job| {
            let mut launcher = Launcher::of_this_process();
            launcher.job = job;
            ProcessRank::world(&launcher).map(|_| ()).unwrap_err().to_string()
        };
        let message = refused(Job::Of(2));
        assert!(message.starts_with("a launcher started 2 processes, but this program was built without"), "{message}");
        assert!(refused(Job::Unknown).starts_with("a launcher started several processes, but"));
    }
}
