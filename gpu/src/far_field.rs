//! Particles, tables and lists of the split method on a device.

use crate::buffers::Buffer;
use crate::device::{Device, DeviceError, DeviceInfo, KernelLaunch};
use crate::krylov_state::KrylovBuffers;
use crate::lists::DeviceList;
use crate::numbers::{KernelNumbers, NumberBuffers};
use crate::pair_rows::{NearBuffers, NearRows};
use crate::repeated::{COMMAND_LISTS, CommandList, Repeated};
use crate::share::{Peers, parts_of_lines};
use crate::surface_laws::SurfaceLaws;
use crate::tables::{DevicePairTable, LatticeShape, SplitTables, fixed_points};
use crate::task::{DeviceAddress, KernelTask};
use std::rc::Rc;
use std::time::Instant;

/// Points of a bin and of a tile along an axis; threads of blocks; as in `gpu/kernels`.
const BIN: usize = 4;
const TILE: usize = 8;

/// Numbers that scans leave: of neighbours, and of stiff and of soft pairs.
const COUNTS: usize = 3;

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

/// Particles that are present on a device.
#[derive(Debug, Clone, Copy)]
pub struct PlacedParticles<'a> {
    /// Lattice coordinates as fractions of the edges, three each.
    pub fractions: &'a [f64],
    /// Classes of radius.
    pub classes: &'a [u32],
    /// Number of those at the start whose motions are wanted; the others are those of other devices.
    pub owned: usize,
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
    /// Spreading.
    pub spread: f64,
    /// Transforms and the solve.
    pub transform: f64,
    /// Interpolation.
    pub interpolate: f64,
    /// Order of the particles, search for neighbours, and pair corrections.
    pub near: f64,
    /// Copies to and from the device.
    pub copies: f64,
}

/// Lists on the device.
#[derive(Default)]
pub(crate) struct Buffers {
    tables: [Buffer; 6],
    parts: [Buffer; 2],
    pub(crate) of_solve: [Buffer; 4],
    pub(crate) images: [Buffer; 3],
    of_box: [Buffer; 2],
    particles: [Buffer; 8],
    bins: [Buffer; 2],
    pub(crate) scans: [Buffer; 4],
    neighbour_starts: Buffer,
    neighbours: Buffer,
    pub(crate) loads: [Buffer; 3],
    pub(crate) records: Buffer,
    grid: [Buffer; 2],
    pub(crate) motions: [Buffer; 3],
    /// Numbers of neighbours, of stiff and of soft pairs.
    counts: Buffer,
    /// Sums of blocks, of the vectors of an iteration and of the two kernels of one within it.
    pub(crate) sums: [Buffer; 3],
    numbers: NumberBuffers,
    pub(crate) near: NearBuffers,
    pub(crate) surface_laws: Buffer,
    pub(crate) krylov: KrylovBuffers,
    /// Ids of particles, and their steps across the faces of the box.
    pub(crate) names: [Buffer; 2],
    /// Arguments of the columns of solutions, places of rows in them, and sums of comparisons.
    pub(crate) history: Buffer,
    pub(crate) places: Buffer,
    pub(crate) compared: Buffer,
    /// Arguments of a displacement.
    pub(crate) displacement: Buffer,
}

impl Buffers {
    /// Addresses of what kernels leave to the kernels after them.
    pub(crate) fn scratch(&self) -> impl Iterator<Item = DeviceAddress> {
        self.scans.iter().chain(&self.sums).map(Buffer::address)
    }
}

/// Far field of particles by the split method on a device.
pub struct SplitFarField {
    pub(crate) device: Box<dyn Device>,
    pub(crate) tables: SplitTables,
    pub(crate) task: KernelTask,
    /// Numbers on the device.
    pub(crate) numbers: KernelNumbers,
    pub(crate) buffers: Buffers,
    pub(crate) near: NearRows,
    /// Laws of forces between surfaces that are there.
    pub(crate) surface_laws: Option<SurfaceLaws>,
    pub(crate) repeated: [Repeated; COMMAND_LISTS],
    /// Lists that were released.
    pub(crate) spare: Vec<DeviceList>,
    /// Other devices that share the grid, if there are any, and the rows of the particles in the order of bins for the
    /// exchange with them.
    pub(crate) peers: Option<Rc<dyn Peers>>,
    pub(crate) host_rows: Vec<i32>,
    neighbours: usize,
    pub(crate) seconds: StageSeconds,
}

/// Arguments that hold for all particles and boxes.
fn task_of(tables: &SplitTables) -> KernelTask {
    let (planes, modes) = (tables.share.own_planes(), tables.share.own_modes());
    KernelTask {
        class_count: tables.classes() as i32,
        grid: tables.grid.map(|n| n as i32),
        bins: tables.grid.map(|n| n.div_ceil(BIN) as i32),
        tiles: [tables.grid[0], tables.grid[1], planes.len()].map(|n| n.div_ceil(TILE) as i32),
        first_plane: planes.start as i32,
        planes: planes.len() as i32,
        first_mode: modes.start as i32,
        modes: modes.len() as i32,
        points: tables.points as i32,
        lanes: if tables.points <= 8 { 8 } else { 16 },
        cutoff_square: tables.cutoff * tables.cutoff,
        inverse_viscosity: 1.0 / tables.viscosity,
        gaussian: tables.gaussian,
        widening: tables.widening,
        bounded_axes: tables.bounded_axes(),
        ..KernelTask::default()
    }
}

