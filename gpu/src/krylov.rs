//! Lanczos' iteration for the square root of a mobility on a device, see `gpu/kernels/krylov.h`.

use crate::buffers::Buffer;
use crate::device::DeviceError;
use crate::far_field::{Orders, SplitFarField};
use crate::krylov_state::{LOAD_COMPONENTS, MOST_VECTORS, SCALARS};
use crate::numbers::KernelNumbers;
use crate::repeated::CommandList;
use crate::task::KernelTask;
use crate::vectors::SUM_THREADS;

/// Bytes that an iteration with this many vectors takes for each particle: its id, the remainder and the vectors, and
/// sums of blocks.
pub(crate) fn krylov_bytes(vectors: f64) -> f64 {
    let sums = MOST_VECTORS as f64 / SUM_THREADS as f64;
    size_of::<f64>() as f64 * (1.0 + LOAD_COMPONENTS as f64 * (1.0 + vectors) + sums)
}

/// Input of a draw of random numbers.
#[derive(Debug, Clone, Copy)]
pub struct ParticleDraw<'a> {
    /// Ids of the particles.
    pub ids: &'a [u64],
    /// Seed of their numbers.
    pub seed: u64,
    /// Square roots of the mobilities of single spheres for forces, torques and stresslets, by class of radius.
    pub scales: &'a [[f64; 3]],
    /// Whether there are torques and stresslets.
    pub has_dipoles: bool,
}

/// Operator of the iteration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KrylovOperator {
    /// The pair corrections with those of single spheres, without the part on the grid.
    Pairs,
    /// The whole mobility.
    Whole,
}

impl SplitFarField {
    /// Begins an iteration with normal random numbers of the particles. Returns the norm of the vector of all.
    pub fn draw_numbers(&mut self, draw: &ParticleDraw) -> Result<f64, DeviceError> {
        self.place_loads(draw.has_dipoles)?;
        self.place_motions([true, draw.has_dipoles])?;
        self.set_numbers(&KernelNumbers { noise_seed: draw.seed, ..self.numbers })?;
        self.place_ids(draw.ids)?;
        let (blocks, bytes) = (self.blocks(), self.vector_bytes());
        let (on, own) = (self.device.as_mut(), &mut self.buffers.krylov);
        own.count = 0;
        let state = own.state.reserve(on, size_of::<u64>() * (SCALARS + 2 * MOST_VECTORS))?;
        on.upload(state, bytemuck::bytes_of(&-1_i64))?;
        own.scales.fill(on, bytemuck::cast_slice(draw.scales.as_flattened()))?;
        own.remainder.reserve(on, bytes)?;
        own.sums.reserve(on, size_of::<f64>() * MOST_VECTORS * blocks)?;
        // Motions by pairs alone are those with none on the grid.
        self.clear_grid()?;
        if blocks == 0 {
            return Ok(0.0);
        }
        let task = self.krylov_task();
        self.launch_particles("krylov_draw", &task)?;
        self.launch_vectors("krylov_norm", 1, &task)?;
        Ok(self.krylov_scalars()?[1].sqrt())
    }

    /// Appends the remainder over its norm as a vector to the basis. The part of its image that is orthogonal to the
    /// basis becomes the remainder. Returns the product of the vector with its image, and the norm of the remainder.
    ///
    /// # Panics
    /// With more than [`MOST_VECTORS`] vectors.
    pub fn extend_basis(&mut self, operator: KrylovOperator, orders: &Orders) -> Result<[f64; 2], DeviceError> {
        self.place_vector()?;
        let (suffix, orders, of_iteration) = (self.tables.numbers.suffix(), *orders, self.krylov_task());
        let KernelTask { ids, krylov, residual, list_weights, list_sums, .. } = of_iteration;
        let addresses = [ids, krylov, residual, list_weights, list_sums, orders.spread as u64];
        self.repeat(CommandList::Krylov, &addresses, |field| {
            let task = field.krylov_task();
            field.launch_particles(&format!("krylov_loads_{suffix}"), &task)?;
            match operator {
                KrylovOperator::Pairs => field.correct_pairs(&orders)?,
                KrylovOperator::Whole => field.evaluate_in_order(&orders)?,
            }
            let task = field.krylov_task();
            field.launch_particles(&format!("krylov_image_{suffix}"), &task)?;
            field.launch_vectors("krylov_products_of_image", MOST_VECTORS, &task)?;
            // Orthogonalised twice against the whole basis, to remove round-off.
            field.launch_particles("krylov_project", &task)?;
            field.launch_vectors("krylov_products", MOST_VECTORS, &task)?;
            field.launch_particles("krylov_project_again", &task)?;
            field.launch_vectors("krylov_norm", 1, &task)
        })?;
        let [diagonal, square] = self.krylov_scalars()?;
        Ok([diagonal, square.sqrt()])
    }

    /// Leaves all motions at zero.
    pub fn clear_motions(&mut self) -> Result<(), DeviceError> {
        let KernelTask { velocities, angular_velocities, strain_rates, particles, .. } = self.task;
        let values = particles as usize * self.tables.numbers.size();
        for (address, each) in [(velocities, 3), (angular_velocities, 3), (strain_rates, 5)] {
            if address != 0 {
                self.device.zero(address, each * values)?;
            }
        }
        Ok(())
    }

    /// Adds to the motions those with some coordinates in the basis, one of each of its vectors.
    pub fn add_from_basis(&mut self, coordinates: &[f64]) -> Result<(), DeviceError> {
        let (task, suffix) = (self.krylov_task(), self.tables.numbers.suffix());
        self.device.upload(task.krylov + (SCALARS * size_of::<f64>()) as u64, bytemuck::cast_slice(coordinates))?;
        self.launch_particles(&format!("krylov_motions_{suffix}"), &task)
    }

    /// Bytes of a vector.
    fn vector_bytes(&self) -> usize {
        let components = if self.task.strain_rates == 0 { 3 } else { LOAD_COMPONENTS };
        size_of::<f64>() * components * self.task.particles as usize
    }

    /// Takes room for the next vector of the basis.
    fn place_vector(&mut self) -> Result<(), DeviceError> {
        let bytes = self.vector_bytes();
        let (on, own) = (self.device.as_mut(), &mut self.buffers.krylov);
        assert!(own.count < MOST_VECTORS, "an iteration ends within {MOST_VECTORS} vectors");
        if own.vectors.len() == own.count {
            own.vectors.push(Buffer::default());
        }
        let vector = &mut own.vectors[own.count];
        let before = vector.address();
        let address = vector.reserve(on, bytes)?;
        if address != before {
            let place = size_of::<u64>() * (SCALARS + MOST_VECTORS + own.count);
            on.upload(own.state.address() + place as u64, bytemuck::bytes_of(&address))?;
        }
        own.count += 1;
        Ok(())
    }

    /// The product and the square of the state.
    fn krylov_scalars(&mut self) -> Result<[f64; 2], DeviceError> {
        let mut scalars = [0.0_f64; 2];
        let place = self.buffers.krylov.state.address() + size_of::<u64>() as u64;
        self.device.download(place, bytemuck::cast_slice_mut(&mut scalars))?;
        Ok(scalars)
    }

    fn krylov_task(&self) -> KernelTask {
        let own = &self.buffers.krylov;
        KernelTask {
            ids: self.buffers.names[0].address(),
            krylov: own.state.address(),
            list_weights: own.scales.address(),
            list_sums: own.sums.address(),
            residual: own.remainder.address(),
            list_size: self.blocks() as i64,
            ..self.task
        }
    }
}
