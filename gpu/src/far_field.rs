//! Particles, tables and lists of the split method on a device.

use crate::buffers::Buffer;
use crate::device::{Device, DeviceError, DeviceInfo, KernelLaunch};
use crate::lists::DeviceList;
use crate::pair_rows::{NearBuffers, NearRows};
use crate::repeated::{RECORDINGS, Repeated};
use crate::surface_laws::SurfaceLaws;
use crate::tables::{AMPLITUDES, GridSolve, LatticeShape, NumberFormat, SplitTables, fixed_points};
use crate::task::{DeviceAddress, KernelTask};
use std::time::Instant;

/// Points of a bin and of a tile along an axis; threads of blocks; as in `gpu/kernels`.
const BIN: usize = 4;
const TILE: usize = 8;
const SCAN: usize = 256;
pub(crate) const PARTICLE_THREADS: usize = 128;

/// Loads in the order of the particles, three or five numbers each; an empty list stands for none.
#[derive(Debug, Clone, Copy, Default)]
pub struct DeviceLoads<'a> {
    /// Forces.
    pub forces: &'a [f64],
    /// Torques.
    pub torques: &'a [f64],
    /// Stresslets, as their components xx, xy, xz, yy and yz.
    pub stresslets: &'a [f64],
}

/// Motions in the order of the particles; lists that were not asked for are empty.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DeviceMotion {
    /// Velocities.
    pub velocities: Vec<f64>,
    /// Angular velocities.
    pub angular_velocities: Vec<f64>,
    /// Rates of strain, as their components xx, xy, xz, yy and yz.
    pub strain_rates: Vec<f64>,
}

/// Orders of the window's derivatives, 0 to 3, and the motions that are asked for.
#[derive(Debug, Clone, Copy)]
pub struct Orders {
    /// In spreading.
    pub spread: usize,
    /// In interpolation.
    pub interpolate: usize,
    /// Whether velocities are asked for.
    pub velocities: bool,
    /// Whether angular velocities and rates of strain are asked for.
    pub gradients: bool,
}

/// Seconds spent in the parts of evaluations.
#[derive(Debug, Clone, Copy, Default)]
pub struct StageSeconds {
    /// Sorting, and spreading.
    pub spread: f64,
    /// Transforms and the solve.
    pub transform: f64,
    /// Interpolation.
    pub interpolate: f64,
    /// Search for neighbours, and pair corrections.
    pub near: f64,
    /// Copies to and from the device.
    pub copies: f64,
}

/// Lists on the device.
#[derive(Default)]
pub(crate) struct Buffers {
    tables: [Buffer; 6],
    pub(crate) of_solve: [Buffer; 4],
    pub(crate) images: [Buffer; 3],
    of_box: [Buffer; 2],
    particles: [Buffer; 8],
    bins: [Buffer; 2],
    scans: [Buffer; 4],
    neighbour_starts: Buffer,
    neighbours: Buffer,
    pub(crate) loads: [Buffer; 3],
    pub(crate) records: Buffer,
    grid: [Buffer; 2],
    pub(crate) motions: [Buffer; 3],
    /// Sums of blocks, of the vectors of an iteration and of the two kernels of one within it, and the sums of all.
    pub(crate) sums: [Buffer; 3],
    pub(crate) totals: Buffer,
    /// State of an iteration for near pairs.
    pub(crate) state: Buffer,
    pub(crate) near: NearBuffers,
    pub(crate) surface_laws: Buffer,
}

/// Far field of particles by the split method on a device.
pub struct SplitFarField {
    pub(crate) device: Box<dyn Device>,
    pub(crate) tables: SplitTables,
    pub(crate) task: KernelTask,
    pub(crate) buffers: Buffers,
    pub(crate) near: NearRows,
    /// Laws of forces between surfaces that are there.
    pub(crate) surface_laws: Option<SurfaceLaws>,
    pub(crate) repeated: [Repeated; RECORDINGS],
    /// Lists that were released.
    pub(crate) spare: Vec<DeviceList>,
    neighbours: usize,
    pub(crate) seconds: StageSeconds,
}

