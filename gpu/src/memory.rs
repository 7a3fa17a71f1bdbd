//! Memory that an evaluation takes of a device.

use crate::assembly::{GIVEN_BYTES, ROW_BYTES};
use crate::contacts::{CONTACT_NUMBERS, contact_bytes};
use crate::coupled::{RESIDUALS, RESULTS, UNKNOWNS};
use crate::displace::MOVING;
use crate::groups::group_bytes;
use crate::history::{ARGUMENT_BYTES, GUESS, KEPT, SOLUTION};
use crate::krylov::krylov_bytes;
use crate::pair_rows::PAIR_NUMBERS;
use crate::tables::{AMPLITUDES, COLUMN_NUMBERS, NumberFormat};

/// Numbers on which the memory of an evaluation depends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EvaluationSize {
    /// Precision.
    pub numbers: NumberFormat,
    /// Grid points along each edge.
    pub grid: [usize; 3],
    /// Number of devices that share the grid.
    pub devices: usize,
    /// Number of particles that are present on one of them.
    pub particles: f64,
    /// Number of classes of radius.
    pub classes: f64,
    /// Number of neighbours of all particles.
    pub neighbours: f64,
    /// Number of intervals of all tables of pair functions.
    pub intervals: f64,
    /// Solve on the grid.
    pub solve: SolveKind,
    /// Number of images in walls of all particles.
    pub images: f64,
    /// Vectors of the basis of the square roots by which random motions are drawn; 0 without such motions.
    pub random_vectors: f64,
}

/// Kind of a solve on the grid, see [`crate::GridSolve`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SolveKind {
    /// In a periodic box.
    Periodic,
    /// In unbounded fluid.
    Unbounded,
    /// With walls or open faces across z.
    Channel,
}

/// Numbers on which the memory of a solve with near pairs depends, besides that of evaluations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearSize {
    /// Precision of the grid.
    pub numbers: NumberFormat,
    /// Number of particles.
    pub particles: f64,
    /// Number of stiff pairs of all particles, each of which counts for both of its particles.
    pub stiff: f64,
    /// The same of soft pairs.
    pub soft: f64,
    /// Bytes of the tables of lubrication.
    pub tables: f64,
    /// Whether spheres are lubricated at walls.
    pub at_walls: bool,
}

/// Bytes of a particle in the columns of past solutions that the steps of a run keep, those to which a step that fails
/// returns among them, and in those of its motion, with three integers: its steps across the faces of the box.
/// Brownian steps have fewer: random motions and loads, in place of older solutions.
pub const HISTORY_BYTES: f64 = (size_of::<f64>() * (KEPT + MOVING) + 3 * size_of::<i32>()) as f64;

/// Bytes of a particle in columns that steps with several solves keep besides: two more past solutions, the mean and
/// the expected velocity before and after a displacement, displacements that separate spheres, and positions and
/// lattice steps at the start of a substep.
pub const SUBSTEP_BYTES: f64 = (size_of::<f64>() * (2 * GUESS + 2 * 2 * 3 + 3 + 6)) as f64;

/// Bytes of a particle in columns that Brownian steps with two evaluations keep besides those with one: motions of the
/// fluid as they are drawn and those for which the first solution is exact, displacements, loads as they are drawn and
/// with those between surfaces, its total stresslets, and the Brownian stresslets of the step before; in place of
/// velocities before and after a displacement.
pub const DIFFERENCE_BYTES: f64 = (size_of::<f64>() * (2 * 11 + 3 + 2 * 6 + 2 * 5 - 2 * 3)) as f64;

/// Bytes of a particle in contacts with this many slots: the lists of an evaluation, and the states of contacts at the
/// start of the step, at the start of the substep and at its end.
pub fn bytes_of_contacts(slots: usize) -> f64 {
    (contact_bytes(slots) + 3 * size_of::<f64>() * CONTACT_NUMBERS * slots) as f64
}

