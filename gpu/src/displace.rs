//! Particles that move on a device, see `gpu/kernels/displace.h`.

use crate::device::{DeviceError, KernelLaunch};
use crate::far_field::{PARTICLE_THREADS, SplitFarField};
use crate::lists::DeviceList;
use crate::numbers::KernelNumbers;
use crate::task::{DeviceAddress, KernelTask};
use bytemuck::{Pod, Zeroable};
use std::mem::offset_of;

/// Columns of displacements and of velocities at most.
pub const MOST_COLUMNS: usize = 8;

/// Numbers of a particle that moves on the device, before and after a step that may fail: position and lattice steps,
/// the velocity and up to three past ones, which change with the frame of reference, and the motion of a new solution
/// beside the last angular velocity.
pub(crate) const MOVING: usize = 2 * (3 + 3 + 4 * 3) + 6 + 3;

/// A displacement of particles in a box: lists in the order of ids, and in the units of the host.
#[derive(Debug, Clone)]
pub struct DisplacementInput {
    /// Positions, and lattice steps that were taken out of them; before and after.
    pub places: [[DeviceList; 2]; 2],
    /// Displacements and their weights.
    pub terms: Vec<(DeviceList, f64)>,
    /// Columns of velocities, before and after.
    pub velocities: Vec<[DeviceList; 2]>,
    /// Edges of the box.
    pub edges: [f64; 3],
    /// Strain of the box.
    pub strain: f64,
    /// Tilts of the box.
    pub tilts: [f64; 2],
    /// Axes of the box as rows of a matrix that maps components along them to components in space, if they differ.
    pub axes: Option<[f64; 9]>,
    /// Velocity gradient of the flow by which images move, row by row.
    pub gradient: [f64; 9],
    /// Deformation of displaced positions and of velocities by the flow, row by row.
    pub deformation: [f64; 9],
    /// Matrix that converts lattice steps before to those along the vectors of the box.
    pub renaming: [[i32; 3]; 3],
    /// Distance from the box, in edges, from which on a particle is lost.
    pub farthest: f64,
}

/// Particles that move on the device.
#[derive(Debug, Clone, Copy)]
pub struct MovedParticles<'a> {
    /// Positions in the order of ids, in the units of the host.
    pub positions: DeviceList,
    /// Lattice steps that were taken out of them.
    pub steps: DeviceList,
    /// Classes of radius, unless they are those of the particles that were arranged last.
    pub classes: Option<&'a [u32]>,
    /// Unit of length of the host over that of the far field.
    pub length: f64,
}

/// Arguments with the fields of `gpu/kernels/displace.h` in the same order.
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[repr(C)]
struct Displacement {
    positions: DeviceAddress,
    steps: DeviceAddress,
    terms: [DeviceAddress; MOST_COLUMNS],
    velocities: [DeviceAddress; MOST_COLUMNS],
    moved: DeviceAddress,
    counted: DeviceAddress,
    carried: [DeviceAddress; MOST_COLUMNS],
    weights: [f64; MOST_COLUMNS],
    edges: [f64; 3],
    strain: f64,
    tilts: [f64; 2],
    axes: [f64; 9],
    gradient: [f64; 9],
    deformation: [f64; 9],
    farthest: f64,
    renaming: [[i64; 3]; 3],
    particles: i64,
    is_rotated: i64,
    is_lost: i64,
}

impl SplitFarField {
    /// Moves particles and wraps them into their box. Returns whether all are within the box after that; otherwise the
    /// lists afterwards are undefined.
    ///
    /// # Panics
    ///
    /// With more than [`MOST_COLUMNS`] displacements or columns of velocities.
    pub fn displace(&mut self, from: &DisplacementInput) -> Result<bool, DeviceError> {
        let [[positions, moved], [steps, counted]] = from.places.map(|pair| pair.map(|list| list.address));
        let &DisplacementInput { edges, strain, tilts, axes, gradient, deformation, farthest, .. } = from;
        let mut arguments = Displacement {
            positions,
            steps,
            moved,
            counted,
            edges,
            strain,
            tilts,
            axes: axes.unwrap_or_default(),
            gradient,
            deformation,
            farthest,
            renaming: from.renaming.map(|row| row.map(i64::from)),
            is_rotated: i64::from(axes.is_some()),
            particles: from.places[0][0].count as i64 / 3,
            ..Displacement::default()
        };
        for (k, (list, weight)) in from.terms.iter().enumerate() {
            (arguments.terms[k], arguments.weights[k]) = (list.address, *weight);
        }
        for (k, [before, after]) in from.velocities.iter().enumerate() {
            (arguments.velocities[k], arguments.carried[k]) = (before.address, after.address);
        }
        let blocks = (arguments.particles as usize).div_ceil(PARTICLE_THREADS);
        if blocks == 0 {
            return Ok(true);
        }
        let on = self.device.as_mut();
        let displacement = self.buffers.displacement.fill(on, bytemuck::bytes_of(&arguments))?;
        let task = KernelTask { displacement, ..self.task };
        on.launch(&KernelLaunch { kernel: "displace_all", blocks, threads: PARTICLE_THREADS }, &task)?;
        let mut is_lost = 0_i64;
        let place = displacement + offset_of!(Displacement, is_lost) as u64;
        on.download(place, bytemuck::bytes_of_mut(&mut is_lost))?;
        if is_lost != 0 {
            self.buffers.displacement.forget();
        }
        Ok(is_lost == 0)
    }

    /// [`Self::arrange`] of particles that move on the device, all of which are there.
    pub fn arrange_moved(&mut self, particles: &MovedParticles) -> Result<(), DeviceError> {
        let &MovedParticles { positions, steps, classes, length } = particles;
        if let Some(classes) = classes {
            self.count_particles(classes.len(), classes.len());
            self.copy_classes(classes)?;
        }
        self.set_numbers(&KernelNumbers { length, ..self.numbers })?;
        self.reserve_particles()?;
        let bytes = 3 * size_of::<i32>() * self.task.particles as usize;
        let periods = self.buffers.names[1].reserve(self.device.as_mut(), bytes)?;
        let task = KernelTask { list_x: positions.address, list_y: steps.address, periods, ..self.task };
        self.launch_particles("place_all", &task)?;
        self.list_neighbours()
    }
}
