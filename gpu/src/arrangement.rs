//! Order of the particles by bins, and their neighbours.

use crate::device::DeviceError;
use crate::far_field::{COUNTS, PARTICLE_THREADS, PlacedParticles, SplitFarField};
use crate::repeated::CommandList;
use crate::tables::fixed_points;
use std::time::Instant;

impl SplitFarField {
    /// Sets the particles. Sorts them, and finds the neighbours of those whose motions are wanted.
    pub fn arrange(&mut self, particles: &PlacedParticles) -> Result<(), DeviceError> {
        let &PlacedParticles { fractions, classes, owned } = particles;
        let clock = Instant::now();
        self.count_particles(classes.len(), owned);
        self.place(fractions, classes)?;
        self.seconds.copies += clock.elapsed().as_secs_f64();
        let clock = Instant::now();
        self.list_neighbours()?;
        if self.peers.is_some() && !classes.is_empty() {
            self.host_rows.resize(classes.len(), 0);
            self.device.download(self.task.rows, bytemuck::cast_slice_mut(&mut self.host_rows))?;
        }
        self.seconds.near += clock.elapsed().as_secs_f64();
        Ok(())
    }

    /// Sets the number of particles, and of those whose motions are wanted.
    pub(crate) fn count_particles(&mut self, count: usize, owned: usize) {
        if self.task.particles as usize != count {
            self.release_spare();
        }
        (self.task.particles, self.task.owned) = (count as i32, owned as i32);
    }

    /// Copies classes of radius to the device.
    pub(crate) fn copy_classes(&mut self, classes: &[u32]) -> Result<(), DeviceError> {
        let Self { device, task, buffers, .. } = self;
        task.classes = buffers.particles[1].fill(device.as_mut(), bytemuck::cast_slice(classes))?;
        Ok(())
    }

    /// Copies particles to the device, and reserves the lists of particles.
    fn place(&mut self, fractions: &[f64], classes: &[u32]) -> Result<(), DeviceError> {
        let Self { device, task, buffers, .. } = self;
        task.positions = buffers.particles[0].fill(device.as_mut(), &fixed_points(fractions))?;
        self.copy_classes(classes)?;
        self.reserve_particles()
    }

    /// Reserves the lists of particles, and clears those that count.
    pub(crate) fn reserve_particles(&mut self) -> Result<(), DeviceError> {
        let Self { device, tables, task, buffers, .. } = self;
        let (numbers, count, on) = (tables.numbers, task.particles as usize, device.as_mut());
        // Recordings of the order do not depend on what was evaluated before.
        [task.forces, task.torques, task.stresslets] = [0; 3];
        [task.velocities, task.angular_velocities, task.strain_rates] = [0; 3];
        let [positions, _, keys, unsorted, rows, sorted, sorted_classes, interpolated] = &mut buffers.particles;
        task.positions = positions.reserve(on, 3 * count * size_of::<u64>())?;
        task.keys = keys.reserve(on, 4 * count)?;
        task.unsorted = unsorted.reserve(on, 4 * count)?;
        task.rows = rows.reserve(on, 4 * count)?;
        task.sorted_positions = sorted.reserve(on, 3 * count * numbers.size())?;
        task.sorted_classes = sorted_classes.reserve(on, 4 * count)?;
        task.interpolated = interpolated.reserve(on, 12 * count * numbers.size())?;
        let bins: usize = task.bins.iter().map(|&n| n as usize).product();
        let [starts, cursors] = &mut buffers.bins;
        task.bin_starts = starts.reserve(on, 4 * (bins + 1))?;
        task.bin_cursors = cursors.reserve(on, 4 * bins)?;
        on.zero(task.bin_starts, 4 * (bins + 1))?;
        on.zero(task.bin_cursors, 4 * bins)?;
        task.neighbour_starts = buffers.neighbour_starts.reserve(on, 4 * (count + 1))?;
        on.zero(task.neighbour_starts, 4 * (count + 1))?;
        task.counts = buffers.counts.reserve(on, 4 * COUNTS)?;
        self.reserve_sums(count)
    }

    /// Sorts the particles by bin.
    fn sort(&mut self) -> Result<(), DeviceError> {
        let bins: usize = self.task.bins.iter().map(|&n| n as usize).product();
        self.run_over_particles("bin_particles", PARTICLE_THREADS)?;
        self.scan(self.task.bin_starts, bins + 1, None)?;
        self.launch("scatter_particles", self.particle_blocks(1, PARTICLE_THREADS), PARTICLE_THREADS)?;
        self.run_over_particles("order_particles", PARTICLE_THREADS)
    }

    /// Sorts the particles, counts the neighbours of each, then lists them.
    pub(crate) fn list_neighbours(&mut self) -> Result<(), DeviceError> {
        let count = self.task.particles as usize;
        self.task.neighbours = 0;
        self.repeat(CommandList::Order, &[], |field| {
            field.sort()?;
            field.run_over_particles("find_neighbours", PARTICLE_THREADS)?;
            field.scan(field.task.neighbour_starts, count + 1, Some(0))
        })?;
        let [found] = self.counts(0)?;
        self.neighbours = found;
        self.task.neighbours = self.buffers.neighbours.reserve(self.device.as_mut(), 8 * self.neighbours)?;
        self.run_over_particles("find_neighbours", PARTICLE_THREADS)
    }
}