impl SplitFarField {
    /// Copies the tables to a device, and reserves the grid there.
    pub fn new(mut device: Box<dyn Device>, tables: SplitTables) -> Result<Self, DeviceError> {
        let (mut buffers, numbers, on) = (Buffers::default(), tables.numbers, device.as_mut());
        let ints = |values: &[i32]| bytemuck::cast_slice::<i32, u8>(values).to_vec();
        let mut task = KernelTask {
            class_count: tables.classes() as i32,
            grid: tables.grid.map(|n| n as i32),
            bins: tables.grid.map(|n| n.div_ceil(BIN) as i32),
            tiles: tables.grid.map(|n| n.div_ceil(TILE) as i32),
            points: tables.points as i32,
            lanes: if tables.points <= 8 { 8 } else { 16 },
            cutoff_square: tables.cutoff * tables.cutoff,
            inverse_viscosity: 1.0 / tables.viscosity,
            gaussian: tables.gaussian,
            widening: tables.widening,
            bounded_axes: tables.bounded_axes(),
            ..KernelTask::default()
        };
        let mut window = Vec::new();
        for (derivative, series) in tables.window.iter().enumerate() {
            task.window_starts[derivative] = window.len() as i32;
            task.window_rows[derivative] = (series.0.len() / tables.points) as i32;
            window.extend_from_slice(&series.0);
        }
        let sizes: Vec<i32> = tables.pairs.iter().map(|table| table.coefficients.len() as i32).collect();
        let starts: Vec<i32> = (0..sizes.len()).map(|pair| sizes[..pair].iter().sum()).collect();
        let pairs = tables.pairs.iter().flat_map(|table| table.coefficients.iter().flatten().flatten().copied());
        let per_square: Vec<f64> = tables.pairs.iter().map(|table| table.per_square).collect();
        let [of_window, of_pairs, of_isolated, of_squares, of_starts, of_sizes] = &mut buffers.tables;
        task.window = of_window.fill(on, &numbers.bytes_of(window.into_iter()))?;
        task.tables = of_pairs.fill(on, &numbers.bytes_of(pairs))?;
        task.isolated = of_isolated.fill(on, &numbers.bytes_of(tables.isolated.iter().flatten().copied()))?;
        task.intervals_per_square = of_squares.fill(on, bytemuck::cast_slice(&per_square))?;
        task.table_starts = of_starts.fill(on, &ints(&starts))?;
        task.table_sizes = of_sizes.fill(on, &ints(&sizes))?;
        let [field, spectrum] = &mut buffers.grid;
        task.field = field.reserve(on, 3 * tables.count() * numbers.size())?;
        task.spectrum = spectrum.reserve(on, 6 * tables.modes() * numbers.size())?;
        let (near, repeated, spare) = (NearRows::default(), <[Repeated; RECORDINGS]>::default(), Vec::new());
        let (neighbours, seconds, surface_laws) = (0, StageSeconds::default(), None);
        let mut field =
            Self { device, tables, task, buffers, near, surface_laws, repeated, spare, neighbours, seconds };
        field.copy_solve()?;
        Ok(field)
    }

    /// Seconds spent so far.
    pub fn seconds(&self) -> StageSeconds {
        self.seconds
    }

    /// Properties of the device.
    pub fn device(&self) -> Result<DeviceInfo, DeviceError> {
        self.device.info()
    }

    /// Number of neighbours of all particles.
    pub fn neighbours(&self) -> usize {
        self.neighbours
    }

    /// Sets the shape of the box.
    pub fn set_box(&mut self, shape: &LatticeShape) -> Result<(), DeviceError> {
        let Self { device, tables, task, buffers, .. } = self;
        let (numbers, on) = (tables.numbers, device.as_mut());
        let spacing: [f64; 3] = std::array::from_fn(|axis| shape.edges[axis] / tables.grid[axis] as f64);
        let ([t, r], s) = (shape.tilts, shape.strain);
        task.edges = shape.edges;
        task.inverse_spacing = spacing.map(f64::recip);
        (task.strain, task.tilt_x, task.tilt_y, task.tilt_across) = (s, t, r, t - s * r);
        task.is_rotated = i32::from(shape.axes.is_some());
        task.axes = shape.axes.unwrap_or_default();
        task.solve_factor = 1.0 / (tables.viscosity * shape.edges.iter().product::<f64>());
        let smoothing = shape.smoothing.iter().flatten().flatten().copied();
        let [of_smoothing, of_levels] = &mut buffers.of_box;
        task.smoothing = of_smoothing.fill(on, &numbers.bytes_of(smoothing))?;
        task.levels = of_levels.fill(on, &numbers.bytes_of(shape.levels.iter().flatten().copied()))?;
        self.task.reach = self.bins_within(self.tables.cutoff);
        Ok(())
    }