impl SplitFarField {
    /// Copies the tables to a device, and reserves the grid there.
    pub fn new(mut device: Box<dyn Device>, tables: SplitTables) -> Result<Self, DeviceError> {
        let (mut buffers, numbers, on) = (Buffers::default(), tables.numbers, device.as_mut());
        let ints = |values: &[i32]| bytemuck::cast_slice::<i32, u8>(values).to_vec();
        let mut task = task_of(&tables);
        let mut window = Vec::new();
        for (derivative, series) in tables.window.iter().enumerate() {
            task.window_starts[derivative] = window.len() as i32;
            task.window_rows[derivative] = (series.0.len() / tables.points) as i32;
            window.extend_from_slice(&series.0);
        }
        let sizes: Vec<i32> = tables.pairs.iter().map(|table| table.coefficients.len() as i32).collect();
        let starts: Vec<i32> = (0..sizes.len()).map(|pair| sizes[..pair].iter().sum()).collect();
        let pairs: Vec<f64> = tables.pairs.iter().flat_map(DevicePairTable::numbers).copied().collect();
        let per_square: Vec<f64> = tables.pairs.iter().map(|table| table.per_square).collect();
        let [of_window, of_pairs, of_isolated, of_squares, of_starts, of_sizes] = &mut buffers.tables;
        task.window = of_window.fill(on, &numbers.bytes_of(&window))?;
        task.tables = of_pairs.fill(on, &numbers.bytes_of(&pairs))?;
        task.isolated = of_isolated.fill(on, &numbers.bytes_of(tables.isolated.as_flattened()))?;
        task.intervals_per_square = of_squares.fill(on, bytemuck::cast_slice(&per_square))?;
        task.table_starts = of_starts.fill(on, &ints(&starts))?;
        task.table_sizes = of_sizes.fill(on, &ints(&sizes))?;
        let [field, spectrum] = &mut buffers.grid;
        let [of_field, of_spectrum] = tables.values();
        task.field = field.reserve(on, of_field * numbers.size())?;
        task.spectrum = spectrum.reserve(on, of_spectrum * numbers.size())?;
        if !tables.share.is_whole() {
            for (axis, parts) in [&tables.share.modes, &tables.share.planes].into_iter().enumerate() {
                task.parts[axis] = buffers.parts[axis].fill(on, &ints(&parts_of_lines(parts)))?;
            }
        }
        [task.numbers, task.state] = buffers.numbers.reserve(on)?;
        let mut field = Self {
            device,
            tables,
            task,
            numbers: KernelNumbers::default(),
            buffers,
            near: NearRows::default(),
            surface_laws: None,
            repeated: Default::default(),
            spare: Vec::new(),
            peers: None,
            host_rows: Vec::new(),
            neighbours: 0,
            seconds: StageSeconds::default(),
        };
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
        let (format, on) = (tables.numbers, device.as_mut());
        let spacing: [f64; 3] = std::array::from_fn(|axis| shape.edges[axis] / tables.grid[axis] as f64);
        let ([t, r], s) = (shape.tilts, shape.strain);
        task.is_rotated = i32::from(shape.axes.is_some());
        let numbers = KernelNumbers {
            edges: shape.edges,
            inverse_spacing: spacing.map(f64::recip),
            strain: s,
            tilt_x: t,
            tilt_y: r,
            tilt_across: t - s * r,
            axes: shape.axes.unwrap_or_default(),
            solve_factor: 1.0 / (tables.viscosity * shape.edges.iter().product::<f64>()),
            ..self.numbers
        };
        let smoothing = shape.smoothing.as_flattened().as_flattened();
        let [of_smoothing, of_levels] = &mut buffers.of_box;
        task.smoothing = of_smoothing.fill(on, &format.bytes_of(smoothing))?;
        task.levels = of_levels.fill(on, &format.bytes_of(&shape.levels.concat()))?;
        self.set_numbers(&numbers)?;
        self.task.reach = self.bins_within(self.tables.cutoff);
        Ok(())
    }

    /// Number of bins to either side of a bin in which particles within a distance are.
    pub(crate) fn bins_within(&self, distance: f64) -> [i32; 3] {
        let KernelNumbers { strain, tilt_y, tilt_across, inverse_spacing, .. } = self.numbers;
        let stretch = [(1.0 + strain * strain + tilt_across.powi(2)).sqrt(), (1.0 + tilt_y * tilt_y).sqrt(), 1.0];
        std::array::from_fn(|axis| {
            let points = distance * stretch[axis] * inverse_spacing[axis];
            // The last bin of each period may have fewer points than the others.
            let turns = points / self.tables.grid[axis] as f64;
            (points / BIN as f64).floor() as i32 + 2 + turns.floor() as i32
        })
    }

    /// Sets the other devices that share the grid, for the particles that are set next.
    pub fn set_peers(&mut self, peers: Rc<dyn Peers>) {
        self.peers = Some(peers);
    }

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
}
