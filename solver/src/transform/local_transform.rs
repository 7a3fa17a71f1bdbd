//! Transforms local to a rank: planes along x and y, and columns along z.

use super::transposition::{Packing, WholeColumns};
use crate::fourier::{AnyLength, Direction, RowPlan, StridedPointer};
use crate::layout::Layout;
use crate::memory::AlignedMemory;
use crate::shared::Shared;
use crate::{Real, Stokes};
use domain::parallel::MeasuredLoop;
use rayon::prelude::*;
use simd::StridedRows;
use std::sync::{Mutex, PoisonError};

/// Operation on a plane.
pub(super) enum PlaneTask<'a, T> {
    /// Transform its rows.
    X,
    /// Transform its columns.
    Y,
    /// Copy its rows to their destinations.
    Pack(&'a Packing<T>),
    /// Copy its rows back from their destinations.
    Unpack(&'a Packing<T>),
}

/// One rank's layout, the plans of its three directions, and work space for each thread.
pub(super) struct LocalTransform<T> {
    layout: Layout,
    rows: RowPlan<T>,
    along_y: AnyLength<T>,
    along_z: AnyLength<T>,
    room: usize,
    workspaces: Vec<Mutex<AlignedMemory<T>>>,
}

impl<T: Real> LocalTransform<T> {
    /// Plans each direction with `plan`.
    pub fn new(layout: Layout, plan: fn(usize) -> AnyLength<T>) -> Self {
        let [nx, ny, nz] = layout.points;
        let rows = RowPlan::new(plan(nx / 2), layout.halo);
        let [along_y, along_z] = [ny, nz].map(plan);
        let room = rows.room().max(along_y.room()).max(along_z.room());
        let workspace =
            || Mutex::new(AlignedMemory::zero((2 + layout.components) * room + T::LANES * layout.physical.y));
        let workspaces = (0..rayon::current_num_threads()).map(|_| workspace()).collect();
        Self { layout, rows, along_y, along_z, room, workspaces }
    }

    /// Bytes of the work space.
    #[cfg(test)]
    pub fn bytes(&self) -> usize {
        let bytes =
            |workspace: &Mutex<AlignedMemory<T>>| size_of_val(workspace.lock().expect("no thread works").values());
        self.workspaces.iter().map(bytes).sum()
    }

    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Calls `work` with the thread's work space: two buffers, a panel of all components, and a batch of rows.
    fn with_workspace(&self, work: impl FnOnce([*mut T; 2], *mut T, &mut [T])) {
        let workspace = rayon::current_thread_index().unwrap_or(0) % self.workspaces.len();
        let mut memory = self.workspaces[workspace].lock().unwrap_or_else(PoisonError::into_inner);
        let (first, rest) = memory.values_mut().split_at_mut(self.room);
        let (second, rest) = rest.split_at_mut(self.room);
        let (panel, batch) = rest.split_at_mut(self.layout.components * self.room);
        work([first.as_mut_ptr(), second.as_mut_ptr()], panel.as_mut_ptr(), batch);
    }

    /// Numbers of rows along y and along z.
    pub fn all_lines(&self) -> [usize; 2] {
        let [_, ny, nz] = self.layout.points;
        [ny, nz]
    }

    /// Performs the tasks on every plane of this rank, one after the other while the plane is in the cache; only the
    /// first `occupied` rows along y and z are transformed.
    pub fn planes(&self, memory: &Shared<T>, direction: Direction, occupied: [usize; 2], tasks: &[PlaneTask<T>]) {
        let [lines, planes] = self.layout.rows.clone();
        let rows = occupied[0].clamp(lines.start, lines.end) - lines.start;
        let is_occupied = |z: usize| planes.start + z < occupied[1];
        let (components, planes) = (self.layout.components, planes.len());
        let bytes = 2 * components * planes * self.layout.physical.z * size_of::<T>();
        (0..components * planes).into_par_iter().moving(bytes).for_each(|i| {
            let (component, z) = (i / planes, i % planes);
            for task in tasks {
                match task {
                    PlaneTask::X | PlaneTask::Y if !is_occupied(z) => {}
                    PlaneTask::X => self.plane_rows(memory, direction, self.layout.physical.at(component, 0, z), rows),
                    PlaneTask::Y => self.plane_columns(memory, direction, self.layout.transposed.at(component, 0, z)),
                    // SAFETY: a plane belongs to one thread, and the packing is that of this field's transform.
                    PlaneTask::Pack(packing) => unsafe { packing.pack(memory, [component, z]) },
                    PlaneTask::Unpack(packing) => unsafe { packing.unpack(memory, [component, z]) },
                }
            }
        });
    }

    /// Transforms the first rows of a plane, as many at once as there are lanes.
    fn plane_rows(&self, memory: &Shared<T>, direction: Direction, plane: usize, rows: usize) {
        let stride = self.layout.physical.y;
        self.with_workspace(|[first, second], values, batch| {
            for row in (0..rows).step_by(T::LANES) {
                // SAFETY: a plane belongs to one thread, and the rows lie inside it.
                unsafe {
                    let place = memory.at(plane + row * stride);
                    if row + T::LANES <= rows {
                        let rows = StridedRows { first: place, stride };
                        self.rows.run(direction, rows, [values, first, second]);
                        continue;
                    }
                    let last = std::slice::from_raw_parts_mut(place, (rows - row) * stride);
                    batch[..last.len()].copy_from_slice(last);
                    batch[last.len()..].fill(T::default());
                    self.rows.run(
                        direction,
                        StridedRows { first: batch.as_mut_ptr(), stride },
                        [values, first, second],
                    );
                    last.copy_from_slice(&batch[..last.len()]);
                }
            }
        });
    }

    /// Transforms the columns of a plane, block by block.
    fn plane_columns(&self, memory: &Shared<T>, direction: Direction, plane: usize) {
        let stride = self.layout.transposed.y;
        self.with_workspace(|buffers, _, _| {
            for block in 0..self.layout.blocks.len() {
                // SAFETY: a plane belongs to one thread, and the blocks lie inside it.
                unsafe {
                    let columns = StridedPointer { first: memory.at(plane + block * 2 * T::LANES), stride };
                    self.along_y.run(direction, columns, columns, buffers);
                }
            }
        });
    }

    /// Transforms columns along z.
    pub fn pencils<const C: usize>(&self, whole: &WholeColumns<T>, direction: Direction) {
        self.each_panel::<C>(whole, |components, _| {
            self.with_workspace(|buffers, _, _| {
                for columns in components {
                    // SAFETY: the panel belongs to one thread.
                    unsafe { self.along_z.run(direction, columns, columns, buffers) };
                }
            });
        });
    }

    /// Transforms columns along z, multiplies them by the operator, and transforms them back.
    pub fn pencils_through<const C: usize>(&self, whole: &WholeColumns<T>, operator: &Stokes<T, C>) {
        let stride = 2 * T::LANES;
        self.each_panel::<C>(whole, |components, [block, mode]| {
            self.with_workspace(|buffers, panel, _| {
                // SAFETY: the panel belongs to one thread, and the work space has room for its components.
                unsafe {
                    let work: [_; C] =
                        std::array::from_fn(|c| StridedPointer { first: panel.add(c * self.room), stride });
                    // Only a vector field has a channel.
                    let channel = operator.channel().zip(<[_; 3]>::try_from(&components[..]).ok());
                    let added = channel.and_then(|(channel, all)| channel.amplitudes([block, mode], all));
                    for (columns, work) in components.into_iter().zip(work) {
                        self.along_z.run(Direction::Forward, columns, work, buffers);
                    }
                    operator.multiply([block, mode], work.map(|w| w.first));
                    for (columns, work) in components.into_iter().zip(work) {
                        self.along_z.run(Direction::Backward, work, columns, buffers);
                    }
                    if let (Some((channel, all)), Some(added)) = (channel, &added) {
                        channel.add([block, mode], added, all);
                    }
                }
            });
        });
    }

    /// Visits every panel of columns along z: the columns of one block along x and one mode along y.
    fn each_panel<const C: usize>(
        &self,
        whole: &WholeColumns<T>,
        work: impl Fn([StridedPointer<T>; C], [usize; 2]) + Sync,
    ) {
        let (Layout { blocks, .. }, WholeColumns { memory, strides, modes }) = (&self.layout, whole);
        let bytes = 2 * C * modes.len() * blocks.len() * self.layout.points[2] * 2 * T::LANES * size_of::<T>();
        (0..modes.len() * blocks.len()).into_par_iter().moving(bytes).for_each(|i| {
            let (mode, block) = (i / blocks.len(), i % blocks.len());
            let components = std::array::from_fn(|component| {
                let start = strides.at(component, mode, 0) + block * 2 * T::LANES;
                // SAFETY: the panel lies inside this rank's share.
                StridedPointer { first: unsafe { memory.at(start) }, stride: strides.z }
            });
            work(components, [blocks.start + block, modes.start + mode]);
        });
    }
}