    /// Number of bins to either side of a bin in which particles within a distance are.
    pub(crate) fn bins_within(&self, distance: f64) -> [i32; 3] {
        let &KernelTask { strain, tilt_y, tilt_across, inverse_spacing, .. } = &self.task;
        let stretch = [(1.0 + strain * strain + tilt_across.powi(2)).sqrt(), (1.0 + tilt_y * tilt_y).sqrt(), 1.0];
        std::array::from_fn(|axis| {
            let points = distance * stretch[axis] * inverse_spacing[axis];
            // The last bin of each period may have fewer points than the others.
            let turns = points / self.tables.grid[axis] as f64;
            (points / BIN as f64).floor() as i32 + 2 + turns.floor() as i32
        })
    }

    /// Sets the particles: lattice coordinates as fractions of the edges, three each, and classes of radius. Sorts
    /// them, and finds their neighbours.
    pub fn arrange(&mut self, fractions: &[f64], classes: &[u32]) -> Result<(), DeviceError> {
        let clock = Instant::now();
        if self.task.particles as usize != classes.len() {
            self.release_spare();
        }
        self.task.particles = classes.len() as i32;
        self.repeated = Default::default();
        self.place(fractions, classes)?;
        self.seconds.copies += clock.elapsed().as_secs_f64();
        let clock = Instant::now();
        self.sort()?;
        self.device.finish()?;
        self.seconds.spread += clock.elapsed().as_secs_f64();
        let clock = Instant::now();
        self.list_neighbours()?;
        self.device.finish()?;
        self.seconds.near += clock.elapsed().as_secs_f64();
        Ok(())
    }

    /// Copies particles to the device, and reserves the lists of particles.
    fn place(&mut self, fractions: &[f64], classes: &[u32]) -> Result<(), DeviceError> {
        let Self { device, tables, task, buffers, .. } = self;
        let (numbers, count, on) = (tables.numbers, classes.len(), device.as_mut());
        let [positions, of_classes, keys, unsorted, rows, sorted, sorted_classes, interpolated] =
            &mut buffers.particles;
        task.positions = positions.fill(on, &fixed_points(fractions))?;
        task.classes = of_classes.fill(on, bytemuck::cast_slice(classes))?;
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
        on.zero(task.bin_cursors, 4 * bins)
    }

    /// Sorts the particles by bin.
    fn sort(&mut self) -> Result<(), DeviceError> {
        let bins: usize = self.task.bins.iter().map(|&n| n as usize).product();
        self.run_over_particles("bin_particles", PARTICLE_THREADS)?;
        self.scan(self.task.bin_starts, bins + 1, 0)?;
        self.launch("scatter_particles", self.particle_blocks(1, PARTICLE_THREADS), PARTICLE_THREADS)?;
        self.run_over_particles("order_particles", PARTICLE_THREADS)
    }

    /// Counts the neighbours of each particle, then lists them.
    fn list_neighbours(&mut self) -> Result<(), DeviceError> {
        let count = self.task.particles as usize;
        let on = self.device.as_mut();
        self.task.neighbour_starts = self.buffers.neighbour_starts.reserve(on, 4 * (count + 1))?;
        on.zero(self.task.neighbour_starts, 4 * (count + 1))?;
        self.task.neighbours = 0;
        self.run_over_particles("find_neighbours", PARTICLE_THREADS)?;
        let mut sum = [0_i32];
        let address = self.scan(self.task.neighbour_starts, count + 1, 0)?;
        self.device.download(address, bytemuck::cast_slice_mut(&mut sum))?;
        self.neighbours = sum[0] as usize;
        self.task.neighbours = self.buffers.neighbours.reserve(self.device.as_mut(), 8 * self.neighbours)?;
        self.run_over_particles("find_neighbours", PARTICLE_THREADS)
    }

    /// Replaces a list of counts by the sums of those before each; `level` is that of the recursion. Returns the place
    /// of the sum of all.
    pub(crate) fn scan(
        &mut self,
        list: DeviceAddress,
        count: usize,
        level: usize,
    ) -> Result<DeviceAddress, DeviceError> {
        let blocks = count.div_ceil(SCAN);
        let totals = self.buffers.scans[level].reserve(self.device.as_mut(), 4 * blocks)?;
        let task = KernelTask { scanned: list, scan_totals: totals, scan_count: count as i32, ..self.task };
        self.device.launch(&KernelLaunch { kernel: "scan_blocks", blocks, threads: SCAN }, &task)?;
        if blocks == 1 {
            return Ok(totals);
        }
        let sum = self.scan(totals, blocks, level + 1)?;
        self.device.launch(&KernelLaunch { kernel: "scan_add", blocks, threads: SCAN }, &task)?;
        Ok(sum)
    }