impl NearSize {
    /// Bytes of the pairs and of the vectors of the iteration, and of one solution.
    pub fn bytes(&self) -> f64 {
        let pair = |value: usize| (PAIR_NUMBERS * value + 2 * 4) as f64;
        let pairs = self.stiff * pair(size_of::<f64>()) + self.soft * pair(self.numbers.size());
        // Unknowns, preconditioned residual and direction; residual and image of the direction; six vectors of the
        // preconditioner, motions and loads of the start, known loads, and given ones or motions for the host;
        // stresslets of the start or given moments, and ambient motions; the result; a solution, and places of ids.
        let vectors = 8 * (3 * UNKNOWNS + 2 * RESIDUALS + 10 * 6 + 5 + 11 + RESULTS + SOLUTION) + 4;
        let groups = group_bytes(self.particles as usize) as f64;
        let given = if self.at_walls { GIVEN_BYTES } else { 0 };
        ARGUMENT_BYTES + self.tables + pairs + groups + (ROW_BYTES + given + vectors) as f64 * self.particles
    }
}

/// Bytes on a device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EvaluationBytes {
    /// Lists that the kernels use.
    pub lists: f64,
    /// Vectors of the iterations for the stresslets of rigid spheres and for random motions, which several devices
    /// leave to the host.
    pub vectors: f64,
    /// Work areas of the transforms. cuFFT takes as much as the transformed data, or less, where all factors of the
    /// numbers of points are small.
    pub transforms: f64,
}

impl EvaluationBytes {
    /// Sum of all.
    pub fn total(&self) -> f64 {
        self.lists + self.vectors + self.transforms
    }
}

impl EvaluationSize {
    /// Bytes of an evaluation with all kinds of loads and motions, as [`crate::SplitFarField`] reserves them.
    pub fn bytes(&self) -> EvaluationBytes {
        let value = self.numbers.size() as f64;
        let [nx, ny, nz] = self.grid;
        // Of planes, and of columns along z.
        let [of_planes, of_columns] = [ny * nz.div_ceil(self.devices), ny.div_ceil(self.devices) * nz];
        let spectrum = 6.0 * value * ((nx / 2 + 1) * of_planes.max(of_columns)) as f64;
        let on_grid = 3.0 * value * (nx * of_planes) as f64;
        // The memory of the field has the modes that devices exchange, too.
        let field = if self.devices > 1 { on_grid.max(spectrum) } else { on_grid };
        let bins: f64 = self.grid.iter().map(|&n| n.div_ceil(4) as f64).product();
        // Positions in two orders, loads as given and as records, interpolated values, motions; five lists of integers,
        // and the starts of the neighbours.
        let particle = f64::from(8 * 3) + value * f64::from(3 + 11 + 12 + 12 + 11) + 4.0 * 6.0;
        // Each block of images serves two particles.
        let images = (72.0 * value + 8.0) * self.images;
        let tables = 54.0 * value * self.intervals + 16.0 * self.classes * self.classes + self.solve_bytes() + images;
        let lists = spectrum + field + 8.0 * bins + particle * self.particles + 8.0 * self.neighbours + tables;
        // The motion and that of a step; unknowns, residual, preconditioned residual, direction and its image.
        let solve = value * f64::from(2 * 11 + 5 * 5);
        let random = if self.random_vectors > 0.0 { krylov_bytes(self.random_vectors) } else { 0.0 };
        let vectors = if self.devices > 1 { 0.0 } else { (solve + random) * self.particles };
        EvaluationBytes { lists, vectors, transforms: 2.0 * spectrum }
    }

    /// Bytes of the tables of the solve.
    fn solve_bytes(&self) -> f64 {
        let [nx, ny, nz] = self.grid;
        let numbers = match self.solve {
            SolveKind::Periodic => 0,
            SolveKind::Unbounded => return (self.numbers.size() * 6 * (nx / 2) * (ny / 2 + 1) * (nz / 2 + 1)) as f64,
            SolveKind::Channel => (COLUMN_NUMBERS + AMPLITUDES) * (nx / 2 + 1) * ny.div_ceil(self.devices) + 3 * nz,
        };
        (size_of::<f64>() * numbers) as f64 + if self.images > 0.0 { 4.0 * self.particles } else { 0.0 }
    }
}
