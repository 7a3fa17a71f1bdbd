//! Measures of displacements of particles that move on a device, and of their near pairs, see `gpu/kernels/steps.h`.

use crate::device::DeviceError;
use crate::far_field::SplitFarField;
use crate::lists::DeviceList;
use crate::task::{DeviceAddress, KernelTask};
use crate::vectors::SUM_THREADS;
use bytemuck::{Pod, Zeroable};
use std::ops::Range;

/// Columns of which a displacement is a weighted sum, at most.
pub const STEP_COLUMNS: usize = 4;

/// Different weights of these columns at most.
const STEP_ORDERS: usize = 4;

/// Displacements of particles, and limits of their near pairs. Lists are in the order of ids, and all numbers in the
/// units of the host, except that columns may have any other. A measure needs a part of this.
#[derive(Debug, Clone, Copy, Default)]
pub struct StepInput<'a> {
    /// Radii by class.
    pub radii: &'a [f64],
    /// Unit of length of the host over that of the far field.
    pub length: f64,
    /// Positions to which velocities belong, in a box without tilts.
    pub positions: Option<DeviceList>,
    /// Velocity gradient of the flow, row by row.
    pub gradient: [f64; 9],
    /// Deformation of displaced separations by the flow, row by row.
    pub deformation: [f64; 9],
    /// Velocities with those of the flow.
    pub columns: &'a [DeviceList],
    /// Weights of the columns in displacements.
    pub weights: &'a [[f64; STEP_COLUMNS]],
    /// Ratios of the difference between the highest of four orders and the next one, to the two differences after it,
    /// up to which a motion counts as smooth.
    pub smooth: [f64; 2],
    /// Gaps over the mean radius: smaller ones count as that large in losses, and in errors.
    pub least: [f64; 2],
    /// Distance of centres up to which pairs count.
    pub reach: f64,
    /// Gap of spheres that are moved apart over their mean radius.
    pub closest: f64,
    /// Its relative tolerance.
    pub slack: f64,
}

/// Largest measures of all particles or pairs; `None` without any that is positive, or without pairs.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StepMeasures {
    /// Error.
    pub error: Option<f64>,
    /// Roughness.
    pub roughness: Option<f64>,
    /// Relative loss of a gap.
    pub loss: Option<f64>,
    /// Smallest gap.
    pub gap: Option<f64>,
}

/// Sums as in `gpu/kernels/steps.h`.
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[repr(C)]
struct StepSums {
    error: u64,
    roughness: u64,
    loss: u64,
    nearest: u64,
}

/// Arguments with the fields of `gpu/kernels/steps.h` in the same order.
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[repr(C)]
struct StepMotion {
    radii: DeviceAddress,
    positions: DeviceAddress,
    columns: [DeviceAddress; STEP_COLUMNS],
    sums: DeviceAddress,
    pushed: DeviceAddress,
    weights: [[f64; STEP_COLUMNS]; STEP_ORDERS],
    gradient: [f64; 9],
    deformation: [f64; 9],
    smooth: [f64; 2],
    least: [f64; 2],
    reach: f64,
    length: f64,
    closest: f64,
    slack: f64,
}

/// The number that an integer in the order of numbers stands for.
fn number_of(ordered: u64) -> Option<f64> {
    let sign = 1 << 63;
    let bits = if ordered & sign == 0 { !ordered } else { ordered & !sign };
    (ordered != 0).then(|| f64::from_bits(bits))
}

impl From<StepSums> for StepMeasures {
    fn from(sums: StepSums) -> Self {
        let [error, roughness, loss, nearest] = [sums.error, sums.roughness, sums.loss, sums.nearest].map(number_of);
        Self { error, roughness, loss, gap: nearest.map(|gap| -gap) }
    }
}

impl SplitFarField {
    /// Weighted sum of columns of as many values.
    pub fn combine(&mut self, terms: &[(DeviceList, f64)], to: &DeviceList) -> Result<(), DeviceError> {
        let (first, others) = terms.split_at(terms.len().min(STEP_COLUMNS));
        self.combine_few(first, to)?;
        others.chunks(STEP_COLUMNS - 1).try_for_each(|part| self.combine_few(&[&[(*to, 1.0)], part].concat(), to))
    }

    fn combine_few(&mut self, terms: &[(DeviceList, f64)], to: &DeviceList) -> Result<(), DeviceError> {
        let (columns, weights): (Vec<_>, Vec<_>) = terms.iter().copied().unzip();
        let mut padded = [0.0; STEP_COLUMNS];
        padded[..weights.len()].copy_from_slice(&weights);
        let step = self.place_step(&StepInput { columns: &columns, weights: &[padded], ..StepInput::default() })?;
        let task = KernelTask { list_y: to.address, step, list_size: to.count as i64, ..self.task };
        self.launch_vectors("combine_all", to.count.div_ceil(SUM_THREADS), &task)
    }

    /// Velocities in the first column plus the first weight times those of the flow at the positions.
    pub fn add_flow(&mut self, input: &StepInput, to: &DeviceList) -> Result<(), DeviceError> {
        let step = self.place_step(input)?;
        let particles = to.count / 3;
        let task = KernelTask { list_y: to.address, step, list_size: particles as i64, ..self.task };
        self.launch_vectors("add_flow", particles.div_ceil(SUM_THREADS), &task)
    }

