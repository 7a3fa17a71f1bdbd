//! Motions by degenerate quadrupoles: exact sums as those of the matrix, without storing it.

use super::entries::{LocatedSphere, Shapes};
use super::pair_sum::{PairSum, UnitLoad};
use super::wave_sum::{transform, wavevectors};
use crate::mobility::noise::{ParticleComponents, components};
use crate::pairs::table::PairFunctions;
use domain::parallel::MeasuredLoop;
use domain::{PeriodicBox, Tensor, Vector};
use rayon::prelude::*;

/// Motions of the spheres `own` by the quadrupoles of all spheres.
pub(super) fn motions(
    shapes: &Shapes,
    cell: &PeriodicBox,
    spheres: &[LocatedSphere],
    own: &[usize],
    quadrupoles: &[Vector],
) -> Vec<ParticleComponents> {
    let waves = waves(shapes, cell, spheres, quadrupoles);
    let pairs = PairSum::new(shapes, cell, PairFunctions::of_quadrupole);
    let of_sphere = |&i: &usize| {
        let mut sums = [components(&by_waves(shapes, &spheres[i], &waves))];
        for (source, &force) in spheres.iter().zip(quadrupoles) {
            pairs.add_flows(&spheres[i], source, &[UnitLoad { force, dipole: Tensor::ZERO }], &mut sums);
        }
        sums[0]
    };
    own.par_iter().map(of_sphere).measured().collect()
}

/// Amplitude `u` of a wavevector, `2 Re[u exp(i k.x)]` with its opposite: real and imaginary parts.
struct FlowMode {
    k: Vector,
    real: Vector,
    imaginary: Vector,
}

/// The flow of the common Gaussians, `u = (I - k k/k^2) / (mu V k^2) sum H [w_+(k) - w_-(k)]/e exp(-i k.Y)`.
fn waves(shapes: &Shapes, cell: &PeriodicBox, spheres: &[LocatedSphere], quadrupoles: &[Vector]) -> Vec<FlowMode> {
    let scale = 2.0 / (cell.volume() * shapes.viscosity);
    let wave = |k: Vector| {
        let square = k.length_squared();
        let envelope = |class: u32| {
            let quadrupole = shapes.envelopes[class as usize].quadrupole();
            let [wide, narrow] = quadrupole.envelopes().map(|e| transform(&shapes.common, e.monopole, square));
            quadrupole.weight * (wide - narrow)
        };
        let (mut real, mut imaginary) = (Vector::ZERO, Vector::ZERO);
        for (sphere, &h) in spheres.iter().zip(quadrupoles) {
            let (sin, cos) = k.dot(sphere.position).sin_cos();
            let density = h * envelope(sphere.class);
            real += density * cos;
            imaginary -= density * sin;
        }
        let project = |u: Vector| (u - k * (k.dot(u) / square)) * (scale / square);
        FlowMode { k, real: project(real), imaginary: project(imaginary) }
    };
    let wavevectors = wavevectors(cell, shapes.largest_wavenumber());
    wavevectors.into_par_iter().map(wave).measured().collect()
}

/// Velocity and velocity gradient of a sphere, averaged over its envelopes.
fn by_waves(shapes: &Shapes, sphere: &LocatedSphere, waves: &[FlowMode]) -> (Vector, Tensor) {
    let envelope = &shapes.envelopes[sphere.class as usize];
    let (mut velocity, mut gradient) = (Vector::ZERO, Tensor::ZERO);
    for &FlowMode { k, real, imaginary } in waves {
        let [of_force, of_dipole] =
            [envelope.monopole, envelope.dipole].map(|sigma| transform(&shapes.common, sigma, k.length_squared()));
        let (sin, cos) = k.dot(sphere.position).sin_cos();
        velocity += (real * cos - imaginary * sin) * of_force;
        let slope = (real * sin + imaginary * cos) * -of_dipole;
        gradient += Tensor::from_cols(slope * k.x, slope * k.y, slope * k.z);
    }
    (velocity, gradient)
}
