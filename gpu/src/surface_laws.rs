//! Laws of forces between the surfaces of spheres, as a device takes them.

use bytemuck::{Pod, Zeroable};

/// Kind of a law: how the repulsion `F` depends on the distance `r` of the centres, by its numbers `a`, `b` and `c`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SurfaceKind {
    /// `F = a [(reach^2 - r^2) / b]^2 r`
    Barrier,
    /// `F = a exp(-h / b)` at a gap `h`.
    Screened,
    /// `F = a [c - 1 / (max(h, 0) + b)^2]` at a gap `h`.
    VanDerWaals,
    /// `F = -a max(0, b - [(r^2 + b - c) / (2 r)]^2)`
    Depletion,
}

/// Law of a force between two spheres of given classes of radius, zero beyond its reach, with the fields of
/// `gpu/kernels/surface.h` in the same order.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct SurfacePair {
    kind: i64,
    pub(crate) reach: f64,
    contact: f64,
    numbers: [f64; 3],
}

impl SurfacePair {
    /// The law of a kind with its numbers, for distances of the centres `reach` where it ends and `contact` without a
    /// gap.
    pub fn new(kind: SurfaceKind, [reach, contact]: [f64; 2], numbers: [f64; 3]) -> Self {
        Self { kind: kind as i64, reach, contact, numbers }
    }
}

/// Laws of all forces between surfaces.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SurfaceLaws {
    /// Number of forces.
    pub count: usize,
    /// Their laws for all ordered pairs of classes, those of the first class first, and for each pair one by one.
    pub of_pairs: Vec<SurfacePair>,
}
