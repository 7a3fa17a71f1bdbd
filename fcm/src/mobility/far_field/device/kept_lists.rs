//! Columns of solutions that stay in the memory of a device until they are read.

use super::vectors::SharedField;
use super::{by_rows, succeeded};
use crate::mobility::coupled::MovingFlow;
use crate::mobility::past_solutions::PastSolutions;
use domain::{ColumnValues, RemoteAdvance, RemoteDisplacement, RemoteFrame, RemoteHolder, RemoteList};
use gpu::{COLUMN_WIDTHS, COLUMNS, DeviceList, DisplacementInput, DrawnLists, MovingLists, PastLists};
use solver::BackgroundFlow;
use std::cell::RefCell;

/// Lists of numbers of particles in the memory of a device, in the order of ids.
pub(super) struct KeptLists {
    /// The far field, in whose memory they are.
    pub field: SharedField,
    lists: RefCell<Vec<(RemoteList, DeviceList)>>,
    /// Radii by class.
    pub radii: Vec<f64>,
    /// Unit of length of the far field.
    pub length: f64,
}

impl KeptLists {
    /// No lists, for particles with these radii by class, and for a unit of length of the far field.
    pub fn new(field: &SharedField, radii: &[f64], length: f64) -> Self {
        Self { field: field.clone(), lists: RefCell::default(), radii: radii.to_vec(), length }
    }

    /// Columns of a solution for some particles, whose values are undefined, and what stands for them.
    pub fn solution(&self, particles: usize) -> ([DeviceList; COLUMNS], [ColumnValues; COLUMNS]) {
        let lists = COLUMN_WIDTHS.map(|width| self.list(width * particles));
        (lists, lists.map(|list| ColumnValues::remote(self.keep(list))))
    }

    /// Velocities and angular velocities that a solution sets for particles that move at positions in a remote list, in
    /// a flow.
    pub fn moving(&self, positions: &RemoteList, flow: &MovingFlow) -> (MovingLists, [ColumnValues; 2]) {
        let positions = self.held(positions);
        let motions = [(); 2].map(|()| self.list(positions.count()));
        let MovingFlow { flow, carried } = flow;
        let (gradient, spin) = (by_rows(&carried.gradient()), flow.angular_velocity().to_array());
        let lists = MovingLists { positions, motions, gradient, spin };
        (lists, motions.map(|list| ColumnValues::remote(self.keep(list))))
    }

    /// Lists for random motions of particles that move at positions in a remote list, with factors of velocities and of
    /// gradients; and what stands for the motions and for velocities with those of a flow.
    pub fn drawn(
        &self,
        positions: &RemoteList,
        carried: &BackgroundFlow,
        factors: [f64; 2],
    ) -> (DrawnLists, [ColumnValues; 2]) {
        let positions = self.held(positions);
        let [ambient, velocities] = [11, 3].map(|numbers| self.list(numbers * positions.count() / 3));
        let gradient = by_rows(&carried.gradient());
        let lists = DrawnLists { ambient, velocities, positions, factors, gradient };
        (lists, [ambient, velocities].map(|list| ColumnValues::remote(self.keep(list))))
    }

    /// A list of this many values, which are undefined.
    pub fn list(&self, count: usize) -> DeviceList {
        succeeded(self.field.borrow_mut().wide_list(count))
    }

    /// The list that something stands for.
    pub fn held(&self, remote: &RemoteList) -> DeviceList {
        self.find(remote).expect("a list is kept as long as something stands for it")
    }

    /// Keeps a list as long as something stands for it.
    pub fn keep(&self, list: DeviceList) -> RemoteList {
        let remote = RemoteList::new();
        self.lists.borrow_mut().push((remote.clone(), list));
        remote
    }

    /// The list that something stands for, if it is one of these.
    pub fn find(&self, remote: &RemoteList) -> Option<DeviceList> {
        self.lists.borrow().iter().find(|(kept, _)| kept == remote).map(|(_, list)| *list)
    }

    /// Lists of past solutions, which are copied to the device if they are not there, by the places of rows in the
    /// order of ids. Copies are kept until unused lists are released.
    pub fn of(&self, past: &PastSolutions, places: &[u32]) -> PastLists {
        let mut copies: Vec<(&ColumnValues, DeviceList)> = Vec::new();
        let lists = past.columns.each_ref().map(|column| {
            let is_known = column[0].remote_list().is_some() || !column[0].is_empty();
            is_known.then(|| {
                column.each_ref().map(|values| {
                    let is_copied = |copied: &&ColumnValues| copied.shares_memory_with(values);
                    let copy = copies.iter().find(|(copied, _)| is_copied(copied)).map(|&(_, list)| list);
                    let known = values.remote_list().and_then(|remote| self.find(remote)).or(copy);
                    known.unwrap_or_else(|| {
                        let list = self.copied(values, places);
                        copies.push((values, list));
                        list
                    })
                })
            })
        });
        let &PastSolutions { line, parabola, blend, .. } = past;
        PastLists { lists, line, parabola, blend }
    }

    /// A copy of a list whose rows have some places.
    fn copied(&self, values: &[f64], places: &[u32]) -> DeviceList {
        let width = values.len() / places.len().max(1);
        let mut by_place = vec![0.0; values.len()];
        for (row, &place) in values.chunks_exact(width.max(1)).zip(places) {
            by_place[width * place as usize..][..width].copy_from_slice(row);
        }
        let list = self.list(values.len());
        succeeded(self.field.borrow_mut().fill(&list, &by_place));
        self.keep(list);
        list
    }

    /// Releases the lists that nothing refers to.
    pub fn release_unused(&self) {
        self.lists.borrow_mut().retain(|(remote, list)| {
            if remote.is_alone() {
                self.field.borrow_mut().release(list);
            }
            !remote.is_alone()
        });
    }
}

impl RemoteHolder for KeptLists {
    fn copies(&self, lists: &[&RemoteList]) -> Vec<Vec<f64>> {
        let of = |remote: &&RemoteList| {
            let list = self.held(remote);
            succeeded(self.field.borrow_mut().values_of(&list))
        };
        lists.iter().map(of).collect()
    }

    fn hold(&self, values: &[f64]) -> RemoteList {
        let list = self.list(values.len());
        succeeded(self.field.borrow_mut().fill(&list, values));
        self.keep(list)
    }

    fn advance(&self, displaced: &RemoteDisplacement) -> Option<RemoteAdvance> {
        let &RemoteDisplacement { positions, steps, terms, velocities, frame } = displaced;
        let RemoteFrame { cell, gradient, deformation, renaming, farthest } = frame;
        self.release_unused();
        let moved = |remote: &RemoteList| {
            let before = self.held(remote);
            [before, self.list(before.count())]
        };
        let places = [positions, steps].map(moved);
        let velocities: Vec<_> = velocities.iter().map(moved).collect();
        let all_somewhere = succeeded(self.field.borrow_mut().displace(&DisplacementInput {
            places,
            terms: terms.iter().map(|(remote, weight)| (self.held(remote), *weight)).collect(),
            velocities: velocities.clone(),
            edges: cell.edges().to_array(),
            strain: cell.strain(),
            tilts: cell.tilts(),
            axes: cell.axes().map(by_rows),
            gradient: by_rows(&gradient),
            deformation: by_rows(&deformation),
            renaming,
            farthest,
        }));
        let [positions, steps] = places.map(|[_, after]| self.keep(after));
        let velocities = velocities.iter().map(|&[_, after]| self.keep(after)).collect();
        all_somewhere.then_some(RemoteAdvance { positions, steps, velocities })
    }
}
