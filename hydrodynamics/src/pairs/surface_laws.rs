//! Laws of forces between surfaces, as a device takes them.

use fcm::{SurfaceKind, SurfaceLaws, SurfacePair};
use lubrication::{PairKind, SurfaceForce};
use std::f64::consts::PI;

/// Force between surfaces that a solver takes over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TakenForce {
    /// Its law.
    pub force: SurfaceForce,
    /// Whether solves with a prediction take it at the end of its time.
    pub is_implicit: bool,
}

/// Laws of some forces between spheres of all pairs of radii, for distances in another unit of length. The unit of
/// force is unchanged.
pub fn laws(forces: &[TakenForce], radii: &[f64], length: f64) -> SurfaceLaws {
    let pairs = radii.iter().flat_map(|&own| radii.iter().map(move |&other| [own, other]));
    let of_pair = |pair: [f64; 2]| forces.iter().map(move |force| law(force, pair, length));
    SurfaceLaws { count: forces.len(), of_pairs: pairs.flat_map(of_pair).collect() }
}

fn law(&TakenForce { force, is_implicit }: &TakenForce, radii: [f64; 2], length: f64) -> SurfacePair {
    let between = PairKind::Spheres(radii);
    let [reach, contact] = [force.reach(between), between.contact()].map(|distance| distance / length);
    let (mean, harmonic) = (between.mean_radius() / length, between.harmonic_radius());
    let (kind, numbers) = match force {
        SurfaceForce::Barrier(barrier) => {
            (SurfaceKind::Barrier, [barrier.strength(between) / contact, reach * reach - contact * contact, 0.0])
        }
        SurfaceForce::Screened { strength, radius_power, length: screening } => {
            (SurfaceKind::Screened, [strength * harmonic.powi(radius_power.into()), screening / length, 0.0])
        }
        SurfaceForce::VanDerWaals { hamaker, closest, range } => {
            let factor = hamaker * harmonic / (12.0 * length * length);
            (SurfaceKind::VanDerWaals, [factor, closest * mean, ((range + closest) * mean).powi(-2)])
        }
        SurfaceForce::Depletion { pressure, thickness } => {
            let [own, other] = radii.map(|radius| ((radius + thickness) / length).powi(2));
            (SurfaceKind::Depletion, [pressure * PI * length * length, own, other])
        }
    };
    SurfacePair::new(kind, [reach, contact], numbers).implicit(is_implicit)
}