    /// Vectors of a column, of which none is longer than `most` times the radius of its particle, by radii of classes.
    pub fn limit(&mut self, column: DeviceList, radii: &[f64], most: f64, to: &DeviceList) -> Result<(), DeviceError> {
        let (columns, weights) = (&[column], &[[most, 0.0, 0.0, 0.0]]);
        let step = self.place_step(&StepInput { radii, columns, weights, ..StepInput::default() })?;
        self.launch_particles("limit_all", &KernelTask { list_y: to.address, step, ..self.task })
    }

    /// Error and roughness of displacements over the radius, from the weights of differences between two displacements,
    /// or four and the next ones. A number that is not one is the largest.
    pub fn displacement_error(&mut self, input: &StepInput) -> Result<StepMeasures, DeviceError> {
        self.measure(&format!("displacement_error_{}", input.weights.len() + 1), input).map(StepMeasures::from)
    }

    /// Changes of the gaps of the pairs of arranged particles within a reach, after two displacements or four.
    pub fn gap_changes(&mut self, input: &StepInput) -> Result<StepMeasures, DeviceError> {
        let kernel = format!("gap_changes_{}_{}", input.weights.len(), self.tables.numbers.suffix());
        self.measure(&kernel, input).map(StepMeasures::from)
    }

    /// Smallest gap over the mean radius, of the pairs of arranged particles within a reach.
    pub fn smallest_relative_gap(&mut self, input: &StepInput) -> Result<Option<f64>, DeviceError> {
        let kernel = format!("nearest_pairs_{}", self.tables.numbers.suffix());
        self.measure(&kernel, input).map(|sums| StepMeasures::from(sums).gap)
    }

    /// Rounds in which pairs of arranged particles within a reach that are too close after a displacement are moved
    /// apart, the first one from no displacements: round `n` writes those after it into `lists[n % 2]`. Displacements
    /// are the same after further rounds if no particle has moved in one. Returns the number of particles that move in
    /// each of these rounds, which the host gets in one copy.
    pub fn push_apart(
        &mut self,
        input: &StepInput,
        lists: [DeviceList; 2],
        rounds: Range<usize>,
    ) -> Result<Vec<u64>, DeviceError> {
        let mut pushed = vec![0_u64; rounds.len()];
        if self.task.particles == 0 || pushed.is_empty() {
            return Ok(pushed);
        }
        let bytes = size_of_val(&pushed[..]);
        let of_rounds = self.buffers.pushed.reserve(self.device.as_mut(), bytes)?;
        let (step, near_reach) = (self.place_step(input)?, self.bins_within(input.reach / input.length));
        self.device.zero(of_rounds, bytes)?;
        let kernel = format!("pushed_apart_{}", self.tables.numbers.suffix());
        for (place, round) in rounds.enumerate() {
            let [list_y, other] = [round, round + 1].map(|number| lists[number % 2].address);
            let list_x = if round == 0 { 0 } else { other };
            let list_size = place as i64;
            self.launch_particles(&kernel, &KernelTask { list_x, list_y, step, list_size, near_reach, ..self.task })?;
        }
        self.device.download(of_rounds, bytemuck::cast_slice_mut(&mut pushed))?;
        Ok(pushed)
    }

    /// Sums of a kernel over all particles.
    fn measure(&mut self, kernel: &str, input: &StepInput) -> Result<StepSums, DeviceError> {
        let mut sums = StepSums::default();
        if self.task.particles == 0 {
            return Ok(sums);
        }
        let step = self.place_step(input)?;
        let (of_sums, near_reach) = (self.buffers.step_sums.address(), self.bins_within(input.reach / input.length));
        self.device.zero(of_sums, size_of::<StepSums>())?;
        self.launch_particles(kernel, &KernelTask { step, near_reach, ..self.task })?;
        self.device.download(of_sums, bytemuck::bytes_of_mut(&mut sums))?;
        Ok(sums)
    }

    /// Copies arguments to the device.
    ///
    /// # Panics
    ///
    /// With more than [`STEP_COLUMNS`] columns or four weights.
    fn place_step(&mut self, input: &StepInput) -> Result<DeviceAddress, DeviceError> {
        let &StepInput { gradient, deformation, smooth, least, reach, length, closest, slack, .. } = input;
        let Self { device, buffers, .. } = self;
        let on = device.as_mut();
        let mut motion = StepMotion {
            positions: input.positions.map_or(0, |list| list.address),
            sums: buffers.step_sums.reserve(on, size_of::<StepSums>())?,
            pushed: buffers.pushed.address(),
            gradient,
            deformation,
            smooth,
            least,
            reach,
            length,
            closest,
            slack,
            ..StepMotion::default()
        };
        if !input.radii.is_empty() {
            motion.radii = buffers.radii.fill(on, bytemuck::cast_slice(input.radii))?;
        }
        for (place, list) in input.columns.iter().enumerate() {
            motion.columns[place] = list.address;
        }
        motion.weights[..input.weights.len()].copy_from_slice(input.weights);
        buffers.step.fill(on, bytemuck::bytes_of(&motion))
    }
}
