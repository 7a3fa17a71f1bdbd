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

impl SurfaceKind {
    const ALL: [Self; 4] = [Self::Barrier, Self::Screened, Self::VanDerWaals, Self::Depletion];
}

/// Law of a force between two spheres of given classes of radius, zero beyond its reach, with the fields of
/// `gpu/kernels/surface.h` in the same order.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct SurfacePair {
    kind: i64,
    is_implicit: i64,
    pub(crate) reach: f64,
    contact: f64,
    numbers: [f64; 3],
}

impl SurfacePair {
    /// Size of the force in contact.
    fn at_contact(&self) -> f64 {
        let &Self { kind, reach, contact: r, numbers: [a, b, c], .. } = self;
        let force = match SurfaceKind::ALL[kind as usize] {
            SurfaceKind::Barrier => a * ((reach * reach - r * r) / b).powi(2) * r,
            SurfaceKind::Screened => a,
            SurfaceKind::VanDerWaals => a * (c - 1.0 / (b * b)),
            SurfaceKind::Depletion => a * b,
        };
        force.abs()
    }

    /// The law of a kind with its numbers, for distances of the centres `reach` where it ends and `contact` without a
    /// gap.
    pub fn new(kind: SurfaceKind, [reach, contact]: [f64; 2], numbers: [f64; 3]) -> Self {
        Self { kind: kind as i64, is_implicit: 0, reach, contact, numbers }
    }

    /// The same, implicit or not: predictions take implicit forces at their end. Only barriers and screened repulsions
    /// have a stiffness.
    #[must_use]
    pub fn implicit(self, is_implicit: bool) -> Self {
        Self { is_implicit: i64::from(is_implicit), ..self }
    }

    /// Whether predictions take the force at their end.
    pub(crate) fn is_implicit(&self) -> bool {
        self.is_implicit != 0
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

impl SurfaceLaws {
    /// Size of the largest force between spheres in contact.
    pub fn largest(&self) -> f64 {
        self.of_pairs.iter().map(SurfacePair::at_contact).fold(0.0, f64::max)
    }

    /// Distance of the centres up to which implicit forces act; 0 without any.
    pub(crate) fn implicit_reach(&self) -> f64 {
        self.of_pairs.iter().filter(|law| law.is_implicit()).map(|law| law.reach).fold(0.0, f64::max)
    }
}
