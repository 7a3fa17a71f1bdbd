//! Particles, tables and lists of the split method on a device.

use crate::buffers::{Buffer, KnownBuffer};
use crate::contact_buffers::ContactBuffers;
use crate::device::{Device, DeviceError, DeviceInfo, KernelLaunch};
use crate::krylov_state::KrylovBuffers;
use crate::lists::DeviceList;
use crate::numbers::{KernelNumbers, NumberBuffers};
use crate::pair_rows::{NearBuffers, NearRows};
use crate::repeated::{COMMAND_LISTS, Repeated};
use crate::share::{Peers, parts_of_lines};
use crate::surface_laws::SurfaceLaws;
use crate::tables::{DevicePairTable, LatticeShape, SplitTables};
use crate::task::{DeviceAddress, KernelTask};
use std::rc::Rc;
use std::time::Instant;

/// Points of a bin and of a tile along an axis; threads of blocks; as in `gpu/kernels`.
const BIN: usize = 4;
const TILE: usize = 8;

/// Numbers that scans leave: of neighbours, and of stiff and of soft pairs.
pub(crate) const COUNTS: usize = 3;

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
    of_box: [KnownBuffer; 2],
    pub(crate) particles: [Buffer; 8],
    pub(crate) bins: [Buffer; 2],
    pub(crate) scans: [Buffer; 4],
    pub(crate) neighbour_starts: Buffer,
    pub(crate) neighbours: Buffer,
    pub(crate) loads: [Buffer; 3],
    pub(crate) records: Buffer,
    grid: [Buffer; 2],
    pub(crate) motions: [Buffer; 3],
    /// Numbers of neighbours, of stiff and of soft pairs.
    pub(crate) counts: Buffer,
    /// Sums of blocks, of the vectors of an iteration and of the two kernels of one within it.
    pub(crate) sums: [Buffer; 3],
    numbers: NumberBuffers,
    pub(crate) near: NearBuffers,
    pub(crate) surface_laws: Buffer,
    pub(crate) krylov: KrylovBuffers,
    /// Ids of particles, and their steps across the faces of the box.
    pub(crate) names: [Buffer; 2],
    /// Arguments of the columns of solutions, places of rows in them, and sums of comparisons.
    pub(crate) history: KnownBuffer,
    pub(crate) places: Buffer,
    pub(crate) compared: Buffer,
    /// Arguments of a displacement, of random motions, and of known solutions.
    pub(crate) displacement: KnownBuffer,
    pub(crate) drawn: KnownBuffer,
    pub(crate) known: KnownBuffer,
    pub(crate) contacts: ContactBuffers,
    /// Predicted motions.
    pub(crate) predicted: KnownBuffer,
    /// Limits of overlaps, and sums.
    pub(crate) overlap_limits: KnownBuffer,
    pub(crate) overlaps: Buffer,
    /// Arguments of displacements that are measured, radii by class, and sums.
    pub(crate) step: KnownBuffer,
    pub(crate) radii: KnownBuffer,
    pub(crate) step_sums: Buffer,
    pub(crate) pushed: Buffer,
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
    /// Whether the ids of the particles are there.
    pub(crate) has_ids: bool,
    pub(crate) repeated: [Repeated; COMMAND_LISTS],
    /// Lists that were released.
    pub(crate) spare: Vec<DeviceList>,
    /// Other devices that share the grid, if there are any, and the rows of the particles in the order of bins for the
    /// exchange with them.
    pub(crate) peers: Option<Rc<dyn Peers>>,
    pub(crate) host_rows: Vec<i32>,
    pub(crate) neighbours: usize,
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
            has_ids: false,
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
            lowest: shape.lowest,
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
