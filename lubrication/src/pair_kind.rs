//! Pair of surfaces: two spheres, or a sphere and a wall.

/// Pair of two spheres with given radii, or of a sphere and a plane wall. At a wall, quantities that depend on the
/// harmonic mean radius have the limit of a large second sphere; the arithmetic mean radius, which has none, is
/// replaced by the sphere's radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PairKind {
    /// Two spheres.
    Spheres([f64; 2]),
    /// A sphere and a wall.
    Wall(f64),
}

impl From<[f64; 2]> for PairKind {
    fn from(radii: [f64; 2]) -> Self {
        Self::Spheres(radii)
    }
}

impl PairKind {
    /// Distance of the centres, or of the centre from the wall, at contact.
    pub fn contact(&self) -> f64 {
        match self {
            Self::Spheres(radii) => radii[0] + radii[1],
            Self::Wall(radius) => *radius,
        }
    }

    /// Mean radius; at a wall the radius of the sphere.
    pub fn mean_radius(&self) -> f64 {
        match self {
            Self::Spheres(radii) => 0.5 * (radii[0] + radii[1]),
            Self::Wall(radius) => *radius,
        }
    }

    /// Harmonic mean radius `2 a_i a_j / (a_i + a_j)`; at a wall twice the radius of the sphere.
    pub fn harmonic_radius(&self) -> f64 {
        match self {
            Self::Spheres(radii) => 2.0 * radii[0] * radii[1] / (radii[0] + radii[1]),
            Self::Wall(radius) => 2.0 * radius,
        }
    }

    /// Distance at which the gap is `gap` mean radii.
    pub fn at_gap(&self, gap: f64) -> f64 {
        match self {
            Self::Spheres(radii) => (radii[0] + radii[1]) * (1.0 + 0.5 * gap),
            Self::Wall(radius) => radius * (1.0 + gap),
        }
    }

    /// The same surfaces in other units of length.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        match self {
            Self::Spheres(radii) => Self::Spheres(radii.map(|radius| radius * factor)),
            Self::Wall(radius) => Self::Wall(radius * factor),
        }
    }
}