    /// Blocks that have some threads for each particle.
    pub(crate) fn particle_blocks(&self, each: usize, threads: usize) -> usize {
        (self.task.particles as usize * each).div_ceil(threads)
    }

    pub(crate) fn run_over_particles(&mut self, kernel: &str, threads: usize) -> Result<(), DeviceError> {
        let name = format!("{kernel}_{}", self.tables.numbers.suffix());
        self.launch(&name, self.particle_blocks(1, threads), threads)
    }

    pub(crate) fn launch(&mut self, kernel: &str, blocks: usize, threads: usize) -> Result<(), DeviceError> {
        if blocks == 0 {
            return Ok(());
        }
        self.device.launch(&KernelLaunch { kernel, blocks, threads }, &self.task)
    }

    /// Motions that loads cause.
    pub fn apply(&mut self, loads: &DeviceLoads, orders: &Orders) -> Result<DeviceMotion, DeviceError> {
        let clock = Instant::now();
        self.copy_loads(loads, orders)?;
        self.seconds.copies += clock.elapsed().as_secs_f64();
        self.evaluate(orders)?;
        let clock = Instant::now();
        let motion = self.copy_motion()?;
        self.seconds.copies += clock.elapsed().as_secs_f64();
        Ok(motion)
    }

    /// Copies the tables of the solve on the grid.
    fn copy_solve(&mut self) -> Result<(), DeviceError> {
        let Self { device, tables, task, buffers, .. } = self;
        let ([first, second, third, fourth], on) = (&mut buffers.of_solve, device.as_mut());
        match &tables.solve {
            GridSolve::Periodic => {}
            GridSolve::Unbounded(kernel) => {
                task.free_kernel = first.fill(on, &tables.numbers.bytes_of(kernel.iter().copied()))?;
            }
            GridSolve::Channel(channel) => {
                task.channel_columns = first.fill(on, bytemuck::cast_slice(&channel.columns))?;
                task.channel_planes = second.fill(on, bytemuck::cast_slice(&channel.mean_planes))?;
                task.channel_mean = third.fill(on, bytemuck::cast_slice(&channel.mean_kernel))?;
                let columns = tables.modes() / tables.grid[2];
                task.channel_amplitudes = fourth.reserve(on, (AMPLITUDES * columns + 6) * size_of::<f64>())?;
            }
        }
        Ok(())
    }

    pub(crate) fn copy_loads(&mut self, loads: &DeviceLoads, orders: &Orders) -> Result<(), DeviceError> {
        let Self { device, tables, task, buffers, .. } = self;
        let (numbers, count, on) = (tables.numbers, task.particles as usize, device.as_mut());
        let addresses = [&mut task.forces, &mut task.torques, &mut task.stresslets];
        let lists = [loads.forces, loads.torques, loads.stresslets];
        for ((address, list), buffer) in addresses.into_iter().zip(lists).zip(&mut buffers.loads) {
            *address = if list.is_empty() { 0 } else { buffer.fill(on, &numbers.bytes_of(list.iter().copied()))? };
        }
        let [velocities, turns, strains] = &mut buffers.motions;
        task.velocities = if orders.velocities { velocities.reserve(on, 3 * count * numbers.size())? } else { 0 };
        task.angular_velocities = if orders.gradients { turns.reserve(on, 3 * count * numbers.size())? } else { 0 };
        task.strain_rates = if orders.gradients { strains.reserve(on, 5 * count * numbers.size())? } else { 0 };
        Ok(())
    }

    pub(crate) fn copy_motion(&mut self) -> Result<DeviceMotion, DeviceError> {
        let KernelTask { velocities, angular_velocities, strain_rates, .. } = self.task;
        Ok(DeviceMotion {
            velocities: self.values(velocities, 3)?,
            angular_velocities: self.values(angular_velocities, 3)?,
            strain_rates: self.values(strain_rates, 5)?,
        })
    }

    /// Values of each particle at an address; none at 0.
    fn values(&mut self, address: u64, each: usize) -> Result<Vec<f64>, DeviceError> {
        let count = if address == 0 { 0 } else { each * self.task.particles as usize };
        self.download(address, count, self.tables.numbers)
    }

    pub(crate) fn download(
        &mut self,
        address: u64,
        count: usize,
        numbers: NumberFormat,
    ) -> Result<Vec<f64>, DeviceError> {
        let mut bytes = vec![0; count * numbers.size()];
        if count > 0 {
            self.device.download(address, &mut bytes)?;
        }
        Ok(numbers.values_of(&bytes))
    }
}
